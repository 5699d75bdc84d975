"""Typed replies on machines, and their construction from records of the store."""

from collections.abc import Callable, Collection, Mapping
from datetime import datetime
from typing import Annotated, Any, TypeVar

import msgspec
from msgspec import Raw, structs
from pydantic import Field

from hpn.application.faults import Fault
from hpn.documents.answers import AxisAnswer, AxisFault
from hpn.documents.axis import MOST_AXES
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.store import DocumentLine, Machine, RevisionLine, SavedAxis
from hpn.web.api.replies import SELECTIONS_LISTED, Moment, ProblemReply, RevisionReply
from hpn.web.columns import answer_in, common_of, whole_of, without_of
from hpn.web.door.problems import Problem
from hpn.words.reply import Reply

L = TypeVar("L", bound="LineReply")

OwnPart = Annotated[dict[str, Any], Field(description="The axis’s own part of its application, as sent.")]
Whole = Annotated[dict[str, Any], Field(description="The whole application: own values and inherited common values.")]


class AnswerReply(AxisAnswer, frozen=True):
    """Answer of an axis, with the problem of an open axis."""

    problem: Annotated[ProblemReply | None, Field(description="Reason why an open axis has no answer.")] = None


Answer = Annotated[AnswerReply, Field(description="Gear of the axis, with its verdict and figures.")]


class AxisReply(Reply, frozen=True):
    """One axis of a document."""

    number: Annotated[int, Field(description="Number of the axis; no other axis of this document ever gets it.")]
    name: Annotated[str | None, Field(description="Name.")]
    quantity: Annotated[int, Field(description="Number of equal axes.")]
    note: Annotated[str | None, Field(description="Note.")]
    ordering_code: Annotated[str | None, Field(description="Ordering code.")]
    without: Annotated[tuple[str, ...], Field(description="Paths of common values that the axis does not inherit.")]
    application: OwnPart
    resolved: Whole
    answer: Answer
    updated: Moment
    updated_by: Annotated[str | None, Field(description="Key or author of the last change.")]


class CountsReply(Reply, frozen=True):
    """Numbers of axes; an axis in none of the three groups has a gear that is not rated."""

    axes: Annotated[int, Field(description="All axes.")]
    suitable: Annotated[int, Field(description="Axes with a suitable gear.")]
    unsuitable: Annotated[int, Field(description="Axes with a gear that is not suitable.")]
    open: Annotated[int, Field(description="Axes without an answer.")]


class LineReply(Reply, frozen=True):
    """One line of the list of documents."""

    id: Annotated[str, Field(description="Id.")]
    url: Annotated[str, Field(description="Address of its page.")]
    kind: Annotated[str, Field(description="machine or selection.")]
    title: Annotated[str | None, Field(description="Title.")]
    reference: Annotated[str | None, Field(description="Reference.")]
    author: Annotated[str | None, Field(description="Author.")]
    note: Annotated[str | None, Field(description="Note.")]
    revision: Annotated[str | None, Field(description="Latest revision.")]
    created: Moment
    updated: Moment
    saved: Annotated[str | None, Field(description="Moment of saving; null before the first saving.")]
    counts: Annotated[CountsReply, Field(description="Numbers of axes.")]
    utilisation: Annotated[
        float | None,
        Field(description="Largest utilisation of a suitable gear; for a selection, the utilisation of its gear."),
    ]


class MachineReply(LineReply, frozen=True):
    """A document with its working copy."""

    common: Annotated[dict[str, Any], Field(description="Common values.")]
    order: Annotated[tuple[int, ...], Field(description="Numbers of the axes in their order.")]
    axes: Annotated[tuple[AxisReply, ...], Field(max_length=MOST_AXES, description="Axes in their order.")]


class MachineToday(Reply, frozen=True):
    """Verdict on a document by today's engine and catalogue."""

    verdict_changed: Annotated[int, Field(description="Number of axes whose gear or verdict differs.")]
    axes: Annotated[list[int], Field(max_length=100, description="Numbers of the first 100 of these axes.")]


class ListedReply(LineReply, frozen=True):
    """One line of the list, with today's verdict."""

    today: Annotated[
        MachineToday | None, Field(description="Verdict by today’s engine and catalogue; null until it is computed.")
    ]


class MachineListReply(Reply, frozen=True):
    """Part of the list of documents."""

    machines: Annotated[
        list[ListedReply], Field(max_length=SELECTIONS_LISTED, description="Documents, in the requested order.")
    ]
    next_cursor: Annotated[str | None, Field(description="Cursor of the next part; null at the end.")]
    deleted: Annotated[list[str], Field(description="Ids deleted since `deleted_since`; empty without it.")]
    pending: Annotated[int, Field(description="Number of documents of this kind whose `today` is not computed yet.")]


class NumbersReply(Reply, frozen=True):
    """New and restored axes."""

    numbers: Annotated[tuple[int, ...], Field(description="Numbers of the axes, in the order of the request.")]


class EffectReply(Reply, frozen=True):
    """Effect of a change of several axes."""

    axes: Annotated[int, Field(description="Number of axes in the change.")]
    other_gear: Annotated[tuple[int, ...], Field(description="Numbers of the axes with another gear.")]
    without_gear: Annotated[tuple[int, ...], Field(description="Numbers of the axes without a gear after the change.")]
    weight_before_kg: Annotated[float | None, Field(description="Mass of all gears of the machine before the change.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all gears of the machine after the change.")]


class RevisionsReply(Reply, frozen=True):
    """Revisions of a document."""

    revisions: Annotated[list[RevisionReply], Field(description="Revisions, the latest first.")]


