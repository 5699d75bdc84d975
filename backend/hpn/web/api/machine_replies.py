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


def line(found: DocumentLine, kind: type[L] = LineReply, **more: Any) -> L:  # type: ignore[assignment]
    """A line of the list."""
    same = ("id", "kind", "title", "reference", "author", "note", "revision")
    return kind(
        **{name: getattr(found, name) for name in same},
        url=f"/{found.kind}s/{found.id}",
        created=moment(found.created),
        updated=moment(found.updated),
        saved=None if found.saved is None else moment(found.saved),
        counts=CountsReply(found.axes, found.suitable, found.unsuitable, found.open),
        utilisation=found.utilisation,
        **more,
    )


def listed(found: DocumentLine, key: str) -> ListedReply:
    """A line of the list, with what it gets by the versions of a key, if that is known."""
    today = None
    if found.today_of == key and found.today_changed is not None:
        today = MachineToday(found.today_changed, msgspec.json.decode(found.today_axes or "[]"))
    return line(found, ListedReply, today=today)


def machine(found: Machine) -> LineReply:
    """A document with its axes."""
    common = common_of(found)
    axes = tuple(axis(each, common) for each in found.items)
    return line(found, MachineReply, common=common, order=found.order, axes=axes)


def parts(found: Machine, names: Collection[str], of_axes: Collection[str]) -> dict[str, Any]:
    """Some fields of a document, and of its axes."""
    common = common_of(found)
    values = structs.asdict(line(found)) | {"common": common, "order": found.order}
    chosen: dict[str, Any] = {name: value for name, value in values.items() if name in names}
    if of_axes:
        chosen["axes"] = [{name: PARTS[name](each, common) for name in of_axes} for each in found.items]
    return chosen


def _same(name: str) -> Callable[[SavedAxis, Mapping[str, Any]], Any]:
    return lambda found, _: getattr(found, name)


PARTS: Mapping[str, Callable[[SavedAxis, Mapping[str, Any]], Any]] = {
    **{name: _same(name) for name in ("number", "name", "quantity", "note", "ordering_code")},
    "without": lambda found, _: without_of(found),
    "application": lambda found, _: _raw(found.application),
    "resolved": lambda found, common: _raw(whole_of(found, common)),
    "answer": lambda found, _: answer(answer_in(found.answer)),
    "updated": lambda found, _: moment(found.updated),
    "updated_by": _same("updated_by"),
}
"""Fields of an axis, each as it is made."""


def axis(found: SavedAxis, common: Mapping[str, Any]) -> AxisReply:
    """An axis with its application and its answer."""
    return AxisReply(**{name: part(found, common) for name, part in PARTS.items()})


def _raw(content: bytes) -> Any:
    return Raw(content)


def answer(found: AxisAnswer) -> AnswerReply:
    """An answer, with its problem."""
    problem = None if found.status != "open" else problem_of(found.faults)
    return AnswerReply(**{name: getattr(found, name) for name in found.__struct_fields__}, problem=problem)


def problem_of(faults: tuple[AxisFault, ...]) -> ProblemReply:
    """Problem details of an open axis."""
    named = [Fault(fault.location, fault.detail, fault.code) for fault in faults]
    return msgspec.convert(Problem.at(named).body(), ProblemReply)


def revision(found: RevisionLine) -> RevisionReply:
    """A line of the list of revisions."""
    same = [name for name in RevisionReply.__struct_fields__ if name not in ("created", "axis_count")]
    values = {name: getattr(found, name) for name in same}
    return RevisionReply(**values, created=moment(found.created), axis_count=found.axes)


def frozen(found: RevisionLine, content: Frozen) -> FrozenReply:
    """A revision as it was frozen."""
    block = {name: getattr(content, name) for name in ("title", "reference", "author", "note", "common")}
    return FrozenReply(revision=revision(found), axes=tuple(map(_frozen_axis, content.axes)), **block)


def _frozen_axis(found: FrozenAxis) -> FrozenAxisReply:
    values: dict[str, Any] = structs.asdict(found)
    return FrozenAxisReply(**values | {"answer": answer(found.answer)})
