"""Revisions: a document under a label with all own, inherited and resolved values; it never changes."""

import re
from typing import Annotated, Any

import msgspec
from msgspec import Raw
from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from hpn.documents.answers import AxisAnswer
from hpn.documents.common import flat
from hpn.words.fields import Model
from hpn.words.reply import Reply
from hpn.words.titles import Note, Title
from hpn.words.wording import N_

LABEL = re.compile(r"[A-Za-z0-9._-]{1,20}")
NOW, TODAY, SAVED = "now", "today", "saved"
"""Names of the working copy and of today's answer in a comparison; label of first revisions of older documents."""

NOT_A_LABEL = N_("must be 1 to 20 letters, digits, dots, hyphens or underscores, such as B or 1.2")
RESERVED = N_("is reserved: choose another label")


def label_key(label: str) -> str:
    """Label in the form for comparisons, where case makes no difference."""
    return label.casefold()


def is_label(text: str) -> bool:
    """True for a valid label of a revision; a label of only dots would be lost in an address."""
    return LABEL.fullmatch(text) is not None and text.strip(".") != "" and label_key(text) not in (NOW, TODAY, SAVED)


def _label(text: str) -> str:
    if LABEL.fullmatch(text) is None or not text.strip("."):
        raise PydanticCustomError("label", NOT_A_LABEL)
    if not is_label(text):
        raise PydanticCustomError("reserved", RESERVED)
    return text


Label = Annotated[str, AfterValidator(_label), Field(json_schema_extra={"pattern": f"^{LABEL.pattern}$"})]


class RevisionBlock(Model):
    """Label and signatures of a revision."""

    label: Label = Field(description="Label, unique in the document without regard to case.", examples=["B"])
    author: Title | None = Field(None, description="Author of the revision.", examples=["MA"])
    checked: Title | None = Field(None, description="Initials of the checker.", examples=["KR"])
    approved: Title | None = Field(None, description="Initials of the approver.", examples=["LB"])
    note: Note | None = Field(None, description="Changes in this revision.")


class FrozenAxis(Reply, frozen=True):
    """An axis as it was: its own part as sent, its application resolved with the common values, and its answer."""

    number: int
    name: str | None
    quantity: int
    note: str | None
    ordering_code: str | None
    without: tuple[str, ...]
    application: Raw
    resolved: Raw
    answer: AxisAnswer

    @property
    def own(self) -> frozenset[str]:
        """Paths of the axis's own values."""
        return frozenset(path for path, _ in flat(msgspec.json.decode(self.application)))

    @property
    def inherited(self) -> frozenset[str]:
        """Paths of the machine’s values in the axis's application."""
        return frozenset(path for path, _ in flat(msgspec.json.decode(self.resolved))) - self.own


class Frozen(Reply, frozen=True):
    """A document as it was. Answers are those of its own time."""

    title: str | None
    reference: str | None
    author: str | None
    note: str | None
    common: dict[str, Any]
    axes: tuple[FrozenAxis, ...]


encode = msgspec.json.Encoder().encode
decode = msgspec.json.Decoder(Frozen).decode
