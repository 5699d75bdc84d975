"""The client examples of docs/rest.md, run as they stand there against a service with keys and an open one."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from hpn.web.door.keys import new_key
from tests.operations.service import Service, serving

PAGE = (Path(__file__).parents[2] / "docs/rest.md").read_text()
KEY, PAIR = new_key("readme")


@dataclass
class Example:
    """An example's service, and the key that its user has."""

    service: Service
    key: str | None

    def block(self, language: str, folder: Path) -> Path:
        """File with the one example in this language, for this service instead of the usual one."""
        (text,) = re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.M | re.S)
        assert "http://127.0.0.1:8000" in text
        file = folder / f"example.{language}"
        file.write_text(text.replace("http://127.0.0.1:8000", self.service.url))
        return file

    def run(self, *command: str | Path, folder: Path) -> str:
        """Output of an example."""
        clean = {name: value for name, value in os.environ.items() if name != "HPN_KEY"}
        key = {} if self.key is None else {"HPN_KEY": self.key}
        environment = clean | key | {"no_proxy": "127.0.0.1"}
        outcome = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
        assert outcome.returncode == 0, outcome.stderr + outcome.stdout
        return outcome.stdout


@pytest.fixture(
    scope="module",
    params=[(PAIR, KEY), *(pytest.param(keys, marks=pytest.mark.soak) for keys in (("", None), ("", "")))],
    ids=["guarded", "open", "empty key"],
)
def example(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Example]:
    """A service that lets only the holder of the key save, list and send batches, and an open one, without a key."""
    pairs, key = request.param
    with serving(tmp_path_factory.mktemp("example"), {"HPN_API_KEYS": pairs}) as running:
        yield Example(running, key)


def test_the_example_for_curl(example: Example, tmp_path: Path) -> None:
    file = example.block("sh", tmp_path)

    first = example.run("sh", "-eu", file, folder=tmp_path)
    file.write_text(file.read_text().partition("# What there is")[0])
    second = example.run("sh", "-eu", file, folder=tmp_path)
    saved, _, listed = first.partition("}")

    assert json.loads(saved + "}")["url"].startswith("/selections/")
    assert second.startswith(saved)  # the same selection, by its Idempotency-Key
    assert [selection["reference"] for selection in json.loads(listed)["selections"]] == ["4711-07"]
    gears = json.loads((tmp_path / "gears.json").read_text())["gears"]
    assert sorted((gear["quantity"], gear["axes"]) for gear in gears) == [(1, [2]), (4, [1])]
    (question,) = json.loads((tmp_path / "questions.json").read_text())["errors"]
    output = json.loads((tmp_path / "made.json").read_text())
    assert question["code"] == "question" and output["url"].startswith("/machines/")
    changed = json.loads((tmp_path / "changed.json").read_text())
    assert changed["common"]["tolerances"] and changed["axes"][0]["answer"]["holds"] in (True, False)
    assert json.loads((tmp_path / "differing.json").read_text())["machines"] == []
    results = [json.loads(line) for line in (tmp_path / "results.ndjson").read_text().splitlines()]
    assert [(line["reference"], line["status"]) for line in results] == [("axis-1", "ok"), ("axis-2", "ok")]
    verdict = (tmp_path / "verdict.json").read_bytes()
    best = json.loads((tmp_path / "best.json").read_text())
    assert len(verdict) < 300
    assert best["candidates"][0]["designation"] == best["selected"] == json.loads(verdict)["selected"]
    assert len(best["candidates"]) == 3
    answers = (tmp_path / "answers.csv").read_text().splitlines()
    assert [line.split(",")[:2] for line in answers[1:]] == [["1", '"HPN-20A-4"'], ["2", '"HPN-11A-4"']]


def test_the_example_for_python(example: Example, tmp_path: Path) -> None:
    first, *lines = example.run(sys.executable, example.block("python", tmp_path), folder=tmp_path).splitlines()

    assert re.fullmatch(r"/selections/[\w-]{22} \['HPN-\w+-\d+'\]", first)
    assert [line.split()[0] for line in lines] == [f"axis-{number}" for number in range(1000)]
    assert lines[0].split()[1].startswith("HPN-")
