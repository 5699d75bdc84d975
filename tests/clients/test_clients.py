"""Clients that others' generators make of the OpenAPI document select, save, list, rename, read and delete."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hpn.application import WORKED_EXAMPLE
from tests.build import TURNING
from tests.operations.service import Service, serving

ROOT = Path(__file__).parents[2]
JOURNEYS = Path(__file__).with_name("journeys")
MODULES = ROOT / "frontend/node_modules"
NODE = shutil.which("node", path=f"{ROOT / '.venv/node/bin'}{os.pathsep}{os.environ['PATH']}") or "node"
SCRIPTS = Path(sys.executable).parent
SECONDS = 300

CYCLE = {**WORKED_EXAMPLE["duty_cycle"], "motion": None}
"""The worked example with a null, which models, schema and generated classes have to take."""

EXPECTED = {
    "selected": "HPN-20A-4",
    "phases": 8,
    "saved once": True,
    "listed": ["Axis 7"],
    "renamed": "Axis 8",
    "read": "HPN-20A-4",
    "deleted": 204,
    "missing": 404,
    "refused": "/cursor",
}

BYTES = "application/octet-stream"
PYTHON_CLIENT = {
    "package_name_override": "hpn_client",
    "post_hooks": [],
    "content_type_overrides": {
        "application/asset-administration-shell-package": BYTES,
        "application/gzip": BYTES,
        "application/pdf": BYTES,
        "application/schema+json": "application/json",
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet": BYTES,
        "application/vnd.apache.arrow.file": BYTES,
        "application/vnd.apache.arrow.stream": BYTES,
        "application/vnd.apache.parquet": BYTES,
        "application/x-ndjson": BYTES,
        "text/csv": BYTES,
    },
}
"""Settings of openapi-python-client, which knows few media types: any other has to be named as bytes."""

STRICT = {
    "strict": True,
    "target": "es2022",
    "module": "nodenext",
    "lib": ["es2022", "dom", "dom.iterable"],
    "types": [],
    "outDir": "built",
}
"""Settings of the TypeScript compiler."""


LOST = {"by_typescript_generator": {"phases"}, "by_kotlin_generator": {"phases"}}
"""Answers that a generator's own fault keeps away: typescript-fetch takes every motion for a linear one, by the names
of its fields alone, and sends it without its mechanism, which the service refuses; Kotlin's has one class of both."""


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with one process and the settings as shipped."""
    with serving(tmp_path_factory.mktemp("service")) as running:
        yield running


@pytest.fixture
def document(service: Service, tmp_path: Path) -> Path:
    """The document as the service sends it."""
    path = tmp_path / "openapi.json"
    path.write_bytes(service.client.get("/openapi.json").raise_for_status().content)
    return path


def run(*command: object, folder: Path) -> str:
    """Output of a command that has to succeed."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    words = [str(word) for word in command]
    outcome = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, timeout=SECONDS)
    assert outcome.returncode == 0, outcome.stdout[-4000:] + outcome.stderr[-4000:]
    return outcome.stdout


