"""What a calculation consists of, and the sheet of figures that its steps draw on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hpn.calculation.formula import Formula, Magnitude, Product, Series, Sum, Symbol, Term, leaves_out, over_phases
from hpn.catalogue import Catalogue
from hpn.duty import Duty
from hpn.gear import Gear
from hpn.wording import Sentence


@dataclass(frozen=True, slots=True)
class Line:
    """One equation: what it gives, and the formula; `rounded_down` where the result is a whole number."""

    result: Term
    formula: Formula
    rounded_down: bool = False


@dataclass(frozen=True, slots=True)
class Comparison:
    """A check: the tested formula and its value, the limit by its names, and where that comes from.

    `source` is blank where the limit is the user's own; `allowed` is their u.
    """

    code: str
    tested: Formula
    value: float
    unit: str
    relation: str
    limit: float
    limit_names: tuple[Symbol, ...]
    source: str
    utilisation: float | None
    status: str
    allowed: float

    @property
    def bound(self) -> float:
        """The limit with the user's own reserve."""
        return self.limit * self.allowed if self.relation == "≤" else self.limit / self.allowed


@dataclass(frozen=True, slots=True)
class Step:
    """One equation of the handbook, or of the model that stands in for it; `equation` is None where none is printed."""

    code: str
    title: str
    equation: str | None
    lines: tuple[Line, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
    notes: tuple[Sentence, ...] = ()
    trivial: bool = False

    @property
    def abbreviated(self) -> bool:
        """Whether some of the phases are not written out."""
        return any(leaves_out(line.formula) for line in self.lines)


class Sheet:
    """What the steps of one gear draw on: the reply's figures, the gear's, and the phases."""

    def __init__(self, candidate: Mapping[str, Any], gear: Gear, duty: Duty, catalogue: Catalogue) -> None:
        self.candidate, self.gear, self.duty, self.catalogue = candidate, gear, duty, catalogue
        self.application = duty.applications[0]
        self.count = len(self.application.duty_cycle.phases)
        self.T, self.n, self.t = duty.torque_Nm[0], duty.speed_rpm[0], duty.duration_s[0]
        self.checks = {check["code"]: check for check in candidate["checks"]}
        self.i = Term(Symbol("i"), gear.ratio)
        self.T_av = Term(Symbol("T", "av"), duty.average_torque_Nm.item(0), "Nm")
        stop = duty.emergency_stop_torque_Nm.item(0) if self.application.emergency_stop else None
        self.T_k = None if stop is None else Term(Symbol("T", "k"), stop, "Nm")
        self.T_max = Term(Symbol("T", "max"), duty.maximum_torque_Nm.item(0), "Nm")
        self.n_out_av = Term(Symbol("n", "out av"), duty.average_output_speed_rpm.item(0), "rpm")
        self.n_out_max = Term(Symbol("n", "out max"), duty.maximum_output_speed_rpm.item(0), "rpm")
        self.n_in_av = Term(Symbol("n", "in av"), candidate["average_input_speed_rpm"], "rpm")
        self.n_in_max = Term(Symbol("n", "in max"), candidate["maximum_input_speed_rpm"], "rpm")

    def series(self, make: Callable[[str, int], Formula], values: Callable[[], Any]) -> Series:
        """Sum over the phases; `values` are all of its terms as an array."""
        return over_phases(make, self.count, lambda: float(np.sum(values())))

    def torque(self, index: str, k: int) -> Term:
        """Torque of a phase."""
        return Term(Symbol("T", index), self.T.item(k), "Nm")

    def speed(self, index: str, k: int) -> Term:
        """Speed of a phase."""
        return Term(Symbol("n", index), self.n.item(k), "rpm")

    def time(self, index: str, k: int) -> Term:
        """Duration of a phase."""
        return Term(Symbol("t", index), self.t.item(k), "s")

    @property
    def travel(self) -> Series:
        """|n_1| t_1 + … + |n_n| t_n."""
        return self.series(
            lambda index, k: Product((Magnitude(self.speed(index, k)), self.time(index, k))), lambda: self.n * self.t
        )

    @property
    def cycle_time(self) -> Sum:
        """t_1 + … + t_n + t_p."""
        return Sum((self.series(self.time, lambda: self.t), Term(Symbol("t", "p"), self.duty.pause_s.item(0), "s")))

    def compared(
        self, code: str, tested: Formula, *names: Symbol, unit: str = "", figure: str = ""
    ) -> tuple[Comparison, ...]:
        """The check of a code, where the application asks for it and the gear's figures are published.

        `names` are the symbols of the limit, `figure` is the catalogue's field that it comes from.
        """
        check = self.checks.get(code)
        if check is None or None in (check["limit"], check["demand"]):
            return ()
        return (
            Comparison(
                code=code,
                tested=tested,
                value=check["demand"],
                unit=unit or getattr(tested, "unit", ""),
                relation="≥" if code == "life" else "≤",
                limit=check["limit"],
                limit_names=names,
                source=self.gear.sources.get(figure, ""),
                utilisation=check["utilisation"],
                status=check["status"],
                allowed=self.application.requirements.utilisation,
            ),
        )
