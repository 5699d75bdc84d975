"""Examples for every field of the OpenAPI document: what this very service makes of one full application."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import islice
from typing import Any

import msgspec

from hpn import ENGINE_VERSION
from hpn.application import WORKED_EXAMPLE, Application, InputError
from hpn.application.faults import Fault
from hpn.catalogue import Catalogue, ListedMotor
from hpn.engine.envelopes import EnvelopeQuery, life_envelopes
from hpn.engine.selection import Selection, select
from hpn.explain.differences import FigureDifference, differences
from hpn.web.api.batch import batch_lines
from hpn.web.api.catalogue import one_gear
from hpn.web.api.motors import motors_on_gear
from hpn.web.api.replies import encode
from hpn.web.door.problems import Problem
from hpn.web.form.link_writer import to_link

Json = dict[str, Any]

FULL: Json = {
    "duty_cycle": {
        "phases": [phase | {"radial_N": 500.0, "axial_N": 200.0} for phase in WORKED_EXAMPLE["duty_cycle"]["phases"]],
        "pause_s": 4.0,
    },
    "emergency_stop": {"torque_Nm": 200.0, "count": 1000},
    "output_load": {"load_coefficient": 1.2, "life_h": 20000.0, "life_basis": "L50", "model": "linear"},
    "requirements": {"life_h": 20000.0, "efficiency": 0.95, "motor": {"maximum_speed_rpm": 4000.0}},
    "application_area": "medical",
    "rank_by": "weight",
}
"""The handbook's worked example with the rest of what may be asked; no size and no ratio, so any catalogue has it."""

TURNING: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.8,
        "gravity_mass_kg": 12.0,
        "gravity_radius_mm": 250.0,
        "friction_torque_Nm": 1.5,
        "efficiency": 0.9,
    },
    "start_deg": 0.0,
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 0.8, "acceleration_deg_per_s2": 900.0, "name": "turn"},
        {"profile": "dwell", "time_s": 0.4, "external_torque_Nm": 30.0},
        {"profile": "s_curve", "angle_deg": -90.0, "time_s": 1.0, "speed_rpm": 25.0, "jerk_share": 0.5},
    ],
}
LIFTING: Json = {
    "mechanism": {
        "type": "ball_screw",
        "mass_kg": 80.0,
        "lead_mm": 10.0,
        "incline_deg": 30.0,
        "inertia_kgm2": 0.002,
        "friction_force_N": 24.5,
        "friction_torque_Nm": 0.8,
        "counterweight_kg": 30.0,
    },
    "moves": [
        {"profile": "modified_sine", "distance_mm": 500.0, "time_s": 1.2, "external_force_N": 200.0},
        {"profile": "triangular", "distance_mm": -500.0, "speed_mm_per_s": 800.0},
        {"profile": "s_curve", "distance_mm": 200.0, "time_s": 1.0, "jerk_mm_per_s3": 20000.0},
    ],
}
"""Motions of a rotary and of a linear mechanism."""

MOTOR: Json = {
    "designation": "M 40",
    "maximum_speed_rpm": 6000.0,
    "rated_speed_rpm": 3000.0,
    "rated_torque_Nm": 2.4,
    "peak_torque_Nm": 7.2,
    "inertia_kgm2": 0.00015,
    "source": "supplied by the user: data sheet",
}

NAMES = {"title": "Worked example", "reference": "axis-7"}
LABELS = {**NAMES, "author": "M. Muster", "revision": "B", "ordering_code": "HPN-20A-5-J6-BH-AF1"}

WHOLE: Json = {
    "Application": WORKED_EXAMPLE,
    "Batch": {"applications": [{"reference": "axis-7", **WORKED_EXAMPLE}]},
    "SaveRequest": {"application": WORKED_EXAMPLE, **LABELS},
    "Names": NAMES,
}
"""A whole request per body schema: the handbook's worked example (chapter 4.1)."""

ITEMS_SHOWN = 3


def illustrate(schemas: Json, catalogue: Catalogue) -> None:
    """Give every field of the schemas that has no example one."""
    for name, value in _samples(catalogue).items():
        if name in schemas:
            _illustrate(schemas, schemas[name], value)


