"""The commands of single motions: solve a scene exactly, or run it in an engine.

The answers of `--json` have exactly the documented keys; what is unknown is null.
"""

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from harness.cli import options, terminal
from harness.cli.derivatives import (
    WithDerivatives,
    derivatives_json,
    derivatives_sentences,
    derivatives_table,
)
from harness.cli.divergence import (
    chaos_sentences,
    divergence_json,
    divergence_sentences,
    is_chaotic,
)
from harness.cli.settings import parse_settings
from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.errors import ParityError, TrajectoryError
from harness.core.simulation import Outcome
from harness.core.writing import WriteError
from harness.engines.reference import ENDING, Agreement, Finding, Impact
from harness.engines.reference.assumption_checks import check_assumptions
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import Truth, solve_case
from harness.evaluation.evaluate import evaluate, evaluate_without_truth
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion, motion_frame
from harness.metrics.quantities import QUANTITIES
from models.catalogue import load
from models.effects import modelling_choices

Answer = dict[str, Any]


@dataclass(eq=False, kw_only=True)
class BrokenRunError(TrajectoryError):
    """The simulation of the case of this label is no motion, and its note says why."""

    case: str
    note: str

    def __str__(self) -> str:
        """Return the case and the note."""
        return f"{self.case}: {self.note}"


