"""Commands on scenes alone, which need no engine: the catalogue, and models that engines open."""

from pathlib import Path
from typing import Annotated

import typer

from harness.cli import terminal
from harness.cli.options import Json, SceneName
from harness.core.engine_packages import install_command
from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.core.scene_limits import check_scene_limits
from models.catalogue import load, names
from models.scene import Horizon, Scene


def scenes(json: Json = False) -> None:  # noqa: FBT002 - a switch of the command line
    """The catalogue: what each scene is, and its source."""
    catalogue = [load(name) for name in names()]
    if json:
        typer.echo(terminal.to_json({"scenes": [scene.to_dict() for scene in catalogue]}))
        return
    columns = ("scene", "phi_rad", "psi_dot_rad_s", "theta_dot_rad_s", "ends", "effects", "source")
    rows = [
        (
            *(scene.name, scene.release.phi, scene.release.psi_dot, scene.release.theta_dot),
            *(_end(scene.horizon), ", ".join(scene.effects.declared()) or "none", scene.cite),
        )
        for scene in catalogue
    ]
    terminal.stdout_console().print(terminal.table("Scenes", columns, rows))


def _end(horizon: Horizon) -> str:
    """Return in words when a run ends."""
    return f"{horizon.seconds:g} s" if horizon.seconds else f"bounce {horizon.bounces}"


def _mjcf(scene: Scene) -> str:
    from models.to_mjcf import mjcf  # noqa: PLC0415 - the list of scenes does without numpy

    return mjcf(scene)


def _urdf(scene: Scene) -> str:
    from models.to_urdf import urdf  # noqa: PLC0415

    return urdf(scene)


def _sdf(scene: Scene) -> str:
    from models.to_sdf import sdf  # noqa: PLC0415

    return sdf(scene)


def _usd(scene: Scene) -> str:
    from models.to_usd import usd  # noqa: PLC0415

    try:
        return usd(scene)
    except ImportError as error:
        install = install_command(["rockingcan[usd]"])
        raise MissingPackageError("--format usd", "usd-core", str(error), install) from error


def _csv(scene: Scene) -> str:
    from harness.records.export import exact_frame  # noqa: PLC0415

    return exact_frame(scene).to_csv(index=False, lineterminator="\n")


def _json(scene: Scene) -> str:
    from harness.records.export import exact_json  # noqa: PLC0415

    return f"{terminal.to_json(exact_json(scene))}\n"


_WRITERS = {
    "mjcf": _mjcf,
    "urdf": _urdf,
    "sdf": _sdf,
    "usd": _usd,
    "csv": _csv,
    "json": _json,
}


def export(
    scene: SceneName,
    format_: Annotated[
        str, typer.Option("--format", help="mjcf, urdf, sdf or usd; csv or json: its motion.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Write it here; to standard output if left out.")
    ] = None,
) -> None:
    """A scene as a model that an engine opens, or its exact motion.

    For example: rockingcan export gentle-rock --format mjcf --out can.xml
    """
    if format_ not in _WRITERS:
        raise InvalidSettingError("--format", format_, ", ".join(_WRITERS))
    chosen = load(scene)
    check_scene_limits(chosen)  # what overflows is no model
    text = _WRITERS[format_](chosen)
    if out is None:
        typer.echo(text.rstrip("\n"))
    else:
        terminal.write_text(text, out)
