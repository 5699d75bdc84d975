"""Files without a part of theirs, or with another one, as other programs and earlier versions leave them."""

from collections.abc import Callable
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import openpyxl
from pikepdf import Pdf

from hpn.files.carried import DOCUMENT
from hpn.files.workbook.workbook import CARRIED


def rezipped(content: bytes, alter: Callable[[str, bytes], bytes], zeros: tuple[str, int] | None = None) -> bytes:
    """The zipped file with its parts altered, and with a part of so many megabytes of zeros."""
    packed = BytesIO()
    with ZipFile(BytesIO(content)) as source, ZipFile(packed, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            target.writestr(name, alter(name, source.read(name)))
        if zeros:
            target.writestr(zeros[0], bytes(zeros[1] * 1_000_000))
    return packed.getvalue()


def without_attachments(content: bytes) -> bytes:
    """The report without the parts attached to it."""
    packed = BytesIO()
    with Pdf.open(BytesIO(content)) as pdf:
        for name in list(pdf.attachments):
            del pdf.attachments[name]
        pdf.save(packed)
    return packed.getvalue()


def without_sheet(content: bytes) -> bytes:
    """The workbook without the sheet that is not shown, with the values that a program of tables keeps."""
    book = openpyxl.load_workbook(BytesIO(content), data_only=True)
    del book[CARRIED]
    packed = BytesIO()
    book.save(packed)
    return packed.getvalue()


def without_title_block(content: bytes) -> bytes:
    """The package without its title block, gear and reader."""
    packed = BytesIO()
    with ZipFile(BytesIO(content)) as source, ZipFile(packed, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            if not name.endswith(f"/{DOCUMENT}"):
                target.writestr(name, source.read(name))
    return packed.getvalue()


WITHOUT: dict[str, Callable[[bytes], bytes]] = {
    "pdf": without_attachments,
    "xlsx": without_sheet,
    "aasx": without_title_block,
}
