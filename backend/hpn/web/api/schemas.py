"""What the API answers, for its OpenAPI document: the reply models with a description and a unit on every field.

Replies are written by the domain and never pass through these models; the tests hold both against each other.
"""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import Response

from hpn.application import BatchItem, BearingModel, Model, name_units
from hpn.web.door.problems import MEDIA_TYPE, TITLES


class JSONBytes(Response):
    """JSON that is already encoded."""

    media_type = "application/json"


class Reply(BaseModel):
    """Base of the reply models."""

    model_config = ConfigDict(json_schema_extra=name_units)


class DutyReply(Reply):
    """What the duty cycle comes to."""

    average_torque_Nm: float = Field(description="Average output torque T_av, equation 17.2.")
    average_output_speed_rpm: float = Field(description="Average output speed n_out_av, equation 17.4.")
    maximum_torque_Nm: float = Field(description="Largest torque T_max of the cycle.")
    maximum_output_speed_rpm: float = Field(description="Largest output speed n_out_max of the cycle.")


class CheckReply(Reply):
    """One check of one candidate."""

    code: str = Field(description="Code of the check; its definition stands in check_definitions.")
    demand: float | None = Field(
        description="The value tested, in the check's unit; null where it is unlimited or not published."
    )
    limit: float | None = Field(
        description="Its bound, in the check's unit; null where it is unlimited or not published."
    )
    utilisation: float | None = Field(
        description="Demand over limit (limit over demand for a minimum); null where there is none."
    )
    status: Literal["pass", "fail", "not_rated"] = Field(description="Verdict of the check.")


class ReserveReply(Reply):
    """How far a driver may grow (above 1) or must shrink (below 1) until a check it moves meets its limit."""

    torque_factor: float | None = Field(description="Factor on all duty torques; null where nothing limits.")
    speed_factor: float | None = Field(description="Factor on all speeds; null where nothing limits.")
    load_factor: float | None = Field(description="Factor on all output loads; null where nothing limits.")
    emergency_stop_torque_Nm: float | None = Field(description="Largest permissible emergency-stop torque.")


class CandidateReply(Reply):
    """One gear, its verdict and why."""

    designation: str = Field(description="Designation such as HPN-20A-5.")
    size: str = Field(description="Size such as 20A.")
    ratio: int = Field(description="Ratio i.")
    stages: int = Field(description="Number of stages.")
    status: Literal["suitable", "unsuitable", "unrated"] = Field(description="Verdict on the candidate.")
    rank: int | None = Field(description="Place among the suitable candidates; null for the rest.")
    utilisation: float | None = Field(
        description="Largest utilisation of the load checks and of failing property checks."
    )
    governing_check: str | None = Field(description="Code of the check with that utilisation.")
    reason: str = Field(description="Why the candidate stands where it does.")
    average_input_speed_rpm: float = Field(description="Average input speed, equation 17.5.")
    maximum_input_speed_rpm: float = Field(description="Maximum input speed, equation 17.6.")
    life_L10_h: float | None = Field(description="Life, equation 17.10; null where unlimited or not rated.")
    momentary_peak_count: float | None = Field(
        description="Allowed number of emergency stops, equation 17.9; null where it sets no limit."
    )
    bearing_life_L50_h: float | None = Field(description="Life of the output bearing that half of the bearings reach.")
    bearing_life_L10_h: float | None = Field(description="Life of the output bearing that nine of ten reach: L50 / 5.")
    motor_peak_torque_Nm: float = Field(
        description="Largest torque at the motor, T/(i·η), without the emergency stop. Where no efficiency is known "
        "η is 1, and the torque a lower bound."
    )
    motor_rated_torque_Nm: float = Field(
        description="RMS torque at the motor, T/(i·η), over the cycle with pause. Where no efficiency is known η is 1, "
        "and the torque a lower bound."
    )
    reserve: ReserveReply = Field(description="Reserve per driver, the other inputs as given.")
    checks: list[CheckReply] = Field(description="Every check that was asked for, in a fixed order.")


class CheckDefinitionReply(Reply):
    """What a check tests; the same for every candidate."""

    title: str = Field(description="Name of the check.")
    equation: str | None = Field(description="Number of the handbook's equation, where it has one.")
    unit: str = Field(description="Unit of demand and limit; empty for a pure number.")
    kind: Literal["maximum", "minimum", "range"] = Field(description="Which way the limit bounds the demand.")
    group: Literal["load", "property"] = Field(
        description="Load checks count in the candidate's utilisation; property checks only where they fail."
    )
    limit_name: str = Field(description="Symbol of the limit.")
    source: str = Field(description="Where the limit comes from.")
    tests: str = Field(description="What it tests.")
    consequence: str = Field(description="What goes wrong where it fails.")
    basis: str = Field(description="On which basis it stands.")
    remedy: str = Field(description="What to turn.")


