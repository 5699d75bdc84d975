"""Chains of requests by the links of the OpenAPI document: save, read, export, list, delete."""

import sqlite3
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from hypothesis.strategies import SearchStrategy, one_of, sampled_from
from pydantic import SecretStr
from schemathesis import Case, HookContext, Response
from schemathesis.checks import not_a_server_error
from schemathesis.python.asgi import shutdown_lifespans
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    ensure_resource_availability,
    response_schema_conformance,
    status_code_conformance,
    use_after_free,
)

from hpn.store.tables import metadata
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example

CHECKS = [
    *(not_a_server_error, status_code_conformance, content_type_conformance, response_schema_conformance),
    *(use_after_free, ensure_resource_availability),
]
STEPS = 6
"""Maximum requests in a scenario."""

SELECTION, MACHINE, LIST = "/api/v1/selections/{id}", "/api/v1/machines/{id}", "/api/v1/motor-lists/{id}"
REACHED = {
    "selections": {("POST /api/v1/selections", 201), (f"PATCH {SELECTION}", 200), (f"DELETE {SELECTION}", 204)}
    | {(f"GET {SELECTION}{name}", 200) for name in ("", "/report.pdf", "/report.xlsx", "/submodel.aasx")},
    "machines": {("POST /api/v1/machines", 201), (f"PATCH {MACHINE}", 200), (f"DELETE {MACHINE}", 204)}
    | {(f"GET {MACHINE}{name}", 200) for name in ("", "/gears")},
    "motor-lists": {("POST /api/v1/motor-lists", 201), (f"PUT {LIST}", 200), (f"DELETE {LIST}", 204)}
    | {(f"GET {LIST}", 200)},
}
"""Answers that chains must reach, by the kind of document that they save first.

Each chain uses one kind of document: with more operations to choose from, fewer chains continue with the same
document. The short form has these operations; the fuzz tries the others singly, the long form in chains.
"""

ROUNDS = 6
"""Maximum rounds; each draws twice as many chains as the last and thus continues it, so the result needs no luck."""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Database file of the service."""
    return tmp_path_factory.mktemp("stateful") / "selections.sqlite3"


@pytest.fixture(scope="module")
def schema(file: Path) -> Iterator[schemathesis.BaseSchema]:
    """Document of a service, which schemathesis starts at its first request."""
    app = create_app(Settings(database_url=SecretStr(f"sqlite:///{file}"), log_level="error"))
    schema = schemathesis.openapi.from_asgi("/openapi.json", app)
    schema.hook(before_generate_body)
    yield schema
    shutdown_lifespans()


def before_generate_body(context: HookContext, bodies: SearchStrategy[Any]) -> SearchStrategy[Any]:
    """Bodies of which half are examples: with many inputs, few random bodies are valid.

    schemathesis finds this hook by its name.
    """
    operation = context.operation
    examples = [example for body in operation.body for example in body.examples] if operation else []
    if operation and operation.label == "POST /api/v1/selections":
        examples = [{"application": worked_example(), "reference": "axis-7"}]
    return one_of(sampled_from(examples), bodies) if examples else bodies


@pytest.mark.parametrize("saved", REACHED)
def test_no_chain_of_requests_brings_the_service_to_a_mistake_or_to_an_answer_that_is_not_in_the_document(
    saved: str, schema: schemathesis.BaseSchema, file: Path, soak: bool
) -> None:
    answered: Counter[tuple[str, int]] = Counter()
    labels = sorted({label for label, _ in REACHED[saved]})
    own = schema.include(path_regex=f"^/api/v1/{saved}") if soak else schema.include(name=labels)

    class Chains(own.as_state_machine()):  # type: ignore[misc]
        def setup(self) -> None:
            """Delete all documents of the previous chain, so that the same requests have the same answers."""
            with closing(sqlite3.connect(file)) as database, database:
                for table in metadata.tables:
                    database.execute(f"DELETE FROM {table}")

        def validate_response(self, response: Response, case: Case[Any], **more: Any) -> None:
            answered[case.operation.label, response.status_code] += 1
            case.validate_response(response, checks=CHECKS, recorder=self.recorder)

    for number in range(ROUNDS):
        Chains.run(
            settings=settings(
                max_examples=(4000 if soak else 12) << number,
                stateful_step_count=STEPS,
                phases=[Phase.generate],
                deadline=None,
                suppress_health_check=list(HealthCheck),
            )
        )
        if answered.total() >= (20_000 if soak else 1) and answered.keys() >= REACHED[saved]:
            break

    print(answered.total(), "requests:", dict(answered))
    assert REACHED[saved] - answered.keys() == set()
