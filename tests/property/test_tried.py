"""Every remedy followed to the letter: what "Try it" links to is a selection in which the gear passes."""

import math
import random
from collections.abc import Iterator
from urllib.parse import parse_qsl

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.remedy import Alternative, alternatives_of, growths_of
from hpn.engine.selection import select
from hpn.engine.tried import tried
from hpn.web.form.link_reader import parse
from hpn.web.form.link_writer import to_link
from tests.build import Json
from tests.property.draw import at_random

PROPERTIES = {"ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"}


def rejected(chance: random.Random, catalogue: Catalogue) -> Iterator[tuple[Application, Candidate]]:
    """Gears at random that an application at random rejects though everything about them is known, without end."""
    while True:
        application = Application.model_validate(at_random(chance))
        known = [one for one in select(application, catalogue).candidates if one.is_judged]
        if failing := [one for one in known if one.status == "unsuitable"]:
            yield application, chance.choice(failing)


def verdict(application: Application, designation: str, catalogue: Catalogue) -> str:
    """Verdict on a gear."""
    candidate = select(application, catalogue).candidate(designation)
    assert candidate is not None
    return candidate.status


def has_no_brake(candidate: Candidate) -> bool:
    """True where no brake both stops the load and keeps the gear, or where the one that is given is too weak."""
    peak = candidate.check("momentary_peak_torque")
    return candidate.reserve.brake_torque_Nm == 0 or (
        peak is not None and peak.status == "fail" and not peak.utilisation
    )


def test_each_alternative_of_each_rejected_gear_alone_makes_it_pass(catalogue: Catalogue, soak: bool) -> None:
    """Property limits included, as the link writes it and the form reads it again."""
    found = rejected(random.Random(16), catalogue)
    several, properties = 0, 0
    for application, candidate in (next(found) for _ in range(6000 if soak else 300)):
        alternatives = alternatives_of(candidate, application.requirements.utilisation)
        assert alternatives or has_no_brake(candidate), (candidate, application)
        several += len(alternatives) > 1
        properties += bool(PROPERTIES & {check.code for check in candidate.failing})
        for alternative in alternatives:
            followed = read_back(application, alternative, catalogue)
            assert verdict(followed, candidate.designation, catalogue) == "suitable", (alternative, application)
    assert several > 10  # the draw has gears with a choice,
    assert properties > 10  # and some that fail a limit which no driver moves


def read_back(application: Application, alternative: Alternative, catalogue: Catalogue) -> Application:
    """Application that opens with the link."""
    query = to_link(tried(application, alternative, catalogue)).partition("?")[2]
    form = parse(parse_qsl(query, keep_blank_values=True))
    assert form.application is not None, form.problems
    return form.application


def test_a_check_is_full_when_its_driver_has_grown_as_far_as_it_says(catalogue: Catalogue, soak: bool) -> None:
    """Each driver of each check of a gear at random: a hair below its limit the check passes, a hair above it fails."""
    chance = random.Random(17)
    seen = set()
    for _ in range(1000 if soak else 60):
        application = Application.model_validate(at_random(chance))
        candidate = chance.choice(select(application, catalogue).candidates)
        for code, growths in growths_of(candidate, application.requirements.utilisation).items():
            for growth in growths:
                if growth.factor is None or not 1e-3 < growth.factor < 1e2:  # inside the bounds of the input
                    continue
                seen.add((code, growth.driver))
                for factor, expected in ((growth.factor * (1 - 1e-9), "pass"), (growth.factor * (1 + 1e-6), "fail")):
                    again = select(grown(application, growth.driver, factor, candidate), catalogue)
                    found = again.candidate(candidate.designation)
                    check = found and found.check(code)
                    assert check is not None
                    assert check.status == expected, (code, growth, application)
    assert len(seen) > 10


FIELDS = {
    "torque": ("torque_Nm", "peak_torque_Nm", "rms_torque_Nm"),
    "speed": ("speed_rpm", "peak_speed_rpm"),
    "load": ("radial_N", "axial_N"),
}


def grown(application: Application, driver: str, factor: float, candidate: Candidate) -> Application:
    """The application with a driver multiplied; a number of stops is a whole one, on the same side of its bound.

    The torque of an emergency stop that a brake gives is typed in place of the brake.
    """
    changed: Json = application.model_dump(exclude_unset=True)
    if driver == "emergency_stop":
        assert candidate.stop_torque_Nm is not None
        changed["emergency_stop"].pop("brake", None)
        changed["emergency_stop"]["torque_Nm"] = candidate.stop_torque_Nm * factor
    elif driver == "emergency_stop_count":
        changed["emergency_stop"]["count"] = math.ceil(changed["emergency_stop"]["count"] * factor * (1 - 1e-8))
    else:
        for part in (*changed["duty_cycle"]["phases"], changed.get("output_load") or {}):
            part |= {name: part[name] * factor for name in FIELDS[driver] if part.get(name) is not None}
    return Application.model_validate(changed)
