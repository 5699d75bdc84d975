"""Descriptions of the tools, kept short: an agent carries them along in every conversation."""

from collections.abc import Mapping
from typing import Any

from hpn.words.terms import LIFE_BASES, RANKINGS

Schema = dict[str, Any]

INSTRUCTIONS = (
    "Selects a Harmonic Drive HPN planetary gear for a duty cycle. Torque and speed are at the gear’s output, in the "
    "units that end each name. Never make up an input: ask the user. Give the limits with their sources, and say that "
    "a selection has to be checked with the manufacturer before ordering."
)


def _object(properties: Schema, *required: str) -> Schema:
    needed = {"required": list(required)} if required else {}
    return {"type": "object", "properties": properties, **needed}


def _numbers(*names: str) -> Schema:
    return {name: {"type": "number"} for name in names}


def _list(items: Schema) -> Schema:
    return {"type": "array", "items": items}


_TYPED = ("torque_Nm", "speed_rpm", "duration_s")
PHASE = _object(_numbers(*_TYPED, "radial_N", "axial_N"), *_TYPED)
MOTOR = _object(_numbers("maximum_speed_rpm", "peak_torque_Nm", "rated_torque_Nm", "inertia_kgm2"))
REQUIREMENTS = _object(
    {
        "ratios": _list({"type": "integer"}),
        "sizes": _list({"type": "string"}),
        **_numbers("life_h", "backlash_arcmin", "torsional_stiffness_Nm_per_rad", "weight_kg", "length_mm"),
        **_numbers("ambient_temperature_degC", "utilisation", "efficiency", "load_inertia_kgm2"),
        "motor": MOTOR,
    }
)
LOAD = _object(
    _numbers("radial_N", "axial_N", "load_coefficient", "life_h") | {"life_basis": {"enum": list(LIFE_BASES)}}
)
APPLICATION = _object(
    {
        "duty_cycle": _object({"phases": _list(PHASE), **_numbers("pause_s")}),
        "emergency_stop": _object(_numbers("torque_Nm", "count")),
        "output_load": LOAD,
        "requirements": REQUIREMENTS,
        "rank_by": {"enum": list(RANKINGS)},
    },
    "duty_cycle",
) | {
    "description": "What POST /api/v1/select takes, its other fields too (motion, brake, tolerances): "
    "/api/v1/application.schema.json has them all."
}
DESIGNATION: Schema = {"type": "string", "description": "such as HPN-20A-5"}

TOOLS: Mapping[str, tuple[str, Schema]] = {
    "select": (
        "Select a gear: the decision, each limit with equation and page, the next gears, a link to the whole "
        "calculation.",
        _object({"application": APPLICATION}, "application"),
    ),
    "explain": (
        "Say why one gear does or doesn’t fit, limit by limit, and what would let it fit.",
        _object(
            {"application": {"type": "object", "description": "as in select"}, "designation": DESIGNATION},
            "application",
            "designation",
        ),
    ),
    "catalogue": (
        "Published figures of one gear, each with table and page; without a designation every gear.",
        _object({"designation": DESIGNATION}),
    ),
}
"""Description and schema of each tool, by its name."""
