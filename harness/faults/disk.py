"""A disk that is full while results are written: a message, nothing broken, and on it goes."""

import os
import resource
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from harness.faults.ledger import broken, differing, ledger, whole
from harness.faults.program import Order, started
from harness.faults.trial import Trial
from harness.store import Store

_SMALL, _LARGE = "600k", "64m"

_FILE = 2**17
"""Bytes of the largest file that may be written, where no file system can be mounted."""

_CASES = tuple(
    ("gentle-rock", engine, "matched", timestep)
    for engine in ("mujoco", "pybullet")
    for timestep in (1e-3, 3e-4, 1e-4, 3e-5)
)

_WRONG = 2


def disk(folder: Path, told: Callable[[str], None]) -> Trial:
    """Fill the disk under a running suite; then make room and start it again."""
    began = time.monotonic()
    told("a disk that is full")
    order = Order(store=str(folder / "roomy"), cases=_CASES)
    started(order).communicate()
    place = folder / "small"
    with _small(place) as (how, widen):
        store = Store(folder=place / "store")
        full = started(replace(order, store=str(store.folder)))
        _, complained = full.communicate()
        sound, spoilt = whole(store), broken(store)
        widen()
        again = started(replace(order, store=str(store.folder)))
        again.communicate()
        book = ledger(store)
        other = differing(store, Store(folder=Path(order.store)))
        spoilt += broken(store)
    clear = complained.startswith("cannot write to the store") and "make room" in complained
    return Trial(
        name="disk full",
        done=f"a suite on {how}; then room made, and the suite started again",
        demanded="a clear message and code 2; nothing broken; the second run does the rest",
        found=(
            f"code {full.returncode}, with this on standard error: {_last(complained, store)}",
            f"{sound} of {len(_CASES)} kept, {spoilt} broken",
            f"second run: code {again.returncode}, {book.again} kept ones run again",
            f"{other} results differ from an undisturbed run",
        ),
        passed=clear
        and (full.returncode, again.returncode) == (_WRONG, 0)
        and 0 < sound < len(_CASES)
        and not (spoilt or other or book.again),
        seconds=time.monotonic() - began,
    )


def _last(said: str, store: Store) -> str:
    """Return the last line of what was said, the folder of the store left out."""
    lines = said.strip().splitlines() or ["nothing"]
    return lines[-1].replace(str(store.folder), "STORE")


@contextmanager
def _small(place: Path) -> Iterator[tuple[str, Callable[[], None]]]:
    """Give what has little room, in words, and what makes more of it."""
    place.mkdir(parents=True)
    if os.geteuid() == 0 and _mounted(place):
        try:
            yield (
                f"a file system of {_SMALL}B",
                lambda: _mount("-o", f"remount,size={_LARGE}", str(place)),
            )
        finally:
            umount = shutil.which("umount") or "umount"
            subprocess.run([umount, "--lazy", str(place)], check=False)  # noqa: S603 - our words
        return
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (_FILE, before[1]))
    try:
        yield (
            f"a disk that takes no file above {_FILE // 1024} KiB",
            lambda: resource.setrlimit(resource.RLIMIT_FSIZE, before),
        )
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def _mounted(place: Path) -> bool:
    """Mount a small file system, if that is allowed here."""
    try:
        _mount("-t", "tmpfs", "-o", f"size={_SMALL}", "tmpfs", str(place))
    except (OSError, subprocess.CalledProcessError):
        return False
    return True


def _mount(*words: str) -> None:
    mount = shutil.which("mount") or "mount"
    subprocess.run([mount, *words], check=True, capture_output=True)  # noqa: S603 - our words
