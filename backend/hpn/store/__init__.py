"""Selections that last: saved once, never rewritten, in an SQLite file or a PostgreSQL database."""

from hpn.store.errors import (
    KeyReusedError,
    KeySpentError,
    NewerDatabaseError,
    NoRoomError,
    ShareSpentError,
    StoreError,
    StoreFullError,
    StoreUnavailableError,
)
from hpn.store.fleets import FleetDraft, SavedFleet
from hpn.store.saved import Draft, SavedSelection, Summary
from hpn.store.store import ID, Store

__all__ = [
    "ID",
    "Draft",
    "FleetDraft",
    "KeyReusedError",
    "KeySpentError",
    "NewerDatabaseError",
    "NoRoomError",
    "SavedFleet",
    "SavedSelection",
    "ShareSpentError",
    "Store",
    "StoreError",
    "StoreFullError",
    "StoreUnavailableError",
    "Summary",
]
