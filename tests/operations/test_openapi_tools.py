"""The OpenAPI document in the hands of tools that others wrote: a linter, and a generator of clients."""

import importlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hpn.application import WORKED_EXAMPLE
from tests.operations.service import Service

ROOT = Path(__file__).parents[2]
LINTER = ROOT / "frontend/node_modules/@redocly/cli/bin/cli.js"
RULES = ROOT / "frontend/redocly.yaml"
NODE = shutil.which("node", path=f"{ROOT / '.venv/node/bin'}{os.pathsep}{os.environ['PATH']}") or "node"
AT_HOME = {"REDOCLY_TELEMETRY": "off", "REDOCLY_SUPPRESS_UPDATE_NOTICE": "true"}

Json = dict[str, Any]

GENERATOR = {
    "package_name_override": "hpn_client",
    "post_hooks": [],
    "content_type_overrides": {
        "application/asset-administration-shell-package": "application/octet-stream",
        "application/gzip": "application/octet-stream",
        "application/pdf": "application/octet-stream",
        "application/schema+json": "application/json",
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet": "application/octet-stream",
        "application/vnd.apache.arrow.file": "application/octet-stream",
        "application/vnd.apache.arrow.stream": "application/octet-stream",
        "application/vnd.apache.parquet": "application/octet-stream",
        "application/x-ndjson": "application/octet-stream",
        "text/csv": "application/octet-stream",
    },
}
"""The generator knows few media types: any other has to be told to be bytes."""


@pytest.fixture(scope="module")
def document(service: Service, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The document as the service sends it."""
    path = tmp_path_factory.mktemp("document") / "openapi.json"
    path.write_bytes(service.client.get("/openapi.json").raise_for_status().content)
    return path


@pytest.fixture(scope="module")
def broken(document: Path) -> dict[str, set[str]]:
    """Rules that the document breaks, and those that a spoiled copy does, by file."""
    spoiled = json.loads(document.read_text())
    del spoiled["servers"]
    select = spoiled["paths"]["/api/v1/select"]["post"]
    select["tags"] = ["Unknown"]
    select["requestBody"]["content"]["application/json"]["examples"]["worked_example"]["value"] = {"duty_cycle": 1}
    copy = document.with_name("spoiled.json")
    copy.write_text(json.dumps(spoiled))
    command = [NODE, str(LINTER), "lint", str(document), str(copy), "--config", str(RULES), "--format=github-actions"]
    run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **AT_HOME}, timeout=300)
    found: dict[str, set[str]] = {document.name: set(), copy.name: set()}
    assert "validated in" in run.stderr
    for rule, file in re.findall(r"^::\w+ title=([\w-]+),file=([^,]+)", run.stdout, re.M):
        found[Path(file).name].add(rule)
    return found


def test_the_linter_finds_nothing(broken: dict[str, set[str]]) -> None:
    assert broken["openapi.json"] == set()


def test_the_linter_finds_what_is_wrong(broken: dict[str, set[str]]) -> None:
    assert {"no-empty-servers", "operation-tag-defined", "no-invalid-media-type-examples"} <= broken["spoiled.json"]


def test_a_generated_client_selects_saves_lists_reads_and_deletes(
    service: Service, document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    generate(document, tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    package = importlib.import_module("hpn_client")
    models = importlib.import_module("hpn_client.models")

    with package.Client(base_url=service.url, raise_on_unexpected_status=True) as client:

        def call(operation: str, *path: str, **arguments: Any) -> Any:
            module = importlib.import_module(f"hpn_client.api.{operation}")
            return module.sync(*path, client=client, **arguments)

        application = models.Application.from_dict(WORKED_EXAMPLE)
        selection = call("selection.select", body=application)
        request = models.SaveRequest(application=application, title="Axis 7", reference="4711")
        saved = call("saved_selections.save_selection", body=request, idempotency_key="once")
        again = call("saved_selections.save_selection", body=request, idempotency_key="once")
        listed = call("saved_selections.list_selections", reference="4711")
        read = call("saved_selections.get_selection", saved.id)
        gone = importlib.import_module("hpn_client.api.saved_selections.delete_selection").sync_detailed(
            saved.id, client=client
        )
        missing = call("saved_selections.get_selection", saved.id)
        refused = call("saved_selections.list_selections", cursor="x")

    assert selection.selected == "HPN-20A-5"
    assert saved.id == again.id
    assert [(line.id, line.title) for line in listed.selections] == [(saved.id, "Axis 7")]
    assert read.result.to_dict() == selection.to_dict()
    assert read.application.to_dict() == WORKED_EXAMPLE
    assert (gone.status_code, missing.status) == (204, 404)
    assert refused.errors[0].pointer == "/cursor"


def generate(document: Path, folder: Path) -> None:
    """Write a client for the document as the package `hpn_client`; the generator leaves nothing out."""
    config = folder / "generator.json"
    config.write_text(json.dumps(GENERATOR))
    generator = str(Path(sys.executable).with_name("openapi-python-client"))
    places = {"--path": document, "--config": config, "--output-path": folder / "hpn_client", "--meta": "none"}
    command = [generator, "generate", *(str(word) for pair in places.items() for word in pair)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300)

    assert run.returncode == 0, run.stdout + run.stderr
    assert "WARNING" not in run.stdout + run.stderr
