"""The leaderboard: what engines reach in each scene, and what it costs, from files of results.

Pure functions of results of one suite, and of one division at a time. The case that stands for an
engine in a scene is the one with the smallest error, and the error of a case is one angle: the
larger of the size of the error of the turn, where the can turns, and of the root mean square error
of phi. An error of the turn alone can be zero by chance, where it changes its sign between two
timesteps; both angles together cannot. A run that bounced and whose turn could not be counted has
no error, however near its phi is.

Engines that impose rolling as a constraint solve another problem, and stand after the others.

For example: frontier(cost_points(results, Division.MATCHED), "cpu_s").
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from harness.core.case import run_command
from harness.engines.registry import is_constraint
from harness.metrics.quantities import Number
from harness.results.errors import MixedSuitesError
from harness.results.result import Result
from harness.results.scores import Division, Score

_TURN, _PHI = "angle_of_turn_error_deg", "phi_rms_rad"


@dataclass(frozen=True, slots=True, kw_only=True)
class CostPoint:
    """A case that reached its horizon, with its error and what it cost.

    Parameters
    ----------
    scene, engine : str
    label, version : str
        Of the engine, for people.
    submitter : str
        Who wrote the result; may be empty.
    division : Division
    error_rad : float
        See the module.
    turn_error_deg : float or None
        Error of the first turn, signed; None where nothing turns.
    phi_rms_rad : float
    steps : int
    cpu_s : float
        Time of the processor on the machine of the result: `machine`, which no other is like.
    machine : str
        Processor, in the words of its maker.
    imposes_rolling : bool
        Whether rolling is a constraint of the engine, which is ranked with none that has contacts.
    case : str
        The case in a few words.
    digest : str
        Of the case in the version of its engine.
    command : str
        Runs the case again.
    place : str
        File of the result.
    """

    scene: str
    engine: str
    label: str
    version: str
    submitter: str
    division: Division
    error_rad: float
    turn_error_deg: Number
    phi_rms_rad: float
    steps: int
    cpu_s: float
    machine: str
    imposes_rolling: bool
    case: str
    digest: str
    command: str
    place: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """An engine of one version in one scene: a cell of the leaderboard.

    Parameters
    ----------
    scene, engine, label, version, submitter, division, imposes_rolling, place
        As in `CostPoint`.
    best : CostPoint or None
        The case with the smallest error; None where no case reached its horizon with an error.
    endings : tuple of str
        How the cases of the scene ended, each outcome once; empty where none was run.
    truth_pulls : bool
        Whether the exact motion asks the plane to pull, so that no contact can follow: `best` is
        None then.
    """

    scene: str
    engine: str
    label: str
    version: str
    submitter: str
    division: Division
    imposes_rolling: bool
    best: CostPoint | None
    endings: tuple[str, ...]
    truth_pulls: bool
    place: str


def leaderboard(results: Sequence[Result], division: Division) -> tuple[Standing, ...]:
    """Return the standings of each engine in each scene of a suite, the best of a scene first.

    Scenes are in the order of the results; of each those that have no error stand last, and then
    the engines that impose rolling. An engine without a case in the division has no standing.

    Parameters
    ----------
    results : sequence of Result
        Of one suite. Two results of one engine and version have a standing each.
    division : Division

    Raises
    ------
    MixedSuitesError
        If the results are of several suites.
    """
    scenes = {score.scene: None for result in results for score in result.cases}
    turning = _turning(results)
    standings = [
        _standing(result, scene, engine, division, turning)
        for scene in scenes
        for result in _of_one_suite(results)
        for engine in dict.fromkeys(
            score.engine for score in result.cases if score.division is division
        )
    ]
    places = {scene: place for place, scene in enumerate(scenes)}
    return tuple(sorted(standings, key=lambda s: (places[s.scene], *_rank(s))))


def cost_points(results: Sequence[Result], division: Division) -> tuple[CostPoint, ...]:
    """Return every case of a division that has an error, in the order of the results.

    Raises
    ------
    MixedSuitesError
        If the results are of several suites.
    """
    turning = _turning(results)
    points = (
        _point(result, score, turning)
        for result in _of_one_suite(results)
        for score in result.cases
        if score.division is division
    )
    return tuple(point for point in points if point is not None)


def frontier(points: Sequence[CostPoint], cost: Literal["cpu_s", "steps"]) -> tuple[CostPoint, ...]:
    """Return the points of one scene that no cheaper one is as exact as, the cheapest first.

    Engines that impose rolling are on the frontier of their own: where there are others, on none.
    """

    def price(point: CostPoint) -> float:
        return point.cpu_s if cost == "cpu_s" else point.steps

    best: list[CostPoint] = []
    ranked = [point for point in points if not point.imposes_rolling] or points
    for point in sorted(ranked, key=lambda p: (price(p), p.error_rad)):
        if not best or point.error_rad < best[-1].error_rad:
            best.append(point)
    return tuple(best)


def _of_one_suite(results: Sequence[Result]) -> Sequence[Result]:
    suites = tuple(sorted({result.suite for result in results}))
    if len(suites) > 1:
        raise MixedSuitesError(suites=suites)
    return results


def _turning(results: Sequence[Result]) -> frozenset[str]:
    """Return the scenes in which a can bounces: some run has a bounce to be held to the truth."""
    return frozenset(
        score.scene
        for result in results
        for score in result.cases
        if {_TURN, "bounce_time_error_s"} & set(score.values)
    )


def _rank(standing: Standing) -> tuple[bool, float, str, str]:
    error = math.inf if standing.best is None else standing.best.error_rad
    return standing.imposes_rolling, error, standing.engine, standing.version


def _standing(
    result: Result, scene: str, engine: str, division: Division, turning: Collection[str]
) -> Standing:
    own = [
        score
        for score in result.cases
        if (score.scene, score.engine, score.division) == (scene, engine, division)
    ]
    points = [p for p in (_point(result, score, turning) for score in own) if p is not None]
    return Standing(
        scene=scene,
        engine=engine,
        label=result.engines[engine].label,
        version=result.engines[engine].version,
        submitter=result.name,
        division=division,
        imposes_rolling=is_constraint(engine),
        best=min(points, key=lambda point: point.error_rad, default=None),
        endings=tuple(dict.fromkeys(score.outcome for score in own)),
        truth_pulls=any(score.truth_pulls for score in own),
        place=result.place,
    )


def _point(result: Result, score: Score, turning: Collection[str]) -> CostPoint | None:
    """Return the point of a case; None if it has no error that could be ranked."""
    error = error_rad(score, turns=score.scene in turning)
    if error is None:
        return None
    engine = result.engines[score.engine]
    return CostPoint(
        scene=score.scene,
        engine=score.engine,
        label=engine.label,
        version=engine.version,
        submitter=result.name,
        division=score.division,
        error_rad=error,
        turn_error_deg=score.values.get(_TURN),
        phi_rms_rad=score.values[_PHI],
        steps=int(score.values["steps"]),
        cpu_s=score.values["cpu_s"],
        machine=result.machine.processor,
        imposes_rolling=is_constraint(score.engine),
        case=score.identity.label(),
        digest=score.digest,
        command=command(result, score),
        place=result.place,
    )


def error_rad(score: Score, *, turns: bool) -> Number:
    """Return the error of a case, rad; None if it ended early, or cannot be held to the truth.

    Parameters
    ----------
    score : Score
    turns : bool
        Whether the can bounces in the scene of the case.
    """
    needed = {_PHI, "steps", "cpu_s", *((_TURN,) if turns else ())}
    if not needed <= set(score.values) or not score.finished or score.truth_pulls:
        return None
    return max(abs(math.radians(score.values.get(_TURN, 0.0))), score.values[_PHI])


def command(result: Result, score: Score) -> str:
    """Return the command line that runs a case again, with the settings of its division."""
    prefix = f"{score.engine}."
    own = [
        f"{name.removeprefix(prefix)}={value}"
        for name, value in result.settings.items()
        if name.rpartition(".")[0] == score.engine
    ]
    settings = [*score.options.split(), *own]
    timestep = score.timestep or None
    return run_command(score.scene, score.engine, score.profile, timestep, settings)
