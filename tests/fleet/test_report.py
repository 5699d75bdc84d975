"""The report of a fleet: one HTML file that needs nothing else, says what the answers say, and links to each axis."""

import errno
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import parse_qsl, urlsplit

import pytest

from hpn.application import Application
from hpn.cli import main
from hpn.web.form.link_reader import parse
from tests.fleet.tables import Row, read, row_of, write
from tests.reliability.faults import as_user, catalogue_for_all

APPLICATION = {"duty_cycle": {"phases": [{"torque_Nm": 20.0, "speed_rpm": 200.0, "duration_s": 1.0}]}}
HEAVY = {"duty_cycle": {"phases": [{"torque_Nm": 9000.0, "speed_rpm": 200.0, "duration_s": 1.0}]}}


def rows() -> list[Row]:
    """An axis with a gear, one that no gear suits, one that is rejected, and names that are no HTML."""
    bad = row_of("bad", APPLICATION)
    bad["speed_rpm"] = [-3e9]
    return [row_of("<b>lift & belt</b>", APPLICATION), row_of("heavy", HEAVY), bad]


class Elements(HTMLParser):
    """Elements of a page with their attributes, and the text of each cell."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """See HTMLParser."""
        self.found.append((tag, dict(attrs)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder in which the command has written a report, `report.html`, and the answers, `answers.csv`."""
    folder = tmp_path_factory.mktemp("report")
    axes = write(folder / "axes.csv", rows())
    report, service = ["--report", str(folder / "report.html")], ["--service", "https://gears.example/"]
    assert main(["fleet", str(axes), str(folder / "answers.csv"), "--workers", "1", *report, *service]) == 0
    return folder


@pytest.fixture(scope="module")
def text(folder: Path) -> str:
    """The report."""
    return (folder / "report.html").read_text()


def test_a_report_takes_nothing_from_outside(text: str) -> None:
    elements = Elements(text).found

    addresses = [value for _, inputs in elements for name, value in inputs.items() if name in ("src", "href", "action")]
    assert addresses
    assert [address for address in addresses if not (address or "").startswith("https://gears.example/?")] == []
    assert not {tag for tag, _ in elements} & {"link", "img", "iframe", "object"}


def test_a_report_says_what_the_answers_say(text: str, folder: Path) -> None:
    lift, heavy, bad = read(folder / "answers.csv")
    assert f'<td class="gear">{lift["selected"]}</td>' in text
    assert "&lt;b&gt;lift &amp; belt&lt;/b&gt;" in text and "<b>lift" not in text
    assert heavy["suitable"] == 0 and "No gear; nearest HPN-" in text
    assert bad["error"].replace("'", "&#39;") in text
    assert re.findall(r'<tr class="(\w+)[ \w]*">', text) == ["unsuitable", "rejected", "selected"]


def test_a_report_in_german_has_the_reasons_in_german_too(folder: Path) -> None:
    report = folder / "bericht.html"
    order = ["fleet", str(folder / "axes.csv"), str(folder / "answers.csv"), "--workers", "1"]
    assert main([*order, "--report", str(report), "--lang", "de"]) == 0
    text = report.read_text()

    assert '<html lang="de">' in text and "Getriebe für die Achsen aus axes.csv" in text
    assert "Kein Getriebe; am nächsten: HPN-" in text and "nearest" not in text.partition("</style>")[2]
    assert "</span> speed_rpm: Phase 1: muss mindestens -1000000 sein" in text


def test_every_axis_links_to_its_selection(text: str) -> None:
    links = re.findall(r'href="(https://gears.example/\?[^"]*)"', text)
    once = dict.fromkeys(links)  # the title block names the axis that is used most again
    values = [parse(parse_qsl(urlsplit(link.replace("&amp;", "&")).query)).application for link in once]
    assert values == [Application.model_validate(APPLICATION), Application.model_validate(HEAVY)]


@pytest.mark.parametrize("name", ["report.pdf", "nowhere/report.html"])
def test_a_report_that_could_not_be_written_is_refused_before_anything_is_computed(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    axes, answers = write(tmp_path / "axes.csv", rows()), tmp_path / "answers.csv"

    code = main(["fleet", str(axes), str(answers), "--workers", "1", "--report", str(tmp_path / name)])

    assert code == 2 and name in capsys.readouterr().err
    assert not answers.exists()


def test_without_its_report_no_file_gets_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    axes, answers = write(tmp_path / "axes.csv", rows()), tmp_path / "answers.csv"
    order = ["fleet", str(axes), str(answers), "--workers", "1", "--report", str(tmp_path / "report.html")]

    def full(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_text", full)
        assert main(order) == 1
    assert "stopped: [Errno 28] No space left on device" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["axes.csv"]

    assert main(order) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["answers.csv", "axes.csv", "report.html"]


def test_a_report_where_nothing_may_be_written_is_refused_before_anything_is_computed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        catalogue_for_all(folder, monkeypatch)
        axes = write(folder / "axes.csv", rows())
        assert main(["fleet", str(axes), str(folder / "before.csv")]) == 0  # loads all modules
        (folder / "open").mkdir(mode=0o777)
        (folder / "closed").mkdir(mode=0o755)
        for path, mode in ((folder, 0o755), (folder / "open", 0o777), (folder / "closed", 0o555)):
            path.chmod(mode)
        order = ["fleet", str(axes), str(folder / "open/answers.csv"), "--report", str(folder / "closed/report.html")]
        with as_user(65534):
            assert main(order) == 2
        assert "closed/report.html: this user may not write into" in capsys.readouterr().err
        assert not list((folder / "open").iterdir())


def test_a_report_is_the_same_in_every_locale(tmp_path: Path) -> None:
    axes = write(tmp_path / "Achsen für Halle 7.csv", rows())
    order = ["fleet", str(axes), str(tmp_path / "answers.csv"), "--workers", "1", "--report"]
    command = "from hpn.cli import main; raise SystemExit(main())"
    plain = os.environ | {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}

    assert main([*order, str(tmp_path / "here.html")]) == 0
    subprocess.run([sys.executable, "-c", command, *order, str(tmp_path / "plain.html")], check=True, env=plain)

    assert (tmp_path / "plain.html").read_bytes() == (tmp_path / "here.html").read_bytes()
    assert "Achsen für Halle 7.csv" in (tmp_path / "here.html").read_text(encoding="utf-8")


def test_the_basis_of_the_lives_stands_below_them(text: str) -> None:
    assert "Gear life: L10 as in eq. 17.10" in text
