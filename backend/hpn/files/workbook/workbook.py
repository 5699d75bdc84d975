"""The workbook: the whole selection with live formulas, so that a changed torque changes every figure behind it."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from io import BytesIO
from typing import Any

import xlsxwriter

from hpn.files.export import Export
from hpn.files.motion import MOTION_TITLE
from hpn.files.words import catalogue_version
from hpn.files.workbook.candidates import CandidatesSheet
from hpn.files.workbook.formulas import NOT_RATED, UNLIMITED
from hpn.files.workbook.motion_sheet import write_motion
from hpn.files.workbook.overview import Overview
from hpn.files.workbook.sheets import Book, CycleSheet
from hpn.files.workbook.unchanged import write_unchanged
from hpn.words.reader import Reader
from hpn.words.wording import N_

UNDATED = datetime(1980, 1, 1)
"""Creation time of the workbook of a selection that is not saved: the earliest that its container can hold."""

LINE_POINTS, CHARACTERS_PER_LINE = 15, 95
"""Height and length of a line of a note: no reader of the file fits the row to its text by itself."""


def workbook(export: Export, reader: Reader) -> bytes:
    """The workbook on an export; the same bytes for the same selection."""
    file = BytesIO()
    book = xlsxwriter.Workbook(
        file, {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "nan_inf_to_errors": False}
    )
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
    overview, cycle = (_sheet(book, name) for name in (N_("Selection"), N_("Duty cycle")))
    CycleSheet(book, cycle).write()
    if (motion := book.export.application.duty_cycle.motion) is not None:
        write_motion(book, _sheet(book, MOTION_TITLE), motion)
    candidates, notes = (_sheet(book, name) for name in (N_("Candidates"), N_("Notes")))
    rows = CandidatesSheet(book, candidates).write()
    sheet = Overview(book, overview, rows)
    sheet.write()
    if sheet.fixed:
        write_unchanged(book, _sheet(book, N_("As saved")), sheet.fixed)
    _notes(book, notes)
    overview.activate()


def _sheet(book: Book, name: str) -> Any:
    return book.file.add_worksheet(book.reader.text(name))


def _notes(book: Book, sheet: Any) -> None:
    """Every assumption, and what each check stands on."""
    text, export = book.reader.text, book.export
    sheet.set_column(0, 0, 34)
    sheet.set_column(1, 1, 110)
    sheet.freeze_panes(1, 0)
    sheet.write_row(0, 0, [text(N_("Subject")), text(N_("Assumptions and notes"))], book.style("head"))
    rows = [("", book.shown.told(notice.sentence)) for notice in export.selection.notices]
    for definition in export.selection.check_definitions.values():
        rows.append((text(definition.title), f"{text(definition.tests)} {text(definition.basis)}"))
    rows += [
        (text(N_("Engine")), export.selection.engine_version),
        (text(N_("Catalogue")), catalogue_version(export, book.reader)),
    ]
    for row, (subject, note) in enumerate(rows, 1):
        sheet.write_string(row, 0, subject, book.style("label"))
        sheet.write_string(row, 1, note, book.style("wrap"))
        sheet.set_row(row, LINE_POINTS * (1 + len(note) // CHARACTERS_PER_LINE))
    sheet.repeat_rows(0)
    book.page(sheet)
