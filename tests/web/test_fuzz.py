"""Thousands of requests that the OpenAPI document allows, and as many that it forbids: no server error."""

from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
from fastapi import FastAPI
from hypothesis import HealthCheck, given, settings
from schemathesis import Case, GenerationMode
from schemathesis.checks import not_a_server_error
from schemathesis.python.asgi import shutdown_lifespans
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from hpn.web.app import create_app
from hpn.web.settings import Settings

CHECKS = [not_a_server_error, status_code_conformance, content_type_conformance, response_schema_conformance]
OPERATIONS: dict[str, dict[str, Any]] = {
    f"{method.upper()} {path}": operation
    for path, operations in create_app().openapi()["paths"].items()
    for method, operation in operations.items()
}


def modes(operation: dict[str, Any]) -> list[GenerationMode]:
    """Modes of requests to try: forbidden ones only with a body or query, as a path may contain any text."""
    places = {parameter["in"] for parameter in operation.get("parameters", ())}
    forbids = "requestBody" in operation or "query" in places
    return list(GenerationMode) if forbids else [GenerationMode.POSITIVE]


MUCH = ("/select", "/select/batch", "/bearing-envelopes/{size}", "/selections")
SLOW = ("pdf", "xlsx", "aasx")


def examples(label: str) -> int:
    """Number of examples of an operation: most for those that read an application, few for those that make a file."""
    return 15 if label.endswith(SLOW) else 350 if label.endswith(MUCH) else 100


@pytest.fixture(scope="module")
def schema(tmp_path_factory: pytest.TempPathFactory) -> Iterator[schemathesis.BaseSchema]:
    """Document of a service with its own database; schemathesis starts the service at its first request."""
    file = tmp_path_factory.mktemp("fuzz") / "selections.sqlite3"
    app: FastAPI = create_app(Settings(database_url=f"sqlite:///{file}", log_level="error"))
    yield schemathesis.openapi.from_asgi("/openapi.json", app)
    shutdown_lifespans()


@pytest.mark.parametrize(
    ("label", "mode"),
    [
        pytest.param(label, mode, id=f"{label}-{mode.value}")
        for label, operation in OPERATIONS.items()
        for mode in modes(operation)
    ],
)
def test_no_request_brings_the_service_to_a_mistake(
    schema: schemathesis.BaseSchema, label: str, mode: GenerationMode
) -> None:
    operation = schema.find_operation_by_label(label)
    assert operation is not None

    @settings(max_examples=examples(label), deadline=None, suppress_health_check=list(HealthCheck))
    @given(operation.as_strategy(generation_mode=mode))
    def try_out(case: Case[Any]) -> None:
        case.call_and_validate(checks=CHECKS)

    try_out()