def by_python_client(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-python-client, which leaves nothing of the document out."""
    config = folder / "generator.json"
    config.write_text(json.dumps(PYTHON_CLIENT))
    places = ("--path", document, "--config", config, "--output-path", folder / "hpn_client", "--meta", "none")
    message = run(SCRIPTS / "openapi-python-client", "generate", *places, folder=folder)
    assert "WARNING" not in message
    return [sys.executable, JOURNEYS / "openapi_python_client.py"]


def _generate(document: Path, folder: Path, language: str, *options: str) -> None:
    common = ("-g", language, "-i", document, "-o", folder, *options)
    run(SCRIPTS / "openapi-generator-cli", "generate", *common, folder=document.parent)


def by_python_generator(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-generator in Python."""
    _generate(document, folder, "python", "--package-name", "hpn_client")
    return [sys.executable, JOURNEYS / "openapi_generator.py"]


def _compiled(folder: Path, journey: str) -> list[object]:
    """Command for a journey in TypeScript, once the compiler finds nothing against it."""
    shutil.copy(JOURNEYS / f"{journey}.ts", folder)
    (folder / "package.json").write_text(json.dumps({"type": "module"}))
    (folder / "tsconfig.json").write_text(json.dumps({"compilerOptions": STRICT, "files": [f"{journey}.ts"]}))
    (folder / "node_modules").symlink_to(MODULES)
    run(NODE, MODULES / "typescript/bin/tsc", "--project", folder, folder=folder)
    return [NODE, folder / "built" / f"{journey}.js"]


def by_typescript_generator(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-generator in TypeScript; it leaves out models of forms unless told."""
    _generate(
        document,
        folder / "hpn_client",
        "typescript-fetch",
        "--global-property",
        "skipFormModel=false",
        "--additional-properties",
        "importFileExtension=.js",
    )
    return _compiled(folder, "openapi_generator")


def by_hey_api(document: Path, folder: Path) -> list[object]:
    """Command for the journey with @hey-api/openapi-ts; Node resolves modules by their whole names."""
    output = {"path": str(folder / "hpn_client"), "module": {"extension": ".js"}}
    config = f"export default {json.dumps({'input': str(document), 'output': output})};"
    (folder / "openapi-ts.config.mjs").write_text(config)
    run(NODE, MODULES / "@hey-api/openapi-ts/bin/run.js", folder=folder)
    return _compiled(folder, "hey_api")


def by_typescript_types(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-typescript; what has a default may be left out of a request."""
    options = ("--default-non-nullable", "false", "--output", folder / "schema.d.ts")
    run(NODE, MODULES / "openapi-typescript/bin/cli.js", document, *options, folder=folder)
    return _compiled(folder, "openapi_typescript")


def _by_maven(folder: Path, main: str) -> list[object]:
    """Command for a journey on the Java machine, compiled by Maven."""
    maven = shutil.which("mvn")
    assert maven, "make soak installs Maven and a JDK"
    goals = ("compile", "dependency:build-classpath", "-Dmdep.outputFile=classpath")
    run(maven, "--batch-mode", "--quiet", *goals, folder=folder)
    classes = f"{folder / 'target/classes'}{os.pathsep}{(folder / 'classpath').read_text().strip()}"
    return ["java", "-cp", classes, main]


def by_java_generator(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-generator in Java, without any option."""
    _generate(document, folder, "java")
    shutil.copy(JOURNEYS / "Journey.java", folder / "src/main/java")
    return _by_maven(folder, "Journey")


def by_kotlin_generator(document: Path, folder: Path) -> list[object]:
    """Command for the journey with openapi-generator in Kotlin."""
    _generate(document, folder, "kotlin")
    shutil.copy(JOURNEYS / "Journey.kt", folder / "src/main/kotlin")
    shutil.copy(JOURNEYS / "kotlin.xml", folder / "pom.xml")
    return _by_maven(folder, "JourneyKt")


def figures(service: Service) -> list[float]:
    """Figures with all of their digits, as the service says them to a caller without a generated client."""
    reply = service.client.post("/api/v1/select", json={"duty_cycle": CYCLE}).raise_for_status().json()
    life = reply["candidates"][0]["life_L10_h"]
    return [life, life, reply["duty"]["average_torque_Nm"]]


Generate = Callable[[Path, Path], list[Any]]
LONG: tuple[Generate, ...] = (
    *(by_python_generator, by_hey_api, by_typescript_generator, by_typescript_types),
    *(by_java_generator, by_kotlin_generator),
)


@pytest.mark.parametrize("generate", [by_python_client, *(pytest.param(each, marks=pytest.mark.soak) for each in LONG)])
def test_a_generated_client_selects_saves_lists_renames_reads_and_deletes(
    service: Service, document: Path, tmp_path: Path, generate: Generate
) -> None:
    folder = tmp_path / "client"
    folder.mkdir()

    command = generate(document, folder)
    result = run(*command, service.url, json.dumps(CYCLE), json.dumps(TURNING), folder=folder)

    lost = LOST.get(generate.__name__, set())
    by_name = {name: value for name, value in EXPECTED.items() if name not in lost}
    assert json.loads(result) == {**by_name, "figures": figures(service)}


def test_the_documents_name_the_overrides_that_the_python_client_is_made_with() -> None:
    text = (ROOT / "docs/rest.md").read_text(encoding="utf-8").partition("content_type_overrides:\n")[2]
    named = dict(line.strip().split(": ") for line in text.partition("```")[0].splitlines())

    assert named == PYTHON_CLIENT["content_type_overrides"]
