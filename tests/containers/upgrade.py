"""From an older image and compose file to this one, with what was saved before."""

import io
import json
import os
import re
import subprocess
import tarfile
import tempfile
from pathlib import Path

from tests.build import worked_example
from tests.containers.engine import Engine
from tests.containers.images import Images
from tests.containers.stack import ROOT, stack
from tests.containers.trials import trial

NAME = "what was saved with an older image opens with this one"
COUNT = 20
SAVE = """
import json, urllib.request
for number in range(%d):
    body = json.dumps({"application": json.loads(%r), "title": f"older {number}"}).encode()
    headers = {"Content-Type": "application/json"}
    request = urllib.request.Request("http://127.0.0.1:8000/api/v1/selections", body, headers)
    with urllib.request.urlopen(request, timeout=30) as answer:
        print(json.load(answer)["id"])
"""


def run(engine: Engine, images: Images, wanted: str) -> None:
    """Try an upgrade from the commit in BEFORE, or from the one that this version began with."""
    if re.search(wanted, NAME):
        trial.try_one(NAME, lambda: _upgrade(engine, images))


def _upgrade(engine: Engine, images: Images) -> str:
    commit = (
        os.environ.get("BEFORE") or _git("log", "-1", "--format=%h", "-G^version = ", "--", "pyproject.toml").decode()
    )
    with tempfile.TemporaryDirectory(prefix="hpn-before-") as name:
        tree = Path(name)
        with tarfile.open(fileobj=io.BytesIO(_git("archive", commit.strip()))) as archive:
            archive.extractall(tree, filter="data")
        subprocess.run(["git", "init", "--quiet"], cwd=tree, check=True)  # for the list of its files
        with stack(engine, images, tree) as before:
            before.settings |= {"POSTGRES_PASSWORD": "simple", "HPN_PUBLISH": f"127.0.0.1:{before.http}"}
            before.write_settings()
            before.compose("build", "--quiet", "web", seconds=1800)
            before.up()
            ids = before.python(SAVE % (COUNT, json.dumps(worked_example()))).split()
            assert len(ids) == COUNT, ids
            before.compose("down")
            return f"from {commit.strip()}: {_after(engine, images, ids)}"


def _after(engine: Engine, images: Images, ids: list[str]) -> str:
    with stack(engine, images, ROOT) as after:
        after.settings["POSTGRES_PASSWORD"] = "simple"
        after.write_settings()
        after.compose("build", "--quiet", "web", seconds=1800)
        after.up()
        assert all(after.has(id) for id in ids)
        with after.client() as client:
            pages = {client.get(f"/selections/{id}").status_code for id in ids}
        assert pages == {200}, pages
        after.save("newer")
        return f"{len(ids)} selections, their pages and a new one"


def _git(*words: str) -> bytes:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True).stdout
