"""Records of documents: drafts that the store receives, and records that it returns."""

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal

from hpn.catalogue import Catalogue


def new_id() -> str:
    """New id; it never begins with a hyphen, which would look like a command's option."""
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
"""Columns of an answer that hold lists, as JSON."""

Answer = Mapping[str, Any]
"""Values of the columns of an answer."""


@dataclass(frozen=True, slots=True)
class AxisDraft:
    """Axis to save: its own part and `without` as JSON, the number of its phases or moves, and its answer."""

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
    """Saved axis; `version` counts its changes from 1, `updated_by` is a key's name or the author as typed."""

    number: int = 0
    version: int = 1
    updated: datetime = datetime.min
    updated_by: str | None = None


@dataclass(frozen=True, slots=True)
class AxesOfGear:
    """Axes of a machine with one gear: how many there are, their gears, and numbers and names of the first."""

    axes: int
    quantity: int
    first: tuple[tuple[int, str | None], ...]


@dataclass(frozen=True, slots=True)
class RevisionDraft:
    """Document to freeze under a label; `content` is the whole document as JSON, `result` the reply to a selection.

    `head` has the columns of a selection's line in the list that follow its latest revision. `axis` is the working copy
    from this revision on; None leaves the working copy as it is. The store keeps one copy of each version of the
    catalogue.
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
    """Line of the list of revisions."""

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
    """Machine to save, with its axes in their order, and its revisions from elsewhere, each with its moment.

    `id` is the id of the new document, `owner` the name of the API key that saves it, None without a key. `caller`
    stands for that key or else for the address; the store counts the unsaved machines of each caller.
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
        """Size of the axes' own parts, in bytes."""
        return sum(len(axis.application) for axis in self.axes)


@dataclass(frozen=True, slots=True)
class DocumentLine:
    """Line of a list of documents; `saved` is None until somebody saves it, `version` counts changes from 1.

    `axes`, `suitable`, `unsuitable` and `open` are numbers of axes. By the versions in `today_of`, `today_changed` axes
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
class MachineLine(DocumentLine):
    """Line of the page of machines; a figure that an answer of an earlier version lacks is None.

    `gears` is the number of gears, `kinds` the number of different designations. `changes` counts the changes since the
    latest revision, and `governing_axis` is the number of the axis with the largest utilisation.
    """

    gears: int | None
    kinds: int | None
    weight_kg: float | None
    governing_axis: int | None
    changes: int
    common: str


@dataclass(frozen=True, slots=True)
class MachineList:
    """Part of the page of machines: lines, governing axes by the ids of their machines, the cursor to the next part,
    and numbers of machines by the names of filters."""

    lines: Sequence[MachineLine]
    governing: Mapping[str, SavedAxis]
    next_cursor: str | None
    counts: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Machine(DocumentLine):
    """Document with its working copy: common values as JSON, the order of its axes by number, and all or some axes."""

    common: str
    order: tuple[int, ...]
    items: tuple[SavedAxis, ...] = field(repr=False)
