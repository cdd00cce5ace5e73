"""Constructed releases, each solved in a batch and by itself, held to an independent answer.

Two answers that agree to AGREED are right. Where they do not, sixty digits decide, and an error is
held to what half an ulp of the numbers given does to the motion.
"""

import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from reference import Cycles, Outcome, Problem, Solution, exact_bounces, solve
from tests.reference.hostile.made import Made, made
from tests.reference.hostile.truth import conditioning, numbers_of, truth_of

# Relative, of the period and phi_min: what is promised of hard releases.
AGREED = 1e-9
# A motion is the result of some hundred rounded operations, on numbers each known to half an ulp.
ROUNDINGS = 200.0
# s of the processor, for one scene.
LONGEST = 5.0
MEASURES = ("period", "phi_min")


@dataclass(kw_only=True)
class Tally:
    """What came of releases.

    Attributes
    ----------
    seen, bounced, batch_refused, single_refused : Counter
        Releases by family.
    by_truth : Counter
        Those that sixty digits had to decide.
    worst : dict of str to float
        Error over what conditioning allows, by family.
    slowest : float
        s of the processor.
    faults, refusals : list of str
        Wrong answers; and refusals with their conditioning.
    """

    seen: Counter[str] = field(default_factory=Counter)
    bounced: Counter[str] = field(default_factory=Counter)
    batch_refused: Counter[str] = field(default_factory=Counter)
    single_refused: Counter[str] = field(default_factory=Counter)
    by_truth: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    slowest: float = 0.0
    faults: list[str] = field(default_factory=list)
    refusals: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """Outcome, period and phi_min of one release by one method."""

    outcome: Outcome
    period: float = 0.0
    phi_min: float = 0.0

    def parts(self, other: "Answer") -> float:
        """Relative distance of two answers; infinite where their outcomes differ."""
        if self.outcome is not other.outcome:
            return np.inf
        if self.outcome is not Outcome.FINISHED:
            return 0.0
        pairs = ((getattr(self, name), getattr(other, name)) for name in MEASURES)
        return float(max(abs(one / two - 1) for one, two in pairs))


def campaign(count: int, seed: int) -> Tally:
    """Try so many releases."""
    tally = Tally()
    releases = list(made(count, seed))
    cycles = exact_bounces(
        a=[one.parameters.a for one in releases],
        c=[one.parameters.c for one in releases],
        h=[one.parameters.h for one in releases],
        phi=[one.phi for one in releases],
        phi_dot=[one.phi_dot for one in releases],
        psi_dot=[one.psi_dot for one in releases],
        theta_dot=[one.theta_dot for one in releases],
    )
    for number, one in enumerate(releases):
        _judge(tally, one, _of_batch(cycles, number))
    return tally


def _judge(tally: Tally, release: Made, batch: Answer) -> None:
    family = release.family
    tally.seen[family] += 1
    problem = Problem(
        parameters=release.parameters,
        phi=release.phi,
        phi_dot=release.phi_dot,
        psi_dot=release.psi_dot,
        theta_dot=release.theta_dot,
        # of a moving release the second bounce is the first whole one
        bounces=2,
    )
    start = time.process_time()
    single = _of_solution(solve(problem))
    taken = time.process_time() - start
    tally.slowest = max(tally.slowest, taken)
    if taken > LONGEST:
        tally.faults.append(f"{family}: {taken:.1f} s for {release}")
    integrated = _of_solution(solve(problem, model="rolling"))
    tally.bounced[family] += batch.outcome is Outcome.FINISHED
    refused = {"batch": batch, "single": single}
    answers = {
        name: answer for name, answer in refused.items() if answer.outcome is not Outcome.UNRESOLVED
    }
    tally.batch_refused[family] += batch.outcome is Outcome.UNRESOLVED
    tally.single_refused[family] += single.outcome is Outcome.UNRESOLVED
    apart = max((answer.parts(integrated) for answer in answers.values()), default=0.0)
    if len(answers) == len(refused) and apart <= AGREED:
        tally.worst[family] = max(tally.worst.get(family, 0.0), apart / AGREED)
        return
    _by_sixty_digits(tally, release, answers)


def _by_sixty_digits(tally: Tally, release: Made, answers: dict[str, Answer]) -> None:
    """Hold answers to sixty digits, and refusals to the conditioning."""
    family = release.family
    tally.by_truth[family] += 1
    truth = truth_of(numbers_of(release))
    known = conditioning(release, truth)
    decides = known["gap"] * ROUNDINGS
    if len(answers) < 2:
        tally.refusals.append(
            f"{family}: conditioning of the barrier {known['gap']:.1e}; {release}"
        )
        if decides < 1:
            tally.faults.append(f"{family}: refused, though the barrier is known: {release}")
    for name, answer in answers.items():
        bounces = truth.period is not None
        if bounces != (answer.outcome is Outcome.FINISHED):
            # a motion whose amplitude is below what counts as a bounce is called steady
            small = bounces and truth.phi_max - truth.phi_min < STEADY * truth.phi_max
            if decides < 1 and not small:
                tally.faults.append(f"{family}: {name} says {answer.outcome.name}: {release}")
            continue
        if not bounces:
            continue
        for measure in MEASURES:
            error = abs(getattr(answer, measure) / float(getattr(truth, measure)) - 1)
            allowed = AGREED + ROUNDINGS * known[measure]
            share = error / allowed
            tally.worst[family] = max(tally.worst.get(family, 0.0), share)
            if share > 1 and decides < 1:
                tally.faults.append(
                    f"{family}: {name}, {measure} off by {error:.1e} of {allowed:.1e}: {release}"
                )


# Relative amplitude below which a motion is called steady (`reference.track`), with a margin for
# the rounding of the amplitude itself.
STEADY = 2e-9


def _of_batch(cycles: Cycles, number: int) -> Answer:
    outcome = cycles.outcome(number)
    if outcome is not Outcome.FINISHED:
        return Answer(outcome=outcome)
    return Answer(
        outcome=outcome,
        period=float(cycles.period[number]),
        phi_min=float(cycles.phi_min[number]),
    )


def _of_solution(solution: Solution) -> Answer:
    if solution.outcome is not Outcome.FINISHED or len(solution.bounces) < 2:
        return Answer(outcome=solution.outcome)
    maxima = solution.maxima
    return Answer(
        outcome=solution.outcome,
        period=float(maxima[-1] - maxima[-2]),
        phi_min=solution.bounces[-1].phi_min,
    )
