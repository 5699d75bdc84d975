"""Replies packed for keeping: some 80 kB of repetitive JSON become a ninth of that."""

import threading

import brotli
import zstandard

PARAMETERS = zstandard.ZstdCompressionParameters.from_level(-1, min_match=7)
"""Of zstd, for speed: what recurs in a reply is long, and shorter matches are not worth looking for."""


class _Contexts(threading.local):
    """What packs and unpacks; no two threads may share it."""

    def __init__(self) -> None:
        self.compressor = zstandard.ZstdCompressor(compression_params=PARAMETERS)
        self.decompressor = zstandard.ZstdDecompressor()


_contexts = _Contexts()


def packed(content: bytes) -> bytes:
    """A zstd frame."""
    return _contexts.compressor.compress(content)


def unpacked(content: bytes) -> bytes:
    """What was packed, also by versions that made brotli streams, which never begin as a frame does."""
    if content.startswith(zstandard.FRAME_HEADER):
        return _contexts.decompressor.decompress(content)
    stream: bytes = brotli.decompress(content)
    return stream
