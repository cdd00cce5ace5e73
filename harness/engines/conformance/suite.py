"""The contract in full: every clause, in order, and its result for an engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from harness.engines.base import Engine
from harness.engines.conformance import answers, effects, motion
from harness.engines.conformance.fixture import (
    BrokenContractError,
    ClauseResult,
    ClauseStatus,
    Fixture,
    holds,
    not_applicable,
)

_PROMISES: Mapping[Callable[[Fixture], ClauseResult], str] = {
    answers.name: "The name fits a command line, a file name and a table.",
    answers.version: "The version is a text.",
    answers.settings: "Each setting is named once, explained, and takes its own values.",
    answers.capabilities: "What is honoured is an effect of scenes; what is imposed has a "
    "sentence.",
    answers.trajectory: "A case runs to its horizon and hands over a sound trajectory.",
    answers.report: "A simulation states the settings, timestep and version that were in force.",
    answers.pickling: "A simulation goes through pickle unchanged.",
    motion.initial_state: "The first sample is the release to round-off, at static penetration.",
    motion.mass_properties: "Mass and moments of the compiled can are the declared ones.",
    motion.acceleration_at_release: "The first acceleration is that of a rigid can that rolls.",
    motion.acceleration: "Later accelerations converge to those of a rigid can, in the first "
    "order.",
    answers.repeats: "A case run twice gives equal bits.",
    answers.repeats_after_another: "A case run after another case gives equal bits.",
    answers.repeats_in_a_batch: "Cases run together give the same bits as one by one.",
    answers.repeats_in_a_fresh_process: "A case run in a process of its own gives equal bits.",
    motion.starts: "Samples start at t = 0 and time increases strictly.",
    motion.dense: "Samples are dense by angle, so that turns can be counted.",
    motion.ends: "Samples end at the horizon, whether or not the timestep divides it.",
    motion.horizon: "A longer horizon does not change what happens before.",
    answers.unknown_setting: "A setting that does not exist is refused by name.",
    answers.wrong_value: "A value of another kind than the setting's is refused.",
    answers.unsupported_effect: "A scene that declares what the engine cannot represent is "
    "refused.",
    effects.friction: "Where slip is honoured, friction reaches what is declared and not more.",
    effects.laws_of_effects: "Each effect that is honoured follows its law in the compiled world.",
    effects.motion_with_effects: "With an effect that is honoured the can moves as the exact "
    "equations say.",
    answers.divergence: "What no engine can do ends with an outcome, not with an exception.",
    effects.flight: "Where nothing touches there is no contact point and no force.",
    effects.newton: "The contact force is the one that changed the velocity.",
    effects.same_instant: "The contact point is the lowest point of the rim of the same state.",
}
"""What looks, and what an adapter promises; whatever a look raises is a failure of the adapter."""

CLAUSES = {look.__name__.replace("_", " "): look for look in _PROMISES}
"""Every clause by its name, in the order in which they are worth reading."""

_RUNS = "trajectory"

_WITHOUT_A_RUN = frozenset(
    {
        "name",
        "version",
        "settings",
        "capabilities",
        "trajectory",
        "unknown setting",
        "wrong value",
        "unsupported effect",
        "divergence",
    }
)
"""Clauses that have something to look at where no run hands over a trajectory."""


def conform(engine: Engine) -> tuple[ClauseResult, ...]:
    """Return the result of each clause for an engine.

    Parameters
    ----------
    engine : Engine
        Need not be registered; what needs a name in other processes is then not applicable.
    """
    fixture, results = Fixture(engine), list[ClauseResult]()
    runs = True
    for name, look in CLAUSES.items():
        if runs or name in _WITHOUT_A_RUN:
            result = _look(look, fixture)
        else:
            result = not_applicable(f"needs a run that passes the check '{_RUNS}'")
        if name == _RUNS:
            runs = result.result is ClauseStatus.PASSED
        results.append(replace(result, name=name, sentence=_PROMISES[look]))
    return tuple(results)


def _look(look: Callable[[Fixture], ClauseResult], fixture: Fixture) -> ClauseResult:
    """Return the result of a clause; whatever the adapter raises is a failure of it."""
    try:
        return look(fixture)
    except BrokenContractError as error:
        return ClauseResult(result=ClauseStatus.FAILED, detail=str(error))
    except Exception as error:  # noqa: BLE001 - the suite reports on any adapter to its end
        return holds(f"raised {type(error).__name__}: {error}", "")
