"""The plan of a sweep as its folder states it: written once, whole, and the same ever after."""

import json
import os
import re
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, OutputError
from harness.sweep.plan import SweepPlan, digest_of

PLAN = "sweep.json"
PARTS = "parts"
DAMAGED = "damaged"
LOCK = ".lock"
SUFFIX = ".parquet"
NAME = re.compile(
    r"part-(?P<index>[0-9]{6,})-(?P<plan>[0-9a-f]{16})-(?P<check>[0-9a-f]{32})\.parquet"
)
"""Of the file of a partition: its number, the digest of its plan, the checksum of its content."""

_DRAFT = f".{PLAN}.draft"
_FORMAT = "rockingcan-sweep"
_PROGRAM = "program"
_REPORT = "report"
"""What the command makes of a sweep, beside it."""


class PlanMismatchError(HarnessError, ValueError):
    """The folder holds another sweep than the one that is asked for."""

    def __init__(self, out: Path, differing: str) -> None:
        super().__init__(
            f"'{out}' holds another sweep, which differs in {differing}; "
            "choose another folder with --out, or remove this one"
        )


class ProgramMismatchError(PlanMismatchError):
    """The folder holds this sweep, as far as another program made it."""

    def __init__(self, out: Path, differing: str) -> None:
        super(PlanMismatchError, self).__init__(
            f"'{out}' holds this sweep as another program made it, with {differing}: rows of both "
            "might not go together; choose another folder with --out, or remove this one to make "
            "all anew"
        )


def write_plan(out: Path, plan: SweepPlan) -> None:
    """Write the plan, if it is not there yet, whole or not at all, after a power cut too."""
    place, draft = out / PLAN, out / _DRAFT
    if place.exists():
        return
    told = {"format": _FORMAT, "digest": plan.digest(), "plan": plan.told()}
    with draft.open("w", encoding="utf-8") as file:
        file.write(json.dumps(told, indent=1) + "\n")
        file.flush()
        os.fsync(file.fileno())
    draft.replace(place)
    folder = os.open(out, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def check_same(out: Path, plan: SweepPlan) -> None:
    """Refuse a folder that holds anything but this sweep; one that is not there is free.

    Raises
    ------
    PlanMismatchError
        If another sweep is there, or this one as another program made it.
    OutputError
        If something else is, or the plan that is there cannot be read.
    """
    if not (out / PLAN).exists():
        _check_without_plan(out, plan)
        return
    here, there = plan.told(), _read(out)
    differing = [key for key in here | there if here.get(key) != there.get(key)]
    if differing == [_PROGRAM]:
        raise ProgramMismatchError(out, _other_program(here[_PROGRAM], there.get(_PROGRAM)))
    if differing:
        words = [f"{key} ({there.get(key)!r:.200} there)" for key in differing if key != "scene"]
        raise PlanMismatchError(out, ", ".join((["the scene"] * ("scene" in differing)) + words))


def _other_program(here: dict[str, str], there: object) -> str:
    """Return in words in what a program differs from this one."""
    if not isinstance(there, dict):
        return "no word of which"
    other = [name for name in here if here[name] != there.get(name)]
    return ", ".join(f"{name} {there.get(name)} (now {here[name]})" for name in other)


def _check_without_plan(out: Path, plan: SweepPlan) -> None:
    """Refuse a folder without a plan that is not empty, nor what is left of this very sweep."""
    names = {path.name for path in out.iterdir()} if out.exists() else set()
    # a plan may have been written since we looked for it: the lock decides whose folder it is
    ours = {LOCK, _DRAFT, PLAN, PARTS} | ({DAMAGED, _REPORT} if LOCK in names else set())
    if names - ours:
        raise _foreign(out)
    for path in (out / PARTS).glob(f"*{SUFFIX}"):
        name = NAME.fullmatch(path.name)
        if name is None or name["plan"] != plan.digest():
            raise PlanMismatchError(out, f"its partitions, such as {path.name}")


def _read(out: Path) -> dict[str, Any]:
    """Return the plan that a folder states."""
    place = out / PLAN
    try:
        found: Any = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise _unreadable(place, f"{type(error).__name__}: {error}") from error
    if not isinstance(found, dict) or found.get("format") != _FORMAT:
        raise _foreign(out)
    there = found.get("plan")
    if not isinstance(there, dict) or digest_of(there) != found.get("digest"):
        raise _unreadable(place, "its checksum is not that of its content")
    return there


def _foreign(out: Path) -> OutputError:
    return OutputError(
        f"will not write a sweep to '{out}': the folder is not empty and holds no sweep of "
        "rockingcan; choose another folder with --out"
    )


def _unreadable(place: Path, reason: str) -> OutputError:
    return OutputError(
        f"the plan of the sweep in '{place.parent}' cannot be read ({reason}); remove '{place}' "
        "and start the same sweep again, which goes on with the partitions that are there, or "
        "choose another folder with --out"
    )
