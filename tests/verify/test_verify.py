"""`hpn verify`: files of this version and of the two before, as they are and with a digit altered."""

import json
import random
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache
from io import BytesIO
from pathlib import Path

import openpyxl
import pytest
from msgspec import structs

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.engine.selection import encode
from hpn.files.aas import submodel
from hpn.files.aas.submodel import package
from hpn.files.export import DIGITS
from hpn.files.formats import FileFormat
from hpn.files.report.pdf import pdf
from hpn.files.workbook.workbook import workbook
from hpn.verify.paper import Format
from hpn.verify.shown import FileSubject, UnreadableFileError
from hpn.verify.verify import verify
from hpn.words.reader import Reader
from tests.build import Json
from tests.report.cases import CASES, typed_export_of
from tests.verify.altered import count_of_digits, with_blank_page, with_creator, with_digit_altered
from tests.verify.earlier import VERSIONS, file_of
from tests.verify.stripped import WITHOUT, rezipped

ENGLISH = Reader(digits=DIGITS)
GERMAN = Reader("de", ("lb_in", "lbf", "lb", "in", "degF"), DIGITS)
MAKERS: dict[str, Callable[..., bytes]] = {
    "pdf": lambda export, reader: pdf(export, reader),
    "xlsx": lambda export, reader: workbook(export, reader),
    "aasx": lambda export, reader: package(export),
}


@pytest.fixture(scope="module", autouse=True)
def each_file_read_once() -> Iterator[None]:
    """Shares the reading of a file: most are compared with the same file made again, and pypdf takes longest."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Format, "lines", cache(Format.lines))
        yield


@pytest.mark.parametrize("case", ["everything", "nothing suitable", "extremes"])
@pytest.mark.parametrize("kind", MAKERS)
def test_a_file_of_this_version_is_the_same_in_any_language_and_unit(
    kind: str, case: str, catalogue: Catalogue
) -> None:
    for reader in (ENGLISH, GERMAN):
        export = typed_export_of(CASES[case], catalogue, reference="4711")
        verdict = verify(MAKERS[kind](export, reader), catalogue)
        assert (verdict.differs, verdict.unchecked) == ((), ())
        assert verdict.same > 100
        assert verdict.versions == (type(verdict.versions))(ENGINE_VERSION, catalogue.version)


@pytest.mark.parametrize("case", ["example"])
def test_one_altered_digit_anywhere_on_a_report_is_named(
    case: str, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Digits are altered by pikepdf, in the content of the page; the report to compare with is made once."""
    report = pdf(typed_export_of(CASES[case], catalogue), ENGLISH)
    monkeypatch.setattr(FileFormat, "content", lambda *_: report)
    count = count_of_digits(report)
    assert count > 500
    for number in random.Random(53).sample(range(count), 12):
        altered, place = with_digit_altered(report, number)
        found = verify(altered, catalogue).differs
        assert {finding.place for finding in found} == {place}
        assert all(finding.reasons == ("file",) for finding in found)


def test_a_digit_altered_in_a_workbook_is_named_with_its_row(catalogue: Catalogue) -> None:
    book = openpyxl.load_workbook(BytesIO(workbook(typed_export_of(CASES["example"], catalogue), ENGLISH)))
    sheet = book.worksheets[0]
    cell = next(c for row in sheet.iter_rows() for c in row if c.value == 149.0)
    cell.value = 149.00000001
    packed = BytesIO()
    book.save(packed)
    found = [one for one in verify(packed.getvalue(), catalogue).differs if "149.0" in one.shown]
    assert [one.place for one in found] == [f"Selection, row {cell.row}"]
    assert found[0].reasons == ("file",)


def test_a_digit_altered_in_a_package_is_named_with_its_path(catalogue: Catalogue) -> None:
    def alter(name: str, part: bytes) -> bytes:
        return part.replace(b">149.0<", b">148.0<", 1) if name == "aasx/data.xml" else part

    made = package(typed_export_of(CASES["example"], catalogue))
    found = verify(rezipped(made, alter), catalogue).differs
    section = "TechnicalData/TechnicalPropertyAreas/TorqueAtTheOutput"
    assert [one.place for one in found] == [f"{section}/repeated_peak_torque_Nm"]


def test_a_digit_altered_in_the_course_of_a_motion_is_named_with_its_row(catalogue: Catalogue) -> None:
    def alter(name: str, part: bytes) -> bytes:
        return part.replace(b"0.3,", b"0.4,", 1) if name == "aasx/motion_1.csv" else part

    made = package(typed_export_of(CASES["example"], catalogue))
    found = verify(rezipped(made, alter), catalogue).differs
    assert [one.place for one in found] == ["motion_1.csv/row 3"]


