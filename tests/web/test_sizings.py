"""Sizing by IDTA 02021 at the doors: REST, the page that imports, and the command line."""

import json
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.files.aas.submodel import package
from hpn.links.writer import to_link
from tests.build import worked_example
from tests.report.cases import EVERYTHING, typed_export_of
from tests.report.sizings import packed, shell
from tests.report.test_opened import ONE, bomb, without_application

PACKAGE = {"Content-Type": "application/asset-administration-shell-package"}
Output = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def own(catalogue: Catalogue) -> bytes:
    """Package of the service."""
    return package(typed_export_of(EVERYTHING, catalogue))


def test_over_rest_a_package_gives_its_application_and_what_is_not_used(api: TestClient, own: bytes) -> None:
    answer = api.post("/api/v1/sizing", content=own, headers=PACKAGE)
    reply = answer.json()

    assert answer.status_code == 200
    assert Application.model_validate(reply["application"]) == Application.model_validate(EVERYTHING)
    assert "SizingResult" in reply["unused"]
    selected = api.post("/api/v1/select", json=reply["application"]).json()
    assert selected["selected"] == api.post("/api/v1/select", json=EVERYTHING).json()["selected"]


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"", "has no Sizing of Power Drive Trains"),
        (b"{}", "has no Sizing of Power Drive Trains"),
        (bomb(), "unpacks to more than 50 MB"),
        (packed(shell([ONE])), "its course can’t be read"),
    ],
    ids=["nothing", "no sizing", "bomb", "no course"],
)
def test_over_rest_what_can_not_be_read_is_a_422_in_words(api: TestClient, content: bytes, text: str) -> None:
    answer = api.post("/api/v1/sizing", content=content, headers=PACKAGE)

    assert answer.status_code == 422
    assert text in answer.json()["detail"]


def test_the_page_shows_what_is_not_used_before_it_is_taken(api: TestClient, own: bytes) -> None:
    files = {"file": ("axis.aasx", own, PACKAGE["Content-Type"])}
    response = api.post("/paste", files=files, headers={"HX-Request": "true"})
    without_script = api.post("/paste", files=files)
    taken = api.post("/paste", files=files, data={"take": "all"}, follow_redirects=False)

    for page in (response, without_script):
        assert page.status_code == 200
        assert "<li>SizingResult</li>" in page.text
        assert 'name="take" value="all"' in page.text
    assert taken.headers["location"].startswith(to_link(Application.model_validate(EVERYTHING))[:40])


def test_without_script_the_second_post_takes_what_the_page_has_shown(api: TestClient, own: bytes) -> None:
    response = api.post("/paste", files={"file": ("axis.aasx", own)})
    text = json.dumps(Application.model_validate(EVERYTHING).model_dump(mode="json", exclude_none=True))

    assert '"duty_cycle"' in response.text.replace("&#34;", '"')
    taken = api.post("/paste", data={"text": text, "take": "all"}, follow_redirects=False)
    assert taken.status_code == 303


def test_the_page_says_why_a_package_is_not_taken(api: TestClient) -> None:
    answer = api.post("/paste", files={"file": ("axis.aasx", packed(shell([])))})

    assert answer.status_code == 422
    assert "has no section of a motion" in answer.text


def test_the_command_takes_a_package_and_says_what_is_not_used(tmp_path: Path, own: bytes, capsys: Output) -> None:
    file, plain = tmp_path / "axis.aasx", tmp_path / "axis.json"
    file.write_bytes(own)
    plain.write_text(json.dumps(EVERYTHING))

    assert main(["select", str(plain), "--json"]) in (0, 1)
    expected = capsys.readouterr().out
    assert main(["select", str(file), "--json"]) in (0, 1)
    output = capsys.readouterr()
    assert output.out == expected
    assert "not used: SizingResult\n" in output.err


def test_the_command_names_the_file_that_it_can_not_read(tmp_path: Path, capsys: Output) -> None:
    file = tmp_path / "axis.aasx"
    file.write_bytes(packed(shell([])))

    assert main(["select", str(file)]) == 2
    assert (
        capsys.readouterr().err
        == f"{file}: the sizing has no section of a motion with its course as CSV: give the phases here\n"
    )


def test_a_sizing_without_application_is_selected_by_its_elements(api: TestClient, catalogue: Catalogue) -> None:
    content = without_application(package(typed_export_of(worked_example(), catalogue)))

    application = api.post("/api/v1/sizing", content=content, headers=PACKAGE).json()["application"]

    duty = api.post("/api/v1/select", json=application).json()["duty"]
    assert duty["average_torque_Nm"] == pytest.approx(32.021, rel=1e-4)  # as chapter 4.1 prints it
