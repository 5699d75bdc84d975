"""Pairs of gear and motor as their page shows them: ranked, with the one that is marked, and the rejected by check."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hpn.application import Application, MotorEntry, PairRank
from hpn.catalogue import Catalogue
from hpn.engine.checks import allowed
from hpn.engine.motors import asks_inertia_ratio, with_figures
from hpn.engine.notice import Notice
from hpn.engine.pair_notices import notices_on
from hpn.engine.pairs import CODES, Pair, PairTable, pairs_at, table_of
from hpn.explain.drawings import Subject
from hpn.explain.drawings.plane import Plane, motor_plane
from hpn.links.writer import to_link
from hpn.web.door.visit import current
from hpn.web.form.linked import LONGEST_LINK

SHOWN, MOST_SHOWN = 30, 1000
"""Pairs that the page lists at first, and at most."""

NEAREST = 3
"""Pairs that are named of those that fail by one check."""


@dataclass(frozen=True, slots=True)
class PairRow:
    """A pair with the largest utilisations of its gear and of its motor's peak torque; None where there is none."""

    pair: Pair
    of_gear: float | None
    peak: float | None


@dataclass(frozen=True, slots=True)
class RejectedPairs:
    """Pairs that fail by one check: how many, of how many motors, and the nearest of them."""

    code: str
    count: int
    motors: int
    nearest: Sequence[PairRow]


@dataclass(frozen=True)
class PairsView:
    """Pairs of an application with the motors of a list; `marked` names gear and motor that are looked at."""

    application: Application
    motors: Sequence[MotorEntry]
    catalogue: Catalogue
    link_of: Callable[[Application, str], str | None]
    rank_by: PairRank = "weight"
    least_Hz: float | None = None
    all_pairs: bool = False
    most: int = SHOWN
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
        """The best pair of each motor."""
        seen, places, gears = set[int](), list[int](), len(self.table.gears.rows)
        for place in self._ranked:
            if place // gears not in seen:
                seen.add(place // gears)
                places.append(place)
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
        """The first suitable pairs, or the best of each motor."""
        places = self._ranked if self.all_pairs else self._of_motors
        return self._rows_at(places[: self.most])

    @property
    def more(self) -> int:
        """Number of further pairs of the same kind."""
        return len(self._ranked if self.all_pairs else self._of_motors) - len(self.rows)

    @cached_property
    def chosen(self) -> PairRow | None:
        """The pair that is looked at: the one that is marked, else the first suitable one."""
        gears = [gear.designation for gear in self.table.gears.rows]
        names = [motor.designation for motor in self.motors]
        gear, motor = self.marked
        if gear in gears and motor in names:
            (row,) = self._rows_at([names.index(motor) * len(gears) + gears.index(gear)])
            return row
        return self.rows[0] if self.rows else None

    @cached_property
    def motor(self) -> MotorEntry | None:
        """Motor of the pair that is looked at."""
        name = self.chosen.pair.motor if self.chosen else ""
        return next((motor for motor in self.motors if motor.designation == name), None)

    @cached_property
    def plane(self) -> Plane | None:
        """Torque over speed at the motor of that pair."""
        gear = self.catalogue.find(self.chosen.pair.designation) if self.chosen else None
        if gear is None or self.motor is None:
            return None
        return motor_plane(Subject(with_figures(self.application, self.motor), gear, self.catalogue), current())

    @cached_property
    def report(self) -> str | None:
        """Address of the PDF of that pair; None where that is too long for a link."""
        if self.chosen is None or self.motor is None:
            return None
        link = to_link(with_figures(self.application, self.motor)).removeprefix("/")
        address = f"/report.pdf{link}&gear={self.chosen.pair.designation}"
        return address if len(address) <= LONGEST_LINK else None

    @property
    def output_at_peak_Nm(self) -> float | None:
        """Torque i T_peak / η that the motor's peak would put on the gear, η as in the limit of the drive."""
        gear = self.catalogue.find(self.chosen.pair.designation) if self.chosen else None
        limit = self.chosen.pair.motor_torque_limit_Nm if self.chosen else None
        peak = self.motor.peak_torque_Nm if self.motor else None
        if gear is None or not limit or peak is None or gear.repeated_peak_torque_Nm is None:
            return None
        return peak / limit * gear.repeated_peak_torque_Nm

    @property
    def repeated_peak_torque_Nm(self) -> float | None:
        """T_R of the gear of that pair."""
        gear = self.catalogue.find(self.chosen.pair.designation) if self.chosen else None
        return gear.repeated_peak_torque_Nm if gear else None

    @cached_property
    def rejected(self) -> list[RejectedPairs]:
        """Pairs that fail by the check that governs, the most frequent first."""
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
        needs = asks_inertia_ratio(self.application) or self.least_Hz is not None
        found = notices_on(self.application, self.motors, self.table.gears, self.catalogue, needs_inertia=needs)
        return tuple(found)

    def bound(self, code: str | None) -> float:
        """Largest utilisation with which a check passes."""
        u = self.application.requirements.utilisation
        return allowed(code, u) if code in CODES[:-1] else 1.0

    def _rows_at(self, places: Sequence[int]) -> list[PairRow]:
        pairs = pairs_at(self.table, places, self.application, self.link_of)
        return [
            PairRow(pair, _known(self.table.of_gear.item(place)), _known(self.table.peak.item(place)))
            for pair, place in zip(pairs, places, strict=True)
        ]


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None
