"""Saved values of one candidate, by the names of the workbook's formulas."""

from collections.abc import Mapping
from dataclasses import dataclass

from msgspec import structs

from hpn.engine.candidates import FIGURES, Candidate, CheckResult
from hpn.engine.checks.motor import MOTOR
from hpn.explain.differences import is_same
from hpn.explain.readings import figure_symbol
from hpn.files.export import Export
from hpn.files.workbook.formulas import (
    CHECK_FORMULAS,
    GEAR_TERMS,
    MOTOR_TORQUES,
    NONE,
    RATINGS,
    CellTerm,
    cell_name,
    terms_of,
)
from hpn.words.quantities import CANDIDATE

_LIMITS = {
    name: code for code, formulas in CHECK_FORMULAS.items() for name in RATINGS if formulas.limit == f"{{{name}}}"
}
"""Published figures that a check names as its limit, and its code."""

_FIELDS = {cell_name(CANDIDATE[field].symbol): field for field in FIGURES}
DEMANDS = {"P_max": "output_bearing_load", "P_m": "output_bearing_life"}
"""Checks whose demand is the value of a term; the other terms are figures of the candidate."""

BY_BRAKE = {cell_name("N_k,max"), "momentary_peak_torque", "momentary_peak_count"}
"""Terms and checks of a stop by the brake, which differs for each gear."""

_MAY_BE_UNLIMITED = ("N_k_max", "L_10", "L_b50")


@dataclass(frozen=True)
class Known:
    """One candidate; `words` are the texts in place of a number."""

    export: Export
    candidate: Candidate
    words: Mapping[str, str]

    def ratings(self) -> dict[str, float | None]:
        """Published figures, from the catalogue of the selection; without it those that are limits of its checks."""
        gear = self.export.gear(self.candidate)
        if gear:
            return {name: getattr(gear, field) for name, field in RATINGS.items()}
        known: dict[str, float | None] = {cell_name(CANDIDATE["ratio"].symbol): self.candidate.ratio}
        known |= {name: check.limit for name, code in _LIMITS.items() if (check := self.candidate.check(code))}
        return {name: known.get(name) for name in RATINGS}

    def fixed(self) -> set[str]:
        """Terms and codes of checks that no formula of this workbook can calculate: they keep their saved values."""
        fixed: set[str] = set()
        loads = self.export.application.loads
        if self.export.figures is None:
            unknown = RATINGS.keys() - _LIMITS.keys() - {cell_name(CANDIDATE["ratio"].symbol)}
            formulas = {term.name: term.formula for term in GEAR_TERMS}
            formulas |= {code: check.ratio for code, check in CHECK_FORMULAS.items()}
            fixed |= {name for name, formula in formulas.items() if terms_of(formula) & unknown}
        elif loads and loads.model == "digitised":
            fixed |= DEMANDS.keys()
        if loads and (loads.radial_position_mm is not None or loads.axial_radius_mm):
            fixed |= DEMANDS.keys()
        if self.export.follows_efficiency_curve(self.candidate) or self.export.selection.turns_motor:
            fixed |= set(MOTOR_TORQUES)
        fixed |= self._by_supplement() | self._by_brake() | self.unknown() | self._otherwise()
        if self.export.figures is None and self._has_listed_motor:
            fixed |= {check.code for check in MOTOR}
        return fixed

    def unknown(self) -> set[str]:
        """Terms that the version of a saved answer did not know."""
        return {term.name for term in GEAR_TERMS if term.field and not self.candidate.says(term.field)}

    def _otherwise(self) -> set[str]:
        """Terms and codes of checks that a saved answer has otherwise than this version's equations give them."""
        today = self.export.today and self.export.today.candidate(self.candidate.designation)
        if not today:
            return set()
        figures = {term.name: term.field for term in GEAR_TERMS if term.field}
        own = {
            name
            for name, field in figures.items()
            if not is_same(getattr(self.candidate, field), getattr(today, field))
        }
        checks = {
            check.code
            for check in self.candidate.checks
            if check.code in CHECK_FORMULAS and not _is_same_check(check, today.check(check.code))
        }
        return own | checks | {name for name, code in DEMANDS.items() if code in checks}

    def _by_supplement(self) -> set[str]:
        """Terms and checks that depend on the gear's own inertia or no-load torque."""
        gear = self.export.gear(self.candidate)
        if gear is None:
            supplied = any(notice.code == "catalogue_supplement" for notice in self.export.selection.notices)
            return {*MOTOR_TORQUES, "inertia_ratio"} if supplied else set()
        motor = MOTOR_TORQUES if gear.no_load_torque_Nm else ()
        return {*motor, *(["inertia_ratio"] if gear.inertia_kgm2 else ())}

    def _by_brake(self) -> set[str]:
        stop = self.export.application.emergency_stop
        return BY_BRAKE if stop is not None and stop.brake is not None else set()

    def formula(self, term: CellTerm) -> str:
        """Formula of a term that is not fixed; blank in a motion with a motor's inertia, which no formula covers."""
        moves = self.export.application.duty_cycle.motion is not None
        return f'IF(J_m="",{term.formula},"")' if moves and term.by_efficiency else term.formula

    def symbol(self, term: CellTerm) -> str:
        """Symbol of a term, the same as in the report."""
        turns = self.export.selection.turns_motor
        return figure_symbol(term.field, turns_motor=turns) if term.field else term.named.symbol

    @property
    def _has_listed_motor(self) -> bool:
        motor = self.export.application.requirements.motor
        return motor is not None and motor.designation is not None

    def terms(self) -> dict[str, float | str]:
        """Values of GEAR_TERMS as saved; words where there is no number."""
        return {term.name: self._term(term.name) for term in GEAR_TERMS}

    def _term(self, name: str) -> float | str:
        if name in DEMANDS:
            return demand_of(self.candidate.check(DEMANDS[name]))
        if name in _MAY_BE_UNLIMITED and self.candidate.is_unlimited(_FIELDS[name]):
            return self.words["unlimited"]
        return _cell(getattr(self.candidate, _FIELDS[name]))

    def utilisation(self, code: str) -> float | str:
        """Utilisation of a check as saved; blank where it was not asked for."""
        check = self.candidate.check(code)
        if check is None:
            return ""
        if check.utilisation is not None:
            return check.utilisation
        return NONE if check.status == "fail" else self.words["not rated"]

    def overall(self) -> float | str:
        """Utilisation of the candidate as saved."""
        unlimited = NONE if self.candidate.status == "unsuitable" else ""
        return unlimited if self.candidate.utilisation is None else self.candidate.utilisation


def _is_same_check(saved: CheckResult, today: CheckResult | None) -> bool:
    return today is not None and all(map(is_same, structs.astuple(saved), structs.astuple(today)))


def demand_of(check: CheckResult | None) -> float | str:
    """Value of a check as a cell; blank where there is none."""
    return _cell(check.demand if check else None)


def limit_of(check: CheckResult | None) -> float | str:
    """Limit of a check as a cell; blank where there is none."""
    return _cell(check.limit if check else None)


def _cell(value: float | None) -> float | str:
    return "" if value is None else value
