"""Typed replies of the API except the selection; all JSON is encoded here."""

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
"""Maximum applications of a batch as one JSON object."""

SELECTIONS_LISTED = 200
"""Maximum lines of a part of the list of saved selections."""

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
        Annotated[str | None, Field(description="Check closest to its limit on that gear.")] | UnsetType
    ) = UNSET
    utilisation: Annotated[float | None, Field(description="Utilisation of that check.")] | UnsetType = UNSET
    suitable: Annotated[int, Field(description="Number of suitable gears.")] | UnsetType = UNSET
    holds: (
        Annotated[
            bool | None,
            Field(description="True: the gear passes over the whole tolerance; left out without tolerances."),
        ]
        | UnsetType
    ) = UNSET
    worst_utilisation: (
        Annotated[float | None, Field(description="Utilisation of the gear in the worst case.")] | UnsetType
    ) = UNSET
    worst_governing_check: Annotated[str | None, Field(description="Check with that utilisation.")] | UnsetType = UNSET
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
    fits: Annotated[bool, Field(description="True: it passes every check of the motor with known figures.")]
    governing_check: Annotated[str, Field(description="Check of the motor closest to its limit.")]
    utilisations: Annotated[
        Mapping[str, float],
        Field(
            description="Demand over limit for each check of the motor, as in `POST /api/v1/select` with this motor."
        ),
    ]
    inertia_ratio: Annotated[
        float | None,
        Field(description="Inertia of the load over i² times that of the motor; null where an inertia is not known."),
    ]


