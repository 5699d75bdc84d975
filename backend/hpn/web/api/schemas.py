"""OpenAPI entries of routes: bodies that they read themselves, headers, problems and links."""

from collections.abc import Iterable
from typing import Annotated, Any

from fastapi import Path, Query
from pydantic import BaseModel, Field

from hpn.application import WORKED_EXAMPLE, Application, BatchItem
from hpn.web.api.replies import MOST_AT_ONCE
from hpn.web.door.bodies import JSON, NDJSON
from hpn.web.door.conditions import REPLAYED
from hpn.web.door.problems import MEDIA_TYPE, TITLES
from hpn.words.fields import Model

LINES = NDJSON[0]


class Batch(Model):
    """Applications to select gears for."""

    applications: tuple[BatchItem, ...] = Field(max_length=MOST_AT_ONCE, description="Up to 10000 applications.")


EXAMPLES: dict[type[BaseModel], Any] = {
    Application: WORKED_EXAMPLE,
    Batch: {"applications": [{"reference": "axis-7", **WORKED_EXAMPLE}]},
}
"""The handbook's worked example (chapter 4.1) as a whole request."""


def request_body(model: type[BaseModel], *media_types: str) -> dict[str, Any]:
    """OpenAPI entry of a request body in JSON; `openapi.py` adds the model's schema to the document."""
    entry: dict[str, Any] = {"schema": {"$ref": f"#/components/schemas/{model.__name__}"}}
    if model in EXAMPLES:
        entry["examples"] = {"worked_example": {"summary": "The handbook’s worked example", "value": EXAMPLES[model]}}
    return {
        "requestBody": {"required": True, "content": {media_type: dict(entry) for media_type in media_types or (JSON,)}}
    }


def batch_body() -> dict[str, Any]:
    """OpenAPI entry of a batch's body: one JSON object, or lines."""
    body = request_body(Batch)
    body["requestBody"]["content"][LINES] = {
        "schema": {
            "type": "string",
            "description": "Lines that end in a line feed, each a JSON object of the schema BatchItem: an application "
            "with its reference. Any number of lines; blank lines are skipped.",
        }
    }
    return body


def fleet_body(media_types: Iterable[str]) -> dict[str, Any]:
    """OpenAPI entry of a fleet's body, a table."""
    table = {
        "type": "string",
        "format": "binary",
        "description": "One row per axis: column `axis`, columns of lists named like the fields of a phase, and the "
        "other fields of an application by dotted path, such as `requirements.life_h`. Or one row per phase, the rows "
        "of an axis together: the other columns are filled in its first row, or repeat the same value.",
    }
    return {"requestBody": {"required": True, "content": {kind: {"schema": dict(table)} for kind in media_types}}}


OF_AXES = "One row per axis or phase, under any headings; `axes.csv` and `axes.parquet` of a machine are such tables."
OF_MOTORS = "One row per motor; the headings are names and units as in its data sheet."


def with_tables(body: dict[str, Any], media_types: Iterable[str], of: str = OF_AXES) -> dict[str, Any]:
    """OpenAPI entry of a body that may also be a table; `of` describes the table."""
    table = {
        "type": "string",
        "format": "binary",
        "description": of,
    }
    body["requestBody"]["content"] |= {kind: {"schema": dict(table)} for kind in media_types}
    return body


# --- Responses --------------------------------------------------------------------------------------------------------

HEADERS = {
    "X-Request-ID": "Id of the request, as in the log of the service.",
    "RateLimit": "Requests left and seconds until the rate starts again, if a rate is set.",
    "RateLimit-Policy": "Requests allowed in a number of seconds, if a rate is set.",
    "Retry-After": "Seconds to wait before the next request.",
    "Accept-Encoding": "identity: the body was refused because it is compressed.",
    "WWW-Authenticate": "Kind of key to send.",
    "ETag": "Tag of this state, for If-None-Match and If-Match.",
    "Allow": "Methods of this address.",
    "Location": "Address of the new resource, or the address to use instead.",
    REPLAYED: "true: the reply to an earlier request with the same Idempotency-Key, repeated.",
    "Link": "Address of the next page, rel=next; none at the end.",
    "Preference-Applied": "Applied preference of `Prefer`.",
    "Content-Disposition": "File name for a download.",
    "Content-Language": "Language of the file.",
    "HPN-Ignored-Columns": "Index columns of pandas that were ignored, in quotes and percent-encoded; if any.",
}
"""Headers of responses with their descriptions; components of the document."""


def headers(*names: str) -> dict[str, Any]:
    """OpenAPI entries of the headers of a response."""
    return {name: {"$ref": f"#/components/headers/{name}"} for name in names}


def _text(description: str) -> dict[str, Any]:
    return {"description": description, "schema": {"type": "string"}}


HEADER_COMPONENTS = {name: _text(description) for name, description in HEADERS.items()}
"""Headers of responses by name."""


