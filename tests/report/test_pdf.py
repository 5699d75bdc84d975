"""The PDF report, read back: its text against the reply, its structure, and its pixels."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from io import BytesIO

import numpy as np
import pikepdf
import pypdfium2
import pytest
from numpy.typing import NDArray
from pypdf import PdfReader

from hpn.account.readings import readings_of
from hpn.catalogue import Catalogue, load_catalogue
from hpn.files.export import DIGITS, ExportTitle
from hpn.files.report.pdf import pdf
from hpn.files.report.verdict import verdict
from hpn.words.reader import Reader
from hpn.words.units import PRESETS
from tests.build import cycle, phase, worked_example
from tests.report.cases import CASES, CREATED, EVERYTHING, language, typed_export_of

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


Make = Callable[[str, Reader], bytes]


@pytest.fixture(scope="module")
def made() -> Make:
    """Reports with the longest title, each made once."""
    catalogue = load_catalogue()

    @cache
    def make(case: str, reader: Reader) -> bytes:
        return pdf(typed_export_of(CASES[case], catalogue, title=HOSTILE["very long"]), reader)

    return make


def read(document: bytes) -> PdfReader:
    """The document, parsed."""
    return PdfReader(BytesIO(document))


@cache
def page_texts(document: bytes, pages: int) -> list[str]:
    """Text of the first pages, by PDFium, which takes a twentieth of the time of pypdf."""
    found = pypdfium2.PdfDocument(document)
    return [page.get_textpage().get_text_bounded().replace("\r\n", "\n") for page in list(found)[:pages]]


def text(document: bytes, reader: Reader = ENGLISH, pages: int = 8) -> str:
    """Text of the first pages, spaces made plain, thousands written together."""
    found = "\n".join(page_texts(document, pages)).replace("\u200b", " ")
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
def test_report_has_the_answer_the_calculation_and_only_vectors(case: str, made: Make) -> None:
    document = read(made(case, GERMAN))
    pages = page_texts(made(case, GERMAN), 4)
    assert "Lastzyklus" in pages[0] and "Prüfungen von" in pages[0] + pages[1]
    assert any("Rechenkern" in page for page in pages[1:3])
    assert any("Seite 17 des Handbuchs, mit neun Stellen" in page for page in pages[:3])
    assert not any(page.images for page in document.pages[:5])


@pytest.mark.parametrize(("reader", "decimal"), [(ENGLISH, "."), (GERMAN, ",")])
@pytest.mark.parametrize("case", ["example", "everything", "nothing suitable", "iso281", "extremes"])
def test_every_check_stands_in_the_report_with_its_figures(
    case: str, reader: Reader, decimal: str, made: Make, catalogue: Catalogue
) -> None:
    export = typed_export_of(CASES[case], catalogue)
    page = text(made(case, reader), reader)
    heading = reader.text("Checks of {gear}").format(gear=export.candidate.designation)
    table = page[page.index(heading) : page.index(reader.text("Published figures of {gear}").partition(" {")[0])]
    titles = [reader.text(export.selection.check_definitions[check.code].title) for check in export.candidate.checks]
    starts = [_position(table, title) for title in titles]
    readings = readings_of(export.candidate, export.selection, export.application, catalogue)
    for check, start in zip(export.candidate.checks, starts, strict=True):
        row = table[start : min((other for other in starts if other > start), default=len(table))]
        shown = numbers(row, decimal)
        read = readings[check.code]
        for value in (read.demand, read.limit, check.utilisation and 100 * check.utilisation):
            # Four digits are printed; a percentage has at least one behind the decimal mark.
            close = (abs(number - value) <= max(6e-4 * abs(value), 0.051) for number in shown if value is not None)
            assert value is None or any(close), (check, row)
        assert reader.text({"pass": "passes", "fail": "fails"}.get(check.status, "not rated")) in row


def _position(table: str, title: str) -> int:
    """Start of a title, with line breaks anywhere in it."""
    pattern = r"\s*-?\s*".join(re.escape(letter) for letter in title if letter != " ")
    match = re.search(pattern, table)
    assert match, title
    return match.start()


def test_every_input_stands_in_the_report(catalogue: Catalogue) -> None:
    page = text(pdf(typed_export_of(EVERYTHING, catalogue, reference="PLM-4711"), ENGLISH), pages=1)
    for figure in ("−20", "250", "0.3", "900", "4 s", "200 Nm", "1000", "500 N", "1.2", "20000 h", "90 %", "0.95"):
        assert figure in page, figure
    for figure in ("4000 rpm", "20 Nm", "8 Nm", "25 °C", "7 arcmin", "5000 Nm/rad", "5 kg", "200 mm", "3, 5, 10, 25"):
        assert figure in page, figure
    assert "medical equipment" in page and "PLM-4711" in page and "21 November 2026" in page


def test_units_are_written_as_on_the_page(made: Make) -> None:
    german = text(made("everything", GERMAN), GERMAN)
    assert "4000 min⁻¹" in german
    assert "rpm" not in german


def test_every_notice_and_the_versions_stand_in_the_report(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    page = "".join(re.findall(r"[a-z0-9]", text(pdf(export, ENGLISH))))
    for notice in export.selection.notices:
        assert "".join(re.findall(r"[a-z0-9]", notice.text.replace("T_R", "TR"))) in page, notice
    assert export.selection.catalogue_version in page


def test_motor_torques_without_an_efficiency_are_said_to_be_a_lower_bound(catalogue: Catalogue, made: Make) -> None:
    found = " ".join(text(pdf(typed_export_of(worked_example(), catalogue), ENGLISH), pages=2).split())
    assert len(re.findall("motor torque needed, lower bound", found)) == 2
    assert "lower bound" not in text(made("everything", ENGLISH), pages=2)


def test_alternatives_are_the_next_suitable_gears_and_what_makes_a_lighter_one_fit(made: Make) -> None:
    page = " ".join(text(made("example", ENGLISH)).split())
    assert re.search(
        r"Shortest life 1 HPN-20A-5 .* 2 HPN-32A-5 41\.7 % maximum input speed 6\.5 kg 130–169 mm "
        r"24 ?753 ?706 h \(gear L10\)",
        page,
    )
    assert re.search(
        r"Nearest miss: HPN-14A-5 .*110\.4 %.*186\.9 %.* Fits if torques drop to 90\.5 % and T ?k to 107", page
    )


def test_a_gear_that_fails_is_reported_with_what_makes_it_fit_and_the_next_ones(made: Make) -> None:
    page = " ".join(text(made("nothing suitable", ENGLISH)).split())
    assert "No gear is suitable. HPN-11A-4 comes closest" in page
    assert "Fits if torques drop to 1.55 %" in page
    assert page.count("Nearest miss: ") == 2


def test_a_chosen_gear_is_reported_beside_the_one_that_ranks_first(catalogue: Catalogue) -> None:
    export = typed_export_of(CASES["example"], catalogue)
    chosen = (text(pdf(replace(export, chosen=f"HPN-{size}-5"), ENGLISH)) for size in ("32A", "14A"))
    other, failing = (" ".join(found.split()) for found in chosen)
    count = sum(gear.status == "suitable" for gear in export.selection.candidates)
    assert f"It was chosen; HPN-20A-5 ranks first of {count} suitable gears." in other
    assert "HPN-14A-5 was chosen, but" in failing and "HPN-20A-5 would be suitable." in failing


def test_a_brake_that_does_not_stop_the_load_is_why_no_gear_is_suitable(catalogue: Catalogue) -> None:
    """100 kg at 250 mm pull with 245 Nm, 0.1 Nm of the brake hold 5 Nm at most."""
    table = {"type": "rotary", "inertia_kgm2": 7.0, "gravity_mass_kg": 100.0, "gravity_radius_mm": 250.0}
    motion = {"mechanism": table, "moves": [{"profile": "triangular", "angle_deg": 90.0, "time_s": 9.0}]}
    stop = {"brake": {"torque_Nm": 0.1}}
    asked = {"duty_cycle": {"motion": motion}, "emergency_stop": stop, "requirements": {"sizes": ["32A"]}}
    said = "".join(verdict(typed_export_of(asked, catalogue), ENGLISH)["text"])
    assert said.endswith("comes closest, but the brake does not stop the load.")


def test_the_title_block_says_who_answers_for_what(catalogue: Catalogue) -> None:
    heading = ExportTitle("Axis 7", "PLM-4711", "A. Müller", "B", "HPN-20A-5-J6-BH-AF1")
    export = replace(typed_export_of(CASES["example"], catalogue), heading=heading)
    found = text(pdf(export, ENGLISH), pages=1)
    for words in ("Axis 7", "PLM-4711", "A. Müller", "Revision\nB", "HPN-20A-5-J6-BH-AF1", "Saved\n21 November 2026"):
        assert words in found
    unsaved = text(pdf(replace(export, created=None, moment=CREATED), ENGLISH), pages=1)
    assert "Date\n21 November 2026" in unsaved and "Not saved" in unsaved


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN])
def test_the_worked_example_takes_three_pages_with_their_heads(reader: Reader, catalogue: Catalogue) -> None:
    heading = ExportTitle("Infeed turret", "HB-2417", "MA", "C")
    document = pdf(replace(typed_export_of(CASES["example"], catalogue), heading=heading), reader)
    pages = page_texts(document, 9)
    assert len(pages) == 3
    for number, page in enumerate(pages, 1):
        head = " ".join(page.split())
        assert head.startswith(f"Infeed turret HB-2417, {reader.text('Revision')} C")
        assert reader.text("Page {page} of {pages}").format(page=number, pages=3) in head
    for cell in ("Checked", "Approved"):
        assert reader.text(cell) in pages[0]
    assert pages[0].count(reader.text("name, date, signature")) == 2


def test_text_and_drawings_have_the_typeface_of_the_page(made: Make) -> None:
    with pikepdf.open(BytesIO(made("example", ENGLISH))) as opened:
        named = [item.get("/BaseFont") for item in opened.objects if isinstance(item, pikepdf.Dictionary)]
    fonts = {str(name).partition("+")[2] for name in named if name is not None}
    assert {name for name in fonts if name.startswith("HPNSans")} == {
        f"HPNSans-{cut}" for cut in ("Regular", "Bold", "Italic")
    }
    assert not [name for name in fonts if "Libertinus" in name]


def test_every_equation_stands_with_its_numbers(made: Make) -> None:
    page = "".join(text(made("example", GERMAN), GERMAN, 5).split())
    titles = {"17.2": "Belastungsgrenze1", "17.4": "Mittlere", "17.5": "Mittlere", "17.6": "Maximale"}
    titles |= {"17.7": "Belastungsgrenze2", "17.8": "Belastungsgrenze3", "17.9": "Anzahl", "17.10": "Lebensdauer"}
    for number, title in titles.items():
        assert f"{number}{title}" in page
    assert "Tav=" in page and "|nj|·tj" in page  # in symbols too
    for term in ("16415769,1", "156047873", "2171534,09", "174635176"):  # |n| t T^(10/3) of each phase, and their sum
        assert term in page, term
    for figures in ("=32,0210136Nm≤TA=TN=80Nm", "=1087,66234min⁻¹≤nav(max)", "=1167275,94h", "3066035,52→3066035"):
        assert figures in page, figures


@pytest.mark.parametrize(("units", "size", "figures"), [
    ((), (210, 297), ("32.02 Nm", "200 Nm", "25 °C")),
    (PRESETS["US"], (216, 279), ("354.0 lb·in", "1770.15 lb·in", "283.4 lb·in", "77 °F")),
])  # fmt: skip
def test_paper_and_figures_are_the_readers(
    units: tuple[str, ...], size: tuple[int, int], figures: Sequence[str], catalogue: Catalogue
) -> None:
    reader = Reader("en", units, DIGITS)
    document = pdf(typed_export_of(EVERYTHING, catalogue), reader)
    box = read(document).pages[0].mediabox
    assert (round(box.width / POINTS_PER_MM), round(box.height / POINTS_PER_MM)) == size
    found = text(document, reader)
    told = found.replace("752 Nm", "")  # a note of the catalogue
    assert not re.search(r"\d Nm|\d N\b", told) if units else "lb" not in found
    for figure in figures:
        assert figure in found, figure


def test_many_phases_are_summarised_and_the_report_says_so(made: Make) -> None:
    page = text(made("ten thousand phases", GERMAN), GERMAN, 1)
    assert "10000 Phasen, hier zusammengefasst" in page


def test_the_same_selection_gives_the_same_bytes(catalogue: Catalogue) -> None:
    assert pdf(typed_export_of(EVERYTHING, catalogue), GERMAN) == pdf(typed_export_of(EVERYTHING, catalogue), GERMAN)


def test_report_is_tagged_for_people_who_listen(made: Make) -> None:
    document = read(made("everything", GERMAN))
    root = document.root_object
    assert "/StructTreeRoot" in root
    assert "/Marked': True" in str(root["/MarkInfo"])
    assert str(root["/Lang"]) == "de"
    assert b"pdfuaid:part" in made("everything", GERMAN)
    assert document.metadata is not None and document.metadata.title == HOSTILE["very long"]


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_title_breaks_nothing(name: str, catalogue: Catalogue) -> None:
    document = pdf(typed_export_of(CASES["example"], catalogue, title=HOSTILE[name], reference=HOSTILE[name]), ENGLISH)
    found = text(document)
    assert "HPN-20A-5" in found
    if name == "typst code":
        assert '#eval("1") $x$ *b* _a_ @ref <label> #sys.inputs' in found
    if name == "no font has it":
        assert "□" in found and "□ stands for characters" in found


@pytest.mark.parametrize("case", CASES)
def test_nothing_leaves_the_type_area_or_runs_into_the_footer(case: str, made: Make) -> None:
    document = made(case, GERMAN)  # which has the longest words
    for page in range(min(len(read(document).pages), 6)):
        ink = pixels(document, page) < 200
        millimetres = PIXELS_PER_MM
        assert ink.any()
        assert not ink[:, : 15 * millimetres].any() and not ink[:, -15 * millimetres :].any()
        assert not ink[: 12 * millimetres].any()
        assert not ink[281 * millimetres : 284 * millimetres].any()  # between the text and its footer


def test_a_figure_never_stands_on_another(made: Make) -> None:
    """Long German labels once pushed symbols and numbers of a table over each other."""
    page = text(made("everything", GERMAN), GERMAN)
    assert re.search(r"Lagerlebensdauer L50\s+Lb,50\s+84\s*437 h", page)


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN], ids=["en", "de"])
def test_every_text_is_set_in_the_reports_own_faces(reader: Reader, catalogue: Catalogue) -> None:
    """A character that a face lacks, such as the minus of min⁻¹, would set a whole text of a drawing in another one."""
    document = pikepdf.open(BytesIO(pdf(typed_export_of(CASES["example"], catalogue), reader)))
    faces = {str(one["/BaseFont"]).partition("+")[2] for one in document.objects if _is_font(one)}
    assert {face for face in faces if "Math" not in face} == {"HPNSans-Regular", "HPNSans-Bold", "HPNSans-Italic"}


def _is_font(one: pikepdf.Object) -> bool:
    return isinstance(one, pikepdf.Dictionary) and one.get("/Type") == "/Font"


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN])
def test_three_phases_with_a_load_and_lives_take_four_pages_and_no_title_loses_its_entries(
    reader: Reader, catalogue: Catalogue
) -> None:
    phases = phase(60, 40, 0.35), phase(25, 70, 1.4), phase(-55, 40, 0.35)
    load = {"radial_N": 900, "life_h": 30000, "life_basis": "L10"}
    application = cycle(
        *phases, pause_s=0.8, emergency_stop={"torque_Nm": 180}, output_load=load, requirements={"life_h": 30000}
    )
    pages = page_texts(pdf(typed_export_of(application, catalogue), reader), 9)

    assert len(pages) == 4
    (notices,) = [page for page in pages if f"\n{reader.text('Notices')}\n" in page]
    assert re.search(rf"\n{reader.text('Notices')}\n1\b.*\n2\b", notices, re.DOTALL)
