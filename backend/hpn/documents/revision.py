"""Revisions: a document as it was under a label, everything own, inherited and resolved, never changed."""

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
"""The working copy and today's catalogue and engine in a comparison, and the first revision of what was saved before
there were revisions."""

NOT_A_LABEL = N_("must be 1 to 20 letters, digits, dots, hyphens or underscores, such as B or 1.2")
RESERVED = N_("is reserved: choose another label")


def label_key(label: str) -> str:
    """Form of a label without its case, which makes no difference between labels."""
    return label.casefold()


def is_label(text: str) -> bool:
    """True for a text that can be the label of a revision; dots alone would be lost in an address."""
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
    checked: Title | None = Field(None, description="Initials of who checked it.", examples=["KR"])
    approved: Title | None = Field(None, description="Initials of who approved it.", examples=["LB"])
    note: Note | None = Field(None, description="What is new in it.")


class FrozenAxis(Reply, frozen=True):
    """An axis as it was: its own part as it was sent, what that and the common values resolved to, and the answer."""

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
        """Paths of its own values."""
        return frozenset(path for path, _ in flat(msgspec.json.decode(self.application)))

    @property
    def inherited(self) -> frozenset[str]:
        """Paths of the machine’s values in its application."""
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
