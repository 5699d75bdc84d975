"""Conversion of axes and answers to columns of the store and back; the store knows neither models nor engine."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import msgspec
import orjson
from msgspec import Raw, structs

from hpn.catalogue import Catalogue
from hpn.documents import revision
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.documents.axis import Axis, phases_of
from hpn.documents.merge import Resolved, merged, resolve
from hpn.store import AxisDraft, Machine, RevisionDraft, RevisionLine, SavedAxis
from hpn.store.records import LISTS

Json = dict[str, Any]

_encode, _answer = msgspec.json.Encoder().encode, msgspec.json.Decoder(AxisAnswer).decode


def columns_of(answer: AxisAnswer) -> Json:
    """Columns of an answer."""
    return structs.asdict(answer) | {name: _encode(getattr(answer, name)).decode() for name in LISTS}


def answer_in(columns: Mapping[str, Any]) -> AxisAnswer:
    """Answer from its columns; a figure that an earlier version did not know is null."""
    return _answer(_encode({**columns, **{name: Raw(columns[name].encode()) for name in LISTS}}))


def json_of(value: Mapping[str, Any]) -> bytes:
    """JSON of an object with a caller's unchecked content."""
    return json.dumps(value, allow_nan=False, separators=(",", ":")).encode()


def own_of(axis: SavedAxis) -> Json:
    """An axis's own part of its application."""
    own: Json = json.loads(axis.application)  # reads numbers of any length, which the models then refuse
    return own


def without_of(axis: SavedAxis) -> tuple[str, ...]:
    """Paths of the common values that don't apply to an axis."""
    return tuple(orjson.loads(axis.without))


def resolved(axis: SavedAxis, common: Mapping[str, Any]) -> Resolved:
    """Application of an axis of a document, merged with the common values."""
    return resolve(own_of(axis), common, without_of(axis))


def whole_of(axis: SavedAxis, common: Mapping[str, Any]) -> bytes:
    """JSON of the application of an axis; takes the inputs `not_asked` from its answer, so nothing is judged again."""
    not_asked = orjson.loads(axis.answer["not_asked"])
    return json_of(merged(own_of(axis), common, {*without_of(axis), *not_asked})[0])


def common_of(machine: Machine) -> Json:
    """Common values of a document."""
    common: Json = orjson.loads(machine.common)
    return common


def drafts_of(axes: Sequence[Axis], common: Mapping[str, Any], catalogue: Catalogue) -> list[AxisDraft]:
    """Drafts of axes, all answered together."""
    questions = [AxisQuestion(resolve(axis.application, common, axis.without), axis.ordering_code) for axis in axes]
    return [draft_of(axis, answer) for axis, answer in zip(axes, answers(questions, catalogue), strict=True)]


def draft_of(axis: Axis, answer: AxisAnswer) -> AxisDraft:
    """Draft of an axis with its answer."""
    return AxisDraft(
        application=json_of(axis.application),
        phases=phases_of(axis.application),
        answer=columns_of(answer),
        name=axis.name,
        quantity=axis.quantity,
        note=axis.note,
        ordering_code=axis.ordering_code,
        without=_encode(axis.without).decode(),
    )


def frozen_of(machine: Machine, axes: Sequence[SavedAxis]) -> revision.Frozen:
    """Frozen form of a document in its present state, with these axes."""
    common = common_of(machine)
    block = (machine.title, machine.reference, machine.author, machine.note)
    return revision.Frozen(*block, common, tuple(_frozen_axis(axis, common) for axis in axes))


def _frozen_axis(axis: SavedAxis, common: Mapping[str, Any]) -> revision.FrozenAxis:
    return revision.FrozenAxis(
        axis.number,
        axis.name,
        axis.quantity,
        axis.note,
        axis.ordering_code,
        without_of(axis),
        Raw(axis.application),
        Raw(whole_of(axis, common)),
        answer_in(axis.answer),
    )


def thawed(machine: Machine, line: RevisionLine, document: revision.Frozen) -> Machine:
    """Document in the state of a revision."""
    items = tuple(
        SavedAxis(
            application=bytes(axis.application),
            phases=0,
            answer=columns_of(axis.answer),
            name=axis.name,
            quantity=axis.quantity,
            note=axis.note,
            ordering_code=axis.ordering_code,
            without=_encode(axis.without).decode(),
            number=axis.number,
            updated=line.created,
            updated_by=line.created_by,
        )
        for axis in document.axes
    )
    block = {name: getattr(document, name) for name in ("title", "reference", "author", "note")}
    return replace(
        machine,
        **block,
        revision=line.label,
        updated=line.created,
        common=json_of(document.common).decode(),
        order=tuple(axis.number for axis in items),
        items=items,
    )


def revision_of(machine: Machine, label: str, *, author: str | None, note: str | None) -> RevisionDraft:
    """Revision of a document in its present state, not checked yet."""
    newest = machine.items[0].answer if machine.items else {}
    return RevisionDraft(
        label=label,
        content=revision.encode(frozen_of(machine, machine.items)),
        axes=len(machine.items),
        engine_version=newest.get("engine_version", machine.engine_version),
        catalogue_version=newest.get("catalogue_version", machine.catalogue_version),
        author=author,
        note=note,
    )
