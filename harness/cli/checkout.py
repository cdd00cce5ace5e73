"""Commands that measure the project and not a scene.

They start programs beside the tests of a source checkout, which a wheel does not ship, each in a
process of its own with the options and the exit code of the command.
"""

import os
import signal
import subprocess
import sys
from pathlib import Path

import typer

from harness.core.errors import MissingCheckoutError
from harness.execution.signals import Interrupted

_CHECKOUT = Path(__file__).parents[2]


def benchmark(context: typer.Context) -> None:
    """What the project claims about speed, measured.

    As ratios within one run of some three minutes.

    Leaves with code 1 if a claim does not hold on this machine. Needs a source checkout.
    """
    raise typer.Exit(run_program("benchmarks", context.args))


def faults(context: typer.Context) -> None:
    """What is lost when runs are killed, hang or fill the disk.

    Trials: kill, crash, hang, fill the disk, stop, take the workers, sweep. Writes faults.md.

    Leaves with code 1 if something was lost, or took too long. Needs a source checkout.
    """
    raise typer.Exit(run_program("faults", context.args))


def run_program(name: str, arguments: list[str]) -> int:
    """Run a program of the source checkout and return its exit code.

    Parameters
    ----------
    name : str
        Its folder in `tests`.
    arguments : list of str

    Raises
    ------
    MissingCheckoutError
        If the tests are not beside the package.
    """
    if not (_CHECKOUT / "tests" / name / "__main__.py").is_file():
        raise MissingCheckoutError(f"tests/{name}")
    paths = [str(_CHECKOUT), *filter(None, [os.environ.get("PYTHONPATH")])]
    # the command's own output: file descriptor 1 is what engines print to, and leads elsewhere
    sys.stdout.flush()
    # -P: in a folder that has `tests` of its own, those are not meant
    program = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-P", "-m", f"tests.{name}", *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdout=sys.stdout,
    )
    try:
        return program.wait()
    except Interrupted:  # the program says what is done; of Ctrl-C it has heard already
        program.send_signal(signal.SIGTERM)
        return program.wait()
