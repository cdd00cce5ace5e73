"""Limits that sound cases keep, on any machine and in any container."""

import math
import os
from pathlib import Path

import pytest

from harness.execution import limits
from harness.execution.limits import available, default_limits

_GIB = 2**30
_WHOLE = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))


@pytest.mark.parametrize(
    ("gibibytes", "workers", "share"),
    [
        (24.0, 1, 4.0),
        (24.0, 4, 4.0),
        (24.0, 8, 2.4),
        (24.0, 100, 0.5),
        (24.0, 10_000, 0.5),
        (0.25, 1, 0.5),
    ],
)
def test_a_sound_case_always_has_what_it_needs(
    monkeypatch: pytest.MonkeyPatch, gibibytes: float, workers: int, share: float
) -> None:
    monkeypatch.setattr(limits, "available", lambda: gibibytes * _GIB)
    assert default_limits(workers).memory == pytest.approx(share * _GIB, rel=1e-12)


def test_a_task_has_half_an_hour() -> None:
    assert default_limits(1).seconds == default_limits(100).seconds == 1800.0


def told(root: Path, group: str, files: dict[str, str]) -> Path:
    """Tell of control groups as Linux does, below a folder; return it."""
    for name, content in ({"proc/self/cgroup": group} | files).items():
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content, encoding="ascii")
    return root


_TWO, _ONE = "sys/fs/cgroup", "sys/fs/cgroup/memory"


@pytest.mark.parametrize(
    ("group", "files", "found"),
    [
        ("0::/\n", {f"{_TWO}/memory.max": "1048576\n"}, 2.0**20),
        ("0::/\n", {f"{_TWO}/memory.max": "max\n"}, math.inf),
        # of a group within groups the tightest counts
        ("0::/a/b\n", {f"{_TWO}/a/memory.max": "4096\n", f"{_TWO}/a/b/memory.max": "8192"}, 4096.0),
        # as the host names it, where the container sees its own as the top
        ("0::/docker/1f\n", {f"{_TWO}/memory.max": "4096\n"}, 4096.0),
        ("4:cpu,memory:/a\n0::/\n", {f"{_ONE}/a/memory.limit_in_bytes": "4096\n"}, 4096.0),
        ("4:memory:/\n", {f"{_ONE}/memory.limit_in_bytes": "9223372036854771712\n"}, math.inf),
        ("0::/gone\n", {}, math.inf),
    ],
)
def test_a_container_has_what_it_is_given(
    tmp_path: Path, group: str, files: dict[str, str], found: float
) -> None:
    assert available(told(tmp_path, group, files)) == min(found, _WHOLE)


def test_without_control_groups_there_is_what_the_machine_has(tmp_path: Path) -> None:
    assert available(tmp_path) == _WHOLE
    assert 0.0 < available() <= _WHOLE
