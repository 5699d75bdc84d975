"""Replies packed for keeping: some 80 kB of repetitive JSON become an eleventh of that."""

import threading

import brotli
import zstandard

LEVEL = 1
"""Of zstd; others pack little better, or little faster."""


class _Contexts(threading.local):
    """What packs and unpacks; no two threads may share it."""

    def __init__(self) -> None:
        self.compressor = zstandard.ZstdCompressor(level=LEVEL)
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
