"""File format of a cache entry: a line of JSON, then the bytes of the arrays, compressed.

The line is strict JSON with the checksum of its own text in it, and that of the arrays. It holds
the metadata and the result, encoded as follows.

JSON has neither tuples, infinite numbers, dataclasses, enumerations nor arrays. Each is wrapped in
an object of one key, so that the decoded value equals the encoded one, its types included. Floats
are written with as many digits as restore them bit for bit, arrays as their bytes.
The key of an entry holds a fingerprint of the sources, so a dataclass has the fields it had; no
entry is read by another version of the program.
"""

import hashlib
import importlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from harness.core.errors import StoreError

FORMAT, VERSION = "rockingcan-store", 2


class Defect(Enum):
    """Why an entry is not what was written."""

    UNREADABLE = "it cannot be read"
    FORMAT = "it is of another format"
    CHECKSUM = "its checksum is not that of its content"
    OTHER_CASE = "it is the entry of another case"
    CUT_SHORT = "its arrays are cut short"
    ARRAYS = "the checksum of its arrays is not theirs"
    NO_RECORD = "it is no whole record"


@dataclass(eq=False, kw_only=True)
class BrokenEntryError(StoreError):
    """An entry is not what was written; `reason` is what the system says, if it says something."""

    defect: Defect
    reason: str = ""

    def __str__(self) -> str:
        """Return the defect in words."""
        return f"{self.defect.value}{self.reason and f': {self.reason}'}"


_TUPLE, _FLOAT, _ARRAY = "(tuple)", "(float)", "(array)"
_CLASS, _SAME, _ENUM = "(class)", "(same)", "(enum)"

_PROGRAM = ("harness.", "models.", "reference.")
"""Packages whose classes an entry may name; no other module is imported because of a file."""

_CODEC = "zstd"


class Encoder:
    """Turns values into JSON's own types; an array or dataclass that recurs is written once."""

    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        # by identity the number, and the object, so that no other object takes over the identity
        self._known: dict[int, tuple[int, object]] = {}

    def encode(self, value: object) -> Any:  # noqa: ANN401, PLR0911 - a line for each type
        """Return a value in JSON's own types.

        Raises
        ------
        TypeError
            If it is, or holds, something else than dataclasses, members of enumerations, arrays of
            numbers, mappings, lists, tuples, text, numbers, truth values and None.
        """
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, Enum):
            return {_ENUM: [_name(type(value)), value.name]}
        if value is None or isinstance(value, str | bool | int):
            return value
        if isinstance(value, float):
            return value if math.isfinite(value) else {_FLOAT: repr(value)}
        if isinstance(value, Mapping):
            return {str(key): self.encode(inner) for key, inner in value.items()}
        if isinstance(value, tuple):
            return {_TUPLE: [self.encode(inner) for inner in value]}
        if isinstance(value, list):
            return [self.encode(inner) for inner in value]
        if id(value) in self._known:
            return {_SAME: self._known[id(value)][0]}
        encoded = self._once(value)
        self._known[id(value)] = len(self._known), value
        return encoded

    def _once(self, value: object) -> dict[str, Any]:
        """Return the encoding of an array or a dataclass at its first occurrence."""
        if isinstance(value, np.ndarray) and value.dtype.kind in "bif":
            self.arrays.append(value)
            return {_ARRAY: [value.dtype.str, list(value.shape)]}
        if is_dataclass(value) and not isinstance(value, type):
            inner = {f.name: self.encode(getattr(value, f.name)) for f in fields(value) if f.init}
            return {_CLASS: [_name(type(value)), inner]}
        raise TypeError(f"a store keeps no {type(value).__name__}")


class Decoder:
    """Turns the output of an `Encoder` into the values that it encoded.

    Parameters
    ----------
    content : bytes
        Of all arrays, one after the other.
    """

    def __init__(self, content: bytes = b"") -> None:
        self._content = content
        self._read = 0
        self._known: list[object] = []

    def decode(self, value: Any) -> Any:  # noqa: ANN401, PLR0911 - as `encode`
        """Return the value that `Encoder.encode` encoded.

        Raises
        ------
        ValueError, LookupError, TypeError, AttributeError, ImportError
            If it is not the output of an encoder.
        """
        if isinstance(value, list):
            return [self.decode(inner) for inner in value]
        if not isinstance(value, dict):
            return value
        name = next(iter(value)) if len(value) == 1 else None
        if name == _TUPLE:
            return tuple(self.decode(inner) for inner in value[_TUPLE])
        if name == _FLOAT:
            return float(value[_FLOAT])
        if name == _ENUM:
            return _class(value[_ENUM][0])[value[_ENUM][1]]
        if name == _SAME:
            return self._known[value[_SAME]]
        if name not in {_ARRAY, _CLASS}:
            return {key: self.decode(inner) for key, inner in value.items()}
        decoded = self._array(*value[_ARRAY]) if name == _ARRAY else self._object(*value[_CLASS])
        self._known.append(decoded)
        return decoded

    def _array(self, kind: str, shape: list[int]) -> NDArray[Any]:
        dtype, count = np.dtype(kind), math.prod(shape)
        size = count * dtype.itemsize
        planes = np.frombuffer(self._content, np.uint8, size, self._read)
        self._read += size
        return np.frombuffer(planes.reshape(dtype.itemsize, count).T.tobytes(), dtype).reshape(
            shape
        )

    def _object(self, kind: str, encoded: dict[str, Any]) -> object:
        return _class(kind)(**{key: self.decode(inner) for key, inner in encoded.items()})


