"""Document as it is sent: title block, common values and axes."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

from pydantic import Field, WrapValidator, model_validator
from pydantic_core import PydanticCustomError

from hpn.documents.axis import MOST_AXES, MOST_PHASES, Axis, phases_of
from hpn.documents.common import Common
from hpn.words.fields import Model, at_most, in_parts, refused
from hpn.words.titles import Note, Title
from hpn.words.wording import N_

TOO_MANY_PHASES = N_("may have {most} phases and moves in all its axes together, and has {count}")


class TitleBlock(Model):
    """Title block of a document."""

    title: Title | None = Field(None, description="Title for people.", examples=["Packing line"])
    reference: Title | None = Field(None, description="Your own number, such as an order number.", examples=["4711"])
    author: Title | None = Field(None, description="Author.", examples=["MA"])
    note: Note | None = Field(None, description="A note on the whole document.")


Axes = Annotated[tuple[Axis, ...], WrapValidator(in_parts), at_most(MOST_AXES)]


class Document(TitleBlock):
    """A machine with all its axes."""

    read_only = frozenset(
        ("id", "url", "kind", "revision", "created", "updated", "saved", "counts", "utilisation", "order")
    )
    common: Common = Field(default_factory=Common, description="Values that hold for every axis without its own.")
    axes: Axes = Field((), description="Axes in their order.")

    @model_validator(mode="after")
    def _within_bounds(self) -> Self:
        if fault := excess_of([phases_of(axis.application) for axis in self.axes]):
            raise refused(self, (("axes",), fault))
        return self


def excess_of(phases: Sequence[int]) -> PydanticCustomError | None:
    """Fault of a document with too many phases and moves in all its axes; None within the limit."""
    if (count := sum(phases)) > MOST_PHASES:
        values: Mapping[str, Any] = {"most": MOST_PHASES, "count": count}
        return PydanticCustomError("too_many_phases", TOO_MANY_PHASES, dict(values))
    return None
