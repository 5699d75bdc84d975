"""Replies on machines, typed, and how they are made of what the store gives back."""

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

OwnPart = Annotated[dict[str, Any], Field(description="Its own part of its application, as it was sent.")]
Whole = Annotated[
    dict[str, Any], Field(description="Its application: own values and the common ones that hold for it.")
]


class AnswerReply(AxisAnswer, frozen=True):
    """Answer of an axis, and the problem of one that is open."""

    problem: Annotated[ProblemReply | None, Field(description="Why an open axis has no answer.")] = None


Answer = Annotated[AnswerReply, Field(description="Its gear, and how that does.")]


class AxisReply(Reply, frozen=True):
    """One axis of a document."""

    number: Annotated[int, Field(description="Number, which no other axis of this document ever has.")]
    name: Annotated[str | None, Field(description="Name.")]
    quantity: Annotated[int, Field(description="Number of such axes.")]
    note: Annotated[str | None, Field(description="Note.")]
    ordering_code: Annotated[str | None, Field(description="Ordering code.")]
    without: Annotated[tuple[str, ...], Field(description="Paths of common values that do not hold for it.")]
    application: OwnPart
    resolved: Whole
    answer: Answer
    updated: Moment
    updated_by: Annotated[str | None, Field(description="Key or author of the last change.")]


class CountsReply(Reply, frozen=True):
    """Numbers of axes; those that are neither have a gear that is not rated."""

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
    saved: Annotated[str | None, Field(description="When it was saved; null while nobody has.")]
    counts: Annotated[CountsReply, Field(description="Numbers of axes.")]
    utilisation: Annotated[
        float | None, Field(description="Largest utilisation of a suitable gear; of a selection that of its gear.")
    ]


class MachineReply(LineReply, frozen=True):
    """A document with its working copy."""

    common: Annotated[dict[str, Any], Field(description="Common values.")]
    order: Annotated[tuple[int, ...], Field(description="Numbers of its axes in their order.")]
    axes: Annotated[tuple[AxisReply, ...], Field(max_length=MOST_AXES, description="Axes in their order.")]


class MachineToday(Reply, frozen=True):
    """Verdict on a document by today's engine and catalogue."""

    verdict_changed: Annotated[int, Field(description="Number of axes with another gear or verdict.")]
    axes: Annotated[list[int], Field(max_length=100, description="Numbers of the first 100 of them.")]


class ListedReply(LineReply, frozen=True):
    """One line of the list, with what it gets today."""

    today: Annotated[MachineToday | None, Field(description="By today’s engine and catalogue; null until it is known.")]


class MachineListReply(Reply, frozen=True):
    """Part of the list of documents."""

    machines: Annotated[
        list[ListedReply], Field(max_length=SELECTIONS_LISTED, description="Documents, in the order asked for.")
    ]
    next_cursor: Annotated[str | None, Field(description="Asks for the next part; null at the end.")]
    deleted: Annotated[list[str], Field(description="Ids that were deleted since then, where that is asked.")]
    pending: Annotated[int, Field(description="Number of documents of this kind whose `today` is not known yet.")]


class NumbersReply(Reply, frozen=True):
    """Axes that are new or back."""

    numbers: Annotated[tuple[int, ...], Field(description="Their numbers, in the order in which they were sent.")]


class EffectReply(Reply, frozen=True):
    """Effect of a change of several axes."""

    axes: Annotated[int, Field(description="Axes that it is about.")]
    other_gear: Annotated[tuple[int, ...], Field(description="Numbers of the axes with another gear.")]
    without_gear: Annotated[tuple[int, ...], Field(description="Numbers of the axes that have none after it.")]
    weight_before_kg: Annotated[float | None, Field(description="Mass of all gears of the machine before.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all gears of the machine after it.")]


class RevisionsReply(Reply, frozen=True):
    """Revisions of a document."""

    revisions: Annotated[list[RevisionReply], Field(description="Revisions, the latest first.")]


