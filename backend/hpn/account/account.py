"""The account of a selection: its inputs, results and published figures, the same for every page and file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hpn.account import published
from hpn.account.inputs import LOADS, REQUIREMENTS, lines_of, mechanism_of, moves_of, phases_of
from hpn.account.lines import Kind, Line, LineTable
from hpn.account.readings import (
    AT_MOTOR,
    CheckReading,
    Life,
    TorqueLimit,
    adds_at_motor,
    figure_symbol,
    readings_of,
    shortest_life,
    torque_limit_of,
)
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import FIGURES, Candidate, CheckResult
from hpn.engine.checks import BY_CODE, allowed
from hpn.engine.checks.motor import OF_MOTOR
from hpn.engine.duty import Duty
from hpn.engine.selection import CheckDefinition, Selection
from hpn.physics import equations
from hpn.words.quantities import CANDIDATE, DUTY, INPUTS, RESERVE
from hpn.words.reader import NOTHING, Reader
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Sentence

UNLIMITED = N_("unlimited")


@dataclass(frozen=True, slots=True)
class CheckLine:
    """A check of the gear: its result and definition, the reading of demand and limit, and the source of the limit.

    `bound` is the largest utilisation at which it passes.
    """

    code: str
    result: CheckResult
    definition: CheckDefinition
    reading: CheckReading
    bound: float
    source: str
    governs: bool

    def where(self, reader: Reader) -> str:
        """Equation of the check and source of its limit."""
        equation = self.definition.equation
        return " · ".join(
            filter(None, (equation and reader.sentence(equation_of(equation)), reader.source(self.source)))
        )


@dataclass(frozen=True)
class Account:
    """A gear of a selection. A kept answer may lack its application or its catalogue, and all data that depends on
    them.

    A line without a value is asked for and unknown; figures that the answer's version did not know have no line.
    """

    selection: Selection
    candidate: Candidate
    application: Application | None
    catalogue: Catalogue | None

    def of(self, candidate: Candidate) -> "Account":
        """Account of another gear of the same selection."""
        return replace(self, candidate=candidate)

    @property
    def gear(self) -> Gear | None:
        """The gear in the answer's catalogue, or None."""
        return self.catalogue.by_designation.get(self.candidate.designation) if self.catalogue else None

    @cached_property
    def equipped(self) -> Application | None:
        """The application with the figures of its listed motor, if the catalogue is available."""
        if self.application is None or self.catalogue is None:
            return self.application
        return with_listed_motor(self.application, self.catalogue)

    @property
    def utilisation(self) -> float:
        """Largest permissible utilisation of a load check."""
        return self.application.requirements.utilisation if self.application else 1.0

    # --- Inputs -------------------------------------------------------------------------------------------------------

    @cached_property
    def loads(self) -> list[Line]:
        """Loads besides the phases."""
        return lines_of(self.equipped, LOADS) if self.equipped else []

    @cached_property
    def requirements(self) -> list[Line]:
        """Requirements of the gear."""
        return lines_of(self.equipped, REQUIREMENTS) if self.equipped else []

    @cached_property
    def mechanism(self) -> list[Line]:
        """Mechanism of a motion; empty for typed phases."""
        motion = self.application.duty_cycle.motion if self.application else None
        return mechanism_of(motion) if motion else []

    @cached_property
    def moves(self) -> LineTable | None:
        """Moves of a motion; None for typed phases."""
        motion = self.application.duty_cycle.motion if self.application else None
        return moves_of(motion) if motion else None

    @cached_property
    def phases(self) -> LineTable | None:
        """Load phases; None if the application is unknown."""
        return phases_of(self.application.duty_cycle) if self.application else None

    # --- Results ------------------------------------------------------------------------------------------------------

    @cached_property
    def cycle(self) -> list[Line]:
        """Figures of the cycle."""
        duty, inertia = self.selection.duty, INPUTS["requirements.load_inertia_kgm2"]
        lines = [_computed(f"duty.{name}", named, getattr(duty, name)) for name, named in DUTY.items()]
        of_motion = _computed("duty.load_inertia_kgm2", inertia, duty.load_inertia_kgm2)
        return lines if duty.load_inertia_kgm2 is None else [*lines, of_motion]

    @cached_property
    def figures(self) -> list[Line]:
        """Figures of the gear under the cycle."""
        return [self.figure(name) for name in FIGURES if self.candidate.says(name)]

    def figure(self, name: str) -> Line:
        """One of these figures, which must be known to the candidate."""
        named = CANDIDATE[name]
        if name == "position_error_arcmin" and self._is_at_rest:
            named = replace(named, name=N_("Position error at rest"))
        symbol = figure_symbol(name, adds_at_motor=adds_at_motor(self.selection, self.gear))
        value = UNLIMITED if self._is_unlimited(name) else getattr(self.candidate, name)
        kind: Kind = "entered" if name == "stop_torque_Nm" and self._has_typed_stop else "computed"
        line = _computed(f"candidate.{name}", replace(named, symbol=symbol), value, kind)
        return replace(line, is_lower_bound=name in AT_MOTOR and self.is_lower_bound)

    def _is_unlimited(self, name: str) -> bool:
        if name == "shortest_life_h":
            return self.shortest_life is not None and self.shortest_life.life_h is None
        return self.candidate.is_unlimited(name)

    @property
    def _is_at_rest(self) -> bool:
        return self.application is not None and self.application.requirements.position_error_at == "rest"

    @property
    def _has_typed_stop(self) -> bool:
        stop = self.application.emergency_stop if self.application else None
        return stop is not None and stop.torque_Nm is not None

    @cached_property
    def reserves(self) -> list[Line]:
        """Reserves of the gear."""
        reserve = self.candidate.reserve
        return [
            _computed(f"reserve.{name}", named, getattr(reserve, name))
            for name, named in RESERVE.items()
            if self.candidate.says(f"reserve.{name}")
        ]

    @cached_property
    def published(self) -> list[Line]:
        """Published figures of the gear."""
        return published.published(self.gear)

    @cached_property
    def _by_code(self) -> Mapping[str, Line]:
        ranges = published.ranged(self.published)
        return {line.code: line for line in (*ranges, *self.cycle, *self.figures, *self.reserves, *self.published)}

    def line(self, code: str) -> Line | None:
        """A figure by its place in `QUANTITIES`; None if the version of a kept answer did not know it."""
        return self._by_code.get(code)

    def text(self, code: str, reader: Reader) -> str:
        """A figure with its unit, a dash if unknown; blank for a figure without a line."""
        line = self.line(code)
        return (line.text(reader) or NOTHING) if line else ""

    # --- Checks -------------------------------------------------------------------------------------------------------

    @cached_property
    def checks(self) -> tuple[CheckLine, ...]:
        """Every check of the gear, in the order of the reply."""
        return tuple(self._checks())

    @property
    def motor_checks(self) -> list[CheckLine]:
        """Checks of the motor, the gear's governing one first."""
        of_motor = {check.code for check in OF_MOTOR}
        return sorted((line for line in self.checks if line.code in of_motor), key=lambda line: not line.governs)

    def check(self, code: str) -> CheckLine | None:
        """A check; None if it was not asked for."""
        return next((check for check in self.checks if check.code == code), None)

    def _checks(self) -> Iterator[CheckLine]:
        readings = readings_of(self.candidate, self.selection, self.application, self.catalogue)
        for result in self.candidate.checks:
            code, definition = result.code, self.selection.check_definitions[result.code]
            bound, governs = allowed(code, self.utilisation), code == self.candidate.governing_check
            yield CheckLine(code, result, definition, readings[code], bound, self._source(code), governs)

    def _source(self, code: str) -> str:
        """Source of a check's limit, as exactly as known."""
        figure = BY_CODE[code].limited_by if code in BY_CODE else None
        exact = self.gear.sources.get(figure) if self.gear and figure else None
        return exact or self.selection.check_definitions[code].source

    # --- Conclusions --------------------------------------------------------------------------------------------------

    @property
    def shortest_life(self) -> Life | None:
        """The shortest life of the gear; None if unknown."""
        return shortest_life(self.candidate)

    @cached_property
    def torque_limit(self) -> TorqueLimit:
        """Torque limit of the drive on the gear, and a larger need of the cycle."""
        return torque_limit_of(self.candidate, self.gear, self.equipped)

    @cached_property
    def is_lower_bound(self) -> bool:
        """True if the motor torques are loss-free, since no efficiency is known."""
        known = self.application is None or self.application.requirements.efficiency is not None
        return not known and not self._follows_efficiency_curve

    @property
    def _follows_efficiency_curve(self) -> bool:
        """True if the motor torques follow a supplied efficiency curve, phase by phase.

        Without the catalogue of the selection its figures are the only evidence: a curve without effect on any phase
        leaves no trace in them.
        """
        assert self.application is not None
        if self.catalogue is not None:
            return self.candidate.designation in self.catalogue.efficiency
        if self.selection.adds_at_motor:
            return any(notice.code == "efficiency_supplied" for notice in self.selection.notices)
        duty, candidate = Duty.of([self.application]), self.candidate
        torques = np.array([candidate.motor_peak_torque_Nm, candidate.motor_rated_torque_Nm], dtype=np.float64)
        output = np.array([duty.maximum_torque_Nm.item(), duty.rms_torque_Nm.item()])
        loss_free = equations.motor_torque(output_torque_Nm=output, ratio=candidate.ratio, efficiency=1.0)
        return bool((np.abs(torques - loss_free) > 1e-9 * loss_free).any())


def _computed(code: str, named: Named, value: float | str | None, kind: Kind = "computed") -> Line:
    return Line(code, named, value, suffix_of(code), kind, equation_of(named.equation) if named.equation else None)


def equation_of(number: str) -> Sentence:
    """Number of an equation of the handbook."""
    return Sentence(N_("eq. {number}"), {"number": number})
