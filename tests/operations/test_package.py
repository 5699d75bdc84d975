"""Wheel and sdist: what pip installs runs every command and the page, from any folder, with the extras that it has."""

import ast
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

import pytest

from hpn.installed import EXTRAS
from tests.build import worked_example
from tests.operations.dockerfile import machine
from tests.operations.installed import ROOT, Installed, brings, build, copy_of_checkout, install
from tests.operations.service import Service, serving

PHASES = "axis,torque_Nm,speed_rpm,duration_s\na,40,250,1\na,0,0,4\n"
SERVED = ("serve", "report", "aas", "mcp", "fleet", "postgres")


def missing(extra: str, wheel: Path) -> str:
    """Text on a missing extra for the person at the machine: the package is on no index, so the wheel is named."""
    return f"the extra {extra} is not installed: pip install '{wheel}[{extra}]'"


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
def bare(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The package without any extra."""
    return install(wheel, tmp_path_factory.mktemp("bare"))


@pytest.fixture(scope="module")
def service(whole: Installed) -> Iterator[Service]:
    """A service of the package."""
    with serving(whole.elsewhere, program=(whole.hpn, "serve"), cwd=whole.elsewhere) as service:
        yield service


@pytest.fixture(scope="module")
def lean(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The package with the one extra of a service."""
    return install(wheel, tmp_path_factory.mktemp("lean"), "serve")


@pytest.fixture(scope="module")
def lean_service(lean: Installed) -> Iterator[Service]:
    """A service without further extras."""
    with serving(lean.elsewhere, program=(lean.hpn, "serve"), cwd=lean.elsewhere) as service:
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
    by_name = {name.removeprefix("hpn/data/"): content for name, content in packed.items() if "/data/" in name}

    assert by_name == {name: (ROOT / name).read_bytes() for name in by_name}
    assert {path.relative_to(ROOT).as_posix() for path in (ROOT / "catalogue").glob("*.csv")} <= by_name.keys()
    assert {path.relative_to(ROOT).as_posix() for path in (ROOT / "frontend/templates").iterdir()} <= by_name.keys()
    for name in json.loads((ROOT / "frontend/dist/manifest.json").read_text()).values():
        assert [form for form in ("", ".br", ".gz") if f"frontend/dist/{name}{form}" in by_name] in ([""], [".br"])
    fonts = {name.removeprefix("frontend/dist/paper/") for name in by_name if name.startswith("frontend/dist/paper/")}
    scripts = {name.removesuffix(".ttf") for name in fonts if name.endswith(".ttf")}
    assert {"HPNSans", "HPNSans-Bold", "HPNSans-Italic", "NotoSans", "NotoSansSC", "NotoSansKR", "NotoEmoji"} <= scripts
    assert fonts == {f"{script}{ending}" for script in scripts for ending in (".ttf", ".ttf.OFL.txt")}
    assert not [name for name in by_name if "dist/templates" in name]
    assert "hpn/py.typed" in packed


def test_without_assets_nothing_is_built_and_a_sentence_says_why(tmp_path: Path) -> None:
    source = copy_of_checkout(tmp_path / "source")
    shutil.rmtree(source / "frontend/dist")

    for form in ("--wheel", "--sdist"):
        built = build(source, tmp_path / "dist", form)
        assert built.returncode != 0
        assert "run `make assets` first" in built.stderr
    assert not [*tmp_path.glob("dist/hpn*")]


@pytest.mark.parametrize("name", ["bare", "whole"])
def test_a_selection_comes_out_as_in_the_checkout(name: str, request: pytest.FixtureRequest) -> None:
    installed: Installed = request.getfixturevalue(name)
    (installed.elsewhere / "application.json").write_text(json.dumps(worked_example()))
    here = subprocess.run(
        [ROOT / ".venv/bin/hpn", "select", "application.json"],
        cwd=installed.elsewhere,
        env=machine(),
        capture_output=True,
        text=True,
    )

    for words in (["select", "application.json"], ["select", "application.json", "--table"], ["catalogue"]):
        answer = installed.run(*words)
        assert (answer.returncode, answer.stderr) == (0, "")
        assert "HPN-" in answer.stdout
    assert installed.run("select", "application.json").stdout == here.stdout
    assert '"designation": "HPN-20A-5"' in installed.run("catalogue", "HPN-20-5").stdout
    assert installed.run("--version").stdout.startswith("HPN Select ")
    assert installed.run("key", "somebody").stdout.startswith("key, to be given to somebody")
    module = [str(installed.environment / "bin/python"), "-m", "hpn", "--version"]
    assert subprocess.run(module, cwd=installed.elsewhere, env=machine()).returncode == 0


def test_wrong_input_is_told_without_any_extra(bare: Installed) -> None:
    (bare.elsewhere / "wrong.json").write_text('{"duty_cycle": {"phases": []}}')
    (bare.elsewhere / "none.json").write_text("{")

    wrong, none, setting = (
        bare.run("select", "wrong.json"),
        bare.run("select", "none.json"),
        bare.run("select", "wrong.json", HPN_CATALOGUE_FOLDER="nowhere"),
    )

    assert (wrong.returncode, none.returncode, setting.returncode) == (2, 2, 2)
    assert wrong.stderr.startswith("/duty_cycle/phases: ")
    assert none.stderr.startswith("none.json: ")
    assert bare.run("catalogue", HPN_CATALOGUE_FOLDER="nowhere").stderr == "nowhere: is not a folder\n"
    assert bare.run("catalogue", HPN_PORT="70000").stderr.startswith("HPN_PORT: ")


@pytest.mark.parametrize(
    ("words", "extra"),
    [
        (["serve"], "serve"),
        (["database"], "serve"),
        (["mcp"], "mcp"),
        (["fleet", "axes.csv", "answers.csv"], "fleet"),
        (["fleet", "axes.csv", "answers.csv", "--report", "report.html"], "fleet"),
    ],
    ids=" ".join,
)
def test_a_command_without_its_extra_names_it(bare: Installed, wheel: Path, words: list[str], extra: str) -> None:
    answer = bare.run(*words)

    assert answer.returncode == 2
    assert answer.stderr == f"hpn {words[0]}: {missing(extra, wheel)}\n"


def test_verify_reads_what_it_can_without_any_extra_and_names_what_it_lacks(bare: Installed, wheel: Path) -> None:
    (bare.elsewhere / "application.json").write_text(json.dumps(worked_example()))
    answered = bare.run("select", "application.json", "--json").stdout
    (bare.elsewhere / "answer.json").write_text(answered)
    (bare.elsewhere / "saved.json").write_text(
        json.dumps({"application": worked_example(), "result": json.loads(answered)})
    )

    of_answer, of_saved = bare.run("verify", "answer.json"), bare.run("verify", "saved.json")

    assert (of_answer.returncode, of_answer.stderr) == (2, f"hpn verify: {missing('serve', wheel)}\n")
    assert (of_saved.returncode, of_saved.stderr) == (0, "")


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
    assert service.client.get("/machines").status_code == 200


@pytest.mark.parametrize(
    ("path", "extra"),
    [("report.pdf", "report"), ("submodel.aasx", "aas"), ("machines", "fleet"), ("mcp", "mcp")],
)
def test_a_route_without_its_extra_names_it(lean_service: Service, path: str, extra: str) -> None:
    files = {"file": ("axes.csv", PHASES, "text/csv")}
    answer = (
        lean_service.client.post(f"/{path}", files=files)
        if path in ("machines", "mcp")
        else lean_service.client.get(f"/{path}?T=40&n=250&t=1&tp=1")
    )

    assert answer.status_code == 501
    assert answer.json()["detail"].startswith(f"the extra {extra} is not installed: install the wheel or folder")
    assert "/" not in answer.json()["detail"]  # where it lies on the server is nobody's business


def test_a_table_that_needs_an_extra_is_refused_by_its_name(lean_service: Service) -> None:
    answer = lean_service.client.post("/paste", files={"file": ("cycle.parquet", b"PAR1 and more PAR1")})

    assert answer.status_code == 422
    assert "the extra fleet is not installed: install the wheel" in answer.text


def test_a_service_with_its_one_extra_serves_page_and_api(lean_service: Service) -> None:
    page = lean_service.client.get("/")
    saved = lean_service.client.post("/api/v1/selections", json={"application": worked_example()})

    workbook = lean_service.client.get(f"{saved.headers['Location']}/report.xlsx")

    assert (page.status_code, saved.status_code, workbook.status_code) == (200, 201, 200)


@pytest.mark.parametrize("name", ["lean_service", "service"])
def test_pages_lead_to_no_file_and_to_no_page_that_the_installation_lacks(
    name: str, request: pytest.FixtureRequest
) -> None:
    client = request.getfixturevalue(name).client
    saved = client.post("/api/v1/selections", json={"application": worked_example()}).json()["url"]
    is_whole = name == "service"

    for path in ("/?T=40&n=250&t=1&tp=1", "/catalogue", "/selections", saved, "/paste"):
        text = client.get(path).text
        # the only axis of a selection is edited without the extra, too
        assert bool(re.search('href="/machines(?!/[^"]*/axes/)', text)) == is_whole, path
        assert ("report.pdf" in text, "submodel.aasx" in text) in ((is_whole, is_whole), (False, False)), path
    axis = re.search('href="(/machines/[^"]*/axes/1)"', client.get(saved).text)
    assert axis is not None
    assert client.get(axis[1]).status_code == 200
    for path in ("/?T=40&n=250&t=1&tp=1", saved):
        text = client.get(path).text
        assert "report.xlsx" in text
        assert ("report.pdf" in text) == is_whole


def test_without_its_wheel_a_command_says_what_is_installed_again(wheel: Path, tmp_path: Path) -> None:
    moved = tmp_path / wheel.name
    shutil.copy(wheel, moved)
    installed = install(moved, tmp_path / "without")
    moved.unlink()

    answer = installed.run("serve")

    assert answer.stderr.startswith("hpn serve: the extra serve is not installed: install the wheel or folder that ")
    assert "hpn-select[" not in answer.stderr


@pytest.mark.parametrize(
    ("words", "extra"),
    [
        (["database"], "postgres"),
        (["serve"], "postgres"),
        (["fleet", "axes.csv", "answers.csv"], "fleet"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else value,
)
def test_a_command_names_a_further_extra(lean: Installed, wheel: Path, words: list[str], extra: str) -> None:
    answer = lean.run(*words, HPN_DATABASE_URL="postgresql://nobody@127.0.0.1/none")

    assert answer.returncode == 2
    assert answer.stderr == f"hpn {words[0]}: {missing(extra, wheel)}\n"


@pytest.mark.parametrize(
    ("words", "extra"), [(["--report", "report.html"], "serve"), (["--engine", "dask"], "cluster")]
)
def test_an_option_without_its_extra_names_it(words: list[str], extra: str, wheel: Path, tmp_path: Path) -> None:
    installed = install(wheel, tmp_path, "fleet")
    (installed.elsewhere / "axes.csv").write_text(PHASES)

    answer = installed.run("fleet", "axes.csv", "answers.csv", *words)

    assert answer.returncode == 2
    assert answer.stderr == f"hpn fleet: {missing(extra, wheel)}\n"
    assert not (installed.elsewhere / "answers.csv").exists()
    assert installed.run("fleet", "axes.csv", "answers.csv").returncode == 0


def imported() -> set[str]:
    """Modules of packages that any module of this one imports."""
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in (ROOT / "backend/hpn").rglob("*.py")]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    names |= {str(node.module) for node in nodes if isinstance(node, ast.ImportFrom) and not node.level}
    return {name.partition(".")[0] for name in names} - sys.stdlib_module_names - {"hpn"}


def test_every_module_that_is_imported_comes_with_the_package_or_an_extra_that_names_it() -> None:
    modules = {extra: set(names) for extra, names in EXTRAS.items()}
    brought = {extra: brings("hpn-select", extra) for extra in ("", *EXTRAS)}

    assert imported() <= brought[""].union(*modules.values())
    for extra, names in modules.items():
        assert names <= brought[extra] - brought[""]
    assert brought[""].union(*brought.values()) == brings("hpn-select", "all")
