"""Selections to be exported, from the plain example to what is hostile."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import msgspec

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import Selection, encode, select
from hpn.files import export
from hpn.links.writer import to_link
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, Json, cycle, phase, worked_example
from tests.wire import candidate_of

CREATED = datetime(2026, 11, 21, 10, 15, tzinfo=UTC)

EVERYTHING = cycle(
    phase(40, 250, 0.3, radial_N=900, axial_N=300),
    phase(32, 500, 3.0),
    phase(-20, 250, 0.4, radial_N=700),
    pause_s=4.0,
    emergency_stop={"torque_Nm": 200, "count": 1000},
    output_load={"radial_N": 500, "axial_N": 200, "load_coefficient": 1.2},
    requirements={
        "ratios": [3, 5, 10, 25],
        "life_h": 20000,
        "backlash_arcmin": 7,
        "torsional_stiffness_Nm_per_rad": 5000,
        "weight_kg": 5,
        "length_mm": 200,
        "ambient_temperature_degC": 25,
        "utilisation": 0.9,
        "efficiency": 0.95,
        "motor": {"maximum_speed_rpm": 4000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
    },
    application_area="medical",
)
"""Every input there is, with values of which none is a default."""


def long_cycle(phases: int, **parts: Any) -> Json:
    """A cycle of many different phases."""
    steps = (phase(30 * math.sin(k / 3) + 5, 300 * math.cos(k / 7), 0.1 + 0.01 * (k % 7)) for k in range(phases))
    return cycle(*steps, **parts)


CASES: dict[str, Json] = {
    "example": worked_example(requirements={"ratios": [5]}),
    "everything": EVERYTHING,
    "twenty phases": EVERYTHING | {"duty_cycle": long_cycle(20)["duty_cycle"]},
    "ten thousand phases": long_cycle(10_000, output_load={"radial_N": 300}),
    "nothing suitable": cycle(
        phase(900, 900), emergency_stop={"torque_Nm": 5000, "count": 5}, requirements={"sizes": ["11A", "14A", "20A"]}
    ),
    "not rated": cycle(phase(400, 90), requirements={"sizes": ["40A"]}),
    "iso281": worked_example(output_load={"radial_N": 700, "axial_N": 90, "model": "iso281", "life_basis": "L10"}),
    "extremes": cycle(phase(0, 1e-5, 1e-9), phase(1e-300, 1e6, 1e9), output_load={"radial_N": 1e9, "axial_N": 0}),
    "standing loads": cycle(phase(0, 100), phase(50, 0, 2), emergency_stop={"torque_Nm": 10}),
}


def typed_export_of(
    application: Json, catalogue: Catalogue, *, title: str = "Rotary table", reference: str = ""
) -> export.Export:
    """An export as a saved selection gives it."""
    question = Application.model_validate(application)
    return export.Export(
        application=question,
        selection=select(question, catalogue, to_link),
        link="http://hpn.example/selections/0123456789abcdefghijkl",
        heading=export.ExportTitle(title, reference),
        created=CREATED,
        catalogue=catalogue,
    )


# --- The same as JSON -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Export:
    """An export whose selection is JSON."""

    application: Application
    reply: Json
    title: str
    reference: str
    catalogue: Catalogue | None

    @property
    def candidates(self) -> Sequence[Json]:
        """Every candidate, best first."""
        candidates: Sequence[Json] = self.reply["candidates"]
        return candidates

    def is_lower_bound(self, candidate: Json) -> bool:
        """True where the motor torques of a candidate are loss-free in some phase."""
        return self.typed().account.of(candidate_of(candidate)).is_lower_bound

    def typed(self) -> export.Export:
        """The same, typed."""
        return export.Export(
            application=self.application,
            selection=msgspec.convert(self.reply, Selection),
            link="http://hpn.example/selections/0123456789abcdefghijkl",
            heading=export.ExportTitle(self.title, self.reference),
            created=CREATED,
            catalogue=self.catalogue,
        )


def export_of(application: Json, catalogue: Catalogue, *, title: str = "Rotary table", reference: str = "") -> Export:
    """An export as a saved selection gives it."""
    question = Application.model_validate(application)
    reply = msgspec.json.decode(encode(select(question, catalogue, to_link)))
    return Export(question, reply, title, reference, catalogue)


def language(code: str) -> Reader:
    """Reader of a file."""
    return Reader(code, digits=export.DIGITS)


# --- Motions and phases that vary -------------------------------------------------------------------------------------

MOTOR = {
    "maximum_speed_rpm": 6000,
    "peak_torque_Nm": 12,
    "rated_torque_Nm": 4,
    "rated_speed_rpm": 3000,
    "inertia_kgm2": 0.00015,
    "inertia_ratio": 80,
}

MOVING: dict[str, Json] = {
    "phases that vary": cycle(
        phase(40, 250, 0.3, peak_torque_Nm=55, peak_speed_rpm=400, rms_torque_Nm=42, radial_N=500),
        phase(-32, 500, 3.0, peak_torque_Nm=36),
        phase(20, 250, 0.4),
        pause_s=4.0,
        requirements={"load_inertia_kgm2": 0.2, "efficiency": 0.95, "motor": MOTOR},
    ),
    "rotary table": {
        "duty_cycle": {"motion": TURNING, "pause_s": 0.5},
        "emergency_stop": {"torque_Nm": 150},
        "requirements": {"ratios": [5, 10, 20], "motor": MOTOR},
    },
    "ball screw": {
        "duty_cycle": {"motion": LIFTING | {"moves": [move | {"axial_N": 90} for move in LIFTING["moves"]]}},
        "requirements": {"sizes": ["11A", "14A"], "efficiency": 0.9},
        "rank_by": "motor_torque",
    },
    "many moves": {"duty_cycle": {"motion": LIFTING | {"moves": LIFTING["moves"] * 40}}},
}
"""Cycles whose torque and speed vary, typed or from a motion."""
