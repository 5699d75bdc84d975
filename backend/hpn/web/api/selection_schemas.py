"""What goes in and out of the saved selections, for validation and for the OpenAPI document."""

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, StringConstraints
from pydantic_core import PydanticCustomError

from hpn.application import Application, Model
from hpn.web.api.schemas import GearReply, ProblemReply, Reply, SelectReply

CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufffe\uffff]")
"""Control characters, line separators, marks that turn the direction of the text around them, and no characters."""


def _plain(text: str) -> str | None:
    if CONTROLS.search(text):
        raise PydanticCustomError("control_characters", "must not contain control characters or line breaks")
    return text or None


Line = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=200),
    AfterValidator(_plain),
    Field(
        json_schema_extra={
            "pattern": "^[^\\u0000-\\u001f\\u007f-\\u009f\\u2028-\\u202e\\u2066-\\u2069\\ufffe\\uffff]*$"
        }
    ),
]
"""One line of text; an empty one counts as none."""


class Labels(Model):
    """What people call a saved selection."""

    title: Line | None = Field(None, description="Title for people.", examples=["Rotary table, axis 7"])
    reference: Line | None = Field(None, description="Your own number, such as a part number.", examples=["4711-07"])


class SaveRequest(Labels):
    """An application to be saved with its result."""

    application: Application = Field(description="The application.")


class SavedReply(Reply):
    """Where the saved selection is."""

    id: str = Field(description="Its id: 128 random bits.")
    url: str = Field(description="Address of its page, relative to this service.")


class SummaryReply(SavedReply):
    """One saved selection in a list."""

    created: str = Field(description="When it was saved, UTC, ISO 8601.")
    title: str | None = Field(description="Title for people.")
    reference: str | None = Field(description="The caller's own number.")
    selected: str | None = Field(description="Designation of the gear selected then, or null.")
    engine_version: str = Field(description="Version of the calculation then.")
    catalogue_version: str = Field(description="Hash of the catalogue's content then.")


class DifferenceReply(Reply):
    """One field that today's engine and catalogue give differently."""

    pointer: str = Field(
        description="JSON pointer into the saved result; into today's where change is added, since the saved lacks it."
    )
    kind: Literal["verdict", "figure", "text"] = Field(description="Verdicts come first, then figures, then texts.")
    change: Literal["changed", "added", "removed"] = Field(description="Whether both have the field, or only one.")
    candidate: str | None = Field(description="Designation of the candidate it belongs to.")
    check: str | None = Field(description="Code of the check it belongs to.")
    field: str = Field(description="Name of the field.")
    saved: Any = Field(description="Value as saved.")
    today: Any = Field(description="Value today.")


class FigureDifferenceReply(Reply):
    """One published figure of a candidate that today's catalogue gives differently."""

    candidate: str = Field(description="Designation of the gear.")
    field: str = Field(description="Name of the figure in the catalogue; designation where only one has the gear.")
    saved: Any = Field(description="Figure in the catalogue of then; null where it was not published.")
    today: Any = Field(description="Figure in today's catalogue; null where it is not published.")


class TodayReply(Reply):
    """What today's engine and catalogue say to the saved application."""

    engine_version: str = Field(description="Version of the calculation today.")
    catalogue_version: str = Field(description="Hash of the catalogue's content today.")
    difference_count: int = Field(description="Number of fields that differ.")
    differences: list[DifferenceReply] = Field(description="The first 500 of them.")
    figure_differences: list[FigureDifferenceReply] | None = Field(
        description="Published figures of the candidates that differ, the first 500; null where the catalogue of then "
        "is not kept."
    )
    problem: ProblemReply | None = Field(
        description="Why the application can't be answered today, for example because the catalogue lacks a ratio."
    )


class SavedSelectionReply(SummaryReply):
    """A saved selection as it was saved, and what differs today. Nothing is rewritten."""

    application: dict[str, Any] = Field(description="The application as it was given.")
    gear: GearReply | None = Field(
        description="Published figures of the first candidate in the catalogue of then; null where that is not kept."
    )
    result: SelectReply = Field(description="The reply it got, whole.")
    today: TodayReply = Field(description="What differs today.")


class SelectionListReply(Reply):
    """Part of the list of saved selections, newest first."""

    selections: list[SummaryReply] = Field(description="Saved selections.")
    next_cursor: str | None = Field(description="Cursor of the next part; null at the end.")
