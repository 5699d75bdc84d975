"""Boxes of tolerances at random, and points of them by a rule of their own: applications as one would type them."""

import copy
import random
from collections.abc import Iterator, Sequence
from typing import Any

from tests.build import Json
from tests.property.draw import at_random

Place = tuple[str | int, ...]
Ends = dict[Place, tuple[float, float]]

ROWS = ("torque_Nm", "speed_rpm", "duration_s", "radial_N", "axial_N")
CROSSING = ("torque_Nm", "radial_N", "axial_N", "external_torque_Nm", "external_force_N")
SINGLE = (
    "pause_s",
    "emergency_stop.torque_Nm",
    "emergency_stop.brake.torque_Nm",
    "emergency_stop.brake.load_torque_Nm",
    "output_load.radial_N",
    "output_load.axial_N",
    "output_load.load_coefficient",
    "output_load.axial_radius_mm",
    "output_load.shaft_centre_mm",
    "output_load.drive.diameter_mm",
    "requirements.life_h",
    "requirements.efficiency",
    "requirements.backlash_arcmin",
    "requirements.torsional_stiffness_Nm_per_rad",
    "requirements.weight_kg",
    "requirements.length_mm",
    "requirements.ambient_temperature_degC",
    "requirements.load_inertia_kgm2",
    "requirements.natural_frequency_Hz",
    "requirements.position_error_arcmin",
    "requirements.rest_friction_Nm",
    "requirements.motor.maximum_speed_rpm",
    "requirements.motor.peak_torque_Nm",
    "requirements.motor.rated_torque_Nm",
    "requirements.motor.rated_speed_rpm",
    "requirements.motor.inertia_kgm2",
    "requirements.motor.inertia_ratio",
    "motion.mechanism.mass_kg",
    "motion.mechanism.inertia_kgm2",
    "motion.mechanism.friction_torque_Nm",
    "motion.mechanism.friction_coefficient",
    "motion.mechanism.efficiency",
    "motion.mechanism.ratio",
    "motion.moves.0.external_force_N",
    "motion.moves.1.external_force_N",
    "motion.moves.0.external_torque_Nm",
)
"""Single numbers that get a tolerance where an application has them."""


def box_at_random(chance: random.Random, document: Json | None = None) -> Json:
    """An application with tolerances on some of its inputs."""
    document = copy.deepcopy(document) if document is not None else at_random(chance)
    cycle = document["duty_cycle"]
    _ask_more(document, chance)
    if "phases" in cycle and len(cycle["phases"]) > 5:
        cycle["phases"] = cycle["phases"][:5]
    tolerances: Json = {}
    candidates = [*SINGLE, *(ROWS if "phases" in cycle else ("radial_N", "axial_N"))]
    candidates += [f"phases.{k}.torque_Nm" for k in range(len(cycle.get("phases", ())))]
    for path in candidates:
        result = value_at(document, path)
        is_row = path in ROWS
        if chance.random() < 0.5 or isinstance(result, dict) or (not is_row and not result):
            continue
        crosses = path.rpartition(".")[2] in CROSSING and not path.startswith("emergency_stop.brake")
        most = 150 if crosses and chance.random() < 0.2 else 40
        percent = chance.choice([0.5, 5, chance.uniform(0, most)])
        if path in ("requirements.efficiency", "motion.mechanism.efficiency", "output_load.load_coefficient"):
            tolerances[path] = {"minus": {"percent": 0}, "plus": {"percent": 0}}
            side = "minus" if path.endswith("efficiency") else "plus"
            room = 100 * (3.0 / result - 1) if side == "plus" else 20.0  # no load coefficient is above 3
            tolerances[path][side] = {"percent": min(percent, room) / 1.001}
        elif chance.random() < 0.2:
            tolerances[path] = {"minus": {"percent": percent / 2}, "plus": {"percent": percent}}
        elif chance.random() < 0.2 and result:
            tolerances[path] = {"absolute": abs(result) * percent / 100}
        else:
            tolerances[path] = {"percent": percent}
    return document | {"tolerances": tolerances}


