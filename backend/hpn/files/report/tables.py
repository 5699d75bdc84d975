"""Tables of the report: duty cycle, figures of cycle and gear, and the gear's published figures."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from hpn.account import inputs
from hpn.account.inputs import InputLine
from hpn.account.motion import MOVES, lines, moves_of, written
from hpn.account.readings import AT_MOTOR, figure_symbol
from hpn.application import DutyCycle
from hpn.application.phase import Phase
from hpn.engine.candidates import FIGURES
from hpn.files.export import Export
from hpn.files.words import measured
from hpn.words.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.words.reader import Reader
from hpn.words.symbols import formula, sentence
from hpn.words.titles import row_label
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Sentence

MOST_PHASES = 20
"""Phases up to which each is listed; beyond, their range and sum."""

_ALWAYS = ("torque_Nm", "speed_rpm", "duration_s")
_WHERE_GIVEN = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "least_torque_Nm", "radial_N", "axial_N")

Column = Sequence[float | None]


def given(export: Export, paths: Sequence[str], reader: Reader) -> list[dict[str, Any]]:
    """Inputs that are given."""
    return _lines(inputs.given(export.equipped, paths, reader))


def _lines(rows: Iterable[InputLine]) -> list[dict[str, Any]]:
    return [{"label": row.label, "symbol": formula(row.symbol), "text": row.text} for row in rows]


def phases(export: Export, reader: Reader) -> dict[str, Any]:
    """The duty cycle: each phase, or of a long cycle least, largest and sum."""
    cycle = export.application.duty_cycle
    listed, number = cycle.load_phases, number_of(cycle, reader)
    given, places = columns(listed), numbers(cycle, reader)
    if len(listed) <= MOST_PHASES:
        cells = [
            ["" if value is None else number(value, suffix_of(name)) for value in column]
            for name, column in given.items()
        ]
        rows, note = [[*row] for row in zip(*places.values(), *cells, strict=True)], ""
    else:
        rows = [[label, *[""] * (len(places) - 1), *row] for label, *row in _summary(given, reader)]
        text = N_("{count} phases, summarised here; each is listed on the last pages.")
        note = reader.told(Sentence(text, {"count": reader.exact(len(listed))}))
    heads = [[formula(INPUTS[f"phase.{name}"].symbol), reader.unit(suffix_of(name))] for name in given]
    header = [*([[], name] for name in places), *heads]
    return {"header": header, "rows": rows, "note": note, "words": len(places)}


def numbers(cycle: DutyCycle, reader: Reader) -> dict[str, list[str]]:
    """Number and name of each phase, in a motion of the move it is a part of, by the heads of their columns."""
    phases, motion = cycle.load_phases, cycle.motion
    if motion is None:
        return {reader.text(N_("Phase")): [row_label(place, phase.name) for place, phase in enumerate(phases)]}
    return {
        reader.text(N_("Phase")): [str(place) for place, _ in enumerate(phases, 1)],
        reader.text(N_("Move")): [row_label(move, motion.moves[move].name) for move in motion.course.move.tolist()],
    }


def number_of(cycle: DutyCycle, reader: Reader) -> Callable[[float, str], str]:
    """How the figures of phases are written: as they were given, or rounded where they come out of a motion."""
    return reader.exact if cycle.motion is None else reader.figure


def columns(phases: Sequence[Phase]) -> dict[str, Column]:
    """Columns of the duty cycle by field: what each phase says, and None where it says nothing."""
    optional = (name for name in _WHERE_GIVEN if any(getattr(phase, name) is not None for phase in phases))
    return {name: [getattr(phase, name) for phase in phases] for name in (*_ALWAYS, *optional)}


def motion(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Mechanism and moves as they were given; of many moves their number alone. None where phases were given."""
    given = export.application.duty_cycle.motion
    if given is None:
        return None
    mechanism = _lines(lines(given, reader))
    columns = moves_of(given)
    heads = [
        [
            formula(MOVES[name].symbol),
            reader.unit(suffix_of(name)) if MOVES[name].symbol else reader.text(MOVES[name].name),
        ]
        for name in columns
    ]
    rows, note = [], ""
    if len(given.moves) <= MOST_PHASES:
        cells = [[written(value, name, reader) for value in column] for name, column in columns.items()]
        rows = [[row_label(k, given.moves[k].name), *row] for k, row in enumerate(zip(*cells, strict=True))]
    else:
        text = N_("{count} moves; each is listed on the last pages.")
        note = reader.told(Sentence(text, {"count": reader.exact(len(given.moves))}))
    header = [[[], reader.text(N_("Move"))], *heads]
    return {"mechanism": mechanism, "moves": {"header": header, "rows": rows, "note": note, "words": 2}}


def _summary(given: Mapping[str, Column], reader: Reader) -> list[list[str]]:
    known = {name: [value for value in column if value is not None] for name, column in given.items()}
    sums = [reader.figure(sum(values)) if name == "duration_s" else "" for name, values in known.items()]
    return [
        [reader.text(N_("least")), *(reader.figure(min(values), suffix_of(name)) for name, values in known.items())],
        [reader.text(N_("largest")), *(reader.figure(max(values), suffix_of(name)) for name, values in known.items())],
        [reader.text(N_("sum")), *sums],
    ]


def of_cycle(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Figures of the cycle."""
    duty = export.selection.duty
    figures = [(DUTY[name], name, getattr(duty, name)) for name in DUTY]
    figures.append((INPUTS["requirements.load_inertia_kgm2"], "load_inertia_kgm2", duty.load_inertia_kgm2))
    return [_line(named.name, named.symbol, name, value, reader) for named, name, value in figures if value is not None]


def of_gear(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Figures of the reported gear under the cycle."""
    candidate, turns = export.candidate, export.selection.turns_motor
    typed = ("stop_torque_Nm",) if candidate.stopping_time_s is None else ()  # stands with the inputs
    bound = f", {reader.text(N_('lower bound'))}" if export.is_lower_bound(candidate) else ""
    return [
        _line(
            CANDIDATE[name].name,
            figure_symbol(name, turns_motor=turns),
            name,
            value,
            reader,
            bound if name in AT_MOTOR else "",
        )
        for name in FIGURES
        if name not in typed and (value := getattr(candidate, name)) is not None
    ]


def _line(label: str, symbol: str, name: str, value: float, reader: Reader, note: str = "") -> dict[str, Any]:
    text = measured(value, suffix_of(name), reader)
    return {"label": sentence(reader.text(label) + note), "symbol": formula(symbol), "text": text}


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
