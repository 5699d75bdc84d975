"""Answers of earlier versions, and the figures that a saved answer has. Readers ask here instead of guessing.

An answer gives every figure that its version knows of every candidate, null without a value. A figure that an answer
lacks was thus unknown to its version: it is left out of a page instead of being read as null.
"""

from collections.abc import Mapping
from typing import Any

import msgspec
from msgspec import Raw, structs

from hpn.engine.candidates import FIGURES, Candidate, Reserve
from hpn.engine.selection import CheckDefinition, Selection


class UnreadableReplyError(ValueError):
    """An answer without a part that every version has, such as the verdict on a gear."""


class KeptCandidate(Candidate, frozen=True):
    """A candidate of an older answer; `unknown` names the figures that its version did not know."""

    unknown: frozenset[str] = frozenset()

    def says(self, figure: str) -> bool:
        """False for a figure that its version did not know."""
        return figure not in self.unknown


class _RawFields(msgspec.Struct):
    """The fields that an answer has, by their names."""

    candidates: list[dict[str, Raw]]


_selection = msgspec.json.Decoder(Selection).decode
_fields = msgspec.json.Decoder(_RawFields).decode


def decode(content: bytes) -> Selection:
    """Selection from a saved answer of this version or an earlier one; raises UnreadableReplyError for any other
    content.
    """
    try:
        selection, raw = _selection(content), _fields(content)
    except msgspec.MsgspecError as error:
        raise UnreadableReplyError(f"the saved result can’t be read: {error}") from None
    if not selection.candidates:
        raise UnreadableReplyError("the saved result has no candidate")
    candidates = map(_with_unknown, selection.candidates, raw.candidates)
    definitions = selection.check_definitions | _lacking(selection)
    return structs.replace(selection, candidates=tuple(candidates), check_definitions=definitions)


def fields_of(content: bytes) -> Mapping[str, Any]:
    """A saved answer with its own fields only."""
    fields: dict[str, Any] = msgspec.json.decode(content)
    return fields


def _with_unknown(candidate: Candidate, raw: Mapping[str, Raw]) -> Candidate:
    reserve = _reserve(raw["reserve"]) if "reserve" in raw else {}
    unknown = _FIGURES - raw.keys() | {f"reserve.{name}" for name in _RESERVES - reserve.keys()}
    return KeptCandidate(**structs.asdict(candidate), unknown=unknown) if unknown else candidate


_FIGURES, _RESERVES = frozenset(FIGURES), frozenset(Reserve.__struct_fields__)
_reserve = msgspec.json.Decoder(dict[str, Raw]).decode


def _lacking(selection: Selection) -> dict[str, CheckDefinition]:
    """Definitions for checks that an answer does not define: by their code, as pure numbers."""
    codes = {check.code for candidate in selection.candidates for check in candidate.checks}
    return {
        code: CheckDefinition(title=code, equation=None, unit="", kind="maximum", group="load")
        for code in codes - selection.check_definitions.keys()
    }
