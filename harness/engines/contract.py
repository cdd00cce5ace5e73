"""Checks of an engine's answer before anything is measured of it.

An adapter may be wrong; then its answer is refused with the reason, and no other case suffers. A
refused answer is a fault of the adapter. Numbers that grew without bound are no fault: a run that
diverged says so and hands over the trajectory before.
"""

import math
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Outcome, ParityRow, Simulation
from harness.core.trajectory import Trajectory

_STATE = ("time", "position", "quaternion", "velocity", "angular_velocity", "contact_force")

_TOO_LARGE = 2**63
"""Magnitude from which a whole number does not fit into 64 bits."""

_UNIT_TOLERANCE = 1e-6
"""Distance of a quaternion from unit length: that of one normalised in single precision."""


def contract_violation(answer: object, case: Case) -> str:
    """Return why an answer is not a simulation of a case; empty if it is one.

    Parameters
    ----------
    answer : object
        What an adapter's `simulate` returned.
    case : Case
    """
    if not isinstance(answer, Simulation):
        return f"`simulate` returned {type(answer).__name__}, not a Simulation"
    if answer.case != case:
        return f"`simulate` answered another case, {_text_of(answer.case)}"
    wrong = _fault_of_fields(answer)
    if wrong:
        return wrong
    trajectory: object = answer.trajectory
    if trajectory is None:
        return ""
    if not isinstance(trajectory, Trajectory):
        return f"`trajectory` is {type(trajectory).__name__}, not a Trajectory"
    return _fault_of_numbers(trajectory)


def describe_exception(error: BaseException, verb: str = "simulate") -> str:
    """Return a sentence about an exception of an adapter, whose own message may raise again.

    Parameters
    ----------
    error : BaseException
        Somebody's: even its message may raise, or be no text that a file can hold.
    verb : str
        What the adapter was to do.
    """
    raised = f"`{verb}` raised {type(error).__name__}"
    message = _text_of(error)
    return f"{raised}: {message}" if message else raised


def _text_of(thing: object) -> str:
    """Return the text of an object as a file can hold it; empty if the object raises."""
    with suppress(Exception):
        text = thing.label() if isinstance(thing, Case) else str(thing)
        return text.encode("utf-8", "replace").decode()
    return ""


def _as_python(value: object) -> object:
    """Return a numpy scalar as a Python number; anything else as it is."""
    return value.item() if isinstance(value, np.generic) else value


def _is_text(value: object) -> bool:
    """Whether this is text that a file can hold."""
    return isinstance(value, str) and value == value.encode("utf-8", "replace").decode()


def _is_whole(value: object) -> bool:
    """Whether this is a whole number that fits into 64 bits."""
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < _TOO_LARGE


def _is_number(value: object) -> bool:
    scalar = _as_python(value)
    return isinstance(scalar, float) or _is_whole(scalar)


def _is_finite(value: object) -> bool:
    return _is_number(value) and math.isfinite(value)  # type: ignore[arg-type]


def _is_count(value: object) -> bool:
    scalar = _as_python(value)
    return _is_whole(scalar) and scalar >= 0  # type: ignore[operator]


def is_timestep(value: object) -> bool:
    """Whether this is a valid timestep of an adapter, s."""
    return value is None or (_is_finite(value) and value > 0.0)  # type: ignore[operator]


def _is_setting(value: object) -> bool:
    """Whether this is a valid value of a setting."""
    setting = _as_python(value)
    if isinstance(setting, tuple):
        return all(map(_is_number, setting))
    return setting is None or isinstance(setting, bool) or _is_number(setting) or _is_text(setting)


_Kinds = dict[str, tuple[Callable[[object], bool], str]]

_TEXT, _NUMBER = (_is_text, "text"), (_is_number, "a number")
_COUNT = (_is_count, "a whole number, zero or greater")
_SECONDS = (_is_finite, "a number of seconds")

_FIELDS: _Kinds = {
    "outcome": (lambda value: isinstance(value, Outcome), "an Outcome"),
    "note": _TEXT,
    "engine_version": _TEXT,
    "model": _TEXT,
    "timestep": (is_timestep, "a positive number of seconds, or None"),
    "steps": _COUNT,
    "constraint_rows": _COUNT,
    "compile_s": _SECONDS,
    "setup_s": _SECONDS,
    "wall_s": _SECONDS,
    "cpu_s": _SECONDS,
    "static_penetration": (_is_number, "a number of metres"),
    "parity": (lambda value: isinstance(value, tuple), "a tuple"),
}
"""Kind of each field other than case, settings and trajectory."""

_VERDICTS = {"equal", "imposed", "mismatch", "does not apply"}

_OF_ROWS: _Kinds = {
    "quantity": _TEXT,
    "unit": _TEXT,
    "declared": _NUMBER,
    "found": _NUMBER,
    "how": _TEXT,
    "verdict": (
        lambda value: isinstance(value, str) and value in _VERDICTS,
        "equal, imposed, mismatch or does not apply",
    ),
}
"""Kind of each field of a row of the parity table."""


def _fault_of_kinds(owner: object, kinds: _Kinds, of: str = "") -> str:
    """Return which field is not of its kind and so could be neither reported nor stored."""
    for name, (fits, kind) in kinds.items():
        value: object = getattr(owner, name)
        if not fits(value):
            return f"`{name}`{of} is {_shown(value)}, not {kind}"
    return ""


def _fault_of_fields(answer: Simulation) -> str:
    """Return which field of a simulation, of its settings or of its parity is not of its kind."""
    if wrong := _fault_of_kinds(answer, _FIELDS):
        return wrong
    for name, value in answer.settings.items():
        if not _is_text(name):
            return f"`settings` has a name that is {_shown(name)}, not text"
        if not _is_setting(value):
            return f"`settings` has {_shown(value)} as '{name}', which is no setting's value"
    rows: tuple[object, ...] = answer.parity
    for row in rows:
        if not isinstance(row, ParityRow):
            return f"`parity` holds {_shown(row)}, not ParityRow"
        if wrong := _fault_of_kinds(row, _OF_ROWS, " of a row of `parity`"):
            return wrong
    return ""


def _shown(value: object) -> str:
    """Return a number or a short text as it is, or the type of anything else."""
    most = 40
    short = _is_text(value) and isinstance(value, str) and len(value) <= most
    return repr(value) if short or _is_number(value) else type(value).__name__


def _fault_of_numbers(trajectory: Trajectory) -> str:
    """Return what is wrong with the numbers of a trajectory whose shapes are right."""
    for name in _STATE:
        bad = ~np.isfinite(getattr(trajectory, name).reshape(len(trajectory), -1)).all(axis=1)
        if bad.any():
            first = int(np.argmax(bad))
            return f"`{name}` is no number at sample {first} of {len(trajectory)}"
    if trajectory.time[0] != 0.0:
        return f"`time` starts at {float(trajectory.time[0])!r} s, not at the release, 0.0"
    count = trajectory.contact_count
    if (count < 0).any():
        first = int(np.argmax(count < 0))
        return f"`contact_count` is {int(count[first])} at sample {first} of {len(trajectory)}"
    lost = (count > 0) & ~np.isfinite(trajectory.contact_point).all(axis=1)
    if lost.any():
        first = int(np.argmax(lost))
        return f"`contact_point` is no number at sample {first}, where there is a contact"
    off = float(np.abs(np.linalg.norm(trajectory.quaternion, axis=1) - 1.0).max())
    if off > _UNIT_TOLERANCE:
        return f"`quaternion` is off unit length by {off:.1e}"
    return ""
