"""The columns of a record: their names, their units, and the file that holds them.

A column is named after its quantity and its unit, such as `time_s`, `x_mm` or `phi_deg`. Columns of
other names are mapped by the user; what is not understood is left out, and told.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping
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
        `.parquet`, or text with a line of names, which may be a comment (`#`): separated by commas,
        semicolons (with a comma or a point in its numbers), tabulators or blanks.
    mapped : mapping of str to str, optional
        Name in the file of a column by its name here.

    Raises
    ------
    RecordFileError
        If the file cannot be read, has no such columns, or a cell of them is no finite number.
    """
    theirs = dict(mapped or {})
    taken = set(theirs.values())
    there, frame = _frame(path, lambda name: name in taken or _named(name) is not None)
    missing = [column for column in theirs.values() if column not in there]
    if missing:
        hint = did_you_mean(missing[0], there)
        raise RecordFileError(path, f"has no column '{missing[0]}'{hint} {_there(there)}")
    theirs |= {name: name for name in there if name not in taken and _named(name)}
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
    left_out = tuple(name for name in there if name not in theirs.values())
    found = Columns(path=path, quantities=values, names=names, left_out=left_out)
    _check(found, there)
    return found


def _check(found: Columns, every: Iterable[str]) -> None:
    """Refuse columns that make no motion."""
    path = found.path

    def lacks(group: Iterable[str]) -> str:
        return ", ".join(f"{one}_{next(iter(UNITS[one]))}".rstrip("_") for one in group)

    needed = [one for one in ("time", *POSITION) if one not in found.quantities]
    if needed:
        words = f"has no column {lacks(needed)}: map it by --column; "
        raise RecordFileError(path, f"{words}{_there(every)}")
    turned = [group for group in (QUATERNION, ANGLES) if found.has(group)]
    if len(turned) != 1:
        many = "both" if turned else "neither"
        words = f"has {many} of {lacks(QUATERNION)} and {lacks(ANGLES)}: one is needed; "
        raise RecordFileError(path, f"{words}{_there(every)}")
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


def _there(names: Iterable[str]) -> str:
    """Return the columns of a file in words."""
    return f"its columns are {shown(', '.join(names))}"


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
    elif cells.dtype.name == "category":  # each text once, and never as often as it stands there
        texts = [*map(_number, cells.cat.categories.tolist()), math.nan]  # the last of no text: -1
        numbers = np.array(texts, dtype=np.float64)[cells.cat.codes]
    else:
        numbers = np.array([_number(cell) for cell in cells.tolist()], dtype=np.float64)
    bad = ~(np.abs(numbers) < _LARGEST_NUMBER)
    if gaps:
        bad &= ~np.isnan(numbers)
    if bad.any():
        first = int(np.argmax(bad))
        cell = shown(cells.iloc[first])
        words = f"column '{column}' has {cell} in sample {first + 1}: no number"
        raise RecordFileError(path, words)
    return numbers


def _number(cell: object) -> float:
    """Return a cell as a number, infinite if it is none, NaN if it is empty."""
    if cell is None or cell == "":
        return math.nan
    try:
        return float(str(cell))  # exact, other than the parsers of tables
    except ValueError:
        return math.inf


def _frame(path: Path, known: Callable[[str], bool]) -> tuple[list[str], "pd.DataFrame"]:
    """Return the names of all columns of a file, and a table that has those that are known.

    Raises
    ------
    RecordFileError
        If there is none, or it is too large.
    """
    try:
        _check_size(path, path.stat().st_size, LARGEST_FILE, "bytes")
        read = _parquet_frame if path.suffix == ".parquet" else _text_frame
        names, frame = read(path, known)
    except RecordFileError:
        raise
    except OSError as error:
        raise RecordFileError(path, f"cannot be read: {error.strerror or error}") from error
    except Exception as error:  # a parser raises what it likes on what is no table
        raise RecordFileError(path, f"is no table: {error}") from error
    _check_size(path, len(frame), MOST_SAMPLES, "samples")
    _check_names(path, names)
    return names, frame


def _check_size(path: Path, size: int, most: int, of_what: str) -> None:
    """Refuse a file that has too much of something."""
    if size > most:
        raise RecordFileError(path, f"has more than {most} {of_what}")