def test_an_altered_answer_inside_a_file_is_named_though_the_lines_agree_with_it(catalogue: Catalogue) -> None:
    def alter(name: str, part: bytes) -> bytes:
        return part.replace(b'"limit":80', b'"limit":90') if name == "aasx/result.json" else part

    found = verify(rezipped(package(typed_export_of(CASES["example"], catalogue)), alter), catalogue).differs
    assert {one.reasons for one in found} == {("file",)}
    assert any(one.place.startswith("result.json/candidates/") for one in found)


def test_a_digit_altered_on_the_report_in_a_package_is_named_with_its_page(catalogue: Catalogue) -> None:
    """Text by its line; a page of drawings alone, as nothing has it there today."""

    def with_digit(name: str, part: bytes) -> bytes:
        return with_digit_altered(part, 100)[0] if name == "aasx/report.pdf" else part

    def with_page(name: str, part: bytes) -> bytes:
        return with_blank_page(part) if name == "aasx/report.pdf" else part

    made = package(typed_export_of(CASES["example"], catalogue))
    page = with_digit_altered(pdf(typed_export_of(CASES["example"], catalogue), ENGLISH), 100)[1]
    assert {one.place for one in verify(rezipped(made, with_digit), catalogue).differs} == {f"report.pdf, {page}"}
    assert [one.shown for one in verify(rezipped(made, with_page), catalogue).differs] == [
        "a drawing, letter or note that differs from its text"
    ]


