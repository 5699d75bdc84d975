"""Entries of the OpenAPI document: the schemas of the typed replies, and what routes take and answer.

Names, sentences and units of quantities come from `hpn.quantities`; the rest stands beside the fields of the replies.
"""

from collections.abc import Mapping
from typing import Any

import msgspec
from pydantic import BaseModel, Field

from hpn.application import BatchItem, Model, name_units
from hpn.quantities import BOLT, CANDIDATE, CHECK, DUTY, ENVELOPE, GEAR, RESERVE, SERIES, Named
from hpn.selection import Selection
from hpn.web.api import replies
from hpn.web.door.problems import MEDIA_TYPE, TITLES

DESCRIBED: Mapping[str, Mapping[str, Named]] = {
    "DutyFigures": DUTY,
    "Candidate": CANDIDATE,
    "CheckResult": CHECK,
    "Reserve": RESERVE,
    "Gear": GEAR,
    "ClampBolt": BOLT,
    "HousingBolts": BOLT,
    "SeriesFigure": SERIES,
    "EnvelopeCurve": ENVELOPE,
}
"""Replies whose fields are quantities."""

REPLIES: tuple[type, ...] = (
    Selection,
    replies.BatchReply,
    replies.CatalogueReply,
    replies.EnvelopeReply,
    replies.SavedReply,
    replies.SavedSelectionReply,
    replies.SelectionListReply,
    replies.ProblemReply,
)

ONE_GEAR = "OneGearReply"


class Batch(Model):
    """Applications to select gears for."""

    applications: tuple[BatchItem, ...] = Field(max_length=10_000, description="Up to 10000 applications.")


def components() -> dict[str, Any]:
    """Schemas of every reply by name, with a sentence and a unit on every field."""
    _, found = msgspec.json.schema_components(REPLIES, ref_template="#/components/schemas/{name}")
    for name, schema in found.items():
        _complete(schema, DESCRIBED.get(name, {}))
    return found | {ONE_GEAR: _one_gear(found["Gear"])}


def _complete(schema: dict[str, Any], named: Mapping[str, Named]) -> None:
    """Describe quantities, and say that a reply always has what only an old saved one may lack."""
    for field, entry in schema.get("properties", {}).items():
        if field in named:
            equation = f" Equation {named[field].equation}." if named[field].equation else ""
            entry["description"] = named[field].sentence + equation
        if ("default" in entry or field in named) and field not in schema["required"]:
            schema["required"].append(field)
        entry.pop("default", None)
    name_units(schema)


def _one_gear(gear: dict[str, Any]) -> dict[str, Any]:
    """One gear by itself, and once more in the form of the whole catalogue, so that one reader serves both."""
    own = {
        "catalogue_version": {"type": "string", "description": "Hash of the catalogue's content, supplement included."},
        "gears": {
            "type": "array",
            "items": {"$ref": "#/components/schemas/Gear"},
            "description": "The gear, as the list of all gears has it.",
        },
    }
    return {
        **gear,
        "title": ONE_GEAR,
        "description": _one_gear.__doc__,
        "properties": {**gear["properties"], **own},
        "required": [*gear["required"], *own],
    }


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


def answers(reply: str, *statuses: int, status: int = 200, **more: Any) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a route's answer, by the name of its schema, and of its problems."""
    content = {"application/json": {"schema": {"$ref": f"#/components/schemas/{reply}"}}}
    return {status: {"description": "The answer.", "content": content, **more}, **problems(*statuses)}


def batch_answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a batch's answer, which comes in the form of its body."""
    entries = answers("BatchReply", *statuses)
    entries[200]["content"]["application/x-ndjson"] = {
        "schema": {"type": "string", "description": "One BatchLine as JSON per line."}
    }
    return entries


def header(name: str, description: str) -> dict[str, Any]:
    """OpenAPI entry of a request header that a route reads."""
    return {"name": name, "in": "header", "required": False, **_text(description)}


IF_NONE_MATCH = {"parameters": [header("If-None-Match", "Tag of the state that the client has: 304 if it is that.")]}
