"""The sheet of all candidates, best first: verdict and utilisations, then computed and published figures."""

from hpn.account.readings import figure_symbol, shortest_life
from hpn.engine.candidates import FIGURES, Candidate
from hpn.files.workbook.sheet import VERDICT_STYLES, Sheet
from hpn.words.quantities import CANDIDATE, GEAR
from hpn.words.terms import VERDICTS
from hpn.words.units import suffix_of
from hpn.words.wording import N_

IDENTITY = (N_("Gear"), N_("Verdict"), N_("Utilisation"), N_("Rank"))
HEAD_POINTS = 80
"""Height of the heads, which have titles of checks in narrow columns."""

WIDTH, CHECK_WIDTH, MOST_ACROSS = 12.0, 10.0, 17
"""Widths of columns in characters, and the number of checks that a page across has room for."""


def write_candidates(sheet: Sheet) -> None:
    """Write the sheet; its first columns, up to the checks, are printed."""
    export, text = sheet.export, sheet.reader.text
    definitions, candidates = export.selection.check_definitions, export.selection.candidates
    known = [name for name in FIGURES if any(getattr(candidate, name) is not None for candidate in candidates)]
    published = [name for name in GEAR if suffix_of(name)] if export.figures else []
    turns = export.selection.turns_motor
    heads = [*map(text, IDENTITY), *(text(definition.title) for definition in definitions.values())]
    heads += [sheet.head(figure_symbol(name, turns_motor=turns) or text(CANDIDATE[name].name), name) for name in known]
    heads += [sheet.head(GEAR[name].symbol or text(GEAR[name].name), name) for name in published]
    for column, head in enumerate(heads):
        sheet.put(column, head, "head")
    sheet.sheet.set_row(0, HEAD_POINTS)
    sheet.sheet.freeze_panes(1, 1)
    sheet.sheet.repeat_rows(0)
    sheet.sheet.repeat_columns(0)
    for candidate in candidates:
        sheet.row += 1
        _write_candidate(sheet, candidate, list(definitions), known, published)
    sheet.sheet.autofilter(0, 0, sheet.row, len(heads) - 1)
    checks = len(IDENTITY) + len(definitions)
    widths = (13, 14, 11, 7, *[CHECK_WIDTH] * len(definitions), *[WIDTH] * (len(heads) - checks))
    sheet.page(widths, across=True, pages=1 + (len(definitions) > MOST_ACROSS), columns=checks)


def _write_candidate(
    sheet: Sheet, candidate: Candidate, codes: list[str], known: list[str], published: list[str]
) -> None:
    sheet.put(0, candidate.designation)
    sheet.put(1, sheet.reader.text(VERDICTS[candidate.status]), VERDICT_STYLES[candidate.status])
    sheet.put(2, candidate.utilisation, "share")
    sheet.put(3, candidate.rank, "figure")
    for column, code in enumerate(codes, len(IDENTITY)):
        check = candidate.check(code)
        sheet.put(column, check.utilisation if check else None, "share")
    place = len(IDENTITY) + len(codes)
    for column, name in enumerate(known, place):
        life = shortest_life(candidate) if name == "shortest_life_h" else None
        endless = candidate.is_unlimited(name) or (life is not None and life.life_h is None)
        value = N_("unlimited") if endless else getattr(candidate, name)
        sheet.put(column, sheet.shown(value, suffix_of(name)), "figure")
    gear = sheet.export.gear(candidate)
    for column, name in enumerate(published if gear else (), place + len(known)):
        sheet.put(column, sheet.shown(getattr(gear, name), suffix_of(name)), "figure")
