"""What a case leaves when it is measured: numbers by name, as a store keeps them."""

from functools import partial
from typing import Any

from harness.campaign import Shelf
from harness.case import Case
from harness.keys import about, key_of
from harness.store import Content, Store

Record = dict[str, Any]
"""What JSON can hold."""

Timed = tuple[Record, float | None]
"""A record, and the seconds that it took by the clock; None if it was kept before."""


def records(store: Store, kind: str, module: str) -> Shelf[Case, Timed]:
    """Return where records of one kind are kept.

    Parameters
    ----------
    store : Store
    kind : str
    module : str
        Name of the module that makes them: when its sources change, they are made again.
    """
    return Shelf(
        store=store,
        kind=kind,
        key=partial(_key, module),
        about=lambda case: about(case, module),
        pack=lambda timed: Content(record=timed[0]),
        unpack=lambda _, content: (dict(content.record), None),
    )


def _key(module: str, case: Case) -> str:
    return key_of(case, module)
