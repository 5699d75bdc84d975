"""The PDF report, read back: its text against the reply, its structure, and its pixels."""

import re
from io import BytesIO

import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray
from pypdf import PdfReader

from hpn.catalogue import Catalogue
from hpn.reader import Reader
from hpn.readings import readings_of
from hpn.report.pdf import pdf
from hpn.report.tables import MOST_PHASES
from tests.build import worked_example
from tests.report.cases import CASES, EVERYTHING, language, typed_export_of

ENGLISH, GERMAN = language("en"), language("de")
POINTS_PER_MM = 72 / 25.4
PIXELS_PER_MM = 4

HOSTILE = {
    "typst code": '#eval("1") $x$ *b* _a_ @ref <label> #sys.inputs \\ "',
    "right to left": "מערכת הנעה 7 مرحبا",
    "turns direction": "axis \u202e7\u202c",
    "no font has it": "བོད 𒀀 7",
    "very long": "x" * 5000,
    "controls": "a\x00b\x1b\n\tc\ud7ff",
    "empty": "",
}


def read(document: bytes) -> PdfReader:
    """The document, parsed."""
    return PdfReader(BytesIO(document))


def text(document: bytes, page: int, reader: Reader = ENGLISH) -> str:
    """Text of one page, spaces made plain, thousands written together."""
    found = read(document).pages[page].extract_text().replace("\u200b", " ")
    return re.sub(rf"(?<=\d){re.escape(reader.group)}(?=\d{{3}}(?!\d))", "", found).replace("\u202f", " ")


def numbers(words: str, decimal: str) -> list[float]:
    """Every number in a text."""
    plain = words.replace("−", "-").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")).replace("·10", "e")
    found = re.findall(rf"-?\d+(?:\{decimal}\d+)?(?:e-?\d+)?", plain)
    return [float(number.replace(decimal, ".")) for number in found]


def pixels(document: bytes, page: int) -> NDArray[np.uint8]:
    """One page as grey pixels."""
    scale = PIXELS_PER_MM / POINTS_PER_MM
    image = pypdfium2.PdfDocument(document)[page].render(scale=scale, grayscale=True).to_numpy()
    return np.asarray(image).reshape(image.shape[0], -1)


@pytest.mark.parametrize("case", CASES)
def test_report_has_two_pages_before_the_phases_of_a_long_cycle_and_only_vectors(
    case: str, catalogue: Catalogue
) -> None:
    export = typed_export_of(CASES[case], catalogue)
    document = read(pdf(export, ENGLISH))
    behind = document.pages[2:]
    assert bool(behind) == (len(export.application.duty_cycle.phases) > MOST_PHASES)
    assert "Versions" in document.pages[1].extract_text()
    assert not any(page.images for page in document.pages[:5])


@pytest.mark.parametrize(("reader", "decimal"), [(ENGLISH, "."), (GERMAN, ",")])
@pytest.mark.parametrize("case", ["example", "everything", "nothing suitable", "iso281", "extremes"])
def test_every_check_stands_in_the_report_with_its_figures(
    case: str, reader: Reader, decimal: str, catalogue: Catalogue
) -> None:
    export = typed_export_of(CASES[case], catalogue)
    page = text(pdf(export, reader), 1, reader)
    table = page[: page.index(reader.text("Published figures of {gear}").partition(" {")[0])]
    titles = [reader.text(export.selection.check_definitions[check.code].title) for check in export.candidate.checks]
    starts = [_position(table, title) for title in titles]
    definitions = export.selection.check_definitions
    readings = readings_of(export.candidate, definitions, export.application, catalogue)
    for check, start, end in zip(export.candidate.checks, starts, [*starts[1:], len(table)], strict=True):
        row = table[start:end]
        shown = numbers(row, decimal)
        read = readings[check.code]
        for value in (read.demand, read.limit, check.utilisation and 100 * check.utilisation):
            # Four digits are printed; a percentage has at least one behind the decimal mark.
            close = (abs(number - value) <= max(6e-4 * abs(value), 0.051) for number in shown if value is not None)
            assert value is None or any(close), (check, row)
        assert {"pass": "passes", "fail": "fails"}.get(check.status, "not rated") in row or reader is GERMAN


def _position(table: str, title: str) -> int:
    """Where a title starts, however its line is broken."""
    pattern = r"\s*-?\s*".join(re.escape(letter) for letter in title if letter != " ")
    match = re.search(pattern, table)
    assert match, title
    return match.start()


