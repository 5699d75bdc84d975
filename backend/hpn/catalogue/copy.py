"""A catalogue as bytes that outlast its files: every figure with its source, as the engine read it at that time.

The files themselves are not enough: a later version may need other columns, or read them more strictly.
"""

import dataclasses
from typing import Any

import msgspec
import numpy as np

from hpn.catalogue import Catalogue

FORMAT = 1
"""Format of the copies; raise it when a field of the catalogue is renamed, dropped or changes its meaning."""


class UnreadableCopyError(ValueError):
    """A copy that this version can't read; the text names the reason."""


class _Head(msgspec.Struct):
    format: int
    catalogue: msgspec.Raw


def copy_of(catalogue: Catalogue) -> bytes:
    """A whole catalogue as JSON; the same bytes for the same catalogue."""
    fields = {field.name: getattr(catalogue, field.name) for field in dataclasses.fields(catalogue)}
    return msgspec.json.encode({"format": FORMAT, "catalogue": fields}, enc_hook=_encodable)


def read_copy(content: bytes) -> Catalogue:
    """The copied catalogue, exactly. Figures unknown to an earlier version count as not published.

    Raises UnreadableCopyError for the copy of a version whose catalogue has other fields.
    """
    try:
        head = msgspec.json.decode(content, type=_Head)
        if head.format != FORMAT:
            raise UnreadableCopyError(
                f"the copy of the catalogue has format {head.format}, this version reads {FORMAT}"
            )
        return msgspec.json.decode(head.catalogue, type=Catalogue, dec_hook=_array)
    except msgspec.MsgspecError as error:
        raise UnreadableCopyError(f"the copy of the catalogue can’t be read: {error}") from None


def _encodable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise NotImplementedError(type(value).__name__)


def _array(kind: Any, value: Any) -> Any:
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise msgspec.ValidationError(f"{value!r:.60} is no list of numbers") from None
