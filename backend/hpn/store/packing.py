"""Compressing saved replies: some 80 kB of repetitive JSON become a tenth of that."""

import brotli
import zstandard


def packed(content: bytes) -> bytes:
    """A zstd frame of the content."""
    return zstandard.compress(content)


def unpacked(content: bytes) -> bytes:
    """Content of a zstd frame, or of a brotli stream as earlier versions wrote, which never begins like a frame."""
    if content.startswith(zstandard.FRAME_HEADER):
        return zstandard.decompress(content)
    stream: bytes = brotli.decompress(content)
    return stream
