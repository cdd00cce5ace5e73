"""Tasks that a worker is given in the tests: functions of a module, so that they can be sent."""

import ctypes
import os
import signal
import time

from harness.errors import UnknownEngineError


def square(number: int) -> int:
    return number * number


def process() -> int:
    return os.getpid()


def segfault() -> None:
    ctypes.string_at(0)


def leave() -> None:
    os._exit(3)


def be_killed() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def hang() -> None:
    while time is not None:
        pass


def devour() -> None:
    blocks = []
    while time is not None:
        blocks.append(b"\1" * 2**24)


def refuse() -> None:
    raise UnknownEngineError("ode", ["mujoco"])


def fail() -> None:
    raise ZeroDivisionError("on purpose")


class StubbornError(Exception):
    """Cannot be sent: made of two things, told of one."""

    def __init__(self, one: str, other: str) -> None:
        super().__init__(f"{one} {other}")


def fail_stubbornly() -> None:
    raise StubbornError("as it", "does")


def unsendable() -> object:
    return lambda: None


def nap(seconds: float) -> float:
    time.sleep(seconds)
    return seconds
