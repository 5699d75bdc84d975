"""Zipped file, such as a workbook or a package: its parts, within bounds."""

import zlib
from collections.abc import Mapping
from io import BytesIO
from zipfile import BadZipFile, ZipFile

from hpn.verify.shown import UnreadableFileError

MOST_BYTES = 200_000_000
"""Most bytes of all parts, unpacked."""


def unpacked(content: bytes, *, form: str, below: str = "") -> Mapping[str, bytes]:
    """Parts of a zipped file in the folder `below`, by their names; raises UnreadableFileError, which names the
    form."""
    try:
        with ZipFile(BytesIO(content)) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
                raise UnreadableFileError(f"the {form} holds more than {MOST_BYTES} bytes")
            return {name: archive.read(name) for name in archive.namelist() if name.startswith(below)}
    except (BadZipFile, zlib.error, OSError, ValueError, NotImplementedError, RuntimeError, EOFError) as error:
        raise UnreadableFileError.of(form, error) from None
