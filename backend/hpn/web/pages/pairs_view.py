"""Pairs of gear and motor for their page: ranked pairs, the marked pair, and rejected pairs by check."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hpn.account.inputs import moves_of, phases_of
from hpn.account.lines import Line, LineTable
from hpn.account.readings import assumed_of, thermal_of
from hpn.application import Application, Motor, MotorEntry, PairRank
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import candidates_of
from hpn.engine.checks import allowed
from hpn.engine.duty import Duty
from hpn.engine.evaluation import STATUS, SUITABLE, evaluate
from hpn.engine.motors import with_figures
from hpn.engine.notice import Notice
from hpn.engine.pair_notices import notices_on
from hpn.engine.pairs import CODES, Pair, PairTable, pairs_at, table_of
from hpn.engine.remedy import remedy_of
from hpn.engine.tried import needed_of
from hpn.explain.drawings import Subject
from hpn.explain.drawings.plane import Plane, motor_plane
from hpn.links.writer import to_link
from hpn.web.door.visit import current
from hpn.web.form.linked import LONGEST_LINK
from hpn.words.quantities import DUTY, INPUTS
from hpn.words.reply import finite
from hpn.words.wording import Sentence

ROWS_AT_FIRST, MOST_ROWS = 30, 1000
"""Number of pairs that the page lists at first, and maximum."""

NEAREST = 3
"""Number of pairs named among those that fail by the same check."""


@dataclass(frozen=True, slots=True)
class PairRow:
    """Pair with the largest utilisation of its gear and that of its motor's peak torque; None if unknown."""

    pair: Pair
    of_gear: float | None
    peak: float | None


@dataclass(frozen=True, slots=True)
class RejectedPairs:
    """Pairs that fail by the same check: their number, the number of their motors, and the nearest pairs."""

    code: str
    count: int
    motors: int
    nearest: Sequence[PairRow]


@dataclass(frozen=True, slots=True)
class AxisFacts:
    """Facts of the axis that pairs are for: its moves, or else its phases, and figures of its cycle at the output."""

    is_motion: bool
    cycle: LineTable
    lines: Sequence[Line]


def facts_of(application: Application) -> AxisFacts:
    """Facts of an application's axis; the inertia of the load is left out where it is not known."""
    motion, duty = application.duty_cycle.motion, Duty.of([application])
    inertia = finite(duty.load_inertia_kgm2.item())
    name = "load_inertia_kgm2"
    lines = [Line(f"duty.{name}", INPUTS[f"requirements.{name}"], inertia, "kgm2", "computed")] if inertia else []
    for name, unit in (("maximum_torque_Nm", "Nm"), ("maximum_output_speed_rpm", "rpm")):
        lines.append(Line(f"duty.{name}", DUTY[name], getattr(duty, name).item(), unit, "computed"))
    return AxisFacts(motion is not None, moves_of(motion) if motion else phases_of(application.duty_cycle), lines)


