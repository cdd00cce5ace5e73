"""The columns of a record: their names, their units, and the file that holds them.

A column is named after its quantity and its unit, such as `time_s`, `x_mm` or `phi_deg`. Columns of
other names are mapped by the user; what is not understood is left out, and told.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from harness.core.errors import HarnessError, InvalidSettingError
from harness.core.trajectory import Floats
from models.errors import did_you_mean, shown

if TYPE_CHECKING:
    import pandas as pd

_LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
_ANGLE = {"rad": 1.0, "deg": math.pi / 180.0}
_SPEED = {f"{unit}_s": factor for unit, factor in _LENGTH.items()}
_SPIN = {f"{unit}_s": factor for unit, factor in _ANGLE.items()}
_FORCE, _NUMBER = {"n": 1.0, "kn": 1e3}, {"": 1.0}

UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
        **dict.fromkeys(("x", "y", "z", "contact_x", "contact_y", "depth"), _LENGTH),
        **dict.fromkeys(("phi", "psi", "theta"), _ANGLE),
        **dict.fromkeys(("vx", "vy", "vz"), _SPEED),
        **dict.fromkeys(("wx", "wy", "wz"), _SPIN),
        **dict.fromkeys(("force_x", "force_y", "force_z"), _FORCE),
        **dict.fromkeys(("qw", "qx", "qy", "qz"), _NUMBER),
    }
)
"""Units of each quantity, and what they are in SI."""

POSITION, QUATERNION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
ANGLES, VELOCITY, SPIN = ("phi", "psi", "theta"), ("vx", "vy", "vz"), ("wx", "wy", "wz")
CONTACT, FORCE, DEPTH = ("contact_x", "contact_y"), ("force_x", "force_y", "force_z"), ("depth",)

OPTIONAL = (VELOCITY, SPIN, CONTACT, FORCE, DEPTH)
"""Groups of which a record has every column or none."""

LARGEST_FILE = 2 * 1024**3
"""Bytes."""

MOST_SAMPLES = 5_000_000
MOST_COLUMNS = 1000

_LARGEST_NUMBER = 1e100
"""What is larger overflows where it is squared."""


@dataclass(eq=False)
class RecordFileError(HarnessError, ValueError):
    """A file is no record of a motion.

    Parameters
    ----------
    path : Path
    reason : str
        What is wrong, and what is allowed.
    """

    path: Path
    reason: str

    def __post_init__(self) -> None:
        """Keep both as the arguments of the exception."""
        super().__init__(self.path, self.reason)

    def __str__(self) -> str:
        """Return the file and the reason in a line."""
        return f"'{self.path}': {' '.join(self.reason.split())}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Columns:
    """The columns of a file that are understood, in SI units.

    Parameters
    ----------
    path : Path
    quantities : mapping of str to ndarray, shape (n,)
        By quantity.
    names : mapping of str to str
        Name of each quantity's column in the file, with its unit if it is not SI.
    left_out : tuple of str
        Columns that are not understood.
    """

    path: Path
    quantities: Mapping[str, Floats]
    names: Mapping[str, str]
    left_out: tuple[str, ...] = ()

    def has(self, group: Iterable[str]) -> bool:
        """Whether there is a column of each quantity of a group."""
        return all(quantity in self.quantities for quantity in group)

    def stacked(self, group: Iterable[str]) -> Floats:
        """Return the columns of a group side by side, shape (n, k)."""
        return np.column_stack([self.quantities[quantity] for quantity in group])


@dataclass(frozen=True, slots=True)
class _Named:
    """A quantity, and its unit in SI."""

    quantity: str
    factor: float
    unit: str = field(compare=False)


def _named(column: str) -> _Named | None:
    """Return what a column's name says; None if it is no name of a quantity with its unit."""
    for quantity, units in UNITS.items():
        for unit, factor in units.items():
            if column == (f"{quantity}_{unit}" if unit else quantity):
                return _Named(quantity, factor, unit)
    return None


NAMES = tuple(
    f"{quantity}_{unit}" if unit else quantity
    for quantity, units in UNITS.items()
    for unit in units
)
"""All names that a column may have."""