def _samples(catalogue: Catalogue) -> Json:
    """A value of each schema that no other contains."""
    application = Application.model_validate(FULL)
    link = to_link(application)
    selection = select(application, catalogue, link)
    reply, best = plain(selection), selection.foremost.designation
    gear = plain(catalogue.by_designation[best])
    listed = replace(catalogue, motors=(ListedMotor(**MOTOR),))
    versions = {"engine_version": ENGINE_VERSION, "catalogue_version": catalogue.version}
    where = {"id": "q83vASNFZ4mrze8BI0Vniw", "url": "/selections/q83vASNFZ4mrze8BI0Vniw"}
    shown = {name: reply["candidates"][0][name] for name in ("designation", "status", "utilisation")}
    summary = {**where, "created": "2026-11-21T10:00:00.000000Z", **LABELS, "selected": best, **shown, **versions}
    return {
        **WHOLE,
        "RotaryMotion": TURNING,
        "LinearMotion": LIFTING,
        "DutyCycle": {"motion": TURNING},
        "Application": FULL,
        "BatchItem": {"reference": "axis-7", **FULL},
        "Selection": reply,
        "DutyFigures": plain(select(_moving(TURNING), catalogue).duty),
        "BatchReply": {"results": plain(batch_lines(WHOLE["Batch"]["applications"], catalogue))},
        "BatchLine": plain(batch_lines([{"reference": "axis-8"}], catalogue)[0]),
        "ProblemReply": refusal().body(),
        "CatalogueReply": {
            "gears": [gear],
            "catalogue_version": catalogue.version,
            "series": plain(catalogue.series),
        },
        "OneGearReply": plain(one_gear(catalogue.by_designation[best], catalogue)),
        "MotorsReply": {"catalogue_version": catalogue.version, "motors": [MOTOR]},
        "MotorsOnGearReply": plain(motors_on_gear(application, catalogue.by_designation[best], listed)),
        "EnvelopeReply": envelopes(catalogue, gear["size"]),
        "SelectionListReply": {"selections": [summary], "next_cursor": None},
        "SavedReply": where,
        "SavedSelectionReply": {
            **summary,
            "application": WORKED_EXAMPLE,
            "gear": gear,
            "result": reply,
            "today": versions | _changes(selection, catalogue),
        },
    }


def _moving(motion: Json) -> Application:
    """A motion with loads in its moves."""
    moves = [move | {"radial_N": 500.0, "axial_N": 200.0} for move in motion["moves"]]
    return Application.model_validate({"duty_cycle": {"motion": motion | {"moves": moves}}})


def plain(reply: Any) -> Any:
    """A reply as its reader gets it."""
    return msgspec.json.decode(encode(reply))


def refusal() -> Problem:
    """Of an application whose first phase lasts no time."""
    location = ("duty_cycle", "phases", 0, "duration_s")
    return Problem.at([Fault(location, "must be greater than 0", "greater_than")])


def envelopes(catalogue: Catalogue, size: str) -> Json:
    """Of a size at the published condition."""
    gear = catalogue.find_size(size)
    try:
        curves = plain(life_envelopes(catalogue, gear, EnvelopeQuery())) if gear else []
    except InputError:  # a catalogue whose first choice has no published limits
        curves = []
    limits = {name: source for name, source in gear.sources.items() if name.startswith("dynamic_")} if gear else {}
    return {"size": size, "model": "linear", "curves": curves, "sources": limits}


def _changes(selection: Selection, catalogue: Catalogue) -> Json:
    """Example of differences: torques a tenth higher when saved, and no weight published for the best gear then."""
    phases = [phase | {"torque_Nm": 1.1 * phase["torque_Nm"]} for phase in FULL["duty_cycle"]["phases"]]
    heavier = Application.model_validate(FULL | {"duty_cycle": {"phases": phases}})
    found = differences(select(heavier, catalogue, to_link(heavier)), selection)
    figures = next(difference for difference in found if difference.check)
    best = selection.foremost.designation
    weight = FigureDifference(best, None, "weight_kg", None, catalogue.by_designation[best].weight_kg)
    return {
        "difference_count": len(found),
        "differences": [plain(figures)],
        "figure_differences": [plain(weight)],
        "problem": None,
    }


def _illustrate(schemas: Json, schema: Json, value: Any) -> None:
    if "$ref" in schema:
        _illustrate(schemas, schemas[schema["$ref"].rpartition("/")[2]], value)
    for option in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
        _illustrate(schemas, option, value)
    if isinstance(value, list):
        for item in value[:1]:
            _illustrate(schemas, schema.get("items", {}), item)
    elif isinstance(value, Mapping):
        more = schema.get("additionalProperties")
        if isinstance(more, dict):
            for item in islice(value.values(), 1):
                _illustrate(schemas, more, item)
        for name, field in schema.get("properties", {}).items():
            if name in value:
                field.setdefault("examples", [_brief(value[name], field.get("minItems", 1))])
                _illustrate(schemas, field, value[name])


def _brief(value: Any, least: int = 1) -> Any:
    """A value with few items in each list and mapping of objects, the list itself with the `least` it may have."""
    if isinstance(value, list):
        return [_brief(item) for item in value[: least if value and isinstance(value[0], Mapping) else ITEMS_SHOWN]]
    if isinstance(value, Mapping):
        nested = all(isinstance(item, Mapping) for item in value.values())
        return {name: _brief(item) for name, item in islice(value.items(), 1 if nested else None)}
    return value
