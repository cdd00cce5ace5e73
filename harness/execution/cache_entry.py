"""What a store keeps under a key: a record, arrays of one length, and where they come from.

The record is JSON with the checksum of its own text in it. The arrays are a Parquet file beside it,
which the record names together with its checksum: so the record is what counts, and it is written
last.

Values as strict JSON holds them, and back without loss.

JSON has no tuples and no infinite numbers. Both are wrapped in an object of one key that no record
of ours uses, so that what is read equals what was written, its types included. Floats are written
with as many digits as they need to come back bit for bit.
"""

import hashlib
import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet

from harness.core.errors import StoreError

_TUPLE, _FLOAT = "(tuple)", "(float)"


def encode(value: object) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return a value in JSON's own types.

    Raises
    ------
    TypeError
        If it is, or holds, something else than mappings, lists, tuples, text, numbers, truth values
        and None.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {str(key): encode(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        return {_TUPLE: [encode(inner) for inner in value]}
    if isinstance(value, list):
        return [encode(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return {_FLOAT: repr(value)}
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise TypeError(f"a store keeps no {type(value).__name__}")


def decode(value: Any) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return what `plain` was given."""
    if isinstance(value, list):
        return [decode(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    if set(value) == {_TUPLE}:
        return tuple(decode(inner) for inner in value[_TUPLE])
    if set(value) == {_FLOAT}:
        return float(value[_FLOAT])
    return {key: decode(inner) for key, inner in value.items()}


FORMAT, VERSION = "rockingcan-store", 1

Array = NDArray[np.float64] | NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Metadata:
    """Where an entry comes from: for people, and for pruning.

    Parameters
    ----------
    label : str
        The case in a few words.
    command : str
        What runs it again.
    engine, engine_version : str
    code : str
        Fingerprint of the program that made it.
    modules : tuple of str
        Whose sources are in the fingerprint besides those that are in all.
    kept : str
        When, UTC, ISO 8601.
    machine : str
        Processor on which the times in it were measured.
    """

    label: str
    command: str = ""
    engine: str = ""
    engine_version: str = ""
    code: str = ""
    modules: tuple[str, ...] = ()
    kept: str = ""
    machine: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EntryContent:
    """What was found out: a record of what JSON can hold, tuples too, and arrays by name.

    Parameters
    ----------
    record : mapping
    arrays : mapping of str to ndarray, shape (n,) or (n, k)
        Of float64 or int64, the same n for all.
    """

    record: Mapping[str, Any]
    arrays: Mapping[str, Array] = field(default_factory=dict)


def write_arrays(arrays: Mapping[str, Array]) -> bytes:
    """Return arrays as a Parquet file: a column for each column of each, every bit as it is."""
    columns = {}
    for name, array in arrays.items():
        table = array.reshape(len(array), -1)
        for number in range(table.shape[1]):
            label = name if array.ndim == 1 else f"{name}_{number}"
            columns[label] = pa.array(np.ascontiguousarray(table[:, number]))
    file = io.BytesIO()
    # neither dictionaries nor statistics: both treat numbers that compare equal as one
    parquet.write_table(
        pa.table(columns), file, compression="zstd", use_dictionary=False, write_statistics=False
    )
    return file.getvalue()


def read_arrays(content: bytes, widths: Mapping[str, int | None]) -> dict[str, Array]:
    """Return the arrays of a Parquet file; None is the width of an array of one dimension."""
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with parquet.ParquetFile(pa.BufferReader(content), pre_buffer=False) as file:
        table = file.read(use_threads=False)
    found: dict[str, Array] = {}
    for name, width in widths.items():
        if width is None:
            found[name] = table.column(name).to_numpy()
        else:
            found[name] = np.stack(
                [table.column(f"{name}_{number}").to_numpy() for number in range(width)], axis=1
            )
    return found


def write_record(
    kind: str, key: str, about: Metadata, content: EntryContent, arrays_file: tuple[str, str] | None
) -> bytes:
    """Return the JSON file of an entry; `arrays_file` is name and checksum of its arrays."""
    told = {
        "format": FORMAT,
        "version": VERSION,
        "kind": kind,
        "key": key,
        "about": encode(asdict(about)),
        "record": encode(content.record),
        "arrays": None
        if arrays_file is None
        else {
            "file": arrays_file[0],
            "sha256": arrays_file[1],
            "widths": {
                name: None if array.ndim == 1 else array.shape[1]
                for name, array in content.arrays.items()
            },
        },
    }
    told["sha256"] = checksum(_text(told))
    return (json.dumps(told, indent=1, allow_nan=False, ensure_ascii=False) + "\n").encode()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EntryRecord:
    """The JSON file of an entry, read and checked."""

    about: Metadata
    record: dict[str, Any]
    arrays_file: str | None
    arrays_sha256: str
    widths: dict[str, int | None]


def read_record(content: bytes, kind: str, key: str) -> EntryRecord:
    """Return the JSON file of an entry.

    Raises
    ------
    StoreError
        With what is wrong with it.
    """
    try:
        told = json.loads(content)
        stated = told.pop("sha256")
        if told["format"] != FORMAT or told["version"] != VERSION:
            raise StoreError("it is of another format")
        if checksum(_text(told)) != stated:
            raise StoreError("its checksum is not that of its content")
        if (told["kind"], told["key"]) != (kind, key):
            raise StoreError("it is the entry of another case")
        arrays = told["arrays"] or {"file": None, "sha256": "", "widths": {}}
        return EntryRecord(
            about=Metadata(**decode(told["about"])),
            record=decode(told["record"]),
            arrays_file=arrays["file"],
            arrays_sha256=arrays["sha256"],
            widths=arrays["widths"],
        )
    # too deep a nesting is a RecursionError
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, StoreError):
            raise
        raise StoreError("it is no whole record") from error


def checksum(content: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def _text(told: Mapping[str, Any]) -> bytes:
    """Return what the checksum of a record is taken of: the same however it is laid out."""
    return json.dumps(told, sort_keys=True, allow_nan=False).encode()
