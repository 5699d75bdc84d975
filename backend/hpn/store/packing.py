"""Replies packed for keeping: always a brotli stream, in which a short reply stands as it is."""

import brotli

SHORT_BYTES = 16_384
"""Up to here packing costs more than writing what it would save."""

UNCOMPRESSED = 1 << 20
END = b"\x03"


def packed(content: bytes) -> bytes:
    """A brotli stream of a reply; some 70 kB of repetitive JSON become a ninth of that."""
    if not 0 < len(content) <= SHORT_BYTES:
        stream: bytes = brotli.compress(content, quality=0)
        return stream
    # RFC 7932, 9.1 and 9.2: a window of 16 bits, one uncompressed meta-block of so many bytes, and an empty last one.
    return (UNCOMPRESSED | (len(content) - 1) << 4).to_bytes(3, "little") + content + END


def unpacked(stream: bytes) -> bytes:
    """What was packed."""
    content: bytes = brotli.decompress(stream)
    return content
