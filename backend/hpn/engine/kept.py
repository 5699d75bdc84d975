"""Answers of earlier versions: which figures a saved one has. Whatever reads one asks here, and guesses nothing.

A version gives every figure that it knows of every candidate, null where it has no value. So a figure that an answer
lacks is one that its version did not know: it is left out where it would be shown, not read as null.
"""

from collections.abc import Mapping
from typing import Any

import msgspec
from msgspec import Raw, structs

from hpn.engine.candidates import FIGURES, Candidate, Reserve
from hpn.engine.selection import CheckDefinition, Selection


class UnreadableReplyError(ValueError):
    """An answer without a part that those of every version have, such as the verdict on a gear."""


class KeptCandidate(Candidate, frozen=True):
    """A candidate of an answer whose version did not know some figures, which `unknown` names."""

    unknown: frozenset[str] = frozenset()

    def says(self, figure: str) -> bool:
        """False for a figure that its version did not know."""
        return figure not in self.unknown


class _Said(msgspec.Struct):
    """The fields that an answer has, by their names."""

    candidates: list[dict[str, Raw]]


_selection = msgspec.json.Decoder(Selection).decode
_said = msgspec.json.Decoder(_Said).decode


def decode(content: bytes) -> Selection:
    """Selection of a saved answer, of this version or an earlier one; raises UnreadableReplyError for any other."""
    try:
        selection, said = _selection(content), _said(content)
    except msgspec.MsgspecError as error:
        raise UnreadableReplyError(f"the saved result can’t be read: {error}") from None
    if not selection.candidates:
        raise UnreadableReplyError("the saved result has no candidate")
    candidates = map(_with_unknown, selection.candidates, said.candidates)
    definitions = selection.check_definitions | _lacking(selection)
    return structs.replace(selection, candidates=tuple(candidates), check_definitions=definitions)


def fields_of(content: bytes) -> Mapping[str, Any]:
    """A saved answer with the fields that it has, and no other."""
    fields: dict[str, Any] = msgspec.json.decode(content)
    return fields


def _with_unknown(candidate: Candidate, said: Mapping[str, Raw]) -> Candidate:
    reserve = _reserve(said["reserve"]) if "reserve" in said else {}
    unknown = _FIGURES - said.keys() | {f"reserve.{name}" for name in _RESERVES - reserve.keys()}
    return KeptCandidate(**structs.asdict(candidate), unknown=unknown) if unknown else candidate


_FIGURES, _RESERVES = frozenset(FIGURES), frozenset(Reserve.__struct_fields__)
_reserve = msgspec.json.Decoder(dict[str, Raw]).decode


def _lacking(selection: Selection) -> dict[str, CheckDefinition]:
    """Definitions of checks that an answer has without one: by their code, as pure numbers."""
    codes = {check.code for candidate in selection.candidates for check in candidate.checks}
    return {
        code: CheckDefinition(title=code, equation=None, unit="", kind="maximum", group="load")
        for code in codes - selection.check_definitions.keys()
    }
