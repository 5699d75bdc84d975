"""Replies of the API besides a selection, typed; encoded as JSON here and nowhere else."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import msgspec
from msgspec import UNSET, UnsetType
from pydantic import Field
from starlette.responses import Response

from hpn.application import BearingModel
from hpn.catalogue import ListedMotor, SeriesFigure
from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve
from hpn.engine.selection import LINK, Selection
from hpn.explain.differences import Difference, FigureDifference
from hpn.web.door.problems import MAXIMUM_ERRORS
from hpn.words.reply import Reply

encode = msgspec.json.Encoder().encode
"""JSON of a reply; NaN and infinity become null."""

DIFFERENCES_SHOWN = 500
MOST: Any = Field(max_length=DIFFERENCES_SHOWN)

MOST_AT_ONCE = 10_000
"""Applications of a batch as one JSON object."""

SELECTIONS_LISTED = 200
"""Most lines of a part of the list of saved selections."""

Version = Annotated[str, Field(description="Hash of the catalogue’s content, supplement included.")]


class JSONBytes(Response):
    """JSON that is already encoded."""

    media_type = "application/json"


class FieldError(Reply, frozen=True):
    """Error in one field."""

    pointer: Annotated[str, Field(description="JSON pointer to the field.")]
    code: Annotated[str, Field(description="Kind of the fault, for programs.")]
    detail: Annotated[str, Field(description="Expected value or form.")]


class ProblemReply(Reply, frozen=True, omit_defaults=True):
    """Problem details, RFC 9457."""

    type: Annotated[str, Field(description="Kind of problem: address of a page with its cause and remedy.")]
    title: Annotated[str, Field(description="Name of the kind.")]
    status: Annotated[int, Field(description="HTTP status.")]
    detail: Annotated[str, Field(description="Error, with the expected value or form.")]
    errors: (
        Annotated[list[FieldError], Field(min_length=1, max_length=MAXIMUM_ERRORS, description="The fields at fault.")]
        | UnsetType
    ) = UNSET


class BatchLine(Reply, frozen=True):
    """Result of one item: its answer in brief, or the problem."""

    reference: Annotated[str | None, Field(description="The item’s own reference.")]
    status: Annotated[Literal["ok", "error"], Field(description="Outcome of the item.")]
    selected: Annotated[str | None, Field(description="Designation of the selected gear, or null.")] | UnsetType = UNSET
    governing_check: (
        Annotated[str | None, Field(description="Check that is closest to its limit on that gear.")] | UnsetType
    ) = UNSET
    utilisation: Annotated[float | None, Field(description="Utilisation of that check.")] | UnsetType = UNSET
    suitable: Annotated[int, Field(description="Number of suitable gears.")] | UnsetType = UNSET
    holds: (
        Annotated[bool | None, Field(description="True: the gear passes over the whole tolerance, if given.")]
        | UnsetType
    ) = UNSET
    worst_utilisation: Annotated[float | None, Field(description="Its utilisation in the worst case.")] | UnsetType = (
        UNSET
    )
    worst_governing_check: Annotated[str | None, Field(description="Check that has it.")] | UnsetType = UNSET
    link: Annotated[str, Field(description=LINK)] | UnsetType = UNSET
    problem: Annotated[ProblemReply, Field(description="Reason for an item without a result.")] | UnsetType = UNSET

    @property
    def verdict(self) -> str:
        """Label of the line in the metrics: refused, selected or none."""
        return "refused" if self.status == "error" else "selected" if self.selected else "none"


class BatchReply(Reply, frozen=True):
    """Results in the order of the items."""

    results: Annotated[list[BatchLine], Field(max_length=MOST_AT_ONCE, description="One line per item.")]


class CatalogueReply(Reply, frozen=True):
    """The whole catalogue."""

    catalogue_version: Version
    gears: Annotated[tuple[Gear, ...], Field(min_length=1, description="Every gear, by size and ratio.")]
    series: Annotated[dict[str, SeriesFigure], Field(description="Figures of the whole series.")]


class MotorsReply(Reply, frozen=True):
    """The user’s own motors."""

    catalogue_version: Version
    motors: Annotated[tuple[ListedMotor, ...], Field(description="Every motor of motors.csv, in its order.")]


class MotorUseReply(Reply, frozen=True):
    """One of the user’s own motors on a gear."""

    motor: Annotated[ListedMotor, Field(description="The motor.")]
    fits: Annotated[bool, Field(description="True if it passes every check of the motor whose figures are known.")]
    governing_check: Annotated[str, Field(description="Check of the motor that is closest to its limit.")]
    utilisations: Annotated[
        Mapping[str, float],
        Field(
            description="Demand over limit for each check of the motor, as in `POST /api/v1/select` with this motor."
        ),
    ]
    inertia_ratio: Annotated[
        float | None,
        Field(description="Inertia of the load over i² times that of the motor; null where one is not known."),
    ]


class MotorsOnGearReply(Reply, frozen=True):
    """The user’s own motors on a gear: those that fit first, the smallest rated torque first, then the nearest miss."""

    catalogue_version: Version
    designation: Annotated[str, Field(description="The gear.")]
    motors: Annotated[
        list[MotorUseReply],
        Field(
            description="Every motor of motors.csv with a figure that is checked; where an inertia ratio is required, "
            "every one with an inertia."
        ),
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class OneGearReply(Gear):
    """One gear by itself, and once more in the form of the whole catalogue, so that one reader serves both."""

    catalogue_version: Version
    gears: Annotated[
        tuple[Gear, ...],
        Field(min_length=1, max_length=1, description="The gear, as the list of all gears has it."),
    ]


class EnvelopeReply(Reply, frozen=True):
    """Life envelopes of one size."""

    size: Annotated[str, Field(description="Size such as 20A.")]
    model: Annotated[BearingModel, Field(description="Model of the envelope.")]
    curves: Annotated[
        list[EnvelopeCurve], Field(min_length=3, max_length=4, description="One curve per load coefficient.")
    ]
    sources: Annotated[
        dict[str, str], Field(description="Source of its limits or points; marks those that a user supplied.")
    ]


class SizingReply(Reply, frozen=True):
    """Application of another tool’s sizing."""

    application: Annotated[Any, Field(description="The application, as POST /api/v1/select takes it.")]
    unused: Annotated[tuple[str, ...], Field(description="Paths of the elements of which nothing was taken.")]


# --- Saved selections -------------------------------------------------------------------------------------------------

Id = Annotated[str, Field(description="Its id: 128 random bits.")]
Url = Annotated[str, Field(description="Address of its page, relative to this service.")]
Moment = Annotated[str, Field(description="Moment in UTC.", examples=["2026-11-26T08:30:00.000000Z"])]


class SavedReply(Reply, frozen=True):
    """Where the saved selection is."""

    id: Id
    url: Url


class SummaryReply(Reply, frozen=True):
    """One saved selection in a list."""

    id: Id
    url: Url
    created: Annotated[str, Field(description="When it was saved, UTC, ISO 8601.")]
    title: Annotated[str | None, Field(description="Title for people.")]
    reference: Annotated[str | None, Field(description="The caller’s own number.")]
    author: Annotated[str | None, Field(description="Author.")]
    revision: Annotated[str | None, Field(description="Its revision in the caller’s documents.")]
    ordering_code: Annotated[
        str | None, Field(description="Gear, output version and motor adapter as ordered, as far as they were given.")
    ]
    selected: Annotated[str | None, Field(description="Designation of the gear selected then, or null.")]
    designation: Annotated[
        str | None,
        Field(
            description="Gear that its page and files show first: that of the ordering code, else the selected one or "
            "the nearest miss; null where an earlier version has saved what can’t be read."
        ),
    ]
    status: Annotated[str | None, Field(description="Verdict on that gear, as saved.")]
    utilisation: Annotated[float | None, Field(description="Utilisation of that gear, as saved.")]
    engine_version: Annotated[str, Field(description="Version of the calculation then.")]
    catalogue_version: Annotated[str, Field(description="Hash of the catalogue’s content then.")]


class SelectionToday(Reply, frozen=True):
    """Verdict on a saved selection by today's engine and catalogue."""

    selected: Annotated[str | None, Field(description="Designation of the gear selected today, or null.")]
    status: Annotated[
        str | None, Field(description="Verdict on the gear that its page shows first; open where there is no answer.")
    ]
    verdict_changed: Annotated[bool, Field(description="True where gear or verdict are others than saved.")]


