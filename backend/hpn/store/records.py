"""Records of documents, as the store keeps them: what is handed to it, and what it gives back."""

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal

from hpn.catalogue import Catalogue


def new_id() -> str:
    """A new id; none begins with the hyphen of a command's option."""
    while (id := secrets.token_urlsafe(16)).startswith("-"):
        pass
    return id


DocumentKind = Literal["selection", "machine"]

ANSWER = (
    *("status", "selected", "designation", "governing_check", "utilisation", "life_L10_h", "shortest_life_h"),
    *("shortest_life_of", "natural_frequency_Hz", "motor_torque_limit_Nm", "weight_kg", "suitable", "runner_up"),
    *("average_torque_Nm", "holds", "worst_utilisation", "worst_governing_check", "not_asked", "unknown", "faults"),
    *("engine_version", "catalogue_version"),
)
"""Columns of an axis's answer."""

LISTS = ("not_asked", "unknown", "faults")
"""Those that are lists, as JSON."""

Answer = Mapping[str, Any]
"""Values of these columns."""


@dataclass(frozen=True, slots=True)
class AxisDraft:
    """An axis to be kept: its own part and `without` as JSON, the number of its phases or moves, and its answer."""

    application: bytes = field(repr=False)
    phases: int
    answer: Answer = field(repr=False)
    name: str | None = None
    quantity: int = 1
    note: str | None = None
    ordering_code: str | None = None
    without: str = "[]"


@dataclass(frozen=True, slots=True)
class SavedAxis(AxisDraft):
    """An axis as it is kept; `version` counts its changes from 1, `updated_by` is a key or the author as typed."""

    number: int = 0
    version: int = 1
    updated: datetime = datetime.min
    updated_by: str | None = None


@dataclass(frozen=True, slots=True)
class RevisionDraft:
    """A document to be frozen under a label; `content` is what there is of it, `result` the reply to a selection.

    `head` has the columns of a selection's line that follow its latest revision, `axis` what becomes of its working
    copy with this one; None where it is frozen as it is. The store keeps one copy of each version of the catalogue.
    """

    label: str
    content: bytes = field(repr=False)
    axes: int
    engine_version: str
    catalogue_version: str
    author: str | None = None
    checked: str | None = None
    approved: str | None = None
    note: str | None = None
    created_by: str | None = None
    result: bytes | None = field(default=None, repr=False)
    head: Mapping[str, Any] = field(default_factory=dict, repr=False)
    axis: AxisDraft | None = field(default=None, repr=False)
    catalogue: Catalogue | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class RevisionLine:
    """One line of the list of revisions."""

    number: int
    label: str
    created: datetime
    created_by: str | None
    author: str | None
    checked: str | None
    approved: str | None
    note: str | None
    axes: int
    engine_version: str
    catalogue_version: str


@dataclass(frozen=True, slots=True)
class MachineDraft:
    """A machine to be kept, with its axes in their order, and revisions that it has had elsewhere, with their moments.

    `id` is what it is kept under, `owner` the name of the API key that keeps it, None without one; `caller` stands for
    that key or else the address, whose unsaved machines are counted.
    """

    axes: Sequence[AxisDraft] = field(repr=False)
    engine_version: str
    catalogue_version: str
    title: str | None = None
    reference: str | None = None
    author: str | None = None
    note: str | None = None
    common: str = "{}"
    owner: str | None = None
    caller: str = ""
    revisions: Sequence[tuple[datetime, RevisionDraft]] = field(default=(), repr=False)
    id: str = field(init=False, default_factory=new_id)

    @property
    def bytes(self) -> int:
        """Size of the axes' own parts."""
        return sum(len(axis.application) for axis in self.axes)


@dataclass(frozen=True, slots=True)
class DocumentLine:
    """One line of a list of documents; `saved` is None while nobody has saved it, `version` counts changes from 1.

    `axes`, `suitable`, `unsuitable` and `open` are numbers of axes. By the versions that `today_of` names, so many axes
    get another verdict; `today_axes` are the numbers of the first of them, as JSON.
    """

    id: str
    kind: DocumentKind
    created: datetime
    updated: datetime
    saved: datetime | None
    title: str | None
    reference: str | None
    author: str | None
    revision: str | None
    note: str | None
    owner: str | None
    version: int
    axes: int
    suitable: int
    unsuitable: int
    open: int
    revisions: int
    utilisation: float | None
    engine_version: str
    catalogue_version: str
    today_of: str | None
    today_changed: int | None
    today_axes: str | None


@dataclass(frozen=True, slots=True)
class Machine(DocumentLine):
    """A document with its working copy: common values as JSON, the order of its axes by number, and these or some."""

    common: str
    order: tuple[int, ...]
    items: tuple[SavedAxis, ...] = field(repr=False)
