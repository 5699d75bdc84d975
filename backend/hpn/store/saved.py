"""Records of selections, as the store keeps them."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

import brotli
import orjson
import zstandard

from hpn.catalogue import Catalogue
from hpn.store.records import ANSWER, LISTS, RevisionLine, new_id


@dataclass(frozen=True, slots=True)
class Draft:
    """Selection to save: the application as it was given, and the reply to it, byte for byte.

    `designation` is the gear that its page shows first, with its status and utilisation. `owner` is the name of the API
    key that saves it, None without a key. `id` is the id of the new selection; where its idempotency key has saved the
    selection before, that one's id holds. `catalogue` is the catalogue of the reply; the store keeps one copy of each
    version. `answer` has the columns of an axis's answer that are no fields of this class, `phases` is the number of
    phases, and `label` the label of the first revision.
    """

    application: bytes
    result: bytes
    engine_version: str
    catalogue_version: str
    selected: str | None
    title: str | None = None
    reference: str | None = None
    author: str | None = None
    revision: str | None = None
    ordering_code: str | None = None
    designation: str | None = None
    status: str | None = None
    utilisation: float | None = None
    idempotency_key: str | None = None
    owner: str | None = None
    catalogue: Catalogue | None = field(default=None, repr=False)
    answer: Mapping[str, Any] = field(default_factory=dict, repr=False)
    phases: int = 0
    label: str = "saved"
    id: str = field(init=False, default_factory=new_id)

    @property
    def digest(self) -> str:
        """Fingerprint of the request; equal for equal requests, whichever engine or catalogue answered."""
        parts: list[object] = [self.application.decode(), self.title, self.reference]
        later = [self.author, self.revision, self.ordering_code]
        # Earlier versions knew none of these: without them a retry of an earlier request has the same fingerprint.
        return hashlib.sha256(orjson.dumps(parts + later if any(later) else parts)).hexdigest()

    @property
    def columns(self) -> dict[str, Any]:
        """Answer of the selection's axis: all columns."""
        own = ("selected", "designation", "utilisation", "engine_version", "catalogue_version")
        empty = dict.fromkeys(ANSWER) | dict.fromkeys(LISTS, "[]")
        return (
            empty | dict(self.answer) | {name: getattr(self, name) for name in own} | {"status": self.status or "open"}
        )


@dataclass(frozen=True, slots=True)
class SelectionLine:
    """Line of a list of saved selections.

    `designation` is the gear that its page shows first, with the verdict of its revision; None where the reply of an
    earlier version can't be read. `version` counts its changes from 1. Where `today_changed` is not 0, the versions in
    `today_of` give another gear or verdict.
    """

    id: str
    created: datetime
    title: str | None
    reference: str | None
    author: str | None
    revision: str | None
    ordering_code: str | None
    selected: str | None
    designation: str | None
    status: str | None
    utilisation: float | None
    engine_version: str
    catalogue_version: str
    version: int
    today_of: str | None
    today_changed: int | None
    today_selected: str | None
    today_status: str | None


@dataclass(frozen=True, slots=True)
class SavedSelection(SelectionLine):
    """Saved selection in one revision; `owner` is the name of the API key that saved it, None without a key.

    `label` is the label of this revision, `revisions` are all, the latest first.
    """

    owner: str | None
    label: str
    revisions: tuple[RevisionLine, ...]
    application: bytes = field(repr=False)
    result: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class Page:
    """Part of a list, newest first; `next_cursor` asks for the next part, None at the end."""

    selections: list[SelectionLine]
    next_cursor: str | None


def search_text(*texts: str | None) -> str:
    """Text for searches: labels in lower case, one a line."""
    return "\n".join(filter(None, texts)).casefold()


# --- Replies are some 80 kB of repetitive JSON; packed they take a tenth -------------------------------------------


def packed(content: bytes) -> bytes:
    """Zstd frame of the content."""
    return zstandard.compress(content)


def unpacked(content: bytes) -> bytes:
    """Content of a zstd frame, or of a brotli stream as earlier versions wrote, which never begins like a frame."""
    if content.startswith(zstandard.FRAME_HEADER):
        return zstandard.decompress(content)
    stream: bytes = brotli.decompress(content)
    return stream
