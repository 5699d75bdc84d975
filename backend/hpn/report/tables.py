"""Tables of the report: duty cycle, what it and the gear come to, and the gear's published figures."""

from collections.abc import Sequence
from typing import Any

from hpn.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.reader import Reader
from hpn.report import inputs
from hpn.report.export import Export
from hpn.report.symbols import formula
from hpn.report.words import equation, measured
from hpn.selection import FIGURES
from hpn.units import suffix_of
from hpn.wording import N_, Sentence

MOST_PHASES = 20
"""Phases up to which each is listed; beyond, their range and sum."""

_ALWAYS, _WHERE_GIVEN = ("torque_Nm", "speed_rpm", "duration_s"), ("radial_N", "axial_N")

Column = Sequence[float | None]


def given(export: Export, paths: Sequence[str], reader: Reader) -> list[dict[str, Any]]:
    """Inputs that are given."""
    rows = inputs.given(export.application, paths, reader)
    return [{"label": row.label, "symbol": formula(row.symbol), "text": row.text} for row in rows]


def phases(export: Export, reader: Reader) -> dict[str, Any]:
    """The duty cycle: each phase, or of a long cycle least, largest and sum."""
    listed = export.application.duty_cycle.phases
    names = [*_ALWAYS, *(name for name in _WHERE_GIVEN if any(getattr(p, name) is not None for p in listed))]
    columns: list[Column] = [[getattr(phase, name) for phase in listed] for name in names]
    if len(listed) <= MOST_PHASES:
        cells = [["" if value is None else reader.exact(value) for value in column] for column in columns]
        rows, note = [[str(k), *row] for k, row in enumerate(zip(*cells, strict=True), 1)], ""
    else:
        rows = _summary(names, columns, reader)
        text = N_("{count} phases, summarised here; the workbook and the link have each.")
        note = reader.told(Sentence(text, {"count": reader.exact(len(listed))}))
    heads = [[formula(INPUTS[f"phase.{name}"].symbol), reader.unit(suffix_of(name) or "")] for name in names]
    return {"header": [[[], ""], *heads], "rows": rows, "note": note}


def _summary(names: Sequence[str], columns: Sequence[Column], reader: Reader) -> list[list[str]]:
    known = [[value for value in column if value is not None] for column in columns]
    sums = [reader.figure(sum(c)) if name == "duration_s" else "" for name, c in zip(names, known, strict=True)]
    return [
        [reader.text(N_("least")), *(reader.figure(min(column)) for column in known)],
        [reader.text(N_("largest")), *(reader.figure(max(column)) for column in known)],
        [reader.text(N_("sum")), *sums],
    ]


def derived(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Figures of the cycle and of the reported gear."""
    duty, candidate = export.selection.duty, export.candidate
    figures = [(name, DUTY[name], getattr(duty, name)) for name in DUTY]
    figures += [(name, CANDIDATE[name], getattr(candidate, name)) for name in FIGURES]
    lower_bound = export.is_lower_bound(candidate)
    loss_free = lower_bound and not export.follows_efficiency_curve(candidate)
    rows = []
    for name, named, value in figures:
        if value is not None:
            at_motor = name.startswith("motor_")
            bound = f", {reader.text(N_('lower bound'))}" if lower_bound and at_motor else ""
            rows.append(
                {
                    "label": reader.text(named.name) + bound,
                    "symbol": formula(named.symbol),
                    "text": measured(value, suffix_of(name) or "", reader),
                    "where": "η = 1" if loss_free and at_motor else equation(named.equation, reader),
                }
            )
    return rows


def ratings(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Published figures of the reported gear, each with its source."""
    gear = export.gear(export.candidate)
    return [
        {
            "label": reader.text(named.name),
            "symbol": formula(named.symbol),
            "text": reader.with_unit(reader.exact(value, unit), unit),
            "where": reader.source(gear.sources.get(name, "")),
        }
        for name, named in GEAR.items()
        if gear and (unit := suffix_of(name)) and (value := getattr(gear, name)) is not None
    ]
