"""From when on a second signal is another wish."""

import signal

import pytest

from harness.execution import signals


@pytest.mark.parametrize(("later", "leaves"), [(4.99, False), (5.01, True)])
def test_a_signal_that_comes_five_seconds_after_the_first_ends_the_program(
    later: float, monkeypatch: pytest.MonkeyPatch, *, leaves: bool
) -> None:
    clock = iter((100.0, 100.0 + later))
    left: list[int] = []
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    monkeypatch.setattr(signals, "_leave", lambda number, _: left.append(number))
    monkeypatch.setattr(signals, "_asked", None)
    with pytest.raises(signals.Interrupted):
        signals._received(signal.SIGINT, None)  # noqa: SLF001 - as the system calls it
    signals._received(signal.SIGINT, None)  # noqa: SLF001 - likewise
    assert left == ([signal.SIGINT] if leaves else [])
