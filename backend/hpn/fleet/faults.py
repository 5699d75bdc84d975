"""Reasons for which axes are rejected: as code and sentence until they are shown. Nothing of Arrow is imported here."""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from hpn.words.wording import N_, Sentence

OF_PHASE, OF_ITEM, OF_SIZE = (
    N_("phase {number}: {reason}"),
    N_("item {number}: {reason}"),
    N_("size {size}: {reason}"),
)
TWICE = Sentence(N_("must be unique, with its rows together"))


class CellFault(NamedTuple):
    """A cell that can't be taken: the row of its batch, its column, what would be right, and a code for programs."""

    row: int
    column: str
    reason: Sentence
    code: str

    def moved(self, rows: int) -> "CellFault":
        """The fault of a row that stands further down."""
        return self._replace(row=self.row + rows)


class Reason(msgspec.Struct, frozen=True, array_like=True):
    """One reason of an axis, as it is kept."""

    column: str
    code: str
    sentence: Sentence


def kept(faults: Sequence[CellFault]) -> str:
    """Reasons of an axis as a cell."""
    return msgspec.json.encode([Reason(fault.column, fault.code, fault.reason) for fault in faults]).decode()


def reasons_of(cell: str | None, error: str | None = None) -> list[Reason]:
    """The reasons of such a cell; of an axis that an earlier version has kept, its text in English."""
    if cell is not None:
        return msgspec.json.decode(cell, type=list[Reason])
    return [] if error is None else [Reason("", "invalid", Sentence("{text}", {"text": error}))]


def text_of(faults: Sequence[CellFault]) -> str:
    """Reasons of an axis as one text in English."""
    return "; ".join(f"{fault.column}: {fault.reason.text}" for fault in faults)


def of_phase(number: int, reason: Sentence) -> Sentence:
    """Reason in one phase of an axis, which count from 1."""
    return Sentence(OF_PHASE, {"number": str(number), "reason": reason})
