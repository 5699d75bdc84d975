"""Replies packed for keeping: some 80 kB of repetitive JSON become a ninth of that."""

import threading

import brotli
import zstandard

SHORT_BYTES = 16_384
"""Up to here packing costs more than writing what it would save."""

_FAST = zstandard.ZstdCompressionParameters.from_level(-1, min_match=7, hash_log=12)
"""What recurs in a reply is long: shorter matches are not worth looking for, nor a table beyond the first cache."""
_AS_IT_IS = -1000
"""A level at which zstd looks for next to nothing."""


class _Contexts(threading.local):
    """What packs and unpacks; no two threads may share it."""

    def __init__(self) -> None:
        self.packer = zstandard.ZstdCompressor(compression_params=_FAST)
        self.framer = zstandard.ZstdCompressor(level=_AS_IT_IS)
        self.unpacker = zstandard.ZstdDecompressor()


_contexts = _Contexts()


def packed(content: bytes) -> bytes:
    """A zstd frame, in which a short reply stands almost as it is."""
    return (_contexts.packer if len(content) > SHORT_BYTES else _contexts.framer).compress(content)


def unpacked(content: bytes) -> bytes:
    """What was packed, also by versions that made brotli streams, which never begin as a frame does."""
    if content.startswith(zstandard.FRAME_HEADER):
        return _contexts.unpacker.decompress(content)
    stream: bytes = brotli.decompress(content)
    return stream
