"""Run again what the numbers in the texts come from: ``make measure``, ``make measure ONLY=cost``.

What needs every engine is measured by ``.venv-engines/bin/python -m docs.measure engines``.

`docs/measured.toml` says which commands these are and which of their files are kept, in the folder
`reports/baseline/NAME`. Beside them, `made.json` says by which command, when and where, and what it
took: time, processor time with that of its processes, and the memory of the largest of them.
"""

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from PIL import Image
from pydantic import BaseModel, ConfigDict, TypeAdapter

from harness.core.provenance import provenance
from harness.execution.atomic_write import write_atomically

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "reports" / "baseline"
PRINTED = "printed.json"
"""Name of what a command printed."""
ROWS = "rows.csv"
"""Name of the rows of a sweep, which it keeps in parts."""


class Measured(BaseModel):
    """A command, and the files of it that are kept.

    Parameters
    ----------
    command : str
        With `{out}` for the folder of its report, which is read and thrown away.
    files : tuple of str
        In that folder.
    exit_codes : tuple of int
        With which the command may end: a claim that does not hold is a result, too.
    all_engines : bool
        Whether every engine is to be there: measured if it is named, in the environment of
        `make engines`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    command: str
    files: tuple[str, ...]
    exit_codes: tuple[int, ...] = (0,)
    all_engines: bool = False


def measured() -> dict[str, Measured]:
    """Return the measurements by name."""
    with (ROOT / "docs" / "measured.toml").open("rb") as file:
        return TypeAdapter(dict[str, Measured]).validate_python(tomllib.load(file))


COLOURS = 128
"""Of a figure that is kept: lines look the same, and it is a quarter as long."""


def keep(file: Path, place: Path) -> None:
    """Copy a file that was measured; a figure with fewer colours."""
    if file.suffix != ".png":
        shutil.copyfile(file, place)
        return
    with Image.open(file) as figure:
        plain = figure.convert("RGB")
    # the method that keeps thin lines of a colour of their own
    few = plain.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(place, optimize=True)


_MAXRSS_BYTES = 1024
"""Of the unit of the largest resident memory, on Linux."""


def measure(name: str, what: Measured) -> None:
    """Run a command and keep its files.

    Raises
    ------
    SystemExit
        If the command ends with another exit code than it should.
    """
    with tempfile.TemporaryDirectory(prefix="rockingcan-") as folder:
        out = Path(folder) / "out"
        words = [word.format(out=out) for word in shlex.split(what.command)]
        program = str(Path(sys.executable).with_name(words[0]))
        began = time.monotonic()
        out_file = Path(folder) / PRINTED
        with out_file.open("wb") as stdout:
            child = subprocess.Popen([program, *words[1:]], cwd=ROOT, stdout=stdout)  # noqa: S603 - a command of our own
            _, status, usage = os.wait4(child.pid, 0)  # what `subprocess.run` does not tell
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in what.exit_codes:
            sys.exit(f"`{what.command}` ended with {child.returncode}, not in {what.exit_codes}")
        took = {
            "seconds": round(time.monotonic() - began, 1),
            "processor_seconds": round(usage.ru_utime + usage.ru_stime, 1),
            "largest_process_mb": round(usage.ru_maxrss * _MAXRSS_BYTES / 1e6, 1),
        }
        place = KEPT / name
        place.mkdir(parents=True, exist_ok=True)
        for file in what.files:
            if file == PRINTED:
                printed = out_file.read_bytes().replace(str(out).encode(), b"{out}")
                write_atomically(place / PRINTED, printed)
            elif file == ROWS:
                parts = [pd.read_parquet(part) for part in sorted((out / "parts").iterdir())]
                write_atomically(place / ROWS, pd.concat(parts).to_csv(index=False).encode())
            else:
                keep(out / file, place / Path(file).name)
    made = {"command": what.command, "took": took, **provenance().to_dict()}
    write_atomically(place / "made.json", (json.dumps(made, indent=2) + "\n").encode())


def main(names: Annotated[list[str] | None, typer.Argument()] = None) -> None:
    """Run the commands of the measurements named, or of all that need no further engines."""
    every = measured()
    if unknown := sorted(set(names or ()) - set(every)):
        sys.exit(f"no measurement {', '.join(unknown)}; docs/measured.toml has {', '.join(every)}")
    for name in names or [name for name, what in every.items() if not what.all_engines]:
        typer.echo(f"{name}: {every[name].command}", err=True)
        measure(name, every[name])


if __name__ == "__main__":
    typer.run(main)