def _name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(path: str) -> Any:  # noqa: ANN401 - a dataclass or an enumeration
    module, _, name = path.partition(":")
    if module.startswith(_PROGRAM):
        kind = getattr(importlib.import_module(module), name)
        if is_dataclass(kind) or (isinstance(kind, type) and issubclass(kind, Enum)):
            return kind
    raise TypeError(f"no class of a result: {path}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Metadata:
    """Origin of an entry, for people and for pruning.

    Parameters
    ----------
    label : str
        The case in a few words.
    command : str
        Runs the case again.
    engine, engine_version : str
    code : str
        Fingerprint of the program that made it.
    modules : tuple of str
        Modules whose sources are in this fingerprint besides those that are in every one.
    kept : str
        Time of storing, UTC, ISO 8601.
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
class CacheEntry:
    """An entry read from a file: its metadata is checked, its arrays are not.

    Parameters
    ----------
    metadata : Metadata
    encoded : JSON
        The result.
    arrays : bytes
        Compressed.
    arrays_size : int
        Bytes of the arrays without compression.
    arrays_sha256 : str
        Expected checksum of the arrays.
    """

    metadata: Metadata
    encoded: Any
    arrays: bytes = field(repr=False)
    arrays_size: int
    arrays_sha256: str

    def value(self) -> Any:  # noqa: ANN401 - any result
        """Return the result.

        Raises
        ------
        BrokenEntryError
            If the entry is broken.
        """
        if checksum(self.arrays) != self.arrays_sha256:
            raise BrokenEntryError(defect=Defect.ARRAYS)
        try:
            size = self.arrays_size
            content = pa.decompress(self.arrays, size, _CODEC, asbytes=True) if size else b""
            return Decoder(content).decode(self.encoded)
        except (ValueError, LookupError, TypeError, AttributeError, ImportError) as error:
            raise BrokenEntryError(defect=Defect.NO_RECORD) from error


def write_entry(kind: str, key: str, metadata: Metadata, value: object) -> bytes:
    """Return the file of an entry.

    Raises
    ------
    TypeError
        If the value is, or holds, what `Encoder.encode` does not know.
    """
    encoder = Encoder()
    encoded = encoder.encode(value)
    plain = b"".join(map(_planes, encoder.arrays))
    arrays: bytes = pa.compress(plain, _CODEC, asbytes=True) if plain else b""
    record = {
        "format": FORMAT,
        "version": VERSION,
        "kind": kind,
        "key": key,
        "about": Encoder().encode(asdict(metadata)),
        "result": encoded,
        "arrays": {"bytes": len(arrays), "size": len(plain), "sha256": checksum(arrays)},
    }
    record["sha256"] = checksum(_text(record))
    return json.dumps(record, allow_nan=False, ensure_ascii=False).encode() + b"\n" + arrays


def _planes(array: NDArray[Any]) -> bytes:
    """Return the first bytes of all numbers, then the second: this compresses a tenth better."""
    return np.frombuffer(array.tobytes(), np.uint8).reshape(-1, array.itemsize).T.tobytes()


def read_entry(content: bytes, kind: str, key: str) -> CacheEntry:
    """Return an entry from its file.

    Raises
    ------
    BrokenEntryError
        If the entry is broken; its defect says how.
    """
    line, newline, arrays = content.partition(b"\n")
    try:
        record = json.loads(line)
        stated = record.pop("sha256")
        if record["format"] != FORMAT or record["version"] != VERSION:
            raise BrokenEntryError(defect=Defect.FORMAT)
        if checksum(_text(record)) != stated or not newline:
            raise BrokenEntryError(defect=Defect.CHECKSUM)
        if (record["kind"], record["key"]) != (kind, key):
            raise BrokenEntryError(defect=Defect.OTHER_CASE)
        if record["arrays"]["bytes"] != len(arrays):
            raise BrokenEntryError(defect=Defect.CUT_SHORT)
        return CacheEntry(
            metadata=Metadata(**Decoder().decode(record["about"])),
            encoded=record["result"],
            arrays=arrays,
            arrays_size=record["arrays"]["size"],
            arrays_sha256=record["arrays"]["sha256"],
        )
    # too deep a nesting is a RecursionError
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, BrokenEntryError):
            raise
        raise BrokenEntryError(defect=Defect.NO_RECORD) from error


def checksum(content: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def _text(record: Mapping[str, Any]) -> bytes:
    """Return the text of which a checksum is taken; it does not depend on the order of keys."""
    return json.dumps(record, sort_keys=True, allow_nan=False).encode()
