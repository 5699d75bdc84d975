"""Selections that last: saved once, never rewritten, in an SQLite file or a PostgreSQL database."""

from hpn.store.errors import (
    KeyReusedError,
    KeySpentError,
    NewerDatabaseError,
    NoRoomError,
    ShareSpentError,
    StoreError,
    StoreUnavailableError,
)
from hpn.store.fleets import FleetDraft, FleetSummary, SavedFleet
from hpn.store.saved import Draft, Page, SavedSelection, Summary
from hpn.store.store import ID, Store

__all__ = [
    "ID",
    "Draft",
    "FleetDraft",
    "FleetSummary",
    "KeyReusedError",
    "KeySpentError",
    "NewerDatabaseError",
    "NoRoomError",
    "Page",
    "SavedFleet",
    "SavedSelection",
    "ShareSpentError",
    "Store",
    "StoreError",
    "StoreUnavailableError",
    "Summary",
]
