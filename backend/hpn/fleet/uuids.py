"""UUIDs of Arrow as names of axes: text in between, and UUIDs again in files with that type."""

from uuid import UUID

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

BYTES, CHARACTERS = 16, 36
DIGITS = np.frombuffer(b"0123456789abcdef", np.uint8)
PLACES = np.flatnonzero([mark != "-" for mark in str(UUID(int=0))])
"""Places of the digits in a text."""


def is_uuid(type: pa.DataType) -> bool:
    """True for the Arrow type of UUIDs."""
    return isinstance(type, pa.UuidType)


def text_of(uuids: pa.Array) -> pa.Array:
    """UUIDs as text, in the form of RFC 9562."""
    stored = pc.fill_null(uuids.storage, bytes(BYTES))
    count = len(stored)
    content = np.frombuffer(stored.buffers()[1], np.uint8, BYTES * count, BYTES * stored.offset).reshape(count, BYTES)
    text = np.full((count, CHARACTERS), ord("-"), np.uint8)
    text[:, PLACES[::2]], text[:, PLACES[1::2]] = DIGITS[content >> 4], DIGITS[content & 15]
    starts = np.arange(count + 1, dtype=np.int32) * CHARACTERS
    texts = pa.Array.from_buffers(pa.string(), count, [None, pa.py_buffer(starts), pa.py_buffer(text.tobytes())])
    return pc.if_else(uuids.is_valid(), texts, pa.scalar(None, pa.string()))


def uuids_of(texts: pa.ChunkedArray) -> pa.Array:
    """UUIDs of texts."""
    values = [None if text is None else UUID(text).bytes for text in texts.to_pylist()]
    return pa.ExtensionArray.from_storage(pa.uuid(), pa.array(values, pa.binary(BYTES)))
