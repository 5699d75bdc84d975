"""The workbook with changed inputs, and on paper: LibreOffice calculates, prints and colours it."""

import copy
import random
import re
from collections import Counter
from collections.abc import Iterator
from io import BytesIO

import numpy as np
import openpyxl
import pypdfium2
import pytest
from openpyxl.utils import get_column_letter
from openpyxl.workbook import Workbook
from openpyxl.worksheet.worksheet import Worksheet
from pypdf import PdfReader

from hpn.application import InputError
from hpn.catalogue import Catalogue
from hpn.engine.checks import CHECKS
from tests.build import Json, answer, cycle, phase, worked_example
from tests.property.draw import at_random
from tests.report.cases import EVERYTHING, export_of, language, workbook
from tests.report.conftest import Print, Recalculate
from tests.report.test_workbook import assert_agrees, got, opened, put, same

SHEETS = {"Selection": ("A2", 8, 0), "Inputs": (None, 11, 52), "Candidates": ("B2", 25, 1)}
"""Sheets: what stays in view, how many columns are printed, and the row that stands on every page."""

PAPER_POINTS, PAPER_HEIGHT, LEAST_POINTS = 595 - 0.9 * 72, 842 - 1.2 * 72, 7.0
"""A sheet of A4 within its margins, and the smallest letters to be read."""

GREEN, RED = (0xE6, 0xF4, 0xEA), (0xFC, 0xE8, 0xE6)

STOP = {"torque_Nm": 900, "count": 1000}
SIZES = {"sizes": ["11A", "14A", "20A", "32A", "40A"]}
ASKED = SIZES | {"ratios": [5]}
SAVED = worked_example(requirements=ASKED)
MEANT = cycle(
    phase(40, 250, 0.3),
    phase(500, 500, 3),
    phase(20, 250, 0.4),
    pause_s=4,
    emergency_stop=STOP,
    requirements=ASKED,
)
"""Application that is saved, and the one that `changed` makes of it, in which no gear passes."""

EXTREME = (phase(0.01, 1e-3, 12345.678, peak_torque_Nm=999_999.123, peak_speed_rpm=99_999.1234), phase(0.5, 0, 1e6))
"""Figures from far below 1 to a life of more hours than a column has room for."""


def changed(catalogue: Catalogue) -> Workbook:
    """The workbook on SAVED after its cells were changed to what is MEANT."""
    book = opened(SAVED, catalogue)
    put(book, "torque_Nm", 500, 1)
    put(book, "T_k", STOP["torque_Nm"])
    put(book, "N_k", STOP["count"])
    return book


def drawn(catalogue: Catalogue, times: int) -> dict[str, tuple[Json, Json]]:
    """Drawn applications with their replies, by seed: each asks for a check that fewer than `times` before it do."""
    found: dict[str, tuple[Json, Json]] = {}
    asked: Counter[str] = Counter()
    for seed in range(50 * times):
        application = at_random(random.Random(seed))
        application.setdefault("requirements", {}).setdefault("ratios", [5, 10, 50])  # fewer rows, sooner calculated
        try:
            reply = answer(application, catalogue)
        except InputError:
            continue
        checks = reply["check_definitions"].keys()
        if any(asked[code] < times for code in checks):
            found[f"seed {seed}"] = application, reply
            asked.update(checks)
    missing = {check.code for check in CHECKS if asked[check.code] < times}
    assert not missing, f"draw what asks for {missing} in tests/property/draw.py"
    return found


def assert_chosen_agrees(book: Workbook, chosen: Json, name: str) -> None:
    """Demand, limit and verdict of each check of the chosen gear are those of the reply."""
    words = {"pass": "passes", "fail": "fails", "not_rated": "not rated"}
    titles = {check.code: f"{check.title} [{check.unit}]" if check.unit else check.title for check in CHECKS}
    rows = {row[0]: row for row in book["Selection"].iter_rows(max_col=7, values_only=True)}
    for check in chosen["checks"]:
        _, _, demand, limit, used, verdict, _ = rows[titles[check["code"]]]
        assert verdict == words[check["status"]], (name, check, verdict)
        assert check["demand"] is None or same(demand, check["demand"]), (name, check, demand)
        assert check["limit"] is None or same(limit, check["limit"]), (name, check, limit)
        assert check["utilisation"] is None or same(used, check["utilisation"]), (name, check, used)


