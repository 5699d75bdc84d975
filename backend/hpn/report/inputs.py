"""Every input of an application as a reader finds it: name, symbol, value, unit."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from hpn.application import Application
from hpn.notices import AREAS
from hpn.report.language import Language
from hpn.units import symbol_of
from hpn.wording import N_


@dataclass(frozen=True, slots=True)
class Input:
    """An input other than the phases, at its place in the application model."""

    path: tuple[str, ...]
    symbol: str
    label: str

    @property
    def unit(self) -> str:
        """Symbol of its unit; empty for a pure number or a text."""
        return symbol_of(self.path[-1])

    def value(self, application: Application) -> Any:
        """What the application says, or None."""
        part: Any = application
        for step in self.path:
            part = getattr(part, step) if isinstance(part, BaseModel) else None
        return part


LOADS = (
    Input(("duty_cycle", "pause_s"), "t_p", N_("Pause after the cycle")),
    Input(("emergency_stop", "torque_Nm"), "T_k", N_("Emergency-stop torque")),
    Input(("emergency_stop", "count"), "N_k", N_("Expected emergency stops")),
    Input(("loads", "radial_N"), "F_R", N_("Radial load of the cycle")),
    Input(("loads", "axial_N"), "F_A", N_("Axial load of the cycle")),
    Input(("loads", "load_coefficient"), "f_w", N_("Load coefficient")),
    Input(("loads", "life_h"), "L_b", N_("Required bearing life")),
    Input(("loads", "life_basis"), "", N_("Basis of the bearing life")),
    Input(("loads", "model"), "", N_("Model of the bearing envelope")),
)
"""What loads the gear, besides the phases."""

REQUIREMENTS = (
    Input(("requirements", "life_h"), "L_10,req", N_("Required gear life")),
    Input(("requirements", "utilisation"), "u", N_("Largest acceptable utilisation")),
    Input(("requirements", "efficiency"), "η", N_("Assumed efficiency")),
    Input(("requirements", "motor", "maximum_speed_rpm"), "n_mot", N_("Maximum motor speed")),
    Input(("requirements", "motor", "peak_torque_Nm"), "T_mot", N_("Peak motor torque")),
    Input(("requirements", "motor", "rated_torque_Nm"), "T_mot,N", N_("Rated motor torque")),
    Input(("requirements", "ambient_temperature_degC"), "t_amb", N_("Ambient temperature")),
    Input(("requirements", "backlash_arcmin"), "j_req", N_("Largest acceptable backlash")),
    Input(("requirements", "torsional_stiffness_Nm_per_rad"), "K_3,req", N_("Smallest acceptable torsional stiffness")),
    Input(("requirements", "weight_kg"), "m_req", N_("Largest acceptable weight")),
    Input(("requirements", "length_mm"), "L_req", N_("Largest acceptable length")),
    Input(("requirements", "sizes"), "", N_("Only these sizes")),
    Input(("requirements", "ratios"), "i", N_("Only these ratios")),
    Input(("application_area",), "", N_("Area of use")),
    Input(("rank_by",), "", N_("Ranked by")),
)
"""What is asked of the gear. A test holds both lists against the model."""

WORDS = {
    "linear": N_("straight line"),
    "iso281": N_("ISO 281"),
    "digitised": N_("points of the printed curve"),
    "L50": N_("L50, half reach it"),
    "L10": N_("L10, nine of ten reach it"),
    "weight": N_("weight"),
    "utilisation": N_("utilisation"),
    "length": N_("length"),
    "motor_torque": N_("motor torque"),
    "life": N_("life"),
    "stiffness": N_("stiffness"),
    **AREAS,
}
"""Values that are a code, in words."""


@dataclass(frozen=True, slots=True)
class Row:
    """One input that is given, ready to read."""

    label: str
    symbol: str
    text: str


def given(application: Application, entries: Iterable[Input], language: Language) -> Iterable[Row]:
    """Those inputs that are given or have a default."""
    for entry in entries:
        value = entry.value(application)
        if value is not None:
            yield Row(language.text(entry.label), entry.symbol, _written(value, entry.unit, language))


def _written(value: Any, unit: str, language: Language) -> str:
    if isinstance(value, tuple):
        return ", ".join(str(item) for item in value)
    if isinstance(value, str):
        return language.text(WORDS[value])
    return f"{language.exact(value)}\N{NO-BREAK SPACE}{language.unit(unit)}".rstrip("\N{NO-BREAK SPACE}")