class FrozenAxisReply(Reply, frozen=True):
    """One axis of a revision."""

    number: Annotated[int, Field(description="Number.")]
    name: Annotated[str | None, Field(description="Name.")]
    quantity: Annotated[int, Field(description="Number of equal axes.")]
    note: Annotated[str | None, Field(description="Note.")]
    ordering_code: Annotated[str | None, Field(description="Ordering code.")]
    without: Annotated[tuple[str, ...], Field(description="Paths of common values that the axis does not inherit.")]
    application: OwnPart
    resolved: Whole
    answer: Answer


class FrozenReply(Reply, frozen=True):
    """A whole revision."""

    revision: Annotated[RevisionReply, Field(description="Its line in the list.")]
    title: Annotated[str | None, Field(description="Title.")]
    reference: Annotated[str | None, Field(description="Reference.")]
    author: Annotated[str | None, Field(description="Author.")]
    note: Annotated[str | None, Field(description="Note.")]
    common: Annotated[dict[str, Any], Field(description="Common values.")]
    axes: Annotated[tuple[FrozenAxisReply, ...], Field(max_length=MOST_AXES, description="Axes in their order.")]


# --- From records of the store ----------------------------------------------------------------------------------------


def moment(time: datetime) -> str:
    """Text of a moment in a reply."""
    return time.isoformat(timespec="microseconds").replace("+00:00", "Z")


def line(record: DocumentLine, kind: type[L] = LineReply, **more: Any) -> L:  # type: ignore[assignment]
    """Line of the list."""
    same = ("id", "kind", "title", "reference", "author", "note", "revision")
    return kind(
        **{name: getattr(record, name) for name in same},
        url=f"/{record.kind}s/{record.id}",
        created=moment(record.created),
        updated=moment(record.updated),
        saved=None if record.saved is None else moment(record.saved),
        counts=CountsReply(record.axes, record.suitable, record.unsuitable, record.open),
        utilisation=record.utilisation,
        **more,
    )


def line_reply(record: DocumentLine, key: str) -> ListedReply:
    """Line of the list, with its verdict by the versions of a key, if that is known."""
    today = None
    if record.today_of == key and record.today_changed is not None:
        today = MachineToday(record.today_changed, msgspec.json.decode(record.today_axes or "[]"))
    return line(record, ListedReply, today=today)


def machine(saved: Machine) -> LineReply:
    """Document with its axes."""
    common = common_of(saved)
    axes = tuple(axis(each, common) for each in saved.items)
    return line(saved, MachineReply, common=common, order=saved.order, axes=axes)


def parts(saved: Machine, names: Collection[str], of_axes: Collection[str]) -> dict[str, Any]:
    """Selected fields of a document and of its axes."""
    common = common_of(saved)
    values = structs.asdict(line(saved)) | {"common": common, "order": saved.order}
    chosen: dict[str, Any] = {name: value for name, value in values.items() if name in names}
    if of_axes:
        chosen["axes"] = [{name: PARTS[name](each, common) for name in of_axes} for each in saved.items]
    return chosen


def _same(name: str) -> Callable[[SavedAxis, Mapping[str, Any]], Any]:
    return lambda each, _: getattr(each, name)


PARTS: Mapping[str, Callable[[SavedAxis, Mapping[str, Any]], Any]] = {
    **{name: _same(name) for name in ("number", "name", "quantity", "note", "ordering_code")},
    "without": lambda each, _: without_of(each),
    "application": lambda each, _: _raw(each.application),
    "resolved": lambda each, common: _raw(whole_of(each, common)),
    "answer": lambda each, _: answer(answer_in(each.answer)),
    "updated": lambda each, _: moment(each.updated),
    "updated_by": _same("updated_by"),
}
"""Functions that make the fields of an axis."""


def axis(saved: SavedAxis, common: Mapping[str, Any]) -> AxisReply:
    """Axis with its application and its answer."""
    return AxisReply(**{name: part(saved, common) for name, part in PARTS.items()})


def _raw(content: bytes) -> Any:
    return Raw(content)


def answer(kept_answer: AxisAnswer) -> AnswerReply:
    """Answer with its problem."""
    problem = None if kept_answer.status != "open" else problem_of(kept_answer.faults)
    return AnswerReply(**{name: getattr(kept_answer, name) for name in kept_answer.__struct_fields__}, problem=problem)


def problem_of(faults: tuple[AxisFault, ...]) -> ProblemReply:
    """Problem details of an open axis."""
    named = [Fault(fault.location, fault.detail, fault.code) for fault in faults]
    return msgspec.convert(Problem.at(named).body(), ProblemReply)


def revision(record: RevisionLine) -> RevisionReply:
    """Line of the list of revisions."""
    same = [name for name in RevisionReply.__struct_fields__ if name not in ("created", "axis_count")]
    values = {name: getattr(record, name) for name in same}
    return RevisionReply(**values, created=moment(record.created), axis_count=record.axes)


def revision_reply(record: RevisionLine, content: Frozen) -> FrozenReply:
    """Revision with its frozen content."""
    block = {name: getattr(content, name) for name in ("title", "reference", "author", "note", "common")}
    return FrozenReply(revision=revision(record), axes=tuple(map(_frozen_axis, content.axes)), **block)


def _frozen_axis(axis: FrozenAxis) -> FrozenAxisReply:
    values: dict[str, Any] = structs.asdict(axis)
    return FrozenAxisReply(**values | {"answer": answer(axis.answer)})
