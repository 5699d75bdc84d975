"""The selection as callers of the interface see it: JSON in, JSON out, over the typed flow."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine import batch, remedy, reserve, selection
from hpn.engine.candidates import Candidate
from hpn.engine.checks import BY_CODE
from hpn.explain import calculation
from hpn.explain.calculation import Step
from hpn.physics.equations import ROUNDING

Json = dict[str, Any]

EXPLANATIONS = BY_CODE
MOVES: Mapping[str, Mapping[str, float]] = {str(driver): powers for driver, powers in reserve.MOVES.items()}


@dataclass(frozen=True)
class Selection:
    """An application on its gears, as `POST /api/v1/select` and a line of a batch give it."""

    judged: selection.Judgement

    def json(self, link: str) -> bytes:
        """The reply as JSON."""
        return selection.encode(self.judged.selection(lambda _: link))

    def reply(self, link: str) -> Json:
        """The reply as plain Python values."""
        reply: Json = msgspec.json.decode(self.json(link))
        return reply

    def summary(self, link: str) -> Json:
        """The answer in brief."""
        return self.judged.outcome()._asdict() | {"link": link}

    @property
    def evaluation(self) -> "Selection":
        """The selection behind the answer."""
        return self

    @property
    def duty(self) -> Application:
        """The application behind its duty."""
        return self.judged.application


def select(application: Application, catalogue: Catalogue) -> Selection:
    """Selection of one application."""
    return Selection(selection.judge(application, catalogue))


def select_fleet(applications: Sequence[Application], catalogue: Catalogue) -> list[Selection | InputError]:
    """Selections of many applications."""
    return batch.judge_batch(applications, catalogue, Selection)


def candidate_of(entry: Json) -> Candidate:
    """A candidate of a reply, typed."""
    return msgspec.convert(entry, Candidate)


def ways_of(entry: Json, reserve_utilisation: float = 1.0) -> tuple[remedy.Way, ...]:
    """Ways to make a candidate of a reply pass."""
    return remedy.ways_of(candidate_of(entry), reserve_utilisation)


@dataclass(frozen=True)
class Room:
    """Limit of one driver by the reserve of a reply, and the check that is full first; None without a limit."""

    driver: str
    value: float | None
    check: str | None


def rooms_of(entry: Json, reserve_utilisation: float = 1.0) -> tuple[Room, ...]:
    """Reserve of a candidate of a reply; empty where not every check can be judged."""
    candidate, u = candidate_of(entry), reserve_utilisation
    if not candidate.is_judged:
        return ()
    full = {check.code: (check.utilisation or 0.0) / u for check in candidate.checks}
    rooms = []
    for driver, powers in MOVES.items():
        moved = {code: full[code] ** (1 / power) for code, power in powers.items() if code in full}
        value = getattr(candidate.reserve, f"{driver}_factor")
        if moved:
            rooms.append(Room(driver, value, None if value is None else max(moved, key=moved.__getitem__)))
    stop = candidate.reserve.emergency_stop_torque_Nm
    if stop is not None:
        check = candidate.check("momentary_peak_torque")
        is_full = check is not None and check.limit is not None and stop >= u * check.limit * (1 - ROUNDING)
        rooms.append(Room("emergency_stop", stop, "momentary_peak_torque" if is_full else "momentary_peak_count"))
    return tuple(rooms)


def calculation_of(entry: Json, gear: Gear, application: Application, catalogue: Catalogue) -> tuple[Step, ...]:
    """Calculation of a candidate of a reply."""
    duty = selection.select(application, catalogue).duty
    return calculation.calculation_of(candidate_of(entry), duty, gear, application, catalogue)
