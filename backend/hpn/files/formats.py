"""Formats of files: the maker of each, and the extras that it needs."""

from pkgutil import resolve_name
from typing import Any, NamedTuple

from hpn.words.reader import Reader


class FileFormat(NamedTuple):
    """Format of a file; its maker is only named, `module:function`, so that a caller that makes no file loads nothing.

    The first of its extras is its own; the others are shared with other parts of the program.
    """

    maker: str
    extras: tuple[str, ...]
    is_translated: bool = True

    def content(self, export: Any, reader: Reader, **chosen: Any) -> bytes:
        """File of an export, in the reader's language where the format has one."""
        content: bytes = resolve_name(self.maker)(export, *([reader] if self.is_translated else []), **chosen)
        return content


PDF = FileFormat("hpn.files.report.pdf:pdf", ("report", "serve"))
WORKBOOK = FileFormat("hpn.files.workbook.workbook:workbook", ("serve",))
PACKAGE = FileFormat("hpn.files.aas.submodel:package", ("aas", "serve"), is_translated=False)