def reference(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    model: Annotated[
        str, typer.Option(help="Which equations; auto takes the smallest that carries the scene.")
    ] = "auto",
    method: Annotated[str, typer.Option(help="How they are integrated.")] = "auto",
    rtol: Annotated[float, typer.Option(help="Relative tolerance of the integrator.")] = 1e-12,
    derivatives: WithDerivatives = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """The exact motion in numbers, and the friction it needs.

    Period, turn and peak rates of each bounce, by the smallest model that carries the scene.

    For example: rockingcan reference slipping-rock --model coulomb
    """
    options = (("model", model), ("method", method), ("rtol", rtol))
    case = Case(scene=load(scene), engine="reference", options=options)
    evaluation = evaluate_without_truth(case)
    simulation = evaluation.simulation
    known = simulation.trajectory is not None or simulation.outcome is Outcome.FINISHED
    truth = solve_case(case, again=False) if known else None
    answer = reference_json(evaluation, truth.bounces if truth else ())
    answer |= model_answer(evaluation, truth, model)
    if derivatives:
        answer |= derivatives_json(case.scene)
    if json:
        typer.echo(terminal.to_json(answer))
    else:
        _show(answer, sentences(answer))


def run(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    engine: options.EngineName,
    profile: options.Profile = "matched",
    timestep: options.Timestep = None,
    set_: options.Settings = None,
    out: Annotated[
        Path | None, typer.Option(help="Write the motion here, as .csv or .parquet.")
    ] = None,
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """One scene in one engine, held against the exact motion.

    For example: rockingcan run gentle-rock --engine mujoco --timestep 1e-4 --set impratio=10
    """
    case = Case(
        scene=load(scene),
        engine=engine,
        profile=profile,
        timestep=timestep,
        options=parse_settings(set_ or []),
    )
    if out is not None:
        check_motion_file(out)
    evaluation = evaluate(case)
    simulation, answer = evaluation.simulation, run_json(evaluation)
    mismatch = simulation.outcome is Outcome.MISMATCH
    if out is not None and evaluation.motion is not None:
        write_motion(evaluation.motion, out)
    if json:
        typer.echo(terminal.to_json(answer))
    else:
        if simulation.parity:
            terminal.stdout_console().print(terminal.parity(simulation.parity))
        if not mismatch:
            _show(answer, divergence_sentences(answer))
    if mismatch:
        raise ParityError(case.label(), simulation.note)


def _show(answer: Answer, sentences: Iterable[str]) -> None:
    """Print a motion for people: its tables, the sentences, and its modelling choices."""
    choices = (f"Modelling choice: {sentence}" for sentence in answer["modelling_choices"])
    terminal.stdout_console().print(*motion_tables(answer), *sentences, *choices, sep="\n")


_BOUNCE = (
    *("phi_min_rad", "angle_of_turn_deg", "rotation_turn_deg"),
    *("peak_psi_dot_rad_s", "peak_friction_ratio"),
)
"""Quantities of a bounce, in addition to its time."""

_CONTACT = ("max_penetration_m", "max_slip_m_s", "lift_off_fraction", "multi_contact_fraction")


def reference_json(e: Evaluation, bounces: Sequence[Bounce]) -> Answer:
    """Return the answer of `reference`: the exact motion in numbers."""
    simulation = e.simulation
    return {
        "scene": simulation.case.scene.name,
        "engine": simulation.model,
        "outcome": simulation.ending,
        "wall_s": QUANTITIES["wall_s"].of_run(e),
        "steps": QUANTITIES["steps"].of_run(e),
        "period_s": bounces[0].end - bounces[0].start if bounces else None,
        "energy_drift": e.energy_drift,
        "bounces": [
            {"time_s": bounce.time} | {key: QUANTITIES[key].of_bounce(bounce) for key in _BOUNCE}
            for bounce in bounces
        ],
        "modelling_choices": list(modelling_choices(simulation.case.scene.effects)),
    }


def run_json(e: Evaluation) -> Answer:
    """Return the answer of `run`: the motion in numbers, its errors, its contact, and chaos."""
    turns, ratios = (
        ((), ()) if e.errors is None else (e.errors.angle_of_turn, e.errors.peak_friction_ratio)
    )
    return reference_json(e, e.bounces) | {
        "compile_s": QUANTITIES["compile_s"].of_run(e),
        "setup_s": QUANTITIES["setup_s"].of_run(e),
        "errors": {
            "phi_rms_rad": QUANTITIES["phi_rms_rad"].of_run(e),
            "angle_of_turn_deg": [math.degrees(turn) for turn in turns],
            "contact_locus_rms_m": QUANTITIES["contact_locus_rms_m"].of_run(e),
            "peak_friction_ratio": list(ratios),
        },
        "contact": {key: QUANTITIES[key].of_run(e) for key in _CONTACT},
        "divergence": divergence_json(e.divergence),
        "parts_at_s": e.parts_at,
    }


def _findings_json(findings: Iterable[Finding]) -> list[dict[str, str]]:
    return [{"sentence": finding.sentence, "model": finding.model} for finding in findings]


def model_answer(e: Evaluation, truth: Truth | None, asked: str) -> Answer:
    """Return the part of the answer of `reference` on the model and its checks.

    Parameters
    ----------
    e : Evaluation
    truth : Truth or None
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
        "impacts": [],
        "rest": None,
        "guard": None,
        "findings": _findings_json(e.findings),
        "divergence": divergence_json(e.divergence),
    }
    if truth is None:
        if e.simulation.outcome is Outcome.BROKEN:
            raise BrokenRunError(case=e.simulation.case.label(), note=e.simulation.note)
        if refusal(e.simulation.case.scene):
            return answer
        # a model without a locus, of a motion that ends early: there is no trajectory, but a model
        truth = solve_case(e.simulation.case, again=False)
    own = truth.chosen if asked == "auto" else truth.solved_as
    answer |= {
        "model": own.model,
        "equations": own.equations,
        "why": _why(truth, asked),
        "method": truth.solution.method,
        "agreement": _agreement(truth.solution.agreement),
        "rest": truth.rest,
        "phases": [
            {"kind": phase.kind.value, "start_s": phase.start, "end_s": phase.end}
            for phase in truth.phases
        ],
        "impacts": [_impact_json(impact) for impact in truth.impacts],
    }
    if e.simulation.trajectory is not None:
        seen = check_assumptions(truth)
        answer["findings"] = _findings_json(seen.findings)
        answer["guard"] = {
            "friction_ratio": seen.friction_ratio,
            "least_normal_force_n": seen.normal_force,
            "phi_min_rad": seen.phi_min,
            "phi_max_rad": seen.phi_max,
            "least_gap_m": seen.gap,
        }
    return answer


def _impact_json(impact: Impact) -> Answer:
    """Return an impact of an exact motion, in SI units."""
    keys = ("time_s", "normal_impulse_n_s", "restitution", "energy_lost_j")
    numbers = (impact.time, impact.normal_impulse, impact.restitution, impact.energy_lost)
    rest = {"law": impact.law, "made_energy": impact.made_energy, "ends_at_s": impact.ends_at}
    return dict(zip(keys, numbers, strict=True)) | rest


def _agreement(seen: Agreement | None) -> Answer | None:
    """Return how two methods compare; None of a motion that was solved once."""
    if seen is None:
        return None
    return {**asdict(seen), "holds": seen.holds, "resolved": seen.resolved}


def _why(truth: Truth, asked: str) -> str:
    """Return why this model; where nothing bounces the closed formula of a bounce has no answer."""
    own, needed = truth.solved_as, truth.chosen
    if asked == "auto":
        return needed.why
    if asked != "exact" or own.model == asked:
        return own.why
    smallest = "" if own.model == needed.model else f" The smallest is {needed.model}."
    return (
        f"Asked for exact, the closed formula of a bounce: where nothing bounces it falls back to "
        f"{own.model}, the same equations integrated.{smallest} {needed.why}"
    )


_PHASES = 12
"""Phases that are printed, of the hundreds of a contact that vibrates; `--json` lists all."""


def sentences(answer: Answer) -> Iterable[str]:
    """Yield the sentences on an answer of `reference`, a paragraph each."""
    if answer["model"] is not None:
        plural = "" if answer["equations"] == 1 else "s"
        yield f"Model: {answer['model']}, {answer['equations']} equation{plural}. {answer['why']}"
    yield from _confirmed(answer["agreement"])
    phases = answer["phases"]
    if len(phases) > 1 or any(phase["kind"] == "slip" for phase in phases):
        spelled = [f"{p['kind']} {p['start_s']:.6g} to {p['end_s']:.6g}" for p in phases]
        more = f", and {len(phases) - _PHASES} more" if len(phases) > _PHASES else ""
        yield f"Phases, s: {', '.join(spelled[:_PHASES])}{more}."
    if lost := [impact["energy_lost_j"] for impact in answer["impacts"]]:
        yield f"Impacts: {len(lost)}, which take {sum(lost):.4g} J."
    if rest := answer["rest"]:
        fitted = "" if rest["exponent"] is None else f"; fitted, {rest['exponent']:.4f}"
        law = f" {rest['law'].capitalize()}: phi as " if rest["law"] else ""
        power = f"(t_s - t)^p, p = {rest['exponent_predicted']:.4f}{fitted}." if law else ""
        yield f"The can lies flat at {rest['t_f_s']:.12g} s.{law}{power}"
    yield from chaos_sentences(answer)
    if "derivatives" in answer:
        yield from derivatives_sentences(answer)
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


def motion_tables(answer: Answer) -> Iterable[Table]:
    """Yield the tables of a motion in numbers."""
    single = ("scene", "engine", "outcome", "period_s", "energy_drift", "steps", "wall_s")
    parts = {"Motion": [{key: answer[key] for key in single}], "Bounces": answer["bounces"]}
    if "errors" in answer and not is_chaotic(
        answer
    ):  # else there are none, and a sentence says why
        parts["Errors, engine minus truth"] = [answer["errors"]]
    if "contact" in answer:
        parts["Contact"] = [answer["contact"]]
    for title, rows in parts.items():
        if rows:
            yield terminal.table(title, list(rows[0]), [list(row.values()) for row in rows])
    if "derivatives" in answer:
        yield derivatives_table(answer)


_SUFFIXES = (".csv", ".parquet")


def write_motion(motion: Motion, out: Path) -> None:
    """Write a motion as a table in the format that the file's name asks for.

    Raises
    ------
    WriteError
        If the file cannot be written.
    """
    frame = motion_frame(motion)
    if out.suffix == ".csv":
        terminal.write_text(frame.to_csv(index=False, lineterminator="\n"), out)
    else:
        terminal.write_bytes(frame.to_parquet(index=False), out)


def check_motion_file(out: Path) -> None:
    """Refuse a file for a motion that could not be written later.

    Raises
    ------
    WriteError
        If its name ends otherwise than in a known suffix, or its folder cannot be written.
    """
    if out.suffix not in _SUFFIXES:
        raise WriteError(path=out, reason=f"its name must end in {' or '.join(_SUFFIXES)}")
    if out.is_dir() or not out.absolute().parent.is_dir():
        raise WriteError(path=out, reason="it must be a file in a folder that exists")
    if not os.access(out.absolute().parent, os.W_OK):
        raise WriteError(path=out, reason="its folder is not writable")
