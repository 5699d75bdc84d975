"""Steps, equations and checks of a calculation, and the sheet of their figures."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from hpn.application import Application
from hpn.catalogue import Catalogue, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate
from hpn.engine.check import Check
from hpn.engine.checks import BY_CODE
from hpn.engine.duty import Duty
from hpn.engine.evaluation import CheckStatus
from hpn.engine.selection import DutyFigures
from hpn.explain.calculation.formula import (
    Formula,
    PhaseSum,
    PhaseValues,
    Sum,
    Term,
    Variable,
    over_phases,
    value_of,
)
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.words.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.words.units import suffix_of
from hpn.words.wording import Named, Sentence


@dataclass(frozen=True, slots=True)
class EquationLine:
    """One equation: its result and its formula; `rounded_down` for a whole number as the result."""

    result: Term
    formula: Formula
    rounded_down: bool = False

    def by_hand(self, rounded: Mapping[Variable, float]) -> float:
        """Result with rounded values for some of its symbols."""
        value = value_of(self.formula, rounded)
        return float(math.floor(value * (1 + ROUNDING))) if self.rounded_down else value


@dataclass(frozen=True, slots=True)
class Comparison:
    """A check: the tested formula and its value, the limit by its names, and the limit's source.

    `source` is blank for the user's own limit; `allowed` is the user's u.
    """

    code: str
    tested: Formula
    value: float
    unit: str
    relation: str
    limit: float
    limit_names: tuple[Variable, ...]
    source: str
    utilisation: float | None
    status: CheckStatus
    allowed: float

    @property
    def bound(self) -> float:
        """The limit with the user's own reserve."""
        return self.limit * self.allowed if self.relation == "≤" else self.limit / self.allowed


