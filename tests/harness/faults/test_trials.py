"""The trials of the fault report, shorter: five kills, and the others as they are."""

from collections.abc import Callable
from pathlib import Path

import pytest

from harness.faults.deadly import deadly
from harness.faults.disk import disk
from harness.faults.kills import kills
from harness.faults.signals import signals
from harness.faults.trial import Trial

pytestmark = pytest.mark.slow  # programs that are started dozens of times


@pytest.mark.parametrize("trial", [deadly, disk, signals], ids=lambda trial: trial.__name__)
def test_nothing_is_lost(
    trial: Callable[[Path, Callable[[str], None]], Trial], tmp_path: Path
) -> None:
    told: list[str] = []
    found = trial(tmp_path, told.append)
    assert found.passed, found.found
    assert told


def test_nothing_is_lost_in_five_kills(tmp_path: Path) -> None:
    found = kills(5, tmp_path, lambda _: None)
    assert found.passed, found.found
    assert "5 random moments" in found.done
