"""Only the effects a scene calls for, against a model with everything on: what it saves, and costs.

In MuJoCo the lean model leaves out the stages of a step and the sensors that the scene does not
need. Everything puts them in: every stage, every sensor, the energies, and damping too small for
any number to feel. It keeps the contact of the scene: a dimension for drilling or rolling that the
scene does not declare is another contact, whose coefficients MuJoCo holds above 1e-5, and what is
compared here is the same physics.

The reference takes the smallest model for the turn of every bounce and phi at a hundred instants.
Everything is the largest model, the general can, with all that a command asks of it: the contact
locus and the works beside the angles, the grid that is dense by angle, states and forces there, the
guard's second look at them, and, of a scene that may be chaotic, when copies of its motion part.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.core.trajectory import Floats, Trajectory
from harness.engines.reference.assumption_checks import may_be_chaotic
from harness.engines.reference.to_reference_problem import problem
from harness.engines.reference.truth import Truth
from harness.engines.registry import engine, missing_effects
from harness.engines.stepping.horizon import natural_time
from harness.metrics.bounces import bounces
from harness.metrics.motion import motion
from models.catalogue import load, names
from models.scene import Horizon, Scene
from reference import Bounce, Solution, carries, divergence, examine, smallest, solve
from tests.benchmarks.clock import seconds

TIMESTEP = 1e-4
PIECE = 0.4
"""s: a bounce of most scenes, and six of those of cusps, each of which multiplies round-off."""

BOUNCES = 3
"""Of a scene that the reference solves: as many as show what a bounce costs."""

PAIRS = 15
"""On a processor that is shared one run of three is disturbed: the median of these is not."""

TOLERANCE = 1e-5
"""Relative, a hundredth of what the timestep leaves. Both runs round differently, by 1e-16 in every
step, and every hard bounce multiplies that: to 6e-7 in the six bounces of cusps."""

REFERENCE_GAIN, ENGINE_GAIN = 2.0, 1.2
"""Least ratios of processor times that the project holds itself to."""

GAIN_IN_GENERAL = 1.0
"""The same, of a scene whose effects need the general can: it leaves out the contact point alone,
and the quadratures, sampling and checks that everything adds cost little."""

INSTANTS = 100

_SECONDS = 0.3
"""Processor time, s, of a lean run from which a few pairs are enough: no disturbance is as long."""

_FEW = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Lean:
    """One scene with all that it does not need left out, against the same with everything.

    Parameters
    ----------
    scene, who, model : str
        Scene, engine, and what is solved.
    ratio : float
        Processor time of everything over that of lean, median of pairs.
    claim : str
    quantity : str
        The quantity of interest that differs most; empty if none differs.
    difference : float
        By how much, relative.
    tolerance : float
    holds : bool
        Both the ratio, where it is claimed, and the difference.
    lean_s, everything_s : float
        Processor time, s, medians.
    """

    scene: str
    who: str
    model: str
    ratio: float
    claim: str
    quantity: str
    difference: float
    tolerance: float
    holds: bool
    lean_s: float
    everything_s: float


def lean_ratios(engines: Sequence[str]) -> Iterator[Lean]:
    """Measure both on the scenes of the catalogue: engines that can build both, the reference.

    A scene that needs the largest model, or effects that an engine lacks, has nothing to compare.
    """
    able = [engine for engine in engines if builds_both(engine)]
    for name in names():
        scene = load(name)
        for each in able:
            if not missing_effects(each, scene):
                yield in_engine(each, scene, PAIRS)
        if carries("general", problem(scene)):
            yield in_reference(scene, PAIRS)


def builds_both(name: str) -> bool:
    """Whether an engine has a setting by which its model is lean or has everything."""
    return any(
        setting.name == "build" and {"lean", "everything"} <= set(setting.choices)
        for setting in engine(name).settings
    )


def in_engine(name: str, scene: Scene, pairs: int) -> Lean:
    """Run a piece of a scene with `build=lean`, which is matched's own, and `build=everything`."""
    chosen, piece = engine(name), replace(scene, horizon=Horizon(seconds=PIECE))

    def build(named: str) -> Simulation:
        options = (("build", named),)
        return chosen.simulate(Case(scene=piece, engine=name, timestep=TIMESTEP, options=options))

    lean, full = build("lean"), build("everything")
    times = [(build("lean").cpu_s, build("everything").cpu_s) for _ in range(pairs)]
    if lean.trajectory is None or full.trajectory is None:
        off = {"motion": math.inf}
    else:
        off = between(lean.trajectory, full.trajectory, piece)
    model = f"condim {lean.settings['condim']}"
    return _judged(scene.name, name, model, times, off)


