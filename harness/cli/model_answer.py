"""What `reference` says of its model: which, how many equations, why, and where it ends."""

from collections.abc import Iterable
from dataclasses import asdict

from harness.cli.json_output import Answer, divergence_json
from harness.cli.terminal import chaos_sentences
from harness.core.errors import TrajectoryError
from harness.core.simulation import Outcome
from harness.engines.reference import ENDING, Agreement
from harness.engines.reference.assumption_checks import check_assumptions
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import Truth, solve_case
from harness.evaluation.evaluation import Evaluation


def model_answer(e: Evaluation, found: Truth | None, asked: str) -> Answer:
    """Return what goes into the answer of `reference` beside the motion in numbers.

    Parameters
    ----------
    e : Evaluation
    found : Truth or None
        None of a scene without a motion to show.
    asked : str
        The model that was asked for.

    Raises
    ------
    TrajectoryError
        If the reference returned what is no motion, which nobody may take for an answer.
    """
    answer: Answer = {
        "model": None,
        "equations": None,
        "why": None,
        "method": None,
        "agreement": None,
        "phases": [],
        "guard": None,
        "findings": [asdict(finding) for finding in e.findings],
        "divergence": divergence_json(e.divergence),
    }
    if found is None:
        if e.simulation.outcome is Outcome.BROKEN:
            raise TrajectoryError(f"{e.simulation.case.label()}: {e.simulation.note}")
        if refusal(e.simulation.case.scene):
            return answer
        # a model without a locus, of a motion that ends early: there is no trajectory, but a model
        found = solve_case(e.simulation.case, again=False)
    own = found.chosen if asked == "auto" else found.solved_as
    answer |= {
        "model": own.model,
        "equations": own.equations,
        "why": _why(found, asked),
        "method": found.solution.method,
        "agreement": _agreement(found.solution.agreement),
        "phases": [
            {"kind": phase.kind, "start_s": phase.start, "end_s": phase.end}
            for phase in found.phases
        ],
    }
    if e.simulation.trajectory is not None:
        seen = check_assumptions(found)
        answer["findings"] = [asdict(finding) for finding in seen.findings]
        answer["guard"] = {
            "friction_ratio": seen.friction_ratio,
            "least_normal_force_n": seen.normal_force,
            "phi_min_rad": seen.phi_min,
            "phi_max_rad": seen.phi_max,
            "least_gap_m": seen.gap,
        }
    return answer


def _agreement(seen: Agreement | None) -> Answer | None:
    """Return how two methods compare; None of a motion that was solved once."""
    if seen is None:
        return None
    return {**asdict(seen), "holds": seen.holds, "resolved": seen.resolved}


def _why(found: Truth, asked: str) -> str:
    """Return why this model; where nothing bounces the closed formula of a bounce has no answer."""
    own, needed = found.solved_as, found.chosen
    if asked == "auto":
        return needed.why
    if asked != "exact" or own.model == asked:
        return own.why
    smallest = "" if own.model == needed.model else f" The smallest is {needed.model}."
    return (
        f"Asked for exact, the closed formula of a bounce: where nothing bounces it falls back to "
        f"{own.model}, the same equations integrated.{smallest} {needed.why}"
    )


def sentences(answer: Answer) -> Iterable[str]:
    """Yield what a person reads of it, a paragraph each."""
    if answer["model"] is not None:
        plural = "" if answer["equations"] == 1 else "s"
        yield f"Model: {answer['model']}, {answer['equations']} equation{plural}. {answer['why']}"
    yield from _confirmed(answer["agreement"])
    phases = answer["phases"]
    if len(phases) > 1 or any(phase["kind"] == "slip" for phase in phases):
        spelled = (f"{p['kind']} {p['start_s']:.6g} to {p['end_s']:.6g}" for p in phases)
        yield f"Phases, s: {', '.join(spelled)}."
    yield from chaos_sentences(answer)
    for finding in answer["findings"]:
        carried = f" Model `{finding['model']}` would carry it." if finding["model"] else ""
        yield f"Finding: {finding['sentence']}{carried}"


def _confirmed(seen: Answer | None) -> Iterable[str]:
    """Yield that two methods agree; that they do not is a finding, or the outcome."""
    if seen is None or not (seen["holds"] and seen["resolved"]):
        return
    if seen["quantity"] == ENDING:
        yield "Confirmed: the closed motion ends in the same way, without a bounce."
        return
    yield (
        "Confirmed: the closed motion and an integration of its first period differ by "
        f"{seen['discrepancy']:.1e} in the {seen['quantity']}, and less in all else; round-off "
        f"allows {seen['allowed']:.1e}."
    )
