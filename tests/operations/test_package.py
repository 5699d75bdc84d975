"""Wheel and sdist: what pip installs runs every command and the page, from any folder, with the extras that it has."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.build import worked_example
from tests.operations.dockerfile import machine
from tests.operations.installed import ROOT, Installed, build, copy_of_checkout, install
from tests.operations.service import Service, serving

PHASES = "axis,torque_Nm,speed_rpm,duration_s\na,40,250,1\na,0,0,4\n"
SERVED = ("serve", "report", "aas", "fleet", "postgres")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Wheel that was built from the sdist."""
    folder = tmp_path_factory.mktemp("built")
    built = build(ROOT, folder)
    assert built.returncode == 0, built.stderr
    assert [*folder.glob("*.tar.gz")]
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def whole(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The package with what a service needs."""
    return install(wheel, tmp_path_factory.mktemp("whole"), *SERVED)


@pytest.fixture(scope="module")
def service(whole: Installed) -> Iterator[Service]:
    """A service of the package."""
    with serving(whole.elsewhere, program=(whole.hpn, "serve"), cwd=whole.elsewhere) as service:
        yield service


def contents(wheel: Path) -> dict[str, bytes]:
    """Files of a wheel but the list of them."""
    with ZipFile(wheel) as packed:
        return {name: packed.read(name) for name in packed.namelist() if not name.endswith("/RECORD")}


def test_a_wheel_of_the_checkout_is_that_of_the_sdist(wheel: Path, tmp_path: Path) -> None:
    assert build(ROOT, tmp_path, "--wheel").returncode == 0

    assert contents(next(tmp_path.glob("*.whl"))) == contents(wheel)


def test_a_wheel_holds_catalogue_templates_and_assets_as_they_stand_in_the_checkout(wheel: Path) -> None:
    packed = contents(wheel)
    found = {name.removeprefix("hpn/data/"): content for name, content in packed.items() if "/data/" in name}

    assert found == {name: (ROOT / name).read_bytes() for name in found}
    assert {path.relative_to(ROOT).as_posix() for path in (ROOT / "catalogue").glob("*.csv")} <= found.keys()
    assert {path.relative_to(ROOT).as_posix() for path in (ROOT / "frontend/templates").iterdir()} <= found.keys()
    for name in json.loads((ROOT / "frontend/dist/manifest.json").read_text()).values():
        assert f"frontend/dist/{name}" in found
    assert not [name for name in found if "dist/templates" in name]
    assert "hpn/py.typed" in packed


def test_without_assets_nothing_is_built_and_a_sentence_says_why(tmp_path: Path) -> None:
    source = copy_of_checkout(tmp_path / "source")
    shutil.rmtree(source / "frontend/dist")

    for form in ("--wheel", "--sdist"):
        built = build(source, tmp_path / "dist", form)
        assert built.returncode != 0
        assert "run `make assets` first" in built.stderr
    assert not [*tmp_path.glob("dist/hpn*")]


def test_a_selection_comes_out_as_in_the_checkout(whole: Installed) -> None:
    (whole.elsewhere / "application.json").write_text(json.dumps(worked_example()))
    here = subprocess.run(
        [ROOT / ".venv/bin/hpn", "select", "application.json"],
        cwd=whole.elsewhere,
        env=machine(),
        capture_output=True,
        text=True,
    )

    for words in (["select", "application.json"], ["select", "application.json", "--table"], ["catalogue"]):
        answer = whole.run(*words)
        assert (answer.returncode, answer.stderr) == (0, "")
        assert "HPN-" in answer.stdout
    assert whole.run("select", "application.json").stdout == here.stdout
    assert '"designation": "HPN-20A-5"' in whole.run("catalogue", "HPN-20-5").stdout
    assert whole.run("--version").stdout.startswith("HPN Select ")
    assert whole.run("key", "somebody").stdout.startswith("key, to be given to somebody")
    module = [str(whole.environment / "bin/python"), "-m", "hpn", "--version"]
    assert subprocess.run(module, cwd=whole.elsewhere, env=machine()).returncode == 0


def test_a_fleet_is_sized_and_reported(whole: Installed) -> None:
    (whole.elsewhere / "axes.csv").write_text(PHASES)

    answer = whole.run("fleet", "axes.csv", "answers.csv", "--report", "report.html")

    assert (answer.returncode, answer.stderr) == (0, "")
    assert '"a"' in (whole.elsewhere / "answers.csv").read_text()
    assert "<style>" in (whole.elsewhere / "report.html").read_text()


def test_the_database_is_made(whole: Installed) -> None:
    answer = whole.run("database", HPN_DATABASE_URL="sqlite:///made.sqlite3")

    assert (answer.returncode, answer.stderr) == (0, "")
    assert (whole.elsewhere / "made.sqlite3").exists()


def test_the_page_has_its_styles_and_a_selection_is_saved_and_printed(service: Service) -> None:
    page = service.client.get("/")
    style = page.text.partition('rel="stylesheet" href="')[2].partition('"')[0]
    saved = service.client.post("/api/v1/selections", json={"application": worked_example()})
    address = saved.headers["Location"]

    assert page.status_code == 200
    assert service.client.get(style).headers["content-type"].startswith("text/css")
    assert (saved.status_code, service.client.get(address).status_code) == (201, 200)
    for name, mark in {"report.pdf": b"%PDF", "report.xlsx": b"PK", "submodel.aasx": b"PK"}.items():
        assert service.client.get(f"{address}/{name}").content.startswith(mark)
    assert service.client.get("/fleets").status_code == 200
