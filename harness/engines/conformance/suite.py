"""The contract in full: every check, in order, and what it says of an engine."""

from harness.engines.base import Engine
from harness.engines.conformance import answers, contact, effects, start
from harness.engines.conformance.fixture import (
    BrokenContractError,
    Check,
    ClauseEvidence,
    ClauseResult,
    ClauseStatus,
    Fixture,
    not_applicable,
)

_RUNS = "trajectory"

CHECKS = (
    Check(
        name="name",
        sentence="The name fits a command line, a file name and a table.",
        look=answers.name,
        needs_run=False,
    ),
    Check(
        name="version",
        sentence="The version is a text.",
        look=answers.version,
        needs_run=False,
    ),
    Check(
        name="settings",
        sentence="Each setting is named once, explained, and takes its own values.",
        look=answers.settings,
        needs_run=False,
    ),
    Check(
        name="capabilities",
        sentence="What is honoured is an effect of scenes; what is imposed has a sentence.",
        look=answers.capabilities,
        needs_run=False,
    ),
    Check(
        name=_RUNS,
        sentence="A case runs to its horizon and hands over a sound trajectory.",
        look=answers.trajectory,
        needs_run=False,
    ),
    Check(
        name="report",
        sentence="A simulation states the settings, timestep and version that were in force.",
        look=answers.reported,
    ),
    Check(
        name="pickling",
        sentence="A simulation goes through pickle unchanged.",
        look=answers.pickling,
    ),
    Check(
        name="initial state",
        sentence="The first sample is the release to round-off, at static penetration.",
        look=start.initial_state,
    ),
    Check(
        name="mass properties",
        sentence="Mass and moments of the compiled can are the declared ones.",
        look=start.mass_properties,
    ),
    Check(
        name="acceleration at release",
        sentence="The first acceleration is that of a rigid can that rolls.",
        look=start.acceleration_at_release,
    ),
    Check(
        name="acceleration",
        sentence="Later accelerations converge to those of a rigid can, in the first order.",
        look=start.acceleration_later,
    ),
    Check(
        name="repeats",
        sentence="A case run twice gives equal bits.",
        look=answers.repeats,
    ),
    Check(
        name="repeats after another",
        sentence="A case run after another case gives equal bits.",
        look=answers.repeats_after_another,
    ),
    Check(
        name="repeats in a batch",
        sentence="Cases run together give the same bits as one by one.",
        look=answers.repeats_in_a_batch,
    ),
    Check(
        name="repeats in a fresh process",
        sentence="A case run in a process of its own gives equal bits.",
        look=answers.repeats_in_a_fresh_process,
    ),
    Check(
        name="starts",
        sentence="Samples start at t = 0 and time increases strictly.",
        look=answers.starts,
    ),
    Check(
        name="dense",
        sentence="Samples are dense by angle, so that turns can be counted.",
        look=answers.dense,
    ),
    Check(
        name="ends",
        sentence="Samples end at the horizon, whether or not the timestep divides it.",
        look=answers.ends,
    ),
    Check(
        name="horizon",
        sentence="A longer horizon does not change what happens before.",
        look=answers.grows,
    ),
    Check(
        name="unknown setting",
        sentence="A setting that does not exist is refused by name.",
        look=effects.unknown_setting,
        needs_run=False,
    ),
    Check(
        name="wrong value",
        sentence="A value of another kind than the setting's is refused.",
        look=effects.wrong_value,
        needs_run=False,
    ),
    Check(
        name="unsupported effect",
        sentence="A scene that declares what the engine cannot represent is refused.",
        look=effects.unsupported_effect,
        needs_run=False,
    ),
    Check(
        name="friction",
        sentence="Where slip is honoured, friction reaches what is declared and not more.",
        look=effects.friction,
    ),
    Check(
        name="laws of effects",
        sentence="Each effect that is honoured follows its law in the compiled world.",
        look=effects.laws,
    ),
    Check(
        name="motion with effects",
        sentence="With an effect that is honoured the can moves as the exact equations say.",
        look=effects.motions,
    ),
    Check(
        name="divergence",
        sentence="What no engine can do ends with an outcome, not with an exception.",
        look=contact.divergence,
        needs_run=False,
    ),
    Check(
        name="flight",
        sentence="Where nothing touches there is no contact point and no force.",
        look=contact.flight,
    ),
    Check(
        name="newton",
        sentence="The contact force is the one that changed the velocity.",
        look=contact.newton,
    ),
    Check(
        name="same instant",
        sentence="The contact point is the lowest point of the rim of the same state.",
        look=contact.same_instant,
    ),
)
"""Every clause, in the order in which they are worth reading."""


def conform(engine: Engine) -> tuple[ClauseResult, ...]:
    """Return what each check says of an engine.

    Parameters
    ----------
    engine : Engine
        Need not be registered; what needs a name in other processes is then not applicable.
    """
    bench = Fixture(engine)
    verdicts: list[ClauseResult] = []
    runs = True
    for check in CHECKS:
        if check.needs_run and not runs:
            found = not_applicable(f"needs a run that passes the check '{_RUNS}'")
        else:
            found = _look(check, bench)
        if check.name == _RUNS:
            runs = found.result is ClauseStatus.PASSED
        verdicts.append(
            ClauseResult(
                name=check.name,
                sentence=check.sentence,
                result=found.result,
                number=found.number,
                allowed=found.allowed,
                unit=found.unit,
                detail=found.detail,
            )
        )
    return tuple(verdicts)


def _look(check: Check, bench: Fixture) -> ClauseEvidence:
    """Return what a check finds; whatever the adapter raises is a failure of it."""
    try:
        return check.look(bench)
    except BrokenContractError as error:
        return ClauseEvidence(result=ClauseStatus.FAILED, detail=str(error))
    except Exception as error:  # noqa: BLE001 - the suite reports on any adapter to its end
        return ClauseEvidence(
            result=ClauseStatus.FAILED, detail=f"raised {type(error).__name__}: {error}"
        )
