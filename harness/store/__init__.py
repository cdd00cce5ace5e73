"""Results kept on disk: there whole or not at all, checked on reading, safe for many processes."""

from harness.store.entry import About, Content
from harness.store.folder import Store, StoreWarning
from harness.store.survey import Found, State, prune, survey

__all__ = ["About", "Content", "Found", "State", "Store", "StoreWarning", "prune", "survey"]