def mapping(pairs: Iterable[str]) -> dict[str, str]:
    """Return the columns that were mapped, OURS=THEIRS each, by ours.

    Raises
    ------
    InvalidSettingError
        If one is not of that form, or names no quantity with a unit.
    """
    chosen: dict[str, str] = {}
    for pair in pairs:
        ours, equals, theirs = pair.partition("=")
        if not equals or not theirs:
            raise InvalidSettingError("--column", pair, "OURS=THEIRS, such as time_ms=Time")
        if _named(ours) is None:
            hint = did_you_mean(ours, NAMES, "")
            raise InvalidSettingError("--column", pair, f"{', '.join(NAMES)}{hint}")
        chosen[ours] = theirs
    return chosen


def read_columns(path: Path, mapped: Mapping[str, str] | None = None) -> Columns:
    """Return the columns of a file in CSV or Parquet.

    Parameters
    ----------
    path : Path
        `.parquet`, or text with a line of names: separated by commas, semicolons (with a comma or
        a point in its numbers), tabulators or blanks.
    mapped : mapping of str to str, optional
        Name in the file of a column by its name here.

    Raises
    ------
    RecordFileError
        If the file cannot be read, has no such columns, or a cell of them is no finite number.
    """
    frame = _frame(path)
    theirs = dict(mapped or {})
    missing = [column for column in theirs.values() if column not in frame.columns]
    if missing:
        hint = did_you_mean(missing[0], map(str, frame.columns))
        raise RecordFileError(path, f"has no column '{missing[0]}'{hint} {_there(frame)}")
    taken = set(theirs.values())
    theirs |= {name: name for name in map(str, frame.columns) if name not in taken and _named(name)}
    values: dict[str, Floats] = {}
    names: dict[str, str] = {}
    for ours, column in theirs.items():
        named = _named(ours)
        if named is None:
            continue
        if named.quantity in values:
            both = f"'{names[named.quantity]}' and '{column}'"
            raise RecordFileError(path, f"has two columns of {named.quantity}: {both}")
        numbers = _numbers(path, frame, column, gaps=named.quantity in (*CONTACT, *DEPTH))
        values[named.quantity] = numbers if named.factor == 1.0 else numbers * named.factor
        names[named.quantity] = column if named.factor == 1.0 else f"{column} in {named.unit}"
    left_out = tuple(name for name in map(str, frame.columns) if name not in theirs.values())
    found = Columns(path=path, quantities=values, names=names, left_out=left_out)
    _check(found, frame)
    return found


def _check(found: Columns, frame: "pd.DataFrame") -> None:
    """Refuse columns that make no motion."""
    path = found.path

    def lacks(group: Iterable[str]) -> str:
        return ", ".join(f"{one}_{next(iter(UNITS[one]))}".rstrip("_") for one in group)

    needed = [one for one in ("time", *POSITION) if one not in found.quantities]
    if needed:
        raise RecordFileError(
            path, f"has no column {lacks(needed)}: map it by --column; {_there(frame)}"
        )
    turned = [group for group in (QUATERNION, ANGLES) if found.has(group)]
    if len(turned) != 1:
        many = "both" if turned else "neither"
        words = f"has {many} of {lacks(QUATERNION)} and {lacks(ANGLES)}: one is needed; "
        raise RecordFileError(path, f"{words}{_there(frame)}")
    for group in OPTIONAL:
        there = [one for one in group if one in found.quantities]
        absent = [one for one in group if one not in found.quantities]
        if there and absent:
            raise RecordFileError(path, f"has a column {lacks(there)}, but none {lacks(absent)}")
    time = found.quantities["time"]
    if len(time) < 4:  # noqa: PLR2004 - a cubic has so many
        raise RecordFileError(path, f"has {len(time)} samples, but 4 are needed at least")
    steps = np.diff(time)
    if not (steps > 0.0).all():
        line = int(np.argmax(~(steps > 0.0))) + 2
        raise RecordFileError(path, f"time does not increase at its sample {line}")


def _there(frame: "pd.DataFrame") -> str:
    """Return the columns of a file in words."""
    return f"its columns are {shown(', '.join(map(str, frame.columns)))}"