@dataclass(frozen=True, slots=True)
class Step:
    """One equation of the handbook, or of the model in its place; `equation` is None if none is printed."""

    code: str
    title: str
    equation: str | None
    lines: tuple[EquationLine, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
    notes: tuple[Sentence, ...] = ()

    @property
    def continued(self) -> bool:
        """True if the first comparison continues from the result of the last line."""
        if not self.lines or not self.comparisons or self.lines[-1].rounded_down:
            return False
        return self.comparisons[0].tested == self.lines[-1].result


def step_of_check(
    code: str,
    lines: tuple[EquationLine, ...] = (),
    comparisons: tuple[Comparison, ...] = (),
    notes: tuple[Sentence, ...] = (),
) -> Step:
    """Step that calculates a check; it has the check's title and equation."""
    check = BY_CODE[code]
    return Step(code, check.title, check.equation, lines, comparisons, notes)


class LackingFigureError(LookupError):
    """A figure that a step needs and a saved answer lacks."""


def known(term: Term | None) -> Term:
    """Term of a needed value; raises LackingFigureError without one."""
    if term is None:
        raise LackingFigureError
    return term


class CalculationSheet:
    """Figures for the steps of one gear: the candidate's, the gear's, the duty's and the phases.

    Figures of an answer are read from it, never computed again.
    """

    def __init__(
        self, candidate: Candidate, figures: DutyFigures, gear: Gear, application: Application, catalogue: Catalogue
    ) -> None:
        self.candidate, self.figures, self.gear = candidate, figures, gear
        self.application, self.catalogue = application, catalogue
        self.duty = Duty.of([application])
        self.torque = self._of_phases("torque_Nm")
        self.peak_torque = self._varying("peak_torque_Nm", self.torque)
        self.rms_torque = self._varying("rms_torque_Nm", self.torque)
        self.speed = self._of_phases("speed_rpm")
        self.time = self._of_phases("duration_s")
        self.radial = self._of_phases("radial_N")
        self.axial = self._of_phases("axial_N")
        self.T_av, self.n_out_av = self._of_duty("average_torque_Nm"), self._of_duty("average_output_speed_rpm")
        self.T_max, self.n_out_max = self._of_duty("maximum_torque_Nm"), self._of_duty("maximum_output_speed_rpm")
        self.i = known(self.rating("ratio"))
        inertia, place = self.duty.load_inertia_kgm2.item(), "requirements.load_inertia_kgm2"
        self.load_inertia = None if math.isnan(inertia) else _term(INPUTS[place], place, inertia)

    @property
    def n_in_av(self) -> Term:
        """Average input speed."""
        return known(self.figure("average_input_speed_rpm"))

    @property
    def n_in_max(self) -> Term:
        """Largest input speed."""
        return known(self.figure("maximum_input_speed_rpm"))

    @property
    def T_k(self) -> Term | None:
        """Torque of the emergency stop: the answer's, else as given."""
        own = self.figure("stop_torque_Nm") if self.candidate.says("stop_torque_Nm") else None
        return own or self.input_of("emergency_stop.torque_Nm")

    def _of_phases(self, name: str) -> PhaseValues:
        values: FloatArray = getattr(self.duty.phases, name)[0, 0]
        return PhaseValues(Variable.of(INPUTS[f"phase.{name}"].symbol), values, suffix_of(name))

    @property
    def varies(self) -> bool:
        """True if torque or speed varies in at least one phase."""
        return self.peak_torque is not self.torque or self.rms_torque is not self.torque or self._outruns

    @cached_property
    def _outruns(self) -> bool:
        return bool((self.duty.phases.peak_speed_rpm != self.duty.phases.speed_rpm).any())

    def _varying(self, name: str, steady: PhaseValues) -> PhaseValues:
        """Figure of varying phases; that of steady phases if none varies."""
        varying = self._of_phases(name)
        return varying if (varying.values != steady.values).any() else steady

    def _of_duty(self, name: str) -> Term:
        return _term(DUTY[name], name, getattr(self.figures, name))

    def figure(self, name: str) -> Term | None:
        """Figure of the candidate, or None; raises LackingFigureError if its version did not know the figure."""
        if not self.candidate.says(name):
            raise LackingFigureError(name)
        value: float | None = getattr(self.candidate, name)
        return None if value is None else _term(CANDIDATE[name], name, value)

    def rating(self, name: str) -> Term | None:
        """A figure of the catalogue; None if not published."""
        value: float | None = getattr(self.gear, name)
        return None if value is None else _term(GEAR[name], name, value)

    def input_of(self, place: str) -> Term | None:
        """Magnitude of an input; None if not given."""
        value = abs(self.duty.inputs[place].item())
        return None if math.isnan(value) else _term(INPUTS[place], place, value)

    @cached_property
    def gears(self) -> GearList:
        """List of this gear alone, for the engine."""
        return self.catalogue.listed([self.gear])

    @cached_property
    def travel(self) -> PhaseSum:
        """|n_1| t_1 + … + |n_n| t_n."""
        return over_phases(lambda n, t: abs(n) * t, self.speed, self.time)

    @cached_property
    def cycle_time(self) -> Sum:
        """t_1 + … + t_n + t_p."""
        return over_phases(lambda t: t, self.time) + known(self.input_of("duty_cycle.pause_s"))

    def compared(self, code: str, tested: Formula) -> tuple[Comparison, ...]:
        """Comparison for a check's code; empty unless the application asks for it and the gear's figures are
        published.
        """
        check, result = BY_CODE[code], self.candidate.check(code)
        if result is None or result.demand is None or result.limit is None:
            return ()
        return (
            Comparison(
                code=code,
                tested=tested,
                value=result.demand,
                unit=check.unit,
                relation="≥" if check.kind == "minimum" else "≤",
                limit=result.limit,
                limit_names=_limit_names(check),
                source=self._source(check),
                utilisation=result.utilisation,
                status=result.status,
                allowed=check.allowed(self.application.requirements.utilisation),
            ),
        )

    def _source(self, check: Check) -> str:
        """Source in which a check's limit is printed; blank for the user's own limit, such as a required minimum."""
        figure = None if check.kind == "minimum" else check.limited_by
        return self.gear.sources.get(figure, "") if figure else ""


def _term(named: Named, name: str, value: float) -> Term:
    return Term(Variable.of(named.symbol), value, suffix_of(name))


def _limit_names(check: Check) -> tuple[Variable, ...]:
    """Symbols of a check's limit in its relation, such as `T_av ≤ T_A = T_N`; empty for a number."""
    names = check.relation.replace("≥", "≤").partition(" ≤ ")[2].split(" = ")
    return tuple(Variable.of(name) for name in names if not name.isdigit())
