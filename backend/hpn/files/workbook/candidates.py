"""Sheet of all candidates, best first: verdict and utilisations, then computed and published figures."""

from hpn.account.account import Account
from hpn.files.workbook.sheet import VERDICT_STYLES, SelectionSheet
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_

IDENTITY = (N_("Gear"), N_("Verdict"), N_("Utilisation"), N_("Rank"))
HEAD_POINTS = 80
"""Height of the headings, in points: titles of checks need it in narrow columns."""

WIDTH, CHECK_WIDTH, MOST_ACROSS = 12.0, 10.0, 17
"""Widths of columns in characters, and the number of checks that fit across a page."""


def write_candidates(sheet: SelectionSheet) -> None:
    """Write the sheet; its first columns, up to the checks, are printed."""
    export, text = sheet.export, sheet.reader.text
    definitions = export.selection.check_definitions
    accounts = [export.account.of(candidate) for candidate in export.selection.candidates]
    lines = [line for account in accounts for line in (*account.figures, *account.published)]
    columns = {line.code: line for line in lines if line.value is not None or line.kind == "published"}
    codes = [code for code in dict.fromkeys(line.code for line in lines) if code in columns]
    heads = [*map(text, IDENTITY), *(text(definition.title) for definition in definitions.values())]
    heads += [sheet.head(columns[code].named.symbol or columns[code].label(sheet.reader), code) for code in codes]
    for column, head in enumerate(heads):
        sheet.put(column, head, "head")
    sheet.sheet.set_row(0, HEAD_POINTS)
    sheet.sheet.freeze_panes(1, 1)
    sheet.sheet.repeat_rows(0)
    sheet.sheet.repeat_columns(0)
    for account in accounts:
        sheet.row += 1
        _write_candidate(sheet, account, list(definitions), codes)
    sheet.sheet.autofilter(0, 0, sheet.row, len(heads) - 1)
    checks = len(IDENTITY) + len(definitions)
    widths = (13, 14, 11, 7, *[CHECK_WIDTH] * len(definitions), *[WIDTH] * (len(heads) - checks))
    sheet.page(widths, across=True, pages=1 + (len(definitions) > MOST_ACROSS), columns=checks)


def _write_candidate(sheet: SelectionSheet, account: Account, checks: list[str], figures: list[str]) -> None:
    candidate = account.candidate
    sheet.put(0, candidate.designation)
    sheet.put(1, sheet.reader.text(VERDICTS[candidate.status]), VERDICT_STYLES[candidate.status])
    sheet.put(2, candidate.utilisation, "share")
    sheet.put(3, candidate.rank, "figure")
    for column, code in enumerate(checks, len(IDENTITY)):
        check = candidate.check(code)
        sheet.put(column, check.utilisation if check else None, "share")
    for column, code in enumerate(figures, len(IDENTITY) + len(checks)):
        if line := account.line(code):
            sheet.put(column, line.value_for(sheet.reader), "figure")