def between(one: Trajectory, other: Trajectory, scene: Scene) -> dict[str, float]:
    """Return by how much two motions of a scene differ in each quantity of interest, relative."""
    mine, theirs = motion(one, scene), motion(other, scene)
    _, here, there = np.intersect1d(one.time, other.time, return_indices=True)
    apart = mine.angles.phi[here] - theirs.angles.phi[there]
    found = {
        "phi rms": float(np.sqrt(np.mean(apart**2)) / theirs.angles.phi.max()),
        "place at the end": float(
            np.abs(one.position[here[-1]] - other.position[there[-1]]).max() / scene.can.radius
        ),
    }
    ours, others = bounces(mine, scene.can), bounces(theirs, scene.can)
    if bool(ours) != bool(others):
        found["bounce"] = math.inf
    for first, second in zip(ours[:1], others[:1], strict=False):
        found["time of the bounce"] = abs(first.time / second.time - 1.0)
        # where the record of 1e-4 s is too coarse to count the turn, there is none to compare
        if first.resolved and second.resolved:
            found["turn"] = abs(first.angle_of_turn / second.angle_of_turn - 1.0)
    return found


def in_reference(scene: Scene, pairs: int) -> Lean:
    """Solve a scene for phi and the turn alone, and by the general model for all there is."""
    horizon = scene.horizon
    if horizon.bounces is not None:
        horizon = Horizon(bounces=min(horizon.bounces, BOUNCES))
    piece = replace(scene, horizon=horizon)
    posed = problem(piece)
    model = smallest(posed).model

    def lean() -> tuple[Solution, Floats]:
        solution = solve(posed, model=model)
        return solution, solution.at(np.linspace(0.0, solution.t_end, INSTANTS)).phi

    def full() -> Solution:
        solution = solve(posed, model="general", outputs=frozenset({"contact_locus"}))
        truth = Truth(scene=piece, solution=solution)
        grid = truth.grid()
        truth.at(grid)
        examine(solution, grid / natural_time(piece))
        if may_be_chaotic(piece):
            divergence(posed, solution)
        return solution

    (mine, phi), theirs = lean(), full()
    times = [(seconds(lean), seconds(full))]
    many = pairs if times[0][0] < _SECONDS else _FEW
    times += [(seconds(lean), seconds(full)) for _ in range(many - 1)]
    true = theirs.at(np.linspace(0.0, theirs.t_end, INSTANTS)).phi
    off = {"phi rms": float(np.sqrt(np.mean((phi - true) ** 2)) / true.max())}
    for one, other in zip(mine.bounces, theirs.bounces, strict=True):
        for quantity, read in _OF_A_BOUNCE.items():
            away = abs(read(one) / read(other) - 1.0) if read(other) else abs(read(one))
            off[quantity] = max(off.get(quantity, 0.0), away)
    return _judged(scene.name, "reference", model, times, off)


_OF_A_BOUNCE: dict[str, Callable[[Bounce], float]] = {
    "time of the bounce": lambda bounce: bounce.time,
    "phi at its minimum": lambda bounce: bounce.phi_min,
    "turn": lambda bounce: bounce.angle_of_turn,
}


def _judged(
    scene: str, who: str, model: str, times: list[tuple[float, float]], off: dict[str, float]
) -> Lean:
    """Return what was measured, held to what is claimed of it."""
    quantity, difference = max(off.items(), key=lambda item: item[1])
    ratio = median(full / lean for lean, full in times)
    gain = REFERENCE_GAIN if who == "reference" else ENGINE_GAIN
    gain = GAIN_IN_GENERAL if model == "general" else gain
    return Lean(
        scene=scene,
        who=who,
        model=model,
        ratio=ratio,
        claim=f"at least {gain:g}",
        quantity=quantity if difference else "",
        difference=difference,
        tolerance=TOLERANCE,
        holds=ratio >= gain and difference <= TOLERANCE,
        lean_s=median(pair[0] for pair in times),
        everything_s=median(pair[1] for pair in times),
    )
