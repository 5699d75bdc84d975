"""The image's steps, run in an empty folder: what they make starts and answers.

Left out for want of an engine: the base images themselves, adding the user, and the confinement of the container.
"""

import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.build import worked_example
from tests.operations.dockerfile import Image, build
from tests.operations.service import held_port

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """The image of the Dockerfile, built without an engine."""
    image = build(ROOT / "backend/Dockerfile", ROOT, tmp_path_factory.mktemp("image"))
    image.place("/data").mkdir()
    return image


@pytest.fixture
def port() -> Iterator[str]:
    """Port for a service."""
    with held_port() as port:
        yield str(port)


def test_the_image_starts_answers_is_healthy_and_writes_only_its_data(image: Image, port: str) -> None:
    before = _files(image.place("."))
    process = image.run(image.command("CMD"), HPN_HOST="127.0.0.1", HPN_PORT=port)
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30, trust_env=False) as client:
            _await(client)
            page = client.get("/")
            saved = client.post("/api/v1/selections", json={"application": worked_example()})
            ready = client.get("/readyz")
        healthy = image.run(image.command("HEALTHCHECK"), HPN_PORT=port).wait(timeout=30)
    finally:
        process.terminate()
        process.wait(timeout=60)

    assert page.status_code == 200
    assert "/static/" in page.text
    assert (saved.status_code, ready.status_code, healthy) == (201, 200, 0)
    assert (image.place("/data") / "hpn.sqlite3").exists()
    assert _files(image.place(".")) == before
    unhealthy = image.run(image.command("HEALTHCHECK"), HPN_PORT=port)
    assert unhealthy.wait(timeout=30) != 0


def test_the_image_holds_only_what_runs(image: Image) -> None:
    assert {path.name for path in image.place(".").iterdir()} == {".venv", "backend", "catalogue", "frontend"}
    assert {path.name for path in image.place("frontend").iterdir()} == {"dist", "templates"}
    packages = {path.name for path in image.place(".venv").glob("lib/python*/site-packages/*")}
    assert "uvicorn" in packages
    assert not {"pytest", "mypy", "playwright", "pip", "setuptools", "wheel", "uv"} & packages


def test_the_image_runs_as_a_user_without_rights(image: Image) -> None:
    assert image.settings["USER"] == "10001:10001"
    (step,) = image.skipped
    assert "groupadd --gid 10001 hpn && useradd --uid 10001 --gid 10001 " in step
    assert "install --directory --owner=10001 --group=0 --mode=0770 /data" in step


def _files(folder: Path) -> set[Path]:
    return set(folder.rglob("*"))


def _await(client: httpx.Client) -> None:
    for _ in range(600):
        try:
            if client.get("/healthz").status_code == 200:
                return
        except httpx.TransportError:
            time.sleep(0.2)
    raise AssertionError("the image does not start")
