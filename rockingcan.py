"""The program: what `rockingcan`, `python -m rockingcan` and `python -m harness` start.

The packages `harness`, `models` and `reference` have names that files of a user may have as well,
and Python looks in the folders of PYTHONPATH first, and with `python -m` in the folder where it is
started. So this module stands beside the packages under a name that nothing else has, and looks
where they are found before it imports one. They take a second to import, in which a signal may
come: so signals are heard before.

It also settles, before numpy is imported, that linear algebra has one thread in a process. The
matrices are small, and the cores are taken by cases: threads would wait for each other, at ten
times the processor time on a busy machine, and sums would depend on how many cores there are.
"""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

_PACKAGES = ("harness", "models", "reference")
_WRONG_USE = 2


def main() -> None:
    """Run the command line and leave with its exit code."""
    if reason := _not_linux() or _shadowed():
        sys.stderr.write(f"rockingcan: {reason}\n")
        sys.exit(_WRONG_USE)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from harness.execution.signals import exit_on_signal  # noqa: PLC0415 - it is the right one now

    exit_on_signal("interrupted before it began")
    from harness.cli.main import main as run  # noqa: PLC0415 - after the signals are heard

    run()


def _not_linux() -> str:
    """Return why the program does not run on this system; empty where it does."""
    system: str = sys.platform
    if system == "linux":
        return ""
    return (
        f"this system is '{system}', and it runs on Linux alone, whose /proc, process groups "
        "and locks of files it needs; use a machine or a container with Linux"
    )


def _shadowed() -> str:
    """Return which package Python finds elsewhere than beside this module; empty for none."""
    here = Path(__file__).resolve().parent
    for name in _PACKAGES:
        found = find_spec(name)
        if found is None or found.origin is None:
            return f"its package '{name}' is not installed beside '{here}'; install rockingcan anew"
        place = Path(found.origin).resolve()
        if place != here / name / "__init__.py":
            return (
                f"'{place}' stands before its own package '{name}'; take that folder out of "
                "PYTHONPATH, or start rockingcan by its name and not with python -m"
            )
    return ""


if __name__ == "__main__":
    main()