class MotorsOnGearReply(Reply, frozen=True):
    """The user’s own motors on a gear: fitting motors first, by rising rated torque, then the others, the nearest miss
    first."""

    catalogue_version: Version
    designation: Annotated[str, Field(description="The gear.")]
    motors: Annotated[
        list[MotorUseReply],
        Field(
            description="Every motor of motors.csv with a checked figure; if an inertia ratio is required, only motors "
            "with an inertia."
        ),
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class OneGearReply(Gear):
    """One gear as a single object, and again in the form of the whole catalogue, so that one reader serves both."""

    catalogue_version: Version
    gears: Annotated[
        tuple[Gear, ...],
        Field(min_length=1, max_length=1, description="The gear in the form of the catalogue’s list."),
    ]


class EnvelopeReply(Reply, frozen=True):
    """Life envelopes of one size."""

    size: Annotated[str, Field(description="Size such as 20A.")]
    model: Annotated[BearingModel, Field(description="Model of the envelope.")]
    curves: Annotated[
        list[EnvelopeCurve], Field(min_length=3, max_length=4, description="One curve per load coefficient.")
    ]
    sources: Annotated[
        dict[str, str], Field(description="Source of its limits or points; user-supplied ones are marked.")
    ]


class SizingReply(Reply, frozen=True):
    """Application read from another tool’s sizing."""

    application: Annotated[Any, Field(description="The application, in the form of POST /api/v1/select.")]
    unused: Annotated[tuple[str, ...], Field(description="Paths of the elements that were not used.")]
    note: Annotated[
        str | None,
        Field(description="Names the unused elements that act on the load but are part of no phase; null for none."),
    ] = None


# --- Saved selections -------------------------------------------------------------------------------------------------

Id = Annotated[str, Field(description="Its id: 128 random bits.")]
Url = Annotated[str, Field(description="Address of its page, relative to this service.")]
Moment = Annotated[str, Field(description="Moment in UTC.", examples=["2026-11-26T08:30:00.000000Z"])]


class SavedReply(Reply, frozen=True):
    """Id and address of a saved document."""

    id: Id
    url: Url


class SummaryReply(Reply, frozen=True):
    """One saved selection in a list."""

    id: Id
    url: Url
    created: Annotated[str, Field(description="Moment of saving, UTC, ISO 8601.")]
    title: Annotated[str | None, Field(description="Title for people.")]
    reference: Annotated[str | None, Field(description="The caller’s own number.")]
    author: Annotated[str | None, Field(description="Author.")]
    revision: Annotated[str | None, Field(description="Its revision in the caller’s documents.")]
    ordering_code: Annotated[
        str | None, Field(description="Gear, output version and motor adapter as ordered, as far as given.")
    ]
    selected: Annotated[str | None, Field(description="Designation of the gear selected at that time, or null.")]
    designation: Annotated[
        str | None,
        Field(
            description="Gear shown first on its page and in its files: the gear of the ordering code, else the "
            "selected gear, else the nearest miss; null where the result saved by an earlier version can’t be read."
        ),
    ]
    status: Annotated[str | None, Field(description="Verdict on that gear, as saved.")]
    utilisation: Annotated[float | None, Field(description="Utilisation of that gear, as saved.")]
    engine_version: Annotated[str, Field(description="Version of the calculation at that time.")]
    catalogue_version: Annotated[str, Field(description="Hash of the catalogue’s content at that time.")]


class SelectionToday(Reply, frozen=True):
    """Verdict on a saved selection by today's engine and catalogue."""

    selected: Annotated[str | None, Field(description="Designation of the gear selected today, or null.")]
    status: Annotated[
        str | None, Field(description="Verdict on the gear shown first on its page; open without an answer.")
    ]
    verdict_changed: Annotated[bool, Field(description="True: gear or verdict differ from the saved ones.")]


class SelectionLineReply(SummaryReply, frozen=True):
    """One saved selection in a list, with today's verdict."""

    today: Annotated[
        SelectionToday | None, Field(description="Verdict by today’s engine and catalogue; null until it is computed.")
    ]


class SelectionListReply(Reply, frozen=True):
    """Page of the list of saved selections, newest first."""

    selections: Annotated[
        list[SelectionLineReply], Field(max_length=SELECTIONS_LISTED, description="Saved selections.")
    ]
    next_cursor: Annotated[str | None, Field(description="Cursor of the next page; null at the end.")]
    deleted: Annotated[list[str], Field(description="Ids deleted since `deleted_since`; empty without it.")]
    pending: Annotated[int, Field(description="Number of selections whose `today` is not computed yet.")]


class TodayReply(Reply, frozen=True):
    """Versions of today's engine and catalogue, and differences of their result from the saved one."""

    engine_version: Annotated[str, Field(description="Version of the calculation today.")]
    catalogue_version: Annotated[str, Field(description="Hash of the catalogue’s content today.")]
    difference_count: Annotated[int, Field(description="Number of fields that differ.")]
    differences: Annotated[list[Difference], MOST, Field(description="The first 500 differences.")]
    figure_differences: Annotated[
        Annotated[list[FigureDifference], MOST] | None,
        Field(
            description="Published figures of the candidates that differ, the first 500; null if the catalogue of that "
            "time is not kept."
        ),
    ]
    problem: Annotated[
        ProblemReply | None,
        Field(
            description="Reason why the application can’t be calculated today, for example a ratio that the catalogue "
            "lacks."
        ),
    ]


class RevisionReply(Reply, frozen=True):
    """One line of the list of revisions."""

    label: Annotated[str, Field(description="Label.")]
    number: Annotated[int, Field(description="Place in the order of revisions, from 1.")]
    created: Moment
    created_by: Annotated[str | None, Field(description="Name of the key that froze it.")]
    author: Annotated[str | None, Field(description="Author.")]
    checked: Annotated[str | None, Field(description="Initials of the checker.")]
    approved: Annotated[str | None, Field(description="Initials of the approver.")]
    note: Annotated[str | None, Field(description="Note.")]
    axis_count: Annotated[int, Field(description="Number of axes.")]
    engine_version: Annotated[str, Field(description="Version of the calculation.")]
    catalogue_version: Annotated[str, Field(description="Catalogue.")]


class SavedSelectionReply(SummaryReply, frozen=True):
    """A saved selection as it was saved, and the differences of today. Saved content is never rewritten."""

    application: Annotated[dict[str, Any], Field(description="The application as sent.")]
    gear: Annotated[
        Gear | None,
        Field(
            description="Published figures of the gear `designation` in the catalogue of that time; null if that "
            "catalogue is not kept."
        ),
    ]
    result: Annotated[Selection, Field(description="The complete reply.")]
    label: Annotated[str, Field(description="Label of this revision.")]
    revisions: Annotated[list[RevisionReply], Field(description="Its revisions, the latest first.")]
    today: Annotated[TodayReply, Field(description="Differences today.")]
