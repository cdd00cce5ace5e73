"""Constructed releases, each solved in a batch and by itself, held to an independent answer.

Two answers that agree to AGREED are right, and so are two that part by no more than the numbers
given allow, three digits at least. For all others, and for every refusal, sixty digits decide.
"""

import json
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from reference import Outcome, PeriodicMotions, Problem, Solution, exact_bounces, solve
from reference.analysis.agreement import USEFUL
from reference.analysis.conditioning import EPS, neighbours
from tests.reference.hostile.made import CLOSEST, FAMILIES, Made, made
from tests.reference.hostile.truth import (
    MEASURES,
    Truth,
    conditioning,
    moved_by_ulps,
    numbers_of,
    relative,
    truth_of,
    ulps_decide_the_ending,
    ulps_of_the_gap,
)

# Relative, of the period, phi_min and the two angles: what is promised of hard releases.
AGREED = 1e-9
# A bounce takes a hundred evaluations of some tens of rounded operations each, of which a share
# adds up: a thousand, on numbers each known to half an ulp.
ROUNDINGS = 1000.0
# An ending is refuted, and a refusal without a reason, unless so many ulps of a number given change
# the ending, or of a refusal the third digit: the energy that decides is a sum of some ten rounded
# terms.
DECIDING = 8
# s of the processor, for one scene.
LONGEST = 5.0
# Releases solved in one batch, and kept in one file.
PIECE = 50
RELEASED = ("phi", "phi_dot", "psi_dot", "theta_dot")
# Relative amplitude below which a motion is called steady (`reference.track`), with a margin for
# the rounding of the amplitude itself.
STEADY = 2e-9


@dataclass(kw_only=True)
class Family:
    """What came of the releases of one family.

    Attributes
    ----------
    seen, bounced, batch_refused, single_refused, stated, conditioned, by_truth : int
        Releases; `stated` those of which `solve` says itself that fewer digits are known; the last
        two by what decided them: neighbours in double precision, sixty digits.
    worst : float
        Error over what is allowed.
    slowest : float
        s of the processor.
    """

    seen: int = 0
    bounced: int = 0
    batch_refused: int = 0
    single_refused: int = 0
    stated: int = 0
    conditioned: int = 0
    by_truth: int = 0
    worst: float = 0.0
    slowest: float = 0.0


GREATEST = ("worst", "slowest")


@dataclass(kw_only=True)
class Tally:
    """What came of releases.

    Attributes
    ----------
    families : dict of str to Family
    faults, refusals : list of str
        Wrong answers; and refusals with their conditioning.
    """

    families: dict[str, Family] = field(
        default_factory=lambda: {name: Family() for name in (*FAMILIES, CLOSEST)}
    )
    faults: list[str] = field(default_factory=list)
    refusals: list[str] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        """Count another's releases in."""
        for name, theirs in other.families.items():
            mine = self.families[name]
            for key, value in asdict(theirs).items():
                known = getattr(mine, key)
                setattr(mine, key, max(known, value) if key in GREATEST else known + value)
        self.faults += other.faults
        self.refusals += other.refusals


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """Outcome and measures of one release by one method.

    `stated` is the relative error that the method itself says its answer may have.
    """

    outcome: Outcome
    period: float = 0.0
    phi_min: float = 0.0
    turn: float = 0.0
    rotation: float = 0.0
    stated: float = 0.0

    def parts(self, other: "Answer") -> float:
        """Relative distance of two answers; infinite where their outcomes differ."""
        if self.outcome is not other.outcome:
            return np.inf
        if self.outcome is not Outcome.FINISHED:
            return 0.0
        return max(
            float(relative(name, getattr(self, name), getattr(other, name))) for name in MEASURES
        )


def piece(numbers: range, seed: int) -> Tally:
    """Try the releases of these numbers."""
    tally = Tally()
    releases = list(made(numbers, seed))
    for one, answer in zip(releases, in_a_batch(releases), strict=True):
        _judge(tally, one, answer)
    return tally


def kept_piece(numbers: range, seed: int, folder: Path | None) -> Tally:
    """Try the releases of these numbers, or read what came of them from the folder, if any."""
    if folder is None:
        return piece(numbers, seed)
    kept = folder / f"{seed}-{numbers.start}-{numbers.stop}.json"
    if kept.exists():
        known = json.loads(kept.read_text(encoding="utf-8"))
        known["families"] = {name: Family(**one) for name, one in known["families"].items()}
        return Tally(**known)
    tally = piece(numbers, seed)
    folder.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(asdict(tally)), encoding="utf-8")
    return tally


def _judge(tally: Tally, release: Made, batch: Answer) -> None:
    family = tally.families[release.family]
    family.seen += 1
    problem = problem_of(release)
    start = time.process_time()
    single = _of_solution(solve(problem))
    taken = time.process_time() - start
    family.slowest = max(family.slowest, taken)
    if taken > LONGEST:
        tally.faults.append(f"{taken:.1f} s for {release}")
    integrated = integrated_answer(problem)
    family.bounced += batch.outcome is Outcome.FINISHED
    family.batch_refused += batch.outcome is Outcome.UNRESOLVED
    family.single_refused += single.outcome is Outcome.UNRESOLVED
    family.stated += single.stated > 0
    given = {
        name: answer
        for name, answer in {"batch": batch, "single": single}.items()
        if answer.outcome is not Outcome.UNRESOLVED
    }
    apart = max((answer.parts(integrated) for answer in given.values()), default=0.0)
    allowed = AGREED
    if AGREED < apart < USEFUL:
        allowed += moved_by_roundings(problem, integrated, apart)
        family.conditioned += apart <= allowed
    if apart <= min(allowed, USEFUL):
        family.worst = max(family.worst, apart / allowed)
        if len(given) == 2 and batch.outcome is not Outcome.STEADY:
            return
    _by_sixty_digits(tally, release, given)


