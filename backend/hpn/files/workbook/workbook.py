"""Workbook of a selection: title block, checks, figures and notes, all inputs, every candidate, printed equations."""

import json
from collections.abc import Mapping
from io import BytesIO
from typing import Any

from hpn.account.over_tolerance import over_tolerance
from hpn.account.readings import CheckReading
from hpn.engine.tolerance_words import tolerance_of
from hpn.files.carried import parts_of
from hpn.files.export import Export
from hpn.files.words import catalogue_version
from hpn.files.workbook.candidates import write_candidates
from hpn.files.workbook.equations import write_equations
from hpn.files.workbook.inputs import write_inputs
from hpn.files.workbook.sheet import LONGEST_TEXT, ROW_POINTS, VERDICT_STYLES, Cell, SelectionSheet, new_book
from hpn.words.reader import Reader
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_

PROVED_WORD, SAMPLED_WORD = N_("proved"), N_("sampled")

WIDTHS = (38, 18, 13, 13, 9, 11, 14, 30)
"""Widths of the first sheet's columns in characters; the basis of each check stands behind them and is not printed."""

CARRIED = "hpn"
"""Name of the hidden sheet."""


def workbook(export: Export, reader: Reader) -> bytes:
    """Workbook of an export; the same bytes for the same selection."""
    content = BytesIO()
    book, styles = new_book(content, export)
    for name, write in (
        (N_("Selection"), _write_selection),
        (N_("Inputs"), write_inputs),
        (N_("Candidates"), write_candidates),
        (N_("Equations"), write_equations),
    ):
        if write is not write_equations or export.gear(export.candidate):
            write(SelectionSheet(book.add_worksheet(reader.text(name)), styles, export, reader))
    write_carried(book.add_worksheet(CARRIED), parts_of(export, reader))
    book.close()
    return content.getvalue()


def write_carried(sheet: Any, parts: Mapping[str, bytes]) -> None:
    """Write the parts that the workbook carries on a hidden sheet: a row for each part, in cells of ASCII.

    The file format takes `_x0041_` for a letter, and has room for some 32,000 characters in a cell.
    """
    sheet.very_hidden()
    for row, (name, part) in enumerate(parts.items()):
        text = json.dumps(json.loads(part), separators=(",", ":")).replace("_x", "\\u005fx")
        cells = [text[start : start + LONGEST_TEXT] for start in range(0, len(text), LONGEST_TEXT)]
        for column, cell in enumerate([name, *cells]):
            sheet.write_string(row, column, cell)


def _write_selection(sheet: SelectionSheet) -> None:
    _write_title_block(sheet)
    _write_checks(sheet)
    account = sheet.export.account
    sheet.lines(N_("Figures of the cycle"), account.cycle)
    sheet.lines(N_("Figures of the gear under the cycle"), account.figures)
    sheet.lines(N_("Published figures"), account.published)
    _write_tolerances(sheet)
    _write_notes(sheet)
    sheet.page(WIDTHS, columns=len(WIDTHS))


def _write_title_block(sheet: SelectionSheet) -> None:
    export, reader, heading = sheet.export, sheet.reader, sheet.export.heading
    sheet.put(0, heading.title or reader.text(N_("Untitled selection")), "title")
    sheet.sheet.set_row(0, 20)
    sheet.sheet.freeze_panes(1, 0)
    candidate, moment = export.candidate, export.moment
    block: dict[str, Cell] = {
        N_("Gear"): candidate.designation,
        N_("Ordering code"): heading.ordering_code,
        N_("Reference"): heading.reference,
        N_("Revision"): heading.revision,
        N_("Author"): heading.author,
        N_("Saved"): reader.date(export.created) if export.created else "",
        N_("Made, not saved"): reader.day(moment) if moment and not export.created else "",
        N_("Engine"): export.selection.engine_version,
        N_("Catalogue"): catalogue_version(export, reader),
        N_("Link"): export.link if len(export.link) < LONGEST_TEXT else "",
    }
    sheet.row = 1
    for label, value in block.items():
        if value:
            sheet.put(0, reader.text(label), "quiet")
            sheet.put(1, value)
            sheet.row += 1
    sheet.put(0, reader.text(N_("Verdict")), "quiet")
    sheet.put(1, reader.text(VERDICTS[candidate.status]), VERDICT_STYLES[candidate.status])
    sheet.put(2, candidate.utilisation, "share")
    sheet.row += 1


# --- Checks -----------------------------------------------------------------------------------------------------------

