"""Machines for tests: documents as they were frozen, and a packing line of 40 axes."""

from collections.abc import Sequence
from typing import Any

import msgspec
from msgspec import Raw

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion, answers
from hpn.documents.axis import Axis
from hpn.documents.common import Common
from hpn.documents.merge import resolve
from hpn.documents.revision import Frozen, FrozenAxis
from tests.build import Json, cycle, phase

COMMON: Json = {
    "requirements": {"utilisation": 0.9, "life_h": 20000.0},
    "output_load": {"load_coefficient": 1.2, "life_h": 20000.0, "life_basis": "L50"},
    "rank_by": "weight",
}


def frozen(axes: Sequence[Json], catalogue: Catalogue, common: Json | None = None, **block: str) -> Frozen:
    """A document as it is frozen, its axes numbered as they stand unless they have a `number`."""
    sent = Common.model_validate(common or {}).as_json
    own = [Axis.model_validate({name: value for name, value in axis.items() if name != "number"}) for axis in axes]
    resolved = [resolve(axis.application, sent, axis.without) for axis in own]
    asked = [AxisQuestion(each, axis.ordering_code) for each, axis in zip(resolved, own, strict=True)]
    numbers = [axis.get("number", place) for place, axis in enumerate(axes, 1)]
    return Frozen(
        **{"title": None, "reference": None, "author": None, "note": None, **block},
        common=sent,
        axes=tuple(
            FrozenAxis(
                number=number,
                name=axis.name,
                quantity=axis.quantity,
                note=axis.note,
                ordering_code=axis.ordering_code,
                without=axis.without,
                application=Raw(msgspec.json.encode(axis.application)),
                resolved=Raw(msgspec.json.encode(each.whole)),
                answer=answer,
            )
            for number, axis, each, answer in zip(numbers, own, resolved, answers(asked, catalogue), strict=True)
        ),
    )


def axis(name: str, application: Json, quantity: int = 1, **rest: Any) -> Json:
    """One axis as it is sent."""
    return {"name": name, "quantity": quantity, "application": application, **rest}


NAMES = (
    *("X1 gantry, left", "X2 gantry, right", "Y bridge", "Z1 lift", "A wrist swivel", "C wrist turn", "Magazine disc"),
    *("Tool arm", "Infeed belt 1", "Infeed belt 2", "Spacing screw", "Pusher, carton", "Carton erector"),
    *("Flap folder, front", "Flap folder, rear", "Glue unit lift", "Rotary table 1", "Rotary table 2"),
    *("Indexing table, fill", "Press ram", "Press feed", "Sealing jaw, long", "Sealing jaw, cross", "Film unwind"),
    *("Film draw roll, upper", "Film draw roll, lower", "Knife, rotary", "Dancer", "Discharge belt"),
    *("Turning station", "Gripper rotate", "Gripper lift", "Layer pusher", "Pallet lift", "Pallet conveyor 1"),
    *("Pallet conveyor 2", "Slip sheet arm", "Stretch ring", "Stretch lift", "Label applicator"),
)


def packing_line(*, pallet: float = 1.0) -> list[Json]:
    """Axes of a packing line: one lacks the speed of a phase, and with a heavier pallet no gear lifts it."""
    axes = [axis(name, _application(place), 1 + (place % 7 == 3)) for place, name in enumerate(NAMES)]
    del axes[12]["application"]["duty_cycle"]["phases"][1]["speed_rpm"]
    lift = cycle(
        phase(344 * pallet, 350, 0.25), phase(189 * pallet, 700, 1.6), phase(-292 * pallet, 350, 0.25), pause_s=0.4
    )
    axes[33]["application"] = lift | {
        "emergency_stop": {"torque_Nm": 360.0},
        "output_load": {"radial_N": 1500.0, "axial_N": 370.0},
    }
    axes[19]["application"]["requirements"] = {"utilisation": 0.8}
    axes[37] |= {"ordering_code": "HPN-20A-5-J6-BH-AF1", "note": "as ordered in May"}
    return axes


def _application(place: int) -> Json:
    torque, speed = 6.0 + 9.0 * (place * 7 % 13), 180.0 + 40.0 * (place * 5 % 11)
    application = cycle(
        phase(torque, speed / 2, 0.3), phase(torque / 2, speed, 1.2), phase(-0.8 * torque, speed / 2, 0.3), pause_s=0.6
    )
    if place % 3:
        application["output_load"] = {"radial_N": 100.0 + 40.0 * (place % 5), "axial_N": 30.0 + place}
    if place % 4:
        application["emergency_stop"] = {"torque_Nm": round(1.9 * torque, 1)}
    return application
