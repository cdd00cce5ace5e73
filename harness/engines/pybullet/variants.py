"""PyBullet's settings that are worth a price, and how to write them into a program of one's own.

Each is one change to `matched`. A margin makes another rim than the scene's, which only profile
`default` lets pass: so that variant is the shipped engine with all gaps closed but this.
"""

from typing import TYPE_CHECKING, Any

import pybullet

from harness.case import Case
from harness.engines.pybullet.settings import (
    DYNAMICS,
    PROCESS_WIDE,
    SETTINGS,
    SOLVER,
    URDF_FLAGS,
    in_force,
)
from harness.engines.registry import engine
from harness.engines.variants import COMMON, Variant

if TYPE_CHECKING:
    from harness.engines.pybullet.world import PybulletWorld

_ALL_BUT_THE_MARGIN = tuple(
    (setting.name, setting.matched)
    for setting in SETTINGS
    if setting.matched not in {None, setting.default} and not callable(setting.matched)
)

SHIPPED_ERP = 0.08
"""What contactERP is where PyBullet is not handed one."""

VARIANTS = (
    *COMMON,
    *(
        Variant(
            name=f"{count} sweeps at most",
            settings=(("numSolverIterations", count),),
            thorough=count != 5,  # noqa: PLR2004 - the middle one
        )
        for count in (2, 5, 10)
    ),
    *(
        Variant(
            name=f"contactERP {share:g}",
            settings=(("contactERP", share),),
            imposes="penetration that is taken away slowly",
            thorough=share > SHIPPED_ERP,
        )
        for share in (SHIPPED_ERP, 0.2)
    ),
    Variant(
        name="margin of 1 mm",
        profile="default",
        settings=tuple((dict(_ALL_BUT_THE_MARGIN) | {"collisionMargin": 0.001}).items()),
        imposes="a rim rounded by a margin of 1 mm",
    ),
    Variant(
        name="friction of two directions",
        settings=(("enableConeFriction", 0),),
        imposes="a friction cone that is a pyramid",
    ),
    Variant(name="maximal coordinates", settings=(("useMaximalCoordinates", True),)),
)


def counted_step(world: "PybulletWorld") -> int:
    """Step, and return the sweeps of the solver over all islands."""
    here = {"physicsClientId": world.client}
    pybullet.setPhysicsEngineParameter(reportSolverAnalytics=1, **here)
    islands: tuple[dict[str, Any], ...] = pybullet.stepSimulation(**here) or ()
    return sum(int(island["numIterationsUsed"]) for island in islands)


_ADAPTIVE = """\
# The timestep follows the motion. Before each stepSimulation of a can with these measures:
#   from harness.engines.schedule import Adaptive  # Adaptive(can, largest={largest!r}, ...)
#   pybullet.setTimeStep(step)                     # of schedule.next(quaternion, angular velocity)
"""


def paste(case: Case) -> str:
    """Return the settings of a case as calls, for a world that is connected and a file can.urdf."""
    chosen = engine(case.engine)
    timestep = chosen.timestep(case)
    settings = in_force(case, timestep or 0.0)
    solver = {s.name: settings[s.name] for s in SOLVER if settings[s.name] is not None}
    solver = {**PROCESS_WIDE, **solver}
    dynamics = {s.name: settings[s.name] for s in DYNAMICS if settings[s.name] is not None}
    flags = [
        f"pybullet.{s.name}" for s in URDF_FLAGS if s.name.startswith("URDF_") and settings[s.name]
    ]
    load = ['"can.urdf"', *([f"flags={' | '.join(flags)}"] if flags else [])]
    load += ["useMaximalCoordinates=True"] if settings["useMaximalCoordinates"] else []
    lines = [
        "import pybullet",
        "",
        f"pybullet.setTimeStep({timestep!r})",
        f"pybullet.setPhysicsEngineParameter({_arguments(solver)})",
        f"can = pybullet.loadURDF({', '.join(load)})",
    ]
    if dynamics:
        lines.append(f"pybullet.changeDynamics(can, -1, {_arguments(dynamics)})")
    text = "\n".join(lines) + "\n"
    if case.profile == "adaptive":
        text = _ADAPTIVE.format(largest=timestep) + text
    return text


def _arguments(settings: dict[str, Any]) -> str:
    """Return settings as arguments; a setting that is a word is one of PyBullet's constants."""
    told = {n: f"pybullet.{v}" if isinstance(v, str) else repr(v) for n, v in settings.items()}
    return ", ".join(f"{name}={value}" for name, value in told.items())