def _ask_more(document: Json, chance: random.Random) -> None:
    """Ask more often for what few applications ask for: life, stops by the brake, pinion or pulley."""
    question = document.setdefault("requirements", {})
    if chance.random() < 0.5:
        question.setdefault("life_h", 10 ** chance.uniform(3, 5))
    if "phases" not in document["duty_cycle"]:
        return
    if chance.random() < 0.2:
        brake = {"torque_Nm": chance.uniform(0.5, 30), "load_torque_Nm": chance.uniform(0, 20)}
        document["emergency_stop"] = {"brake": brake, "count": chance.choice([0, 10, 10**5])}
        question["load_inertia_kgm2"] = 10 ** chance.uniform(-3, 0.5)
        question["motor"] = {**question.get("motor", {}), "inertia_kgm2": 10 ** chance.uniform(-5, -3)}
    if chance.random() < 0.2 and "output_load" in document:
        drive = {"type": chance.choice(["rack_and_pinion", "belt"]), "diameter_mm": chance.uniform(20, 200)}
        document["output_load"]["drive"] = drive


def _place(path: str) -> Place:
    parts: Place = tuple(int(part) if part.isdigit() else part for part in path.split("."))
    return ("duty_cycle", *parts) if parts[0] in ("phases", "motion", "pause_s") else parts


def value_at(document: Json, path: str) -> Any:
    """Number that a document has at a path; None where it has none."""
    part: Any = document
    for step in _place(path):
        try:
            part = part[step]
        except (KeyError, IndexError, TypeError):
            return None
    return part


def ends_of(document: Json) -> Ends:
    """Both ends of each number that has a tolerance, by its place."""
    result: Ends = {}
    tolerances = document["tolerances"]
    for path in sorted(tolerances, key=lambda one: one.startswith("phases.")):
        for place in _places(document, path):
            value = _at(document, place)
            result[place] = _around(tolerances[path], value)
    return {place: ends for place, ends in result.items() if ends[0] < ends[1]}


def _places(document: Json, path: str) -> Iterator[Place]:
    if path not in ROWS:
        yield _place(path)
        return
    cycle = document["duty_cycle"]
    table: Place = ("duty_cycle", "phases") if "phases" in cycle else ("duty_cycle", "motion", "moves")
    for number, row in enumerate(_at(document, table)):
        if row.get(path):
            yield (*table, number, path)


def _at(document: Json, place: Sequence[Any]) -> Any:
    part: Any = document
    for step in place:
        part = part[step]
    return part


def _around(tolerance: Json, value: float) -> tuple[float, float]:
    def deviation(side: Json) -> float:
        amount: float = side["absolute"] if "absolute" in side else abs(value) * side["percent"] / 100
        return amount

    alike = "minus" not in tolerance
    minus, plus = (deviation(tolerance if alike else tolerance[side]) for side in ("minus", "plus"))
    return value - minus, value + plus


def point(document: Json, ends: Ends, shares: Sequence[float]) -> Json:
    """The application at a point of its box: each share runs from 0, the lower end, to 1."""
    moved = copy.deepcopy(document)
    del moved["tolerances"]
    for (place, (low, high)), share in zip(ends.items(), shares, strict=True):
        row, name = _at(moved, place[:-1]), place[-1]
        value, x = row[name], low + share * (high - low)
        row[name] = x
        if place[:2] == ("duty_cycle", "phases"):
            if name == "torque_Nm":
                _follow(row, ("peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm"), value, x, low <= 0 <= high)
            elif name == "speed_rpm":
                _follow(row, ("peak_speed_rpm",), value, x, reaches=False)
    return moved


def _follow(row: Json, names: Sequence[str], value: float, x: float, reaches: bool) -> None:
    """Fields that go with a torque or a speed move by its factor; where the torque may be 0, by the addition."""
    for name in names:
        if row.get(name) is not None:
            added = 0.0 if name == "least_torque_Nm" else row[name] + abs(x - value)
            row[name] = added if reaches else row[name] * abs(x / value)