def _numbers(path: Path, frame: "pd.DataFrame", column: str, *, gaps: bool) -> Floats:
    """Return a column as finite numbers, NaN where a cell is empty and may be.

    Raises
    ------
    RecordFileError
        With the first cell that is none.
    """
    cells = frame[column]
    if cells.dtype.kind in "biuf":
        numbers: Floats = cells.to_numpy(dtype=np.float64)
    else:
        numbers = np.array([_number(cell) for cell in cells.tolist()], dtype=np.float64)
    bad = ~(np.abs(numbers) < _LARGEST_NUMBER)
    if gaps:
        bad &= ~np.isnan(numbers)
    if bad.any():
        first = int(np.argmax(bad))
        cell = shown(cells.iloc[first])
        raise RecordFileError(
            path, f"column '{column}' has {cell} in sample {first + 1}: no number"
        )
    return numbers


def _number(cell: object) -> float:
    """Return a cell as a number, infinite if it is none, NaN if it is empty."""
    if cell is None or cell == "":
        return math.nan
    try:
        return float(str(cell))  # exact, other than the parsers of tables
    except ValueError:
        return math.inf


def _frame(path: Path) -> "pd.DataFrame":
    """Return the table of a file.

    Raises
    ------
    RecordFileError
        If there is none.
    """
    try:
        _check_size(path)
        frame = _parquet_frame(path) if path.suffix == ".parquet" else _text_frame(path)
    except RecordFileError:
        raise
    except OSError as error:
        raise RecordFileError(path, f"cannot be read: {error.strerror or error}") from error
    except Exception as error:  # a parser raises what it likes on what is no table
        raise RecordFileError(path, f"is no table: {error}") from error
    frame.columns = [str(name).strip() for name in frame.columns]
    if len(frame) > MOST_SAMPLES:
        raise RecordFileError(path, f"has more than {MOST_SAMPLES} samples")
    if len(frame.columns) > MOST_COLUMNS:
        raise RecordFileError(path, f"has {len(frame.columns)} columns, of {MOST_COLUMNS} at most")
    if len(set(frame.columns)) < len(frame.columns):
        raise RecordFileError(path, "has two columns of one name")
    return frame


def _check_size(path: Path) -> None:
    """Refuse a file that is too large to be read."""
    if (size := path.stat().st_size) > LARGEST_FILE:
        raise RecordFileError(path, f"has {size} bytes, of {LARGEST_FILE} at most")


def _parquet_frame(path: Path) -> "pd.DataFrame":
    """Return the table of a Parquet file, unless it says that it has too many samples."""
    import pyarrow.parquet as pq  # noqa: PLC0415

    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(path, pre_buffer=False) as file:
        if file.metadata.num_rows > MOST_SAMPLES:  # a small file may hold billions
            raise RecordFileError(path, f"has more than {MOST_SAMPLES} samples")
        frame: pd.DataFrame = file.read(use_threads=False).to_pandas(use_threads=False)
    return frame


def _text_frame(path: Path) -> "pd.DataFrame":
    """Return the table of a text, its cells as they are written."""
    import pandas as pd  # noqa: PLC0415

    separator, decimal = _dialect(path)
    frame = pd.read_csv(
        path,
        sep=separator,
        header=None,  # with one, columns of one name would get others
        skipinitialspace=True,
        comment="#",
        index_col=False,
        dtype=str,
        keep_default_na=False,
        encoding="utf-8-sig",
        encoding_errors="replace",
        nrows=MOST_SAMPLES + 2,
    )
    frame.columns = frame.iloc[0]
    frame = frame.iloc[1:]
    if decimal == ".":
        return frame
    pointed: pd.DataFrame = frame.apply(lambda cells: cells.str.replace(decimal, ".", regex=False))
    return pointed


def _dialect(path: Path) -> tuple[str, str]:
    """Return what separates the cells of a text, as pandas writes it, and its decimal point."""
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        lines = (line for line in file if line.strip() and not line.startswith("#"))
        header, first = next(lines, "")[:100_000], next(lines, "")[:100_000]
    separator = next((one for one in (";", "\t", ",") if one in header), r"\s+")
    return separator, "," if separator != "," and "," in first else "."
