"""Reasons why axes are rejected, as code and sentence until they are shown. This module imports nothing of Arrow."""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from hpn.application.faults import OF_PHASE, fault_sentence
from hpn.words.wording import N_, Sentence

OF_ITEM, OF_SIZE = N_("item {number}: {reason}"), N_("size {size}: {reason}")
TWICE = Sentence(N_("must be unique, with its rows together"))


class CellFault(NamedTuple):
    """Cell that can't be taken: its row in the batch, its column, the reason, and a code for programs."""

    row: int
    column: str
    reason: Sentence
    code: str

    def moved(self, rows: int) -> "CellFault":
        """Fault of the same row where it stands `rows` rows further down."""
        return self._replace(row=self.row + rows)


class Reason(msgspec.Struct, frozen=True, array_like=True):
    """Reason of an axis in its stored form."""

    column: str
    code: str
    sentence: Sentence

    def named(self, name: str) -> Sentence:
        """Sentence with the name of the input; only the reason where that is blank."""
        if not name:
            return self.sentence
        return fault_sentence(Sentence("{text}", {"text": name}, ("text",)), self.sentence)


def cell_of(faults: Sequence[CellFault]) -> str:
    """Reasons of an axis as a cell, in JSON."""
    return msgspec.json.encode([Reason(fault.column, fault.code, fault.reason) for fault in faults]).decode()


def reasons_of(cell: str | None, error: str | None = None) -> list[Reason]:
    """Reasons in a cell from `cell_of`; for an axis of an earlier version, its English text `error` as the only
    reason."""
    if cell is not None:
        return msgspec.json.decode(cell, type=list[Reason])
    return [] if error is None else [Reason("", "invalid", Sentence("{text}", {"text": error}))]


def text_of(faults: Sequence[CellFault]) -> str:
    """Reasons of an axis as one text in English."""
    return "; ".join(f"{fault.column}: {fault.reason.text}" for fault in faults)


def of_phase(number: int, reason: Sentence) -> Sentence:
    """Reason in one phase of an axis; phases count from 1."""
    return Sentence(OF_PHASE, {"number": str(number), "reason": reason})