CHECK_HEADS = (
    N_("Check"),
    N_("Relation"),
    N_("Demand"),
    N_("Limit"),
    N_("Unit"),
    N_("Utilisation"),
    N_("Verdict"),
    N_("Source"),
    N_("Basis"),
)


def _write_checks(sheet: SelectionSheet) -> None:
    text = sheet.reader.text
    sheet.heads(N_("Checks"), *map(text, CHECK_HEADS), numbers=(2, 3, 5))
    for check in sheet.export.account.checks:
        definition, result, reading = check.definition, check.result, check.reading
        sheet.put(0, text(definition.title), "wrap")
        sheet.put(1, reading.relation, "quiet")
        for column, value in enumerate(_sides(sheet, reading), 2):
            sheet.put(column, value, "figure")
        sheet.put(4, sheet.reader.unit(reading.unit), "unit")
        sheet.put(5, result.utilisation, "share")
        sheet.put(6, text(VERDICTS[result.status]), VERDICT_STYLES[result.status])
        sheet.put(7, check.where(sheet.reader), "quiet")
        sheet.put(8, f"{text(definition.tests)} {text(definition.basis)}", "quiet")
        sheet.sheet.set_row(sheet.row, ROW_POINTS * (1 + len(text(definition.title)) // WIDTHS[0]))
        sheet.row += 1
    u = sheet.export.application.requirements.utilisation
    if u < 1:
        sheet.put(0, text(N_("Maximum utilisation")), "quiet")
        sheet.put(1, "u", "quiet")
        sheet.put(5, u, "share")
        sheet.row += 1


WORST_HEADS = (
    N_("Check"),
    N_("Case that is worst"),
    N_("Worst"),
    N_("Limit"),
    N_("Unit"),
    N_("Utilisation"),
    N_("Verdict"),
    N_("Basis"),
)
INPUT_HEADS = (N_("Input"), N_("Tolerance"), N_("Worst case, with it exact"), N_("Holds up to"))


def _write_tolerances(sheet: SelectionSheet) -> None:
    """Write the worst case of each check, and the tolerances with the figures of those that decide."""
    over, reader = over_tolerance(sheet.export.account), sheet.reader
    if over is None:
        return
    text = reader.text
    sheet.heads(N_("Over the whole tolerance"), *map(text, WORST_HEADS), numbers=(2, 3, 5))
    for line in over.checks:
        sides = ((N_("high"), line.high), (N_("low"), line.low))
        sheet.put(0, text(line.check.definition.title), "wrap")
        sheet.put(1, "; ".join(f"{text(word)} {', '.join(names)}" for word, names in sides if names), "quiet")
        for column, value in enumerate(_sides(sheet, line.reading) if line.reading else (), 2):
            sheet.put(column, value, "figure")
        sheet.put(4, reader.unit(line.check.reading.unit), "unit")
        sheet.put(5, line.worst, "share")
        sheet.put(6, text(VERDICTS[line.status]), VERDICT_STYLES[line.status])
        sheet.put(7, text(PROVED_WORD if line.is_exact else SAMPLED_WORD), "quiet")
        sheet.row += 1
    deciding = {line.tolerance.path: line for line in over.deciding}
    sheet.heads(N_("Tolerances"), *map(text, INPUT_HEADS), numbers=(2,))
    for each in over.tolerances:
        one = deciding.get(each.path)
        sheet.put(0, reader.sentence(each.place))
        sheet.put(1, each.text(reader), "quiet")
        if one:
            sheet.put(2, one.worst, "share")
            sheet.put(3, each.text(reader, one.allowed) if one.allowed else "", "quiet")
        sheet.row += 1
    for sentence in (*([over.growth] if over.growth else []), *over.failing):
        sheet.note(reader.sentence(sentence), WIDTHS)


def _sides(sheet: SelectionSheet, reading: CheckReading) -> tuple[Cell, Cell]:
    """Demand and limit; the word “unlimited” for a side without a bound."""
    unlimited = sheet.reader.text(N_("unlimited"))
    demand, limit = (sheet.reader.value(value, reading.unit) for value in (reading.demand, reading.limit))
    return unlimited if reading.has_unlimited_demand else demand, unlimited if reading.has_unlimited_limit else limit


def _write_notes(sheet: SelectionSheet) -> None:
    sheet.heads(N_("Assumptions and notes"))
    if of_worst := tolerance_of(sheet.export.candidate):
        sheet.note(sheet.reader.sentence(of_worst), WIDTHS)
    for notice in sheet.export.selection.notices:
        sheet.note(sheet.reader.sentence(notice.sentence), WIDTHS)
