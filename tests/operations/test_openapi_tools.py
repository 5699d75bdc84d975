"""The OpenAPI document in the hands of a linter that others wrote; `tests/clients` has the generators."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.operations.service import Service

ROOT = Path(__file__).parents[2]
LINTER = ROOT / "frontend/node_modules/@redocly/cli/bin/cli.js"
RULES = ROOT / "frontend/redocly.yaml"
NODE = shutil.which("node", path=f"{ROOT / '.venv/node/bin'}{os.pathsep}{os.environ['PATH']}") or "node"
AT_HOME = {"REDOCLY_TELEMETRY": "off", "REDOCLY_SUPPRESS_UPDATE_NOTICE": "true"}

Json = dict[str, Any]


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
    result: dict[str, set[str]] = {document.name: set(), copy.name: set()}
    assert "validated in" in run.stderr
    for rule, file in re.findall(r"^::\w+ title=([\w-]+),file=([^,]+)", run.stdout, re.M):
        result[Path(file).name].add(rule)
    return result


def test_the_linter_finds_nothing(broken: dict[str, set[str]]) -> None:
    assert broken["openapi.json"] == set()


def test_the_linter_finds_what_is_wrong(broken: dict[str, set[str]]) -> None:
    assert {"no-empty-servers", "operation-tag-defined", "no-invalid-media-type-examples"} <= broken["spoiled.json"]
