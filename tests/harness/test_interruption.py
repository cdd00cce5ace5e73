"""Signals act at once, except while something is being written."""

import os
import signal
from collections.abc import Iterator

import pytest

from harness.interruption import SIGNALS, Interrupted, finishing, listen


@pytest.fixture(autouse=True)
def _listening() -> Iterator[None]:
    """Listen, and leave the signals as they were."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    listen()
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_with_its_code(number: signal.Signals, code: int) -> None:
    with pytest.raises(Interrupted) as stopped:
        os.kill(os.getpid(), number)
    assert stopped.value.exit_code == code


def test_a_write_is_finished_first() -> None:
    done = []

    def write() -> None:
        with finishing():
            with finishing():
                os.kill(os.getpid(), signal.SIGTERM)
                done.append("inner")
            done.append("outer")

    with pytest.raises(Interrupted):
        write()
    assert done == ["inner", "outer"]
    with finishing():
        done.append("later")  # the signal is not heard twice