class NoticeReply(Reply):
    """What to know beyond the numbers."""

    code: str = Field(description="Code of the notice.")
    text: str = Field(description="The notice.")


class SelectReply(Reply):
    """The ranked answer to one application."""

    engine_version: str = Field(description="Version of the calculation.")
    catalogue_version: str = Field(description="Hash of the catalogue's content, supplement included.")
    link: str = Field(description="Address of the page that shows this application.")
    duty: DutyReply = Field(description="The duty cycle's own figures.")
    selected: str | None = Field(description="Designation of the first suitable candidate, or null.")
    candidates: list[CandidateReply] = Field(description="Every gear considered, best first.")
    check_definitions: dict[str, CheckDefinitionReply] = Field(description="Definitions by check code.")
    notices: list[NoticeReply] = Field(description="Assumptions and standings.")


class FieldError(Reply):
    """What is wrong with one field."""

    pointer: str = Field(description="JSON pointer to the field.")
    detail: str = Field(description="What would be right.")


class ProblemReply(Reply):
    """Problem details, RFC 9457."""

    type: str = Field(description="Kind of problem.")
    title: str = Field(description="Name of the kind.")
    status: int = Field(description="HTTP status.")
    detail: str = Field(description="What was wrong and what would be right.")
    errors: list[FieldError] | None = Field(None, description="The fields it is about.")


class BatchLine(Reply):
    """Result of one item."""

    reference: str | None = Field(description="The item's own reference.")
    status: Literal["ok", "error"] = Field(description="Whether the item could be evaluated.")
    selected: str | None = Field(None, description="Designation of the selected gear, or null.")
    governing_check: str | None = Field(None, description="Check that is closest to its limit on that gear.")
    utilisation: float | None = Field(None, description="Utilisation of that check.")
    suitable: int | None = Field(None, description="Number of suitable gears.")
    link: str | None = Field(None, description="Address of the page that shows this application.")
    problem: ProblemReply | None = Field(None, description="Why the item could not be evaluated.")


class BatchReply(Reply):
    """Results in the order of the items."""

    results: list[BatchLine] = Field(description="One line per item.")


class Batch(Model):
    """Applications to select gears for."""

    applications: tuple[BatchItem, ...] = Field(max_length=10_000, description="Up to 10000 applications.")


class ClampBoltReply(Reply):
    """Bolt of the motor coupling; which one depends on the coupling."""

    bolt_size: str = Field(description="Thread.")
    tightening_torque_Nm: float | None = Field(description="Tightening torque.")
    source: str = Field(description="Where the figure comes from.")


class HousingBoltsReply(Reply):
    """Bolts of the housing flange."""

    number_of_bolts: int | None = Field(description="Number of bolts.")
    bolt_size: str | None = Field(description="Thread.")
    pitch_diameter_mm: float | None = Field(description="Bolt pitch diameter.")
    tightening_torque_Nm: float | None = Field(description="Tightening torque.")
    source: str = Field(description="Where the figures come from.")


class GearReply(Reply):
    """One gear with every published figure; null where not published."""

    designation: str = Field(description="Designation such as HPN-20A-5.")
    size: str = Field(description="Size such as 20A.")
    ratio: int = Field(description="Ratio i.")
    stages: int = Field(description="Number of stages.")
    repeated_peak_torque_Nm: float | None = Field(description="Repeated peak torque T_R.")
    rated_torque_Nm: float | None = Field(description="Rated torque T_N.")
    momentary_peak_torque_Nm: float | None = Field(description="Momentary peak torque T_M.")
    maximum_input_speed_rpm: float | None = Field(description="Maximum input speed, grease.")
    average_input_speed_rpm: float | None = Field(description="Permissible average input speed, grease.")
    ambient_temperature_minimum_degC: float | None = Field(description="Lowest ambient temperature.")
    ambient_temperature_maximum_degC: float | None = Field(description="Highest ambient temperature.")
    weight_kg: float | None = Field(description="Net weight of the standard version.")
    backlash_arcmin: float | None = Field(description="Largest backlash.")
    transmission_accuracy_arcmin: float | None = Field(description="Largest transmission error.")
    torsional_stiffness_Nm_per_rad: float | None = Field(description="Torsional stiffness K3.")
    length_min_mm: float | None = Field(description="Shortest length L; it depends on the motor.")
    length_max_mm: float | None = Field(description="Longest length L; it depends on the motor.")
    dynamic_radial_load_N: float | None = Field(description="Permissible radial load at L50 20000 h and 100 rpm.")
    dynamic_axial_load_N: float | None = Field(description="Permissible axial load at L50 20000 h and 100 rpm.")
    clamp_bolts: list[ClampBoltReply] = Field(description="Bolts of the motor coupling.")
    housing_bolts: HousingBoltsReply | None = Field(description="Bolts of the housing flange.")
    note: str | None = Field(description="What is particular about the size.")
    sources: dict[str, str] = Field(description="Where each figure comes from, by field name.")


