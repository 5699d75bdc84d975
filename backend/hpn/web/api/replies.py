"""Replies of the API besides a selection, typed; encoded as JSON here and nowhere else."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType
from starlette.responses import Response

from hpn.application import BearingModel
from hpn.catalogue import ListedMotor, SeriesFigure
from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve
from hpn.engine.selection import LINK, Selection
from hpn.explain.differences import Difference, FigureDifference

encode = msgspec.json.Encoder().encode

DIFFERENCES_SHOWN = 500
SELECTIONS_LISTED = 200
"""Most lines of a part of the list of saved selections."""

Version = Annotated[str, Meta(description="Hash of the catalogue’s content, supplement included.")]


class JSONBytes(Response):
    """JSON that is already encoded."""

    media_type = "application/json"


def json_response(reply: Any, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """A reply as JSON; NaN and infinity become null."""
    return JSONBytes(encode(reply), status, headers)


class FieldError(Struct):
    """Error in one field."""

    pointer: Annotated[str, Meta(description="JSON pointer to the field.")]
    code: Annotated[str, Meta(description="Kind of the fault, for programs.")]
    detail: Annotated[str, Meta(description="Value or form that would be right.")]


class ProblemReply(Struct, omit_defaults=True):
    """Problem details, RFC 9457."""

    type: Annotated[str, Meta(description="Kind of problem: address of a page with its cause and remedy.")]
    title: Annotated[str, Meta(description="Name of the kind.")]
    status: Annotated[int, Meta(description="HTTP status.")]
    detail: Annotated[str, Meta(description="Error, and the value or form that would be right.")]
    errors: Annotated[list[FieldError] | UnsetType, Meta(description="The fields it is about.")] = UNSET


class BatchLine(Struct):
    """Result of one item: its answer in brief, or why it has none."""

    reference: Annotated[str | None, Meta(description="The item’s own reference.")]
    status: Annotated[Literal["ok", "error"], Meta(description="Whether the item could be evaluated.")]
    selected: Annotated[str | UnsetType | None, Meta(description="Designation of the selected gear, or null.")] = UNSET
    governing_check: Annotated[
        str | UnsetType | None, Meta(description="Check that is closest to its limit on that gear.")
    ] = UNSET
    utilisation: Annotated[float | UnsetType | None, Meta(description="Utilisation of that check.")] = UNSET
    suitable: Annotated[int | UnsetType, Meta(description="Number of suitable gears.")] = UNSET
    link: Annotated[str | UnsetType, Meta(description=LINK)] = UNSET
    problem: Annotated[ProblemReply | UnsetType, Meta(description="Why the item could not be evaluated.")] = UNSET

    @property
    def verdict(self) -> str:
        """Label of the line in the metrics: refused, selected or none."""
        return "refused" if self.status == "error" else "selected" if self.selected else "none"


class BatchReply(Struct):
    """Results in the order of the items."""

    results: Annotated[list[BatchLine], Meta(description="One line per item.")]


class CatalogueReply(Struct):
    """The whole catalogue."""

    catalogue_version: Version
    gears: Annotated[tuple[Gear, ...], Meta(description="Every gear, by size and ratio.")]
    series: Annotated[dict[str, SeriesFigure], Meta(description="Figures of the whole series.")]


class MotorsReply(Struct):
    """The user’s own motors."""

    catalogue_version: Version
    motors: Annotated[tuple[ListedMotor, ...], Meta(description="Every motor of motors.csv, in its order.")]


class MotorUseReply(Struct):
    """One of the user’s own motors on a gear."""

    motor: Annotated[ListedMotor, Meta(description="The motor.")]
    fits: Annotated[bool, Meta(description="Whether it passes every check of the motor whose figures are known.")]
    governing_check: Annotated[str, Meta(description="Check of the motor that is closest to its limit.")]
    utilisations: Annotated[
        Mapping[str, float],
        Meta(description="Demand over limit by check of the motor, as `POST /api/v1/select` has it with this motor."),
    ]
    inertia_ratio: Annotated[
        float | None,
        Meta(description="Inertia of the load over i² times that of the motor; null where one is not known."),
    ]


class MotorsOnGearReply(Struct):
    """The user’s own motors on a gear: those that fit first, the smallest rated torque first, then the nearest miss."""

    catalogue_version: Version
    designation: Annotated[str, Meta(description="The gear.")]
    motors: Annotated[
        list[MotorUseReply],
        Meta(
            description="Every motor of motors.csv that has a figure which is checked; where an inertia ratio is "
            "required, every one of which the inertia is listed."
        ),
    ]


class EnvelopeReply(Struct):
    """Life envelopes of one size."""

    size: Annotated[str, Meta(description="Size such as 20A.")]
    model: Annotated[BearingModel, Meta(description="Model of the envelope.")]
    curves: Annotated[list[EnvelopeCurve], Meta(description="One curve per load coefficient.")]
    sources: Annotated[
        dict[str, str], Meta(description="Where its limits come from, or its points; says what a user supplied.")
    ]


# --- Saved selections -------------------------------------------------------------------------------------------------

Id = Annotated[str, Meta(description="Its id: 128 random bits.")]
Url = Annotated[str, Meta(description="Address of its page, relative to this service.")]


class SavedReply(Struct):
    """Where the saved selection is."""

    id: Id
    url: Url


class SummaryReply(Struct):
    """One saved selection in a list."""

    id: Id
    url: Url
    created: Annotated[str, Meta(description="When it was saved, UTC, ISO 8601.")]
    title: Annotated[str | None, Meta(description="Title for people.")]
    reference: Annotated[str | None, Meta(description="The caller’s own number.")]
    author: Annotated[str | None, Meta(description="Author.")]
    revision: Annotated[str | None, Meta(description="Its revision in the caller’s documents.")]
    ordering_code: Annotated[
        str | None, Meta(description="Gear, output version and motor adapter as ordered, as far as they were given.")
    ]
    selected: Annotated[str | None, Meta(description="Designation of the gear selected then, or null.")]
    designation: Annotated[
        str | None,
        Meta(
            description="Gear that its page and files show first: that of the ordering code, else the selected one or "
            "the nearest miss; null where an earlier version has saved what can’t be read."
        ),
    ]
    status: Annotated[str | None, Meta(description="Verdict on that gear, as saved.")]
    utilisation: Annotated[float | None, Meta(description="Utilisation of that gear, as saved.")]
    engine_version: Annotated[str, Meta(description="Version of the calculation then.")]
    catalogue_version: Annotated[str, Meta(description="Hash of the catalogue’s content then.")]


class SelectionListReply(Struct):
    """Part of the list of saved selections, newest first."""

    selections: Annotated[list[SummaryReply], Meta(description="Saved selections.")]
    next_cursor: Annotated[str | None, Meta(description="Cursor of the next part; null at the end.")]


class TodayReply(Struct):
    """Versions of today's engine and catalogue, and how their result differs from the saved one."""

    engine_version: Annotated[str, Meta(description="Version of the calculation today.")]
    catalogue_version: Annotated[str, Meta(description="Hash of the catalogue’s content today.")]
    difference_count: Annotated[int, Meta(description="Number of fields that differ.")]
    differences: Annotated[list[Difference], Meta(description="The first 500 of them.")]
    figure_differences: Annotated[
        list[FigureDifference] | None,
        Meta(
            description="Published figures of the candidates that differ, the first 500; null where the catalogue of "
            "then is not kept."
        ),
    ]
    problem: Annotated[
        ProblemReply | None,
        Meta(
            description="Why the application can’t be answered today, for example because the catalogue lacks a ratio."
        ),
    ]


class SavedSelectionReply(SummaryReply):
    """A saved selection as it was saved, and what differs today. Nothing is rewritten."""

    application: Annotated[dict[str, Any], Meta(description="The application as it was given.")]
    gear: Annotated[
        Gear | None,
        Meta(
            description="Published figures of the first candidate in the catalogue of then; null where that is not "
            "kept."
        ),
    ]
    result: Annotated[Selection, Meta(description="The reply it got, whole.")]
    today: Annotated[TodayReply, Meta(description="Differences today.")]
