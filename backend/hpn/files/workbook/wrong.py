"""Formulas that find inputs which the service would refuse: 1 for a wrong cell and 0 for a right one.

A formula takes cells or whole columns of the duty cycle: it multiplies conditions, since SUMPRODUCT takes no AND or IF.
"""

import math
from collections.abc import Mapping
from typing import Any

from hpn.application import LEAST_MOTION
from hpn.application.input_fields import PHASE_FIELDS, PHASE_FIGURES, InputField
from hpn.application.phase import ROOM
from hpn.words.fields import LEAST
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence

WRONG = "wrong_inputs"
"""Name of the cell that counts the wrong inputs."""

REMARKS = "remarks"
"""Name of the remarks on inputs, each blank while its input is right."""

BENEATH = "beneath_phases"
"""Name of the rows beneath the last of the duty cycle."""

_PEAK = '(ABS({torque_Nm})*({peak_torque_Nm}="")+{peak_torque_Nm})'
_FITS: Mapping[str, str] = {
    "peak_torque_Nm": f"({{peak_torque_Nm}}>=ABS({{torque_Nm}})*(1-{ROOM:G}))",
    "peak_speed_rpm": f"({{peak_speed_rpm}}>=ABS({{speed_rpm}})*(1-{ROOM:G}))"
    "*(1-({speed_rpm}=0)*({peak_speed_rpm}>0))",
    "rms_torque_Nm": f"({{rms_torque_Nm}}<={_PEAK}*(1+{ROOM:G}))",
}
"""Conditions on a phase that varies, besides the bounds of its fields."""

_FITTING: Mapping[str, str] = {
    "peak_torque_Nm": N_("at least the phase’s own torque"),
    "peak_speed_rpm": N_("at least the phase’s own speed"),
    "rms_torque_Nm": N_("at most the peak torque"),
}

_USED = "((" + "+".join(f'({{{name}}}<>"")' for name in PHASE_FIGURES) + ")>0)"
"""Condition under which a row of the duty cycle is a phase."""

WRONG_AS_A_WHOLE: Mapping[str, str] = {
    f"IFERROR(SUMPRODUCT(--(ABS(speed_rpm)*duration_s>{LEAST_MOTION:G}))=0,FALSE)": N_(
        "no phase moves: give at least one a speed and a duration"
    ),
    f"COUNTA({BENEATH})>0": N_("phases below the bordered rows of the duty cycle do not count"),
    'AND(T_k<>"",T_B<>"")': N_("give either the torque of the stop or the brake, not both"),
    "COUNTBLANK(radial_used)>0": N_("copy the formulas of the duty cycle into the rows that were inserted there"),
}
"""Faults of the duty cycle as a whole: condition and remedy."""


def is_wrong(field: InputField, cell: str, needed: str = "") -> str:
    """Formula on a cell without a valid value of a field; a blank cell is wrong where `needed` is true.

    A blank number counts as 0, so it may stand for a default of 0 alone.
    """
    blank_is_right = field.nullable or field.default == 0 or needed
    right = f"ISNUMBER({cell})*{_within(field, cell)}" if field.choices is None else _chosen(field, cell)
    wrong = f'({cell}<>"")*(1-{right})' if blank_is_right else f"1-{right}"
    return f'{wrong}+({cell}="")*({needed})' if needed else wrong


def is_wrong_in_phase(name: str, cells: Mapping[str, str]) -> str:
    """Formula on a wrong field of a phase; `cells` are those of the row, or whole columns, by field."""
    field, cell = PHASE_FIELDS[name], f"{{{name}}}"
    asked = _USED if field.required else f'({cell}<>"")'
    right = "*".join(filter(None, (f"ISNUMBER({cell})", _within(field, cell), _FITS.get(name))))
    return f"{asked}*(1-{right})".format_map(cells)


def _within(field: InputField, cell: str) -> str:
    conditions = [f"({cell}<={field.most:.15G})"]
    if field.least > -math.inf:
        conditions.append(f"({cell}>={field.least:.15G})")
    if field.above > -math.inf:
        conditions.append(f"({cell}>{field.above:.15G})")
    if field.kind == "integer":
        conditions.append(f"({cell}=INT({cell}))")
    return "*".join(conditions)


def _chosen(field: InputField, cell: str) -> str:
    equal = "+".join(f'({cell}="{choice}")' for choice in field.choices or ())
    return f"(({equal})>0)"


def advice(field: InputField, reader: Reader, name: str = "") -> str:
    """Text on the valid values of a cell; `name` is the field of a phase."""
    if field.choices is not None:
        return reader.told(Sentence(N_("must be one of {expected}"), {"expected": ", ".join(field.choices)}))
    if field.above == 0 or field.least == LEAST:
        text = N_("must be a number above 0, at most {most}")
    elif field.kind == "integer":
        text = N_("must be a whole number from {least} to {most}")
    else:
        text = N_("must be a number from {least} to {most}")
    said = reader.text(text).format(least=reader.exact(field.least), most=reader.exact(field.most))
    return f"{said}; {reader.text(_FITTING[name])}" if name in _FITTING else said


def validation(field: InputField, advised: str) -> dict[str, Any]:
    """Rule for xlsxwriter's `data_validation`, by which a spreadsheet program refuses a wrong entry."""
    said = {"error_message": advised}
    if field.choices is not None:
        return {"validate": "list", "source": list(field.choices), **said}
    kind = "integer" if field.kind == "integer" else "decimal"
    if field.above > -math.inf:
        return {"validate": kind, "criteria": ">", "value": field.above, **said}
    return {"validate": kind, "criteria": "between", "minimum": field.least, "maximum": field.most, **said}


EVERY_WRONG = (
    f"SUMPRODUCT(--(LEN({REMARKS})>0))",
    *(f"SUMPRODUCT({is_wrong_in_phase(name, {name: name for name in PHASE_FIGURES})})" for name in PHASE_FIGURES),
    *(f"({condition})" for condition in WRONG_AS_A_WHOLE),
)
"""Formulas that count the faults: remarks on inputs, and those in the duty cycle over its columns."""
