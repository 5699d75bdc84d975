"""The workbook: the whole selection with live formulas, so that a changed torque changes every figure behind it."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from io import BytesIO
from typing import Any

import xlsxwriter

from hpn.files.export import Export
from hpn.files.motion import MOTION_TITLE
from hpn.files.workbook.candidates import CandidatesSheet
from hpn.files.workbook.formulas import NOT_RATED, UNLIMITED
from hpn.files.workbook.inputs_sheet import InputsSheet
from hpn.files.workbook.motion_sheet import write_motion
from hpn.files.workbook.overview import Overview
from hpn.files.workbook.sheets import FONT, Book
from hpn.files.workbook.unchanged import write_unchanged
from hpn.words.reader import Reader
from hpn.words.wording import N_

UNDATED = datetime(1980, 1, 1)
"""Creation time of the workbook of a selection that is not saved: the earliest that its container can hold."""


def workbook(export: Export, reader: Reader) -> bytes:
    """The workbook on an export; the same bytes for the same selection."""
    file = BytesIO()
    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "nan_inf_to_errors": False}
    book = xlsxwriter.Workbook(file, options | {"default_format_properties": dict(FONT)})
    created = export.created.astimezone(UTC).replace(tzinfo=None) if export.created else UNDATED
    book.set_properties(
        {"title": export.heading.title, "author": export.heading.author or "HPN Select", "created": created}
    )
    book.set_calc_mode("auto")
    _fill(Book(book, export, replace(reader, units=()), reader, words(reader)))
    book.close()
    return file.getvalue()


def words(reader: Reader) -> Mapping[str, str]:
    """Words that formulas write, by their English ones."""
    english = (UNLIMITED, NOT_RATED, N_("passes"), N_("fails"), N_("suitable"), N_("unsuitable"), N_("unrated"))
    return {word: reader.text(word) for word in english}


def _fill(book: Book) -> None:
    overview, inputs = (_sheet(book, name) for name in (N_("Selection"), N_("Inputs")))
    InputsSheet(book, inputs).write()
    if (motion := book.export.application.duty_cycle.motion) is not None:
        write_motion(book, _sheet(book, MOTION_TITLE), motion)
    sheet = Overview(book, overview, CandidatesSheet(book, _sheet(book, N_("Candidates"))).write())
    sheet.write()
    if sheet.fixed:
        write_unchanged(book, _sheet(book, N_("As saved")), sheet.fixed)
    overview.activate()


def _sheet(book: Book, name: str) -> Any:
    return book.file.add_worksheet(book.reader.text(name))