class SelectionLineReply(SummaryReply, frozen=True):
    """One saved selection in a list, with what it gets today."""

    today: Annotated[
        SelectionToday | None, Field(description="By today’s engine and catalogue; null until it is known.")
    ]


class SelectionListReply(Reply, frozen=True):
    """Page of the list of saved selections, newest first."""

    selections: Annotated[
        list[SelectionLineReply], Field(max_length=SELECTIONS_LISTED, description="Saved selections.")
    ]
    next_cursor: Annotated[str | None, Field(description="Cursor of the next page; null at the end.")]
    deleted: Annotated[list[str], Field(description="Ids that were deleted since then, where that is asked.")]
    pending: Annotated[int, Field(description="Number of selections whose `today` is not known yet.")]


class TodayReply(Reply, frozen=True):
    """Versions of today's engine and catalogue, and how their result differs from the saved one."""

    engine_version: Annotated[str, Field(description="Version of the calculation today.")]
    catalogue_version: Annotated[str, Field(description="Hash of the catalogue’s content today.")]
    difference_count: Annotated[int, Field(description="Number of fields that differ.")]
    differences: Annotated[list[Difference], MOST, Field(description="The first 500 of them.")]
    figure_differences: Annotated[
        Annotated[list[FigureDifference], MOST] | None,
        Field(
            description="Published figures of the candidates that differ, the first 500; null where the catalogue of "
            "that time is not kept."
        ),
    ]
    problem: Annotated[
        ProblemReply | None,
        Field(
            description="Why the application can’t be answered today, for example because the catalogue lacks a ratio."
        ),
    ]


