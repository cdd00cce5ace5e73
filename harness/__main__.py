"""The program: what `rockingcan` and `python -m harness` start.

The command line takes seconds to import, and a signal may come meanwhile: so it is heard first.
"""

from harness.execution.signals import exit_on_signal


def main() -> None:
    """Run the command line and leave with its exit code."""
    exit_on_signal("interrupted before it began")
    from harness.cli.main import main as run  # noqa: PLC0415 - after the signals are heard

    run()


if __name__ == "__main__":
    main()
