"""Documents that last, in an SQLite file or a PostgreSQL database; their revisions are never rewritten."""

from hpn.store.changes import Change, Limits
from hpn.store.errors import (
    ExcessError,
    KeyReusedError,
    KeySpentError,
    LabelTakenError,
    NewerDatabaseError,
    NoRoomError,
    ShareSpentError,
    StoreError,
    StoreFullError,
    StoreUnavailableError,
)
from hpn.store.keys import Once
from hpn.store.lists import ID, LineFilter, Sorting
from hpn.store.records import AxisDraft, DocumentLine, Machine, MachineDraft, RevisionDraft, RevisionLine, SavedAxis
from hpn.store.saved import Draft, SavedSelection, SelectionLine
from hpn.store.store import Store
from hpn.store.todays import AxisVerdict, Stale, Versions

__all__ = [
    "ID",
    "AxisDraft",
    "AxisVerdict",
    "Change",
    "DocumentLine",
    "Draft",
    "ExcessError",
    "KeyReusedError",
    "KeySpentError",
    "LabelTakenError",
    "Limits",
    "LineFilter",
    "Machine",
    "MachineDraft",
    "NewerDatabaseError",
    "NoRoomError",
    "Once",
    "RevisionDraft",
    "RevisionLine",
    "SavedAxis",
    "SavedSelection",
    "SelectionLine",
    "ShareSpentError",
    "Sorting",
    "Stale",
    "Store",
    "StoreError",
    "StoreFullError",
    "StoreUnavailableError",
    "Versions",
]
