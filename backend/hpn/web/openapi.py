"""The OpenAPI document: what FastAPI finds by itself, and what the direct routes know better."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from hpn.application import WORKED_EXAMPLE
from hpn.units import suffix_of, symbol_of
from hpn.web import schemas

PATH_PARAMETERS = {
    "designation": "Designation in any of the printed spellings, such as HPN-20A-5.",
    "size": "Size, such as 20A.",
    "id": "Identifier that saving answered with.",
}

EXAMPLES: dict[str, Any] = {
    "Application": WORKED_EXAMPLE,
    "Batch": {"applications": [{"reference": "axis-7", **WORKED_EXAMPLE}]},
    "SaveRequest": {"application": WORKED_EXAMPLE, "title": "Worked example", "reference": "axis-7"},
}
"""A whole request per body schema: the handbook's worked example (chapter 4.1)."""

FRAMEWORK = ("HTTPValidationError", "ValidationError")


def complete(document: dict[str, Any], *bodies: type[BaseModel]) -> dict[str, Any]:
    """Add schemas and examples of the request bodies, the one form of every problem, and a text for every parameter."""
    models: list[Any] = [(model, "validation") for model in (*bodies, schemas.ProblemReply)]
    _, definitions = models_json_schema(models, ref_template="#/components/schemas/{model}")
    components = document.setdefault("components", {}).setdefault("schemas", {})
    components.update(definitions["$defs"])
    for operation in _operations(document):
        _give_examples(operation)
        _say_problems(operation)
        _mend_replies(operation)
        for parameter in operation.get("parameters", ()):
            _describe(parameter)
    for name in FRAMEWORK:
        components.pop(name, None)
    return document


def _operations(document: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for operations in document["paths"].values():
        yield from operations.values()


def _give_examples(operation: dict[str, Any]) -> None:
    body = operation.get("requestBody", {}).get("content", {}).get("application/json")
    name = body["schema"].get("$ref", "").rpartition("/")[2] if body else ""
    if name in EXAMPLES:
        body["examples"] = {"worked_example": {"summary": "The handbook's worked example", "value": EXAMPLES[name]}}


def _say_problems(operation: dict[str, Any]) -> None:
    """FastAPI announces its own form of a 422; the service answers problems alone."""
    response = operation["responses"].get("422", {})
    schema = response.get("content", {}).get("application/json", {}).get("schema", {})
    if schema.get("$ref", "").endswith("/HTTPValidationError"):
        operation["responses"] |= {str(status): entry for status, entry in schemas.problems(422).items()}


def _mend_replies(operation: dict[str, Any]) -> None:
    """FastAPI takes a reply that it doesn't encode itself for a text, and says so beside the model."""
    for response in operation["responses"].values():
        for content in response.get("content", {}).values():
            if "$ref" in content.get("schema", {}):
                content["schema"].pop("type", None)


def _describe(parameter: dict[str, Any]) -> None:
    if parameter["in"] == "path":
        parameter.setdefault("description", PATH_PARAMETERS[parameter["name"]])
    if suffix_of(parameter["name"]):
        parameter["schema"]["x-unit"] = symbol_of(parameter["name"])
