"""The program: what `rockingcan` and `python -m harness` start.

The command line takes seconds to import, and a signal may come meanwhile: so it is heard first.
"""

from harness.interruption import leave_at_once


def main() -> None:
    """Run the command line and leave with its exit code."""
    leave_at_once("interrupted before it began")
    from harness.cli import main as run  # noqa: PLC0415 - after the signals are heard

    run()


if __name__ == "__main__":
    main()
