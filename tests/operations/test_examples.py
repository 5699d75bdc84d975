"""The README's client examples, run as they stand there against a service that asks for keys."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from hpn.web.keys import new_key
from tests.operations.service import Service, serving

README = (Path(__file__).parents[2] / "README.md").read_text()
KEY, PAIR = new_key("readme")


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that lets only the holder of the key save, list and send batches."""
    with serving(tmp_path_factory.mktemp("guarded"), {"HPN_API_KEYS": PAIR}) as running:
        yield running


def block(language: str, service: Service, folder: Path) -> Path:
    """File with the one example in this language, for this service instead of the usual one."""
    (text,) = re.findall(rf"^```{language}\n(.*?)^```", README, re.M | re.S)
    assert "http://127.0.0.1:8000" in text
    file = folder / f"example.{language}"
    file.write_text(text.replace("http://127.0.0.1:8000", service.url))
    return file


def run(*command: str | Path, folder: Path) -> str:
    """What an example prints."""
    environment = os.environ | {"HPN_KEY": KEY, "no_proxy": "127.0.0.1"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


def test_the_example_for_curl(guarded: Service, tmp_path: Path) -> None:
    file = block("sh", guarded, tmp_path)

    first, second = (run("sh", "-eu", file, folder=tmp_path) for _ in range(2))
    saved, _, listed = first.partition("}")

    assert json.loads(saved + "}")["url"].startswith("/selections/")
    assert second.startswith(saved)  # the same selection, by its Idempotency-Key
    assert [selection["reference"] for selection in json.loads(listed)["selections"]] == ["4711-07"]
    results = [json.loads(line) for line in (tmp_path / "results.ndjson").read_text().splitlines()]
    assert [(line["reference"], line["status"]) for line in results] == [("axis-1", "ok"), ("axis-2", "ok")]


def test_the_example_for_python(guarded: Service, tmp_path: Path) -> None:
    first, *lines = run(sys.executable, block("python", guarded, tmp_path), folder=tmp_path).splitlines()

    assert re.fullmatch(r"/selections/[\w-]{22} \['HPN-\w+-\d+'\]", first)
    assert [line.split()[0] for line in lines] == [f"axis-{number}" for number in range(1000)]
    assert lines[0].split()[1].startswith("HPN-")
