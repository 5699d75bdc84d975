"""Documents that last, in an SQLite file or a PostgreSQL database; their revisions are never rewritten."""

from hpn.store.changes import Change, Limits
from hpn.store.errors import (
    ExcessError,
    KeyReusedError,
    KeySpentError,
    LabelTakenError,
    ListsSpentError,
    NameTakenError,
    NewerDatabaseError,
    NoRoomError,
    ShareSpentError,
    StoreError,
    StoreFullError,
    StoreUnavailableError,
)
from hpn.store.keys import Once
from hpn.store.lists import ID, LineFilter, Sorting
from hpn.store.motor_lists import MOST_LISTS, MotorListDraft, MotorListLine, SavedMotorList
from hpn.store.records import (
    AxesOfGear,
    AxisDraft,
    DocumentLine,
    Machine,
    MachineDraft,
    MachineLine,
    MachineList,
    RevisionDraft,
    RevisionLine,
    SavedAxis,
)
from hpn.store.saved import Draft, SavedSelection, SelectionLine
from hpn.store.store import Store
from hpn.store.todays import AxisVerdict, Stale, Versions

__all__ = [
    "ID",
    "MOST_LISTS",
    "AxesOfGear",
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
    "ListsSpentError",
    "Machine",
    "MachineDraft",
    "MachineLine",
    "MachineList",
    "MotorListDraft",
    "MotorListLine",
    "NameTakenError",
    "NewerDatabaseError",
    "NoRoomError",
    "Once",
    "RevisionDraft",
    "RevisionLine",
    "SavedAxis",
    "SavedMotorList",
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
