"""Entries of a result cache: what is stored, and how one is broken."""

from pathlib import Path
from typing import Any

import numpy as np

from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata

KEY = "ab" * 16


def content(seed: int = 0) -> dict[str, Any]:
    """Return a record with arrays, odd numbers among them."""
    numbers = np.random.default_rng(seed).normal(size=(50, 3))
    # two NaNs of different bits, and both zeros: equal or not, each is to come back as it is
    odd = np.array([0x7FF8000000000001, 0xFFF8000000000000, 0x8000000000000000, 0], dtype=np.uint64)
    numbers[:4, 0] = odd.view(np.float64)
    record = {"x": 0.1, "pair": (1, 2.0), "none": None}
    return record | {"points": numbers, "time": np.linspace(0, 1, 50), "count": np.arange(50)}


def put(store: CacheFolder, key: str = KEY, seed: int = 0) -> Path:
    """Keep an entry and return its file."""
    store.put("things", key, Metadata(label="a case", code="today"), content(seed))
    return store.path("things", key)


def cut(path: Path) -> None:
    """Cut a file in half."""
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