class RevisionReply(Reply, frozen=True):
    """One line of the list of revisions."""

    label: Annotated[str, Field(description="Label.")]
    number: Annotated[int, Field(description="Place in the order of revisions, from 1.")]
    created: Moment
    created_by: Annotated[str | None, Field(description="Key that froze it.")]
    author: Annotated[str | None, Field(description="Author.")]
    checked: Annotated[str | None, Field(description="Initials of the check.")]
    approved: Annotated[str | None, Field(description="Initials of the approval.")]
    note: Annotated[str | None, Field(description="Note.")]
    axis_count: Annotated[int, Field(description="Number of axes.")]
    engine_version: Annotated[str, Field(description="Version of the calculation.")]
    catalogue_version: Annotated[str, Field(description="Catalogue.")]


class SavedSelectionReply(SummaryReply, frozen=True):
    """A saved selection as it was saved, and what differs today. Nothing is rewritten."""

    application: Annotated[dict[str, Any], Field(description="The application as it was given.")]
    gear: Annotated[
        Gear | None,
        Field(
            description="Published figures of the gear `designation` in the catalogue of that time; null where that "
            "is not kept."
        ),
    ]
    result: Annotated[Selection, Field(description="The complete reply.")]
    label: Annotated[str, Field(description="Label of the revision that this is.")]
    revisions: Annotated[list[RevisionReply], Field(description="Its revisions, the latest first.")]
    today: Annotated[TodayReply, Field(description="Differences today.")]