def test_every_input_stands_in_the_report(catalogue: Catalogue) -> None:
    page = text(pdf(typed_export_of(EVERYTHING, catalogue, reference="PLM-4711"), ENGLISH), 0)
    for figure in ("−20", "250", "0.3", "900", "4 s", "200 Nm", "1000", "500 N", "1.2", "20000 h", "0.9", "0.95"):
        assert figure in page, figure
    for figure in ("4000 rpm", "20 Nm", "8 Nm", "25 °C", "7 arcmin", "5000 Nm/rad", "5 kg", "200 mm", "3, 5, 10, 25"):
        assert figure in page, figure
    assert "medical equipment" in page and "PLM-4711" in page and "21 November 2026" in page


def test_units_are_written_as_on_the_page(catalogue: Catalogue) -> None:
    german = text(pdf(typed_export_of(EVERYTHING, catalogue), GERMAN), 0, GERMAN)
    assert "4000 min⁻¹" in german
    assert "rpm" not in german


def test_every_notice_and_the_versions_stand_in_the_report(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    page = "".join(re.findall(r"[a-z0-9]", text(pdf(export, ENGLISH), 1)))
    for notice in export.selection.notices:
        assert "".join(re.findall(r"[a-z0-9]", notice.text.replace("T_R", "TR"))) in page, notice
    assert export.selection.catalogue_version in page


def test_motor_torques_without_an_efficiency_are_said_to_be_a_lower_bound(catalogue: Catalogue) -> None:
    found = " ".join(text(pdf(typed_export_of(worked_example(), catalogue), ENGLISH), 0).split())
    assert len(re.findall("motor torque needed, lower bound", found)) == 2
    assert "lower bound" not in text(pdf(typed_export_of(EVERYTHING, catalogue), ENGLISH), 0)


def test_alternatives_name_the_runner_up_and_why_the_smaller_gear_fails(catalogue: Catalogue) -> None:
    page = text(pdf(typed_export_of(CASES["example"], catalogue), ENGLISH), 1)
    assert re.search(r"Runner-up:\s+HPN-32A-5", page)
    assert re.search(r"Smaller gear:\s+HPN-14A-5 .*110\.4 %.*186\.9 %", page.replace("\n", " "))


def test_many_phases_are_summarised_and_the_report_says_so(catalogue: Catalogue) -> None:
    page = text(pdf(typed_export_of(CASES["ten thousand phases"], catalogue), ENGLISH), 0)
    assert "10000 phases, summarised here" in page


def test_the_same_selection_gives_the_same_bytes(catalogue: Catalogue) -> None:
    assert pdf(typed_export_of(EVERYTHING, catalogue), GERMAN) == pdf(typed_export_of(EVERYTHING, catalogue), GERMAN)


def test_report_is_tagged_for_people_who_listen(catalogue: Catalogue) -> None:
    document = read(pdf(typed_export_of(EVERYTHING, catalogue), GERMAN))
    root = document.root_object
    assert "/StructTreeRoot" in root
    assert "/Marked': True" in str(root["/MarkInfo"])
    assert str(root["/Lang"]) == "de"
    assert b"pdfuaid:part" in pdf(typed_export_of(EVERYTHING, catalogue), GERMAN)
    assert document.metadata is not None and document.metadata.title == "Rotary table"


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_title_breaks_nothing(name: str, catalogue: Catalogue) -> None:
    document = pdf(typed_export_of(CASES["example"], catalogue, title=HOSTILE[name], reference=HOSTILE[name]), ENGLISH)
    assert len(read(document).pages) == 2
    assert "HPN-20A-5" in text(document, 0)
    if name == "typst code":
        assert '#eval("1") $x$ *b* _a_ @ref <label> #sys.inputs' in text(document, 0)
    if name == "no font has it":
        assert "□" in text(document, 0) and "□ stands for characters" in text(document, 1)


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN])
@pytest.mark.parametrize("case", CASES)
def test_nothing_leaves_the_type_area_or_runs_into_the_footer(case: str, reader: Reader, catalogue: Catalogue) -> None:
    document = pdf(typed_export_of(CASES[case], catalogue, title=HOSTILE["very long"]), reader)
    for page in range(2):
        ink = pixels(document, page) < 200
        millimetres = PIXELS_PER_MM
        assert ink.any()
        assert not ink[:, : 15 * millimetres].any() and not ink[:, -15 * millimetres :].any()
        assert not ink[: 12 * millimetres].any()
        assert not ink[281 * millimetres : 284 * millimetres].any()  # between the text and its footer


def test_a_figure_never_stands_on_another(catalogue: Catalogue) -> None:
    """Long German labels once pushed symbols and numbers of a table over each other."""
    page = text(pdf(typed_export_of(EVERYTHING, catalogue), GERMAN), 0, GERMAN)
    assert re.search(r"Lagerlebensdauer L50\s+Lb,50\s+84\s*437 h", page)