def moved_by_roundings(problem: Problem, own: Answer, enough: float) -> float:
    """Return by how much so many roundings of each number move an answer, added up to enough."""
    total = 0.0
    for beside in neighbours(problem, ROUNDINGS * EPS / 2):
        if total >= enough:
            break
        total += max(integrated_answer(other).parts(own) for other in beside)
    return total


def _reason(release: Made, truth: Truth) -> str:
    """Return why a release may be refused; nothing if it may not."""
    moved = moved_by_ulps(release, truth, 1, USEFUL, ("period",))
    if moved > USEFUL:
        return f"an ulp moves the period by {moved:.1e} or more"
    if ulps_decide_the_ending(release, truth, DECIDING):
        return f"{ulps_of_the_gap(release, truth):.1f} ulps of everything change the ending"
    moved = moved_by_ulps(release, truth, DECIDING, USEFUL)
    if moved > USEFUL:
        return f"{DECIDING} ulps of each number move a measure by {moved:.1e} or more"
    return ""


def _by_sixty_digits(tally: Tally, release: Made, given: dict[str, Answer]) -> None:
    """Hold answers to sixty digits, and refusals to what an ulp does."""
    family = tally.families[release.family]
    family.by_truth += 1
    truth = truth_of(numbers_of(release))
    refused = " and ".join(name for name in ("batch", "single") if name not in given)
    if refused:
        reason = _reason(release, truth)
        if not reason:
            reason = "no ulp decides it"
            tally.faults.append(f"refused by {refused}, though no ulp decides it: {release}")
        tally.refusals.append(
            f"{refused}: {reason}, and the least gap of the energy is {float(truth.gap):.1e}: "
            f"{release}"
        )
    errors = {name: _errors(answer, truth) for name, answer in given.items()}
    known: dict[str, float] | None = None
    for name, found in errors.items():
        for measure, error in found.items():
            if error <= AGREED:
                continue
            if measure == "ending":
                if not ulps_decide_the_ending(release, truth, DECIDING):
                    tally.faults.append(f"{name}: {given[name].outcome.name} is refuted: {release}")
                continue
            known = conditioning(release, truth) if known is None else known
            allowed = AGREED + given[name].stated + ROUNDINGS * known.get(measure, 0.0)
            family.worst = max(family.worst, error / allowed)
            if error > allowed:
                tally.faults.append(
                    f"{name}: {measure} off by {error:.1e}, {allowed:.1e} allowed: {release}"
                )


def _errors(answer: Answer, truth: Truth) -> dict[str, float]:
    """Return by how much each measure is off, relative; an ending that is wrong by infinity."""
    if truth.period is None or truth.phi_min is None or truth.phi_max is None:
        ending = Outcome.OVERTURNED if truth.phi_max is None else Outcome.FELL_FLAT
        return {"ending": 0.0 if answer.outcome is ending else np.inf}
    if answer.outcome is not Outcome.FINISHED:
        # a motion whose amplitude is below what counts as a bounce is called steady
        small = truth.phi_max - truth.phi_min < STEADY * truth.phi_max
        steady = small and answer.outcome is Outcome.STEADY
        return {"ending": 0.0 if steady else np.inf}
    return {
        name: float(relative(name, getattr(answer, name), getattr(truth, name)))
        for name in MEASURES
    }


def problem_of(release: Made) -> Problem:
    """Return what is solved of a release: of a moving one the second bounce is the first whole."""
    return Problem(
        parameters=release.parameters,
        **{name: getattr(release, name) for name in RELEASED},
        bounces=2,
    )


def in_a_batch(releases: list[Made], *, compiled: bool = False) -> list[Answer]:
    """Solve releases by `exact_bounces`, by compiled kernels first if asked."""
    cycles = exact_bounces(
        **{name: [getattr(one.parameters, name) for one in releases] for name in "ach"},
        **{name: [getattr(one, name) for one in releases] for name in RELEASED},
        compiled=compiled,
    )
    return [_of_batch(cycles, number) for number in range(len(releases))]


def integrated_answer(problem: Problem) -> Answer:
    """Solve a problem by integration."""
    return _of_solution(solve(problem, model="rolling"))


def _of_batch(cycles: PeriodicMotions, number: int) -> Answer:
    outcome = cycles.outcome(number)
    if outcome is not Outcome.FINISHED:
        return Answer(outcome=outcome)
    return Answer(
        outcome=outcome,
        period=float(cycles.period[number]),
        phi_min=float(cycles.phi_min[number]),
        turn=float(cycles.angle_of_turn[number]),
        rotation=float(cycles.rotation_turn[number]),
    )


def _of_solution(solution: Solution) -> Answer:
    if solution.outcome is not Outcome.FINISHED or len(solution.bounces) < 2:
        return Answer(outcome=solution.outcome)
    maxima, seen = solution.maxima, solution.agreement
    return Answer(
        outcome=solution.outcome,
        period=float(maxima[-1] - maxima[-2]),
        phi_min=solution.bounces[-1].phi_min,
        turn=solution.bounces[-1].angle_of_turn,
        rotation=solution.bounces[-1].rotation_turn,
        stated=seen.discrepancy if seen is not None and seen.holds and seen.sentence else 0.0,
    )
