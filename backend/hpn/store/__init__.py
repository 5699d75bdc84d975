"""Selections that last: saved once, never rewritten, in an SQLite file or a PostgreSQL database."""

from hpn.store.errors import KeyReusedError, KeySpentError, NewerDatabaseError, StoreError, StoreUnavailableError
from hpn.store.saved import Draft, Page, SavedSelection, Summary
from hpn.store.store import Store

__all__ = [
    "Draft",
    "KeyReusedError",
    "KeySpentError",
    "NewerDatabaseError",
    "Page",
    "SavedSelection",
    "Store",
    "StoreError",
    "StoreUnavailableError",
    "Summary",
]