class FrozenAxisReply(Reply, frozen=True):
    """One axis of a revision."""

    number: Annotated[int, Field(description="Number.")]
    name: Annotated[str | None, Field(description="Name.")]
    quantity: Annotated[int, Field(description="Number of such axes.")]
    note: Annotated[str | None, Field(description="Note.")]
    ordering_code: Annotated[str | None, Field(description="Ordering code.")]
    without: Annotated[tuple[str, ...], Field(description="Paths of common values that do not hold for it.")]
    application: OwnPart
    resolved: Whole
    answer: Answer


class FrozenReply(Reply, frozen=True):
    """A revision, whole."""

    revision: Annotated[RevisionReply, Field(description="Its line in the list.")]
    title: Annotated[str | None, Field(description="Title.")]
    reference: Annotated[str | None, Field(description="Reference.")]
    author: Annotated[str | None, Field(description="Author.")]
    note: Annotated[str | None, Field(description="Note.")]
    common: Annotated[dict[str, Any], Field(description="Common values.")]
    axes: Annotated[tuple[FrozenAxisReply, ...], Field(max_length=MOST_AXES, description="Axes in their order.")]


# --- Made of what the store gives -------------------------------------------------------------------------------------


def moment(time: datetime) -> str:
    """A moment as it is sent."""
    return time.isoformat(timespec="microseconds").replace("+00:00", "Z")


def line(record: DocumentLine, kind: type[L] = LineReply, **more: Any) -> L:  # type: ignore[assignment]
    """A line of the list."""
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


def listed(record: DocumentLine, key: str) -> ListedReply:
    """A line of the list, with what it gets by the versions of a key, if that is known."""
    today = None
    if record.today_of == key and record.today_changed is not None:
        today = MachineToday(record.today_changed, msgspec.json.decode(record.today_axes or "[]"))
    return line(record, ListedReply, today=today)


def machine(saved: Machine) -> LineReply:
    """A document with its axes."""
    common = common_of(saved)
    axes = tuple(axis(each, common) for each in saved.items)
    return line(saved, MachineReply, common=common, order=saved.order, axes=axes)


def parts(saved: Machine, names: Collection[str], of_axes: Collection[str]) -> dict[str, Any]:
    """Some fields of a document, and of its axes."""
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
"""Fields of an axis, each as it is made."""


def axis(saved: SavedAxis, common: Mapping[str, Any]) -> AxisReply:
    """An axis with its application and its answer."""
    return AxisReply(**{name: part(saved, common) for name, part in PARTS.items()})


def _raw(content: bytes) -> Any:
    return Raw(content)


def answer(kept_answer: AxisAnswer) -> AnswerReply:
    """An answer, with its problem."""
    problem = None if kept_answer.status != "open" else problem_of(kept_answer.faults)
    return AnswerReply(**{name: getattr(kept_answer, name) for name in kept_answer.__struct_fields__}, problem=problem)


def problem_of(faults: tuple[AxisFault, ...]) -> ProblemReply:
    """Problem details of an open axis."""
    named = [Fault(fault.location, fault.detail, fault.code) for fault in faults]
    return msgspec.convert(Problem.at(named).body(), ProblemReply)


def revision(record: RevisionLine) -> RevisionReply:
    """A line of the list of revisions."""
    same = [name for name in RevisionReply.__struct_fields__ if name not in ("created", "axis_count")]
    values = {name: getattr(record, name) for name in same}
    return RevisionReply(**values, created=moment(record.created), axis_count=record.axes)


def frozen(record: RevisionLine, content: Frozen) -> FrozenReply:
    """A revision as it was frozen."""
    block = {name: getattr(content, name) for name in ("title", "reference", "author", "note", "common")}
    return FrozenReply(revision=revision(record), axes=tuple(map(_frozen_axis, content.axes)), **block)


def _frozen_axis(axis: FrozenAxis) -> FrozenAxisReply:
    values: dict[str, Any] = structs.asdict(axis)
    return FrozenAxisReply(**values | {"answer": answer(axis.answer)})