OF_STATUS = {
    401: headers("WWW-Authenticate"),
    405: headers("Allow"),
    415: headers("Accept-Encoding"),
    429: headers("Retry-After"),
    503: headers("Retry-After"),
}
"""Headers of problems."""


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of the problems that a route can answer."""
    return {
        status: {
            "description": TITLES[status],
            "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemReply"}}},
            **({"headers": dict(OF_STATUS[status])} if status in OF_STATUS else {}),
        }
        for status in statuses
    }


ANYWHERE: dict[int | str, dict[str, Any]] = {
    307: {"description": "Redirect to the address without its trailing slash.", "headers": headers("Location")},
    **problems(405),
}
"""OpenAPI entries of answers of every address."""

GUARDED = problems(401, 414, 421, 429, 503)
"""OpenAPI entries of answers of a guarded route: about keys, query, host, rate and load."""

HAS_IT_ALREADY: dict[int | str, dict[str, Any]] = {
    304: {"description": "The client has the current version.", "headers": headers("ETag")}
}
DELETED: dict[int | str, dict[str, Any]] = {204: {"description": "It is deleted."}}


def answers(*statuses: int, status: int = 200, **more: Any) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a route's answer, beside its model, and of its problems."""
    return {status: {"description": "The answer.", **more}, **problems(*statuses)}


def tagged(*statuses: int, **more: Any) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of an answer with an entity tag, of 304, and of its problems."""
    return answers(*statuses, headers=headers("ETag"), **more) | HAS_IT_ALREADY


def batch_answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a batch's answer, which comes in the form of its body."""
    lines = {
        "type": "string",
        "description": "Lines that end in a line feed, each a JSON object of the schema BatchLine: the answer to one "
        "line, in the order of the body.",
    }
    return answers(*statuses, content={LINES: {"schema": lines}})


def fleet_answers(media_types: Iterable[str], *statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entries of a fleet's answer, which comes in the format of its input."""
    table = {"type": "string", "format": "binary", "description": "The table."}
    return {
        200: {
            "description": "The table, in the format of the input.",
            "content": {media_type: {"schema": dict(table)} for media_type in media_types},
            "headers": headers("Content-Disposition", "HPN-Ignored-Columns"),
        },
        **problems(*statuses),
    }


# --- From one operation to the next -----------------------------------------------------------------------------------


def _links(id: str, *operations: str) -> dict[str, Any]:
    """OpenAPI entries that lead to operations on a saved document; the expression `id` locates its id."""
    return {name: {"operationId": name, "parameters": {"id": id}} for name in operations}


OF_A_SELECTION = (
    "getSelectionReport",
    "getSelectionWorkbook",
    "getSelectionSubmodel",
    "renameSelection",
    "deleteSelection",
)
FROM_SAVED = _links("$response.body#/id", "getSelection", *OF_A_SELECTION)
FROM_SELECTION = _links("$request.path.id", *OF_A_SELECTION)
FROM_LIST = {
    **_links("$response.body#/selections/0/id", "getSelection", "deleteSelection"),
    "listSelections": {
        "operationId": "listSelections",
        "parameters": {"cursor": "$response.body#/next_cursor"},
        "description": "The next page.",
    },
}


OF_A_MACHINE = ("getMachine", "changeMachine", "deleteMachine", "addAxes", "saveRevision", "listRevisions", "getGears")
FROM_SAVED_MACHINE = _links("$response.body#/id", *OF_A_MACHINE)
FROM_MACHINE = _links("$request.path.id", *OF_A_MACHINE[1:])


# --- Requests ---------------------------------------------------------------------------------------------------------


Id = Annotated[str, Path(description="Id from the reply to saving.")]
ListId = Annotated[str, Path(description="Id of a list of motors; `server` for motors.csv.")]
Revision = Annotated[
    str | None,
    Query(
        max_length=20,
        description="Label of a revision of the selection, upper and lower case the same; by default the latest.",
    ),
]
Designation = Annotated[str, Path(description="Designation in any of the printed spellings, such as HPN-20A-5.")]
Size = Annotated[str, Path(description="Size, such as 20A.")]


def header(name: str, description: str) -> dict[str, Any]:
    """OpenAPI entry of a request header."""
    return {"name": name, "in": "header", "required": False, **_text(description)}


IF_NONE_MATCH = {"parameters": [header("If-None-Match", "Tag of the client’s version: 304 if it is current.")]}


ONCE_OF_STATE: dict[str, Any] = {
    "parameters": [
        header("Idempotency-Key", "Makes a retry safe."),
        header("If-Match", "Tag of the document’s state; 412 if it has changed since."),
    ]
}
"""Headers of a request that is executed once, for one state of a document."""

FREEZES = answers(
    *(400, 403, 404, 408, 409, 410, 412, 413, 415, 422), status=201, headers=headers("Location", "ETag", REPLAYED)
)
"""Answers to freezing a revision, of a machine or of a selection."""