@dataclass(frozen=True)
class PairsView:
    """Pairs of an application with the motors of a list; `marked` names gear and motor of the marked pair."""

    application: Application
    motors: Sequence[MotorEntry]
    catalogue: Catalogue
    link_of: Callable[[Application, str], str | None]
    rank_by: PairRank = "weight"
    least_Hz: float | None = None
    all_pairs: bool = False
    most: int = ROWS_AT_FIRST
    marked: tuple[str, str] = ("", "")

    @cached_property
    def table(self) -> PairTable:
        """Figures of every pair; raises InputError as `select` does."""
        return table_of(self.application, self.motors, self.catalogue, self.least_Hz)

    @cached_property
    def _ranked(self) -> list[int]:
        order: list[int] = self.table.ranked(self.rank_by).tolist()
        return order

    @cached_property
    def _of_motors(self) -> list[int]:
        """Places of the best pair of each motor."""
        places: list[int] = self.table.best_of_motors(np.array(self._ranked, np.intp)).tolist()
        return places

    @property
    def count(self) -> int:
        """Number of all pairs."""
        return len(self.motors) * len(self.table.gears.rows)

    @property
    def suitable(self) -> int:
        """Number of suitable pairs."""
        return len(self._ranked)

    @property
    def of_motors(self) -> int:
        """Number of motors with a suitable pair."""
        return len(self._of_motors)

    @cached_property
    def rows(self) -> list[PairRow]:
        """First suitable pairs, or best pairs of the motors."""
        places = self._ranked if self.all_pairs else self._of_motors
        return self._rows_at(places[: self.most])

    @property
    def more(self) -> int:
        """Number of further pairs of the same kind."""
        return len(self._ranked if self.all_pairs else self._of_motors) - len(self.rows)

    @cached_property
    def chosen(self) -> PairRow | None:
        """Chosen pair: the marked one, else the first suitable one."""
        gears = [gear.designation for gear in self.table.gears.rows]
        names = [motor.designation for motor in self.motors]
        gear, motor = self.marked
        if gear in gears and motor in names:
            (row,) = self._rows_at([names.index(motor) * len(gears) + gears.index(gear)])
            return row
        return self.rows[0] if self.rows else None

    @cached_property
    def gear(self) -> Gear | None:
        """Gear of the chosen pair."""
        return self.catalogue.find(self.chosen.pair.designation) if self.chosen else None

    @cached_property
    def motor(self) -> MotorEntry | None:
        """Motor of the chosen pair."""
        name = self.chosen.pair.motor if self.chosen else ""
        return next((motor for motor in self.motors if motor.designation == name), None)

    @cached_property
    def _own(self) -> Motor | None:
        """Motor of the chosen pair with the application's limits."""
        return with_figures(self.application, self.motor).requirements.motor if self.motor else None

    @cached_property
    def _subject(self) -> Subject | None:
        if self.gear is None or self.motor is None:
            return None
        return Subject(with_figures(self.application, self.motor), self.gear, self.catalogue)

    @property
    def assumed(self) -> Sentence:
        """Assumption on the torque of the chosen motor between its known figures."""
        return assumed_of(self._own)

    @cached_property
    def thermal(self) -> Sentence | None:
        """Sentence with both rules of the chosen motor's thermal load; None without a torque curve."""
        if self._subject is None or self._own is None or not self._own.curve:
            return None
        figures = self._subject.of_gear
        return thermal_of(
            rms_Nm=figures.motor_rated_torque_Nm.item(),
            thermal_Nm=figures.motor_thermal_torque_Nm.item(),
            at_mean_Nm=figures.motor_mean_speed_torque_Nm.item(),
        )

    @cached_property
    def remedy(self) -> Sentence | None:
        """Sentence on the changes that would make the chosen pair suitable; None for a suitable one, and where its
        resonance is too low.
        """
        if self._subject is None or self.gear is None or self.chosen is None:
            return None
        pair, application = self.chosen.pair, self._subject.application
        resonates = self.least_Hz is not None and not (pair.drive_resonance_Hz or 0.0) >= self.least_Hz
        if pair.status == STATUS[SUITABLE] or resonates:
            return None
        gears = self.catalogue.listed([self.gear])
        [candidate] = candidates_of(evaluate(Duty.of([application]), gears, self.catalogue), 0)
        return remedy_of(candidate, needed_of(candidate, application, self.catalogue))

    @cached_property
    def plane(self) -> Plane | None:
        """Torque over speed at the motor of the chosen pair."""
        return motor_plane(self._subject, current()) if self._subject else None

    @cached_property
    def report(self) -> str | None:
        """Address of the PDF of the chosen pair; None if it is too long for a link."""
        if self.chosen is None or self.motor is None:
            return None
        link = to_link(with_figures(self.application, self.motor)).removeprefix("/")
        address = f"/report.pdf{link}&gear={self.chosen.pair.designation}"
        return address if len(address) <= LONGEST_LINK else None

    @property
    def output_at_peak_Nm(self) -> float | None:
        """Torque i T_peak / η in Nm that the motor's peak would put on the gear; η as in the drive's torque limit."""
        limit = self.chosen.pair.motor_torque_limit_Nm if self.chosen else None
        peak = self._own.largest_torque_Nm if self._own else None
        if self.gear is None or not limit or peak is None or self.gear.repeated_peak_torque_Nm is None:
            return None
        return peak / limit * self.gear.repeated_peak_torque_Nm

    @cached_property
    def rejected(self) -> list[RejectedPairs]:
        """Failing pairs by their governing check, the most frequent check first."""
        order, governing = self.table.rejected(), self.table.governing.ravel()
        fails = order[self.table.fails[order]]
        groups = []
        for code in np.unique(governing[fails]).tolist():
            places = fails[governing[fails] == code]
            motors = len(np.unique(places // len(self.table.gears.rows)))
            nearest = self._rows_at(places[:NEAREST].tolist())
            groups.append(RejectedPairs(CODES[code], len(places), motors, nearest))
        return sorted(groups, key=lambda group: -group.count)

    @property
    def unrated(self) -> int:
        """Number of pairs that are not rated."""
        return self.count - self.suitable - int(self.table.fails.sum())

    @cached_property
    def notices(self) -> tuple[Notice, ...]:
        """Assumptions and remarks on all pairs."""
        return tuple(notices_on(self.application, self.motors, self.table.gears, self.catalogue, self.least_Hz))

    def bound(self, code: str | None) -> float:
        """Largest utilisation with which a check passes."""
        u = self.application.requirements.utilisation
        return allowed(code, u) if code in CODES[:-1] else 1.0

    def _rows_at(self, places: Sequence[int]) -> list[PairRow]:
        pairs = pairs_at(self.table, places, self.application, self.link_of)
        return [
            PairRow(pair, finite(self.table.of_gear.item(place)), finite(self.table.peak.item(place)))
            for pair, place in zip(pairs, places, strict=True)
        ]