def test_a_package_is_the_same_where_its_maker_or_its_reader_can_set_no_report(
    catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The report is of an extra of its own: without it a package has none, and one in it is named as not checked."""
    export = typed_export_of(CASES["example"], catalogue)
    whole = package(export)
    with monkeypatch.context() as without:
        without.setattr(submodel, "has_extra", lambda extra: False)
        bare, read = package(export), verify(whole, catalogue)
    assert (read.differs, read.unchecked) == ((), ("report.pdf: not checked without the extra report",))
    assert (verify(bare, catalogue).differs, verify(bare, catalogue).unchecked) == ((), ())


def test_drawings_of_another_program_are_listed_as_not_checked(
    catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    report = pdf(typed_export_of(CASES["example"], catalogue), ENGLISH)
    monkeypatch.setattr(FileFormat, "content", lambda *_: with_creator(report, "another"))
    verdict = verify(report, catalogue)
    assert (verdict.differs, len(verdict.unchecked)) == ((), 1)
    assert verdict.unchecked[0].startswith("all pages: what is drawn")


def test_a_decimal_comma_that_moves_in_a_german_text_is_named(catalogue: Catalogue) -> None:
    """78,1 % is no 781 %: a comma is a mark between thousands in English alone."""

    def alter(name: str, part: bytes) -> bytes:
        moved = part.replace(b"mit 78,1", b"mit 781", 1)
        assert name != "aasx/data.xml" or moved != part
        return moved if name == "aasx/data.xml" else part

    found = verify(rezipped(package(typed_export_of(CASES["example"], catalogue)), alter), catalogue).differs
    assert len(found) == 1
    assert "781" in found[0].shown


def test_a_value_that_moves_to_another_column_is_named(catalogue: Catalogue) -> None:
    book = openpyxl.load_workbook(BytesIO(workbook(typed_export_of(CASES["example"], catalogue), ENGLISH)))
    row = next(row for row in book.worksheets[0].iter_rows() if row[-1].value is None and row[-2].value is None)
    last = max(cell.column for cell in row if cell.value is not None)
    row[last].value, row[last - 1].value = row[last - 1].value, None
    packed = BytesIO()
    book.save(packed)
    places = {one.place for one in verify(packed.getvalue(), catalogue).differs}
    assert f"{book.worksheets[0].title}, row {row[0].row}" in places


# --- Files of earlier versions ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["report.pdf", "report.xlsx", "submodel.aasx", "selection.json"])
def test_files_of_earlier_versions_show_what_is_calculated_today(version: str, name: str, catalogue: Catalogue) -> None:
    """Most of their lines have a counterpart today; `earlier.py` says where the files come from."""
    verdict = verify(file_of(version, name), catalogue)
    assert verdict.differs == ()
    assert verdict.versions.engine == version
    assert verdict.same > 90
    assert len(verdict.unchecked) < 90


def test_an_altered_figure_of_an_earlier_version_is_named(catalogue: Catalogue) -> None:
    """The limits are those of today, so that the catalogue is not the reason."""
    value = json.loads(file_of("1.0.0", "selection.json"))
    value["result"]["candidates"][0]["average_input_speed_rpm"] += 1
    found = verify(json.dumps(value).encode(), catalogue).differs
    assert [one.place for one in found] == ["/result/candidates/0/average_input_speed_rpm"]
    assert found[0].reasons == ("engine",)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_digit_altered_on_a_report_of_an_earlier_version_is_named(version: str, catalogue: Catalogue) -> None:
    """As differing, or among what can't be checked with its line; numbers of tables and pages may escape."""
    report = file_of(version, "report.pdf")
    plain, named = verify(report, catalogue), 0
    for number in random.Random(7).sample(range(count_of_digits(report)), 6):
        verdict = verify(with_digit_altered(report, number)[0], catalogue)
        named += (verdict.differs, verdict.unchecked) != (plain.differs, plain.unchecked)
    assert named >= 3


def test_a_report_that_leads_to_a_saved_selection_needs_its_application(catalogue: Catalogue) -> None:
    report = file_of("1.0.0", "saved.pdf")
    with pytest.raises(UnreadableFileError, match="--application"):
        verify(report, catalogue)
    saved = json.loads(file_of("1.0.0", "selection.json"))
    verdict = verify(report, catalogue, FileSubject(Application.model_validate(saved["application"])))
    assert verdict.differs == ()


CHOSEN = "HPN-32A-5"
"""A gear of the worked example that is not the foremost."""


@pytest.mark.parametrize("kind", MAKERS)
def test_a_file_of_an_earlier_version_that_shows_another_gear_than_the_foremost_is_the_same(
    kind: str, catalogue: Catalogue, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As 1.1.0 wrote them: a package without its title block; report and workbook with their link alone, of a saved
    selection, whose JSON names the gear, or of a link with the gear in it.
    """
    export = replace(typed_export_of(CASES["example"], catalogue), chosen=CHOSEN)
    assert export.selection.foremost.designation != CHOSEN
    saved = tmp_path / "saved.json"
    answered = json.loads(encode(export.selection))
    application = export.application.model_dump(mode="json", exclude_none=True)
    saved.write_text(json.dumps({"application": application, "designation": CHOSEN, "result": answered}))
    link = f"https://plm.example{export.selection.link}&gear={CHOSEN}"
    for address, words in (("https://plm.example/selections/7", ["--application", str(saved)]), (link, [])):
        file = tmp_path / f"file.{kind}"
        file.write_bytes(WITHOUT[kind](MAKERS[kind](replace(export, link=address), ENGLISH)))
        code = main(["verify", str(file), *words])
        assert (code, "differs" in (shown := capsys.readouterr()).out, shown.err) == (0, False, "")


def test_a_package_of_an_earlier_version_whose_axis_had_no_link_is_the_same(catalogue: Catalogue) -> None:
    """Axes of machines were packed without one; a report made of it has no code to scan."""
    export = typed_export_of(CASES["example"], catalogue)
    axis = replace(export, link="", selection=structs.replace(export.selection, link=""))

    verdict = verify(WITHOUT["aasx"](package(axis)), catalogue)

    assert (verdict.differs, verdict.same > 90) == ((), True)


def test_a_tolerance_of_an_application_that_leaves_out_defaults_is_the_same(catalogue: Catalogue) -> None:
    """Files carry defaults, such as the pause, that a program need not send; the worst case has them either way."""
    sent: Json = {"duty_cycle": {"phases": [{"torque_Nm": 40, "speed_rpm": 250, "duration_s": 2}]}}
    export = typed_export_of(sent | {"tolerances": {"torque_Nm": {"percent": 10}}}, catalogue)
    for content in (pdf(export, ENGLISH), workbook(export, ENGLISH), package(export), encode(export.selection)):
        assert verify(content, catalogue).differs == ()
    answer = json.loads(encode(export.selection))
    answer["tolerance"]["case"]["duty_cycle"]["phases"][0]["torque_Nm"] += 1
    (found,) = verify(json.dumps(answer).encode(), catalogue).differs
    assert found.place == "/tolerance/case/duty_cycle/phases/0/torque_Nm"


# --- The command ------------------------------------------------------------------------------------------------------


def test_the_command_says_what_differs_by_its_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "selection.json"
    file.write_bytes(file_of("1.1.0", "selection.json"))
    assert main(["verify", str(file)]) == 0
    assert "same to 1e-12" in capsys.readouterr().out

    value = json.loads(file.read_bytes())
    value["result"] |= {"selected": "HPN-32A-5", "engine_version": ENGINE_VERSION}
    file.write_text(json.dumps(value))
    assert main(["verify", str(file)]) == 3
    assert (
        "/result/selected: shows “HPN-32A-5”, calculated “HPN-20A-5”: the file was altered" in capsys.readouterr().out
    )

    assert main(["verify", str(file), "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["differs"]


@pytest.mark.parametrize(
    "content",
    [
        *(b"", b"no file of ours", b"[]", b"{}", b'{"axes": [1]}', b'{"result": {}, "application": {}}'),
        *(b"%PDF-1.7", b"%PDF-1.7\n" + b"1 0 obj" * 50, b"PK", b"PK\x03\x04xl/workbook.xml", b"[" * 100_000),
        *(b'{"candidates": [], "link": "/?T=1&n=1&t=1"}', b'{"axes": [{"application": {"duty_cycle": 7}}]}', b"\xff"),
        *(b'{"candidates": [], "link": "http://["}', b'{"axes": [{"application": {}, "answer": {"unknown": 7}}]}'),
        b'{"axes": [{"application": {}, "answer": {"unknown": [{}]}}]}',
    ],
)
def test_what_is_no_file_of_ours_is_a_sentence(
    content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_bytes(content)
    code = main(["verify", str(file)])
    shown = capsys.readouterr()
    if content.startswith(b'{"axes": [{'):  # an open axis has no figure
        assert code == 0
    else:
        assert (code, shown.out) == (2, "")
        assert shown.err.startswith(f"{file}: ") and shown.err.count("\n") == 1


@pytest.mark.parametrize("kind", ["xlsx", "aasx"])
def test_a_zipped_file_with_damaged_bytes_is_a_sentence(kind: str, catalogue: Catalogue) -> None:
    made = MAKERS[kind](typed_export_of(CASES["example"], catalogue), ENGLISH)
    draw = random.Random(54)
    for _ in range(30):
        damaged = bytearray(made)
        start = draw.randrange(len(made))
        damaged[start : start + 40] = draw.randbytes(40)
        with suppress(UnreadableFileError):
            assert verify(bytes(damaged), catalogue).file


def test_a_file_that_unpacks_to_more_than_its_bounds_is_refused(catalogue: Catalogue) -> None:
    bomb = rezipped(package(typed_export_of(CASES["example"], catalogue)), lambda name, part: part, ("aasx/bomb", 201))
    with pytest.raises(UnreadableFileError, match="the package holds more than 200000000 bytes"):
        verify(bomb, catalogue)
    book = workbook(typed_export_of(CASES["example"], catalogue), ENGLISH)
    with pytest.raises(UnreadableFileError, match="the workbook holds more than 200000000 bytes"):
        verify(rezipped(book, lambda name, part: part, ("xl/bomb", 201)), catalogue)
    opened = openpyxl.load_workbook(BytesIO(book))
    opened.worksheets[0].cell(1_000_000, 16_000).value = 1
    packed = BytesIO()
    opened.save(packed)
    with pytest.raises(UnreadableFileError, match="the workbook has more than 2000000 cells"):
        verify(packed.getvalue(), catalogue)


def test_a_missing_file_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", str(tmp_path / "none.pdf")]) == 2
    assert "there is no such file" in capsys.readouterr().err


def test_a_package_nested_deeply_is_refused(catalogue: Catalogue) -> None:
    deep = b"<a>" * 100_000 + b"</a>" * 100_000
    made = package(typed_export_of(CASES["example"], catalogue))
    with pytest.raises(UnreadableFileError, match="of the package is nested too deeply"):
        verify(rezipped(made, lambda name, part: deep if name == "aasx/data.xml" else part), catalogue)


def test_a_workbook_with_an_infinite_number_is_refused_in_one_line(catalogue: Catalogue) -> None:
    def alter(name: str, part: bytes) -> bytes:
        return part.replace(b"<v>149</v>", b"<v>1e999</v>") if name.startswith("xl/worksheets/") else part

    made = rezipped(workbook(typed_export_of(CASES["example"], catalogue), ENGLISH), alter)
    with pytest.raises(UnreadableFileError) as caught:
        verify(made, catalogue)
    assert str(caught.value).count("\n") == 0