class SeriesFigureReply(Reply):
    """A figure or text that holds for the whole series."""

    value: float | str = Field(description="The figure or text.")
    unit: str | None = Field(description="Its unit.")
    source: str = Field(description="Where it comes from.")


class OneGearReply(GearReply):
    """One gear by itself, and once more in the form of the whole catalogue, so that one reader serves both."""

    catalogue_version: str = Field(description="Hash of the catalogue's content, supplement included.")
    gears: list[GearReply] = Field(description="The gear, as the list of all gears has it.")


class CatalogueReply(Reply):
    """The whole catalogue."""

    catalogue_version: str = Field(description="Hash of the catalogue's content, supplement included.")
    gears: list[GearReply] = Field(description="Every gear, by size and ratio.")
    series: dict[str, SeriesFigureReply] = Field(description="Figures of the whole series.")


class EnvelopeCurveReply(Reply):
    """Corner points of one envelope, from the axial to the radial axis."""

    load_coefficient: float = Field(description="Load coefficient f_w.")
    radial_N: list[float] = Field(description="Radial loads.")
    axial_N: list[float] = Field(description="Axial loads.")


class EnvelopeReply(Reply):
    """Life envelopes of one size."""

    size: str = Field(description="Size such as 20A.")
    model: BearingModel = Field(description="Model of the envelope.")
    curves: list[EnvelopeCurveReply] = Field(description="One curve per load coefficient.")
    sources: dict[str, str] = Field(description="Where its limits come from, or its points; says what a user supplied.")


def request_body(model: type[BaseModel]) -> dict[str, Any]:
    """OpenAPI entry of a JSON request body; `openapi.py` adds the model's schema to the document."""
    schema = {"$ref": f"#/components/schemas/{model.__name__}"}
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}


def batch_body() -> dict[str, Any]:
    """OpenAPI entry of a batch's body, as one JSON object or as lines."""
    body = request_body(Batch)
    body["requestBody"]["content"]["application/x-ndjson"] = {
        "schema": {
            "type": "string",
            "description": "One application with its reference per line, each a JSON object (schema BatchItem).",
        }
    }
    return body


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of the problems that a route can answer."""
    later = {"headers": {"Retry-After": _text("Seconds after which to come again.")}}
    return {
        status: {
            "description": TITLES[status],
            "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemReply"}}},
            **(later if status in (429, 503) else {}),
        }
        for status in statuses
    }


def _text(description: str) -> dict[str, Any]:
    return {"description": description, "schema": {"type": "string"}}


ETAG = {"ETag": _text("Tag of this state, for If-None-Match and If-Match.")}
LOCATION = {"Location": _text("Address of what was saved.")}
NEXT_PART = {"Link": _text("Address of the part that follows, rel=next.")}
HAS_IT_ALREADY: dict[int | str, dict[str, Any]] = {304: {"description": "The client has it already.", "headers": ETAG}}


def replies(model: type[BaseModel], *statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a route's answer and of its problems."""
    return {200: {"model": model}, **problems(*statuses)}


def batch_replies(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a batch's answer, which comes in the form of its body."""
    entries = replies(BatchReply, *statuses)
    entries[200]["content"] = {
        "application/x-ndjson": {"schema": {"type": "string", "description": "One BatchLine as JSON per line."}}
    }
    return entries


def header(name: str, description: str) -> dict[str, Any]:
    """OpenAPI entry of a request header that a route reads."""
    return {"name": name, "in": "header", "required": False, **_text(description)}


IF_NONE_MATCH = {"parameters": [header("If-None-Match", "Tag of the state that the client has: 304 if it is that.")]}
