"""Tasks that a worker is given in the tests: functions of a module, so that they can be sent."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from harness.core.errors import UnknownEngineError
from harness.execution.worker_main import compiling


def square(number: int) -> int:
    return number * number


def compile_for(seconds: float, then: float) -> float:
    """Compile for some time, work for some, and return the sum, s."""
    with compiling("toy"):
        time.sleep(seconds)
    time.sleep(then)
    return seconds + then


def called(function: Callable[[], int]) -> int:
    return function()


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


def say_and_hang(told: str) -> None:
    Path(told).touch()
    hang()


def wait_and_tell(gate: Path, told: Path, name: str) -> None:
    """Wait until a file is there, then write a name."""
    while not gate.exists():
        time.sleep(0.01)
    tell(told, name)


def tell(told: Path, name: str) -> None:
    with told.open("a", encoding="ascii") as file:
        file.write(f"{name} ")


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


def start(program: str, told: str, *, apart: bool) -> None:
    """Start a process, and tell its number and ours when it is at work."""
    words = [sys.executable, "-c", f"{program}\nprint(flush=True)\nimport time; time.sleep(600)"]
    child = subprocess.Popen(words, stdout=subprocess.PIPE, start_new_session=apart)  # noqa: S603
    assert child.stdout is not None
    child.stdout.readline()
    Path(told).write_text(f"{child.pid} {os.getpid()}", encoding="ascii")


def start_and_hang(told: str, *, apart: bool) -> None:
    start("pass", told, apart=apart)
    hang()


def start_and_crash(told: str) -> None:
    start("pass", told, apart=False)
    segfault()


def start_and_return(told: str) -> int:
    start("pass", told, apart=False)
    return 1


def start_one_that_devours(told: str) -> None:
    program = (  # told of first: it may be ended while it still devours
        "import pathlib, time; print(flush=True)\n"
        f"while not pathlib.Path({told!r}).exists(): time.sleep(0.01)\n"
        "block = bytearray(b'1') * 500_000_000"
    )
    start(program, told, apart=False)
    time.sleep(600.0)


def share(told: str) -> None:
    """Hold memory that a process of a fork shares."""
    block = b"\1" * 200_000_000
    child = os.fork()
    if not child:
        time.sleep(600.0)
    Path(told).write_text(f"{child} {os.getpid()}", encoding="ascii")
    time.sleep(3.0)
    assert block


def close_everything() -> None:
    os.closerange(0, 256)
    time.sleep(600.0)


def leave_the_group_and_hang(told: str) -> None:
    os.setpgid(0, os.getpgid(os.getppid()))
    say_and_hang(told)


def outlive_signals() -> str:
    os.kill(os.getpid(), signal.SIGINT)
    os.kill(os.getpid(), signal.SIGTERM)
    return "went on"


def end_helpers() -> list[int]:
    """Start programs, of Python and not, and end them as one does; return their codes."""
    codes = []
    for words in ([sys.executable, "-c", "import time; time.sleep(600)"], ["sleep", "600"]):
        with subprocess.Popen(words) as helper:  # noqa: S603
            helper.terminate()
            codes.append(helper.wait())
    return codes


def end_a_fork() -> int:
    """Fork, and end the child as one does; return its code."""
    here, there = os.pipe()
    child = os.fork()
    if not child:
        os.write(there, b"at work")
        time.sleep(60.0)
        os._exit(1)
    os.read(here, 1)
    os.kill(child, signal.SIGTERM)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
