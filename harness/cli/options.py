"""The options that several commands share, each declared once."""

from pathlib import Path
from typing import Annotated

import typer

SceneName = Annotated[
    str,
    typer.Argument(
        metavar="SCENE",
        help="A scene of the catalogue (see: rockingcan scenes) or the path of a scene file.",
    ),
]
EngineName = Annotated[str, typer.Option(help="Which engine (see: rockingcan engines).")]
Profile = Annotated[
    str,
    typer.Option(
        help="default: as it ships; matched: only what the scene declares; adaptive: own steps."
    ),
]
Timestep = Annotated[float | None, typer.Option(help="In seconds; the profile's own if left out.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="A setting by the engine's own name (see: rockingcan engines ENGINE); repeat it.",
    ),
]
EngineNames = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        help="An engine to run, or 'all' that are installed; repeat it. The usual if left out.",
    ),
]
ReplacedFolder = Annotated[Path, typer.Option(help="Folder of the report; replaced as a whole.")]
ReportFolder = Annotated[Path | None, typer.Option(help="Write a report into this folder.")]
Figures = Annotated[
    bool, typer.Option("--figures", help="Draw each figure for paper too, as PNG and SVG.")
]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON object and nothing else on standard output.")
]

STORE = Path("reports/.store")
"""Usual folder of the store, below the folder in which the command is run."""

VARIABLE = "ROCKINGCAN_STORE"
"""Environment variable that names another folder."""

PANEL = "Running and resuming"
"""Part of the help in which options of running stand."""

Jobs = Annotated[
    int | None,
    typer.Option(min=1, help="Processes; one a core if left out.", rich_help_panel=PANEL),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run on a Dask cluster: its scheduler, such as tcp://host:8786.",
        rich_help_panel=PANEL,
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        metavar="SECONDS",
        help="Stop a case that takes longer; half an hour if left out.",
        rich_help_panel=PANEL,
    ),
]
"""An option for `limits_of`."""

MemoryLimit = Annotated[
    float | None,
    typer.Option(
        metavar="GIB",
        help="Stop a case that uses more memory; 4, or a share of the machine's, if left out.",
        rich_help_panel=PANEL,
    ),
]
"""An option for `limits_of`."""
