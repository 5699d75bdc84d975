"""Checks of the reported gear and the equations behind them: symbols, numbers, limits and sources."""

from typing import Any

from hpn.account.account import Account, CheckLine
from hpn.account.readings import CheckReading
from hpn.engine.checks import CHECKS
from hpn.explain.calculation import Comparison, Step, calculation_of
from hpn.explain.calculation.mathml import addition, compared, in_symbols, result, substituted
from hpn.files.export import Export
from hpn.files.words import exact_percent, quantity_text
from hpn.words.reader import Reader
from hpn.words.symbols import formula, sentence
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_, Sentence

Row = dict[str, Any]

ORDER = {check.code: place for place, check in enumerate(CHECKS)}
WITH_STEPS = frozenset({"average_torque", "life", "output_bearing_life"})
"""Checks whose equation carries their basis as a note."""

AS_LIMITED = frozenset({"repeated_peak_torque", "motor_speed", "motor_rated_speed"})
"""Checks whose basis is only the source of their limit."""


def checks(export: Export, reader: Reader) -> list[Row]:
    """All checks and equations of the gear, in the order of the checks; without the gear's figures no equations."""
    steps, last, rows = _steps(export), -1, list[tuple[int, Row]]()
    for step in steps:
        last = ORDER.get(step.code, last)
        rows.append((last, _of_step(step, export, reader)))
    codes = {step.code for step in steps}
    limits = {limit.code: limit for step in steps for limit in step.comparisons}
    for check in export.account.checks:
        if check.code not in codes:
            rows.append((ORDER.get(check.code, len(ORDER)), _of_check(check, limits.get(check.code), reader)))
    return [row for _, row in sorted(rows, key=lambda row: row[0])]


def limits(account: Account, reader: Reader) -> list[Row]:
    """All checks of the gear with demand and limit, without equations."""
    return [_of_check(check, None, reader) for check in account.checks]


def bases(export: Export, reader: Reader) -> list[tuple[str, Any]]:
    """Title and basis of each check, except where they stand beside its equation or limit."""
    codes = AS_LIMITED | (WITH_STEPS & {step.code for step in _steps(export)})
    return [
        (reader.text(check.definition.title), sentence(reader.text(check.definition.basis)))
        for check in export.account.checks
        if check.code not in codes
    ]


def _steps(export: Export) -> tuple[Step, ...]:
    gear = export.gear(export.candidate)
    if gear is None or export.figures is None:
        return ()
    return calculation_of(export.candidate, export.selection.duty, gear, export.application, export.figures)


def _of_step(step: Step, export: Export, reader: Reader) -> Row:
    check = export.account.check(step.code)
    limit = next((limit for limit in step.comparisons if limit.code == step.code), None)
    lines = [
        {"symbols": in_symbols(reader, line), "numbers": substituted(reader, line), "result": result(reader, line)}
        for line in step.lines
    ]
    row = _of_check(check, limit, reader) if check else _row(step.code)
    if limit and step.lines and limit.tested == step.lines[-1].result:
        lines[-1]["result"], row["limit_formula"] = compared(reader, limit, continued=True), ""
    return row | {
        "number": step.equation or "",
        "title": sentence(reader.text(step.title)),
        "lines": lines,
        "sums": _sums(step, reader),
        "where": row["where"] or ("" if step.equation else reader.text(N_("Not printed in the handbook."))),
        "notes": [sentence(reader.sentence(note)) for note in step.notes],
    }


def _sums(step: Step, reader: Reader) -> Row | None:
    """Columns of a step's sums over the phases; None without sums."""
    sums = addition(reader, step)
    if sums is None:
        return None
    note = reader.text(N_("Only some of the %(count)s phases are written out; the result includes all of them."))
    rows = [[str(place), *values] for place, values in sums.rows]
    return {
        "heads": [math for math, _ in sums.heads],
        "rows": [*rows, ["Σ", *sums.totals]],
        "note": note % {"count": len(sums.rows) + sums.left_out} if sums.left_out else "",
    }


def _row(code: str) -> Row:
    blank: Row = dict.fromkeys(("number", "limit_formula", "demand", "sign", "limit", "where"), "")
    return blank | {"code": code, "relation": [], "lines": [], "notes": [], "check": None, "sums": None}


def _of_check(check: CheckLine, limit: Comparison | None, reader: Reader) -> Row:
    """Row of a check: its limit as an equation, the figures that the equation lacks, and its bar."""
    reading, result = check.reading, check.result
    row = _row(check.code) | {
        "number": check.definition.equation or "",
        "title": sentence(reader.text(check.definition.title)),
        "where": reader.source((limit.source or "your input") if limit else check.source),
        "check": {
            **bar(result.utilisation, check.bound, result.status, reader),
            "word": reader.text(VERDICTS[result.status]),
            "governs": check.governs,
        },
    }
    if limit:
        row["limit_formula"] = compared(reader, limit)
        if reading.demand == limit.value:
            return row
    texts = {"demand": demand(reading, reader), "sign": reading.sign, "limit": bounds(reading, reader)}
    return row | {"relation": formula(reading.relation), **texts}


def bar(utilisation: float | None, bound: float, status: str, reader: Reader, worst: float | None = None) -> Row:
    """Utilisation as a bar and as a number, with a whisker to the worst case; a full bar where a check fails without
    a number."""
    share = utilisation if utilisation is not None else 2.0 if status in ("fail", "unsuitable") else 0.0
    drawn = {"share": share, "bound": bound, "status": status, "whisker": share if worst is None else worst}
    return drawn | {"utilisation": reader.percent(utilisation, bound)}


# --- Demand and limit in words ----------------------------------------------------------------------------------------


def bounds(reading: CheckReading, reader: Reader) -> str:
    """Limit of a check, and the share of it that the user's utilisation u leaves."""
    if reading.has_unlimited_limit:
        return reader.text(N_("unlimited"))
    part = (
        f" {'÷' if reading.kind == 'minimum' else '×'} {exact_percent(reading.part, reader)}"
        if reading.part < 1
        else ""
    )
    return quantity_text(reading.limit, reading.unit, reader, reading.demand) + part


def demand(reading: CheckReading, reader: Reader) -> str:
    """Demand of a check, with its unit."""
    if reading.has_unlimited_demand:
        return reader.text(N_("unlimited"))
    return quantity_text(reading.demand, reading.unit, reader, reading.bound)


def failures(account: Account, reader: Reader) -> str:
    """Failed checks of a gear, for the middle of a sentence."""
    return "; ".join(
        reader.sentence(
            Sentence(
                N_("{check} {demand}, limit {limit} ({percent})"),
                {
                    "check": reader.text(check.definition.title),
                    "demand": demand(check.reading, reader),
                    "limit": bounds(check.reading, reader),
                    "percent": reader.percent(check.result.utilisation, check.bound),
                },
            )
        )
        for check in account.checks
        if check.result.status == "fail"
    )
