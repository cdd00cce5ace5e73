"""The exact can and each engine's, side by side, in a time that is slow where much happens.

Half of the frames are spread over the time, half over the turning of the exact can: the bounce of
the paper's release, microseconds of a run of a tenth of a second, then takes half of the replay.
Every can is shown by its own clock, which strikes zero at its own first bounce.
"""

import math
from collections.abc import Sequence

import numpy as np

from harness.core.report_model import Body, Replay
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion
from harness.studies.comparison.selection import by_case, drawn_runs, label, longest
from models.rim import contact_point
from models.scene import Scene

_FRAMES = 480
"""Eight seconds of sixty frames; a bounce of 209 degrees moves by less than one in a frame."""

_RATE = 60.0
"""Frames that the page shows in a second."""

_SHOWN_TILT = 0.3
"""rad: a can that tilts less is drawn as if it tilted so far."""

_LARGEST_TILT = 12.0
"""Beyond it the drawing would have little to do with the can."""


def replay(scene: str, evaluations: Sequence[Evaluation]) -> tuple[Replay, ...]:
    """Return the replay of a scene, or nothing if there is nothing exact to show."""
    drawn = _two_each(drawn_runs(evaluations))
    exact = longest(drawn).truth if drawn else None
    if exact is None or len(exact.time) <= 1:
        return ()
    own = drawn[0].simulation.case.scene
    true = next((e.true_bounces[0].time for e in drawn if e.true_bounces), 0.0)
    time = _frames(exact)
    bodies = [_body("exact", "reference", exact, own, time)]
    for e in drawn:
        if e.motion is not None:
            late = e.bounces[0].time - true if e.bounces and e.true_bounces else 0.0
            kind = e.simulation.case.engine
            bodies.append(_body(label(e), kind, e.motion, own, time + late))
    tilt = _tilt(exact)
    return (
        Replay(
            name=f"{scene}-replay",
            title="Replay",
            seen=f"{_slow(time, own)} {_drawn(tilt, bounces=bool(drawn[0].true_bounces))}",
            radius=own.can.radius,
            height=2.0 * own.can.half_height,
            time=time,
            bodies=tuple(bodies),
            tilt=tilt,
            scene=scene,
        ),
    )


def _two_each(drawn: Sequence[Evaluation]) -> list[Evaluation]:
    """Return of each engine the run as shipped, and beside it the best that there is."""
    chosen: list[Evaluation | None] = []
    for runs in by_case(drawn, "engine").values():
        own = {e.simulation.case.profile: e for e in runs}
        chosen += [own.get("default"), own.get("adaptive", own.get("matched"))]
    return [e for e in chosen if e is not None]


def _frames(exact: Motion) -> Floats:
    """Return the times of the frames, half by time and half by turning, s."""
    angle = np.abs(np.diff(exact.angles.psi)).cumsum()
    passed = (exact.time - exact.time[0]) / (exact.time[-1] - exact.time[0])
    turned = np.concatenate(([0.0], angle)) / angle[-1] if angle[-1] > 0.0 else passed
    frames: Floats = np.interp(np.linspace(0.0, 1.0, _FRAMES), (passed + turned) / 2.0, exact.time)
    return frames


def _body(label_: str, kind: str, motion: Motion, scene: Scene, time: Floats) -> Body:
    """Return a can at the times of the frames; before and after its record it stands still."""
    at = motion.trajectory
    contact = contact_point(scene.can, at.position, at.quaternion)[:, :2]
    return Body(
        label=label_,
        kind=kind,
        phi=np.interp(time, motion.time, motion.angles.phi),
        psi=np.interp(time, motion.time, motion.angles.psi),
        theta=np.interp(time, motion.time, motion.angles.theta),
        contact=np.column_stack(
            [np.interp(time, motion.time, contact[:, axis]) for axis in range(2)]
        ),
    )


def _tilt(exact: Motion) -> float:
    """Return by how much phi is drawn larger, a number of one digit."""
    largest = float(exact.angles.phi.max())
    wanted = min(max(_SHOWN_TILT / largest, 1.0), _LARGEST_TILT) if largest > 0.0 else 1.0
    return float(math.floor(wanted))


def _slow(time: Floats, scene: Scene) -> str:
    steps = np.diff(time)
    ratio = float(steps.max() / steps.min())
    return (
        f"{time[-1] - time[0]:.3g} s of {scene.name} are played in {_FRAMES / _RATE:.0f} s; where "
        f"the can turns fastest, time goes {ratio:.0f} times slower than where it turns least."
    )


def _drawn(tilt: float, *, bounces: bool) -> str:
    larger = f"Its tilt is drawn {tilt:.0f} times as large as it is" if tilt > 1.0 else ""
    clocks = "every can is shown by the clock of its own first bounce" if bounces else ""
    told = "; ".join(part for part in (larger, clocks) if part)
    return f"{told[:1].upper()}{told[1:]}." if told else "All cans are shown at the same time."