def shows(document: bytes, colour: tuple[int, int, int]) -> bool:
    """True where an area of the first page has a colour."""
    image = pypdfium2.PdfDocument(document)[0].render(rev_byteorder=True).to_numpy()[..., :3]
    return int(np.equal(image, colour).all(axis=-1).sum()) > 100


@pytest.fixture(scope="module")
def printed(catalogue: Catalogue, print_out: Print) -> Iterator[dict[str, bytes]]:
    """Workbooks as LibreOffice prints them, all in one start."""
    hostile = 'R & D &P &"Wingdings" 轴 ' * 20
    books = {
        "saved": opened(SAVED, catalogue),
        "changed": changed(catalogue),
        "everything": opened(EVERYTHING, catalogue, code="de"),
        "extreme": opened(cycle(*EXTREME, output_load={"radial_N": 1, "load_coefficient": 1}), catalogue),
        "hostile": openpyxl.load_workbook(
            BytesIO(workbook(export_of(worked_example(requirements=SIZES), catalogue, title=hostile), language("en")))
        ),
    }
    yield print_out(books)


def test_inputs_that_fail_every_gear_recalculate_to_what_the_service_says(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    reply = answer(MEANT, catalogue)
    fresh = recalculate({"failing": changed(catalogue)})["failing"]
    assert_agrees(fresh, reply)
    assert {candidate["status"] for candidate in reply["candidates"]} == {"unsuitable", "unrated"}
    assert same(got(fresh, "T_av"), reply["duty"]["average_torque_Nm"])
    words = {row[5].value for row in fresh["Selection"].iter_rows()}
    assert {"fails", "passes"} <= words


def test_service_and_workbook_agree_on_drawn_applications(
    catalogue: Catalogue, recalculate: Recalculate, soak: bool
) -> None:
    """By the formulas alone: the values saved beside them are gone before LibreOffice calculates. Many are negative."""
    cases = drawn(catalogue, 60 if soak else 3)
    fresh = recalculate({name: opened(application, catalogue) for name, (application, _) in cases.items()})
    for name, (_, reply) in cases.items():
        assert_agrees(fresh[name], reply)
        designation = got(fresh[name], "gear")
        assert_chosen_agrees(fresh[name], next(c for c in reply["candidates"] if c["designation"] == designation), name)


def test_a_check_that_passed_and_now_fails_turns_from_green_to_red(printed: dict[str, bytes]) -> None:
    assert shows(printed["saved"], GREEN) and not shows(printed["saved"], RED)
    assert shows(printed["changed"], RED)


@pytest.mark.parametrize("name", ["saved", "everything", "hostile"])
def test_a_workbook_is_printed_on_three_pages_with_numbers_and_heads(name: str, printed: dict[str, bytes]) -> None:
    document = pypdfium2.PdfDocument(printed[name])
    assert len(document) == 3
    pages = [document[page].get_textpage().get_text_range() for page in range(len(document))]
    word = r"Seite\s+{}\s+von\s+{}" if name == "everything" else r"Page\s+{}\s+of\s+{}"
    texts = [extracted.extract_text() for extracted in PdfReader(BytesIO(printed[name])).pages]
    assert all(re.search(word.format(number, len(pages)), text) for number, text in enumerate(texts, 1))
    assert "###" not in "".join(pages)
    assert "HPN-20A-5" in pages[2]
    for page in range(len(document)):
        image = document[page].render(scale=1, grayscale=True).to_numpy()
        assert (image[:, :8] > 200).all() and (image[:, -8:] > 200).all()


def test_no_figure_is_too_wide_for_its_column(printed: dict[str, bytes]) -> None:
    document = pypdfium2.PdfDocument(printed["extreme"])
    pages = "".join(document[page].get_textpage().get_text_range() for page in range(len(document)))
    assert "##" not in pages
    assert re.search(r"\d\.\d\dE\+\d\d", pages)


def test_every_sheet_has_its_print_area_and_keeps_its_heads(catalogue: Catalogue) -> None:
    book = opened(EVERYTHING, catalogue)
    assert book.sheetnames == [*SHEETS]
    for name, (frozen, columns, head) in SHEETS.items():
        sheet = book[name]
        assert sheet.freeze_panes == frozen
        assert str(sheet.print_area).endswith(f"$A$1:${get_column_letter(columns)}${sheet.max_row}")
        assert (sheet.page_setup.fitToWidth or 1, sheet.page_setup.fitToHeight or 1) == (1, 1)
        assert not head or sheet.print_title_rows == f"${head}:${head}"


def letters(sheet: Worksheet) -> float:
    """Size in points on A4 of the letters of a sheet in the file's own font, of which a character is 7 pixels wide."""
    fitted = sheet.sheet_properties.pageSetUpPr
    if not (fitted and fitted.fitToPage):
        return 10 * (sheet.page_setup.scale or 100) / 100
    _, last, _ = SHEETS[sheet.title]
    columns = [kind for kind in sheet.column_dimensions.values() if not kind.hidden]
    counts = [max(0, min(kind.max or 0, last) - (kind.min or 0) + 1) for kind in columns]
    width = sum(count * 7 * kind.width for count, kind in zip(counts, columns, strict=True)) * 72 / 96
    rows = [sheet.row_dimensions[row] for row in range(1, sheet.max_row + 1)]
    height = sum(row.height or 12.75 for row in rows if not row.hidden) / (sheet.page_setup.fitToHeight or 1)
    paper = (PAPER_POINTS, PAPER_HEIGHT)
    if sheet.page_setup.orientation == "landscape":
        paper = (842 - 0.9 * 72, 595 - 1.2 * 72)
    return 10 * min(paper[0] / width, paper[1] / height, 1)


EVERY_CHECK = copy.deepcopy(EVERYTHING)
EVERY_CHECK["requirements"] |= {"natural_frequency_Hz": 5, "position_error_arcmin": 60, "load_inertia_kgm2": 0.1}
EVERY_CHECK["requirements"].pop("ratios")
EVERY_CHECK["requirements"]["motor"] |= {"inertia_kgm2": 0.001, "inertia_ratio": 10, "rated_speed_rpm": 3000}


@pytest.mark.parametrize("application", [SAVED, EVERYTHING, EVERY_CHECK], ids=["saved", "everything", "every check"])
def test_letters_of_lists_on_paper_are_large_enough_to_read(application: Json, catalogue: Catalogue) -> None:
    for sheet in opened(application, catalogue):
        if sheet.title in ("Candidates", "Inputs") or application is SAVED:
            assert letters(sheet) >= LEAST_POINTS, sheet.title


def test_checks_that_one_page_has_no_room_for_go_on_beside_their_gears_on_another(catalogue: Catalogue) -> None:
    sheet = opened(EVERY_CHECK, catalogue)["Candidates"]
    (second,) = [mark.id for mark in sheet.col_breaks.brk]
    shown = [column for column in range(5, 26) if not sheet.column_dimensions[get_column_letter(column)].hidden]

    assert sheet.print_title_cols == "$A:$A" and len(shown) == 21
    assert sum(column <= second for column in shown) in (10, 11)
    assert all(merged.max_col <= second for merged in sheet.merged_cells.ranges)


def test_numbers_of_pieces_and_large_figures_have_no_decimals(catalogue: Catalogue) -> None:
    sheet = opened(EVERYTHING, catalogue)["Selection"]
    formats = {row[1].value: row[2].number_format for row in sheet.iter_rows()}

    assert formats["N_k,max"].endswith("#,##0") and ".00;" not in formats["L_10"]


def test_utilisations_have_one_format_and_heads_stand_above_their_numbers(catalogue: Catalogue) -> None:
    sheet = opened(EVERYTHING, catalogue)["Selection"]
    rows = list(sheet.iter_rows())
    top = [row[0].value for row in rows].index("Check")
    head, rows = rows[top], rows[top + 1 : top + 1 + len(CHECKS)]

    shares = {row[k].number_format for row in rows for k in (4, 6)}
    assert shares == {"0.00%"}
    assert [cell.alignment.horizontal for cell in head[:8]] == [
        None,
        None,
        "right",
        "right",
        "right",
        None,
        "right",
        None,
    ]