def _check_names(path: Path, names: list[str]) -> None:
    """Refuse a file with too many columns, or with two of one name."""
    _check_size(path, len(names), MOST_COLUMNS, "columns")
    if len(set(names)) < len(names):
        raise RecordFileError(path, "has two columns of one name")


def _parquet_frame(path: Path, known: Callable[[str], bool]) -> tuple[list[str], "pd.DataFrame"]:
    """Return the names in a Parquet file, and its known columns; its sizes are checked before."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(path, pre_buffer=False) as file:
        samples, schema = file.metadata.num_rows, file.schema_arrow
    _check_size(path, samples, MOST_SAMPLES, "samples")  # a small file may hold billions
    names = [name.strip() for name in schema.names if not name.startswith("__index_level_")]
    _check_names(path, names)
    wanted = [name for name in schema.names if known(name.strip())]
    for name in wanted:
        if pa.types.is_nested(schema.field(name).type):
            raise RecordFileError(path, f"column '{name}' has {schema.field(name).type}: no number")
    unpacked = samples * len(wanted) * np.dtype(np.float64).itemsize
    _check_size(path, unpacked, LARGEST_FILE, "bytes once it is unpacked")
    # a text stays in its dictionary: a short file may repeat a long one in every sample
    with pq.ParquetFile(path, pre_buffer=False, read_dictionary=wanted) as file:
        table = file.read(columns=wanted, use_threads=False)
    frame: pd.DataFrame = table.to_pandas(use_threads=False, ignore_metadata=True)
    return names, frame.rename(columns=str.strip)


_PACKED = (b"\x1f\x8b", b"BZh", b"PK\x03\x04", b"\xfd7zXZ", b"(\xb5/\xfd")
"""First bytes of files that gzip, bzip2, zip, xz and zstd wrote."""


def _text_frame(path: Path, known: Callable[[str], bool]) -> tuple[list[str], "pd.DataFrame"]:
    """Return the table of a text with the names of its columns, its cells as they are written."""
    import pandas as pd  # noqa: PLC0415

    encoding, separator, decimal, names = _dialect(path, known)
    frame = pd.read_csv(
        path,
        sep=separator,
        header=None,  # with one, columns of one name would get others
        skipinitialspace=True,
        comment="#",
        index_col=False,
        dtype=str,
        keep_default_na=False,
        encoding=encoding,
        encoding_errors="replace",
        compression=None,  # a file of a few bytes may unpack to any size
        nrows=MOST_SAMPLES + 2,
    )
    if not names:
        names, frame = [str(name).strip() for name in frame.iloc[0]], frame.iloc[1:]
    if len(names) != len(frame.columns):
        many = f"names {len(names)} columns in a comment, and has {len(frame.columns)}"
        raise RecordFileError(path, many)
    frame.columns = names
    if decimal != ".":
        frame = frame.apply(lambda cells: cells.str.replace(decimal, ".", regex=False))
    return names, frame


def _dialect(path: Path, known: Callable[[str], bool]) -> tuple[str, str, str, list[str]]:
    """Return encoding, separator (as pandas takes it), decimal point, and names in a comment.

    Where the first line of data has the names, as it usually does, there are none in a comment, in
    which numpy.savetxt writes them.
    """
    with path.open("rb") as binary:
        start = binary.read(8)
    if start.startswith(_PACKED):
        raise RecordFileError(path, "is compressed: unpack it first")
    encoding = "utf-16" if start[:2] in {b"\xff\xfe", b"\xfe\xff"} else "utf-8-sig"
    comments: list[str] = []
    with path.open(encoding=encoding, errors="replace", newline="") as file:
        lines = (line[:100_000] for line in file if line.strip())
        header = next(lines, "")
        while header.startswith("#"):
            comments.append(header.lstrip("# "))
            header = next(lines, "")
        first = next((line for line in lines if not line.startswith("#")), "")
    lines_of_names = [] if any(map(known, _cells(header))) else map(_cells, comments)
    names = next((cells for cells in lines_of_names if sum(map(known, cells)) > 1), [])
    separator = _separator(header)
    points = separator == "," or "," not in (header if names else first)
    return encoding, separator, "." if points else ",", names


def _separator(line: str) -> str:
    """Return what separates the cells of a line, as pandas takes it."""
    return next((one for one in (";", "\t", ",") if one in line), r"\s+")


def _cells(line: str) -> list[str]:
    """Return the cells of a line of names."""
    return [cell.strip().strip('"') for cell in re.split(_separator(line), line.strip())]
