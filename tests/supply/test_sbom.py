"""The bill of materials: valid CycloneDX, the same each time, and complete."""

import json
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from cyclonedx.schema import SchemaVersion

from tools.supply import licences, locks, sbom


@pytest.fixture(scope="module")
def text() -> str:
    """The bill."""
    return sbom.text()


def test_the_bill_is_valid(text: str) -> None:
    validation = import_module("cyclonedx.validation.json")  # takes seconds, which a process without this test saves
    assert validation.JsonStrictValidator(SchemaVersion.V1_6).validate_str(text) is None


def test_the_bill_is_the_same_each_time(text: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tools.supply.sbom", str(tmp_path / "again.json")]
    subprocess.run(command, cwd=locks.ROOT, env=os.environ | {"PYTHONHASHSEED": "7"}, check=True)

    assert (tmp_path / "again.json").read_text() == text


def test_the_bill_names_every_package_that_runs_with_its_licence_and_hashes_and_no_other(text: str) -> None:
    components = json.loads(text)["components"]
    run = [package[:2] for package in locks.python(locks.RUN_LOCK)]
    page = [package[:2] for package in licences.of_page(development=False)]

    assert sorted((part["name"], part["version"]) for part in components) == sorted([*run, *page])
    assert {"htmx.org", "fastapi"} <= {part["name"] for part in components}
    assert "pytest" not in {part["name"] for part in components}
    assert all(part["licenses"] and part["externalReferences"][0]["hashes"] for part in components)


def test_the_bill_says_what_the_service_itself_asks_for(text: str) -> None:
    graph = {entry["ref"]: entry.get("dependsOn", []) for entry in json.loads(text)["dependencies"]}
    direct = {name.partition("@")[0] for name in graph["hpn-select"]}

    assert {"pkg:pypi/fastapi", "pkg:pypi/psycopg", "pkg:npm/htmx.org"} <= direct
    assert "pkg:pypi/anyio" not in direct
