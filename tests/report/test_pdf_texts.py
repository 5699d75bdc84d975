"""Texts of the PDF report: every script, links that copy as they are, and each phase of a long cycle."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from io import BytesIO
from typing import Any
from urllib.parse import parse_qsl, quote

import pikepdf
import pypdfium2
import pytest
from pypdf import PdfReader

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.files.report.checks import checks
from hpn.files.report.content import content
from hpn.files.report.pdf import pdf
from hpn.links.writer import to_link
from hpn.web.form.link_reader import parse
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.report.cases import CASES, EVERYTHING, language, long_cycle, typed_export_of

ENGLISH, GERMAN = language("en"), language("de")

SHOWN = {
    "Latin": "Çinçilla Łódź",
    "Cyrillic": "Поворотный",
    "Greek": "Περιστροφή",
    "Hebrew": "שולחן",
    "Arabic": "طاولة",
    "Chinese": "旋转工作台",
    "Japanese": "回転テーブル",
    "Korean": "회전",
    "Thai": "โต๊ะ",
    "Devanagari": "घूर्णन",
    "Tamil": "சுழலும்",
    "Armenian": "Պտտվող",
    "Georgian": "მბრუნავი",
    "Amharic": "የሚሽከረከር",
    "emoji": "😀👩\u200d🔧🇩🇪",
    "marks that combine": "Z\u0338\u0321a\u0310 e\u0301",
    "marks that turn": "\u200f7\u200e",
}
PLAIN = ("Latin", "Cyrillic", "Greek", "Hebrew", "Chinese", "Japanese", "Korean", "emoji")
"""Scripts whose letters stand in a PDF in the order of the text."""

UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")


def by_pypdf(document: bytes, page: int) -> str:
    """Text of a page."""
    return PdfReader(BytesIO(document)).pages[page].extract_text()


def by_pdfium(document: bytes, page: int) -> str:
    """Text of a page, as a browser copies it."""
    return str(pypdfium2.PdfDocument(document)[page].get_textpage().get_text_range())


def every_page(document: bytes) -> str:
    """Text of all pages."""
    return "".join(by_pdfium(document, page) for page in range(len(pypdfium2.PdfDocument(document))))


def test_a_title_of_any_script_is_shown_and_kept_in_the_metadata(catalogue: Catalogue) -> None:
    words = list(SHOWN.values())
    title, reference = " ".join(words[:9]), " ".join(words[9:])
    document = pdf(typed_export_of(CASES["example"], catalogue, title=title, reference=reference), ENGLISH)
    page = by_pdfium(document, 0).replace("\r\n", "")
    assert "□" not in every_page(document)
    for script in PLAIN:
        assert SHOWN[script] in page, script
    information = PdfReader(BytesIO(document)).metadata
    assert information is not None and information.title == title


def test_a_character_that_no_font_has_is_replaced_named_and_kept_in_the_metadata(catalogue: Catalogue) -> None:
    title = "axis བོ 𒀀 \u0378 \uf8ff end"
    document = pdf(typed_export_of(CASES["example"], catalogue, title=title), ENGLISH)
    assert "axis □□ □ □ □ end" in by_pdfium(document, 0)
    assert "fonts lack: U+0378, U+0F56, U+0F7C, U+F8FF, U+12000." in every_page(document)
    information = PdfReader(BytesIO(document)).metadata
    assert information is not None and information.title == title


def test_texts_of_a_supplement_are_shown_or_replaced(supplemented: Supplement) -> None:
    catalogue = supplemented(weights="size,stages,weight_kg,source\n20A,1,3.6,测试 бланк བོ\n")
    result = every_page(pdf(typed_export_of(CASES["example"], catalogue), ENGLISH))
    assert "测试 бланк □□" in result


@pytest.mark.parametrize(
    ("letters", "message"),
    [
        (100, "Not saved: the link carries every input."),
        (1900, "Not saved: the link carries every input."),
        (3000, "Not saved, and the link is too long to print. Save the selection to get a short address."),
    ],
)
def test_a_report_that_is_not_saved_says_what_carries_its_inputs_on_paper(
    letters: int, message: str, catalogue: Catalogue
) -> None:
    link = "http://hpn.example/?T=" + "4" * letters
    document = pdf(replace(typed_export_of(CASES["example"], catalogue), link=link, created=None), ENGLISH)
    pages = [by_pdfium(document, page) for page in (0, 1)]
    assert any(message in page.replace("\r\n", " ") for page in pages)
    assert (link in "".join(pages).replace("\r\n", "")) == (letters < 2000), "a printed link is whole or not there"
    with pikepdf.open(BytesIO(document)) as opened:
        notes = [note for page in opened.pages for note in page.get("/Annots", pikepdf.Array()).as_list()]
        targets = {str(note["/A"]["/URI"]) for note in notes}
    assert targets == ({link} if letters < 2000 else set())


def test_a_near_miss_by_the_users_own_utilisation_says_so(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"utilisation": 0.5})
    misses = content(typed_export_of(application, catalogue), ENGLISH)["alternatives"]["misses"]
    assert misses
    assert "× 50\N{NARROW NO-BREAK SPACE}%" in misses[0][1][0]
    whole = content(typed_export_of(worked_example(), catalogue), ENGLISH)["alternatives"]["misses"]
    assert "×" not in "".join("".join(part) for _, message in whole for part in message)


@pytest.mark.parametrize("phases", [1, 8])
def test_the_printed_link_copies_as_it_is(phases: int, catalogue: Catalogue) -> None:
    """Lines may end inside the link, but nothing stands in it that was not in the link."""
    application = worked_example() | cycle(*(phase(10.25 + k, 100.5, 0.125) for k in range(phases)))
    link = "http://hpn.example:8443" + to_link(Application.model_validate(application))
    document = pdf(replace(typed_export_of(application, catalogue), link=link), GERMAN)
    for text in (by_pypdf(document, 0), by_pdfium(document, 0)):
        assert link in re.sub(r"\r?\n", "", text)
        assert not UNSEEN.search(text)
    with pikepdf.open(BytesIO(document)) as opened:
        targets = {str(note["/A"]["/URI"]) for note in opened.pages[0]["/Annots"].as_list()}
    assert targets == {link}


@pytest.mark.parametrize("unseen", ["\u200b", "\u2060", "\ufeff", "\u00ad", "\u200d"])
def test_a_link_that_an_older_report_broke_reads_as_it_was_meant(unseen: str) -> None:
    query = to_link(Application.model_validate(worked_example())).partition("?")[2]
    broken = quote(re.sub(r"(.{24})", rf"\1{unseen}", query), safe="=&%")
    assert broken != query
    assert parse(parse_qsl(broken)).application == parse(parse_qsl(query)).application is not None


def test_every_phase_of_a_long_cycle_is_printed_under_heads_on_numbered_pages(catalogue: Catalogue) -> None:
    question = long_cycle(700, output_load={"radial_N": 300})
    export = typed_export_of(question, catalogue)
    document = pdf(export, GERMAN)
    pages = [by_pdfium(document, page) for page in range(len(PdfReader(BytesIO(document)).pages))]
    first = next(k for k, page in enumerate(pages) if "Jede Phase des Lastzyklus" in page)
    rows = iter(row for page in pages[first:] for row in re.findall(r"^ *(\d+) +(\S+) +(\S+) +(\S+)\r?$", page, re.M))
    for number, inputs in enumerate(export.application.duty_cycle.load_phases, 1):
        view = (
            str(number),
            *(GERMAN.exact(value) for value in (inputs.torque_Nm, inputs.speed_rpm, inputs.duration_s)),
        )
        assert next(rows) == view
    for number, page in enumerate(pages, 1):
        assert f"Seite {number} von {len(pages)}" in page
        assert number <= first or "n [min⁻¹]" in page


def test_the_document_is_sound_and_its_phases_are_tagged(catalogue: Catalogue) -> None:
    document = pdf(typed_export_of(long_cycle(300), catalogue), ENGLISH)
    with pikepdf.open(BytesIO(document)) as opened:
        assert opened.check_pdf_syntax() == []
        kinds = [str(item.get("/S")) for item in opened.objects if isinstance(item, pikepdf.Dictionary)]
    assert kinds.count("/TD") > 30 and "/TH" in kinds and "/Figure" in kinds


@pytest.mark.parametrize(
    ("code", "message"), [("en", "not in this catalogue’s source"), ("de", "fehlen in der Quelle dieses Katalogs")]
)
def test_a_chosen_gear_without_figures_lacks_them_in_this_catalogue(
    catalogue: Catalogue, code: str, message: str
) -> None:
    export = replace(typed_export_of(worked_example(), catalogue), chosen="HPN-40A-5")
    text = json.dumps(content(export, language(code)), ensure_ascii=False)

    assert f"{message}. HPN-20A-4" in text


MEASURE = """
import re, sys, time
from pathlib import Path
from hpn.catalogue import load_catalogue
from hpn.files.report.pdf import pdf
from hpn.files.report.checks import checks
from tests.report.cases import language, long_cycle, typed_export_of
phases, turns = map(int, sys.argv[1:])
export = typed_export_of(long_cycle(phases), load_catalogue())
for turn in range(turns):
    start = time.process_time()
    size = len(pdf(export, language("en")))
    peak = int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1]) // 1024
    print(turn, round(time.process_time() - start, 1), "s", size // 1024, "kB", peak, flush=True)
"""


def test_memory_of_a_long_cycle_is_bounded_and_given_back(soak: bool) -> None:
    """typst by itself keeps the layout of the last ten reports: 3 GB of 10,000 phases."""
    phases, turns, most = ("10000", "20", 500) if soak else ("2000", "6", 300)
    run = [sys.executable, "-c", MEASURE, phases, turns]
    lines = subprocess.run(run, capture_output=True, text=True, check=True).stdout.splitlines()
    print(*lines, sep="\n")
    first, last = (int(line.split()[-1]) for line in (lines[0], lines[-1]))
    assert last < most
    assert last < 1.5 * first


@pytest.mark.parametrize(("code", "word"), [("en", "unlimited"), ("de", "unbegrenzt")])
def test_a_limit_above_every_number_is_a_word(code: str, word: str, catalogue: Catalogue) -> None:
    """Stops below T_R may come any number of times (17.9), whatever u leaves of it; a dash times u stood there."""
    stops = worked_example(emergency_stop={"torque_Nm": 5, "count": 10}, requirements={"utilisation": 0.93})
    idle = cycle(phase(0, 100), requirements={"life_h": 1e4})
    assert _check("momentary_peak_count", stops, catalogue, code)["limit"] == word
    assert _check("life", idle, catalogue, code)["demand"] == word


def test_a_check_without_an_equation_stands_as_a_relation_with_demand_and_limit(catalogue: Catalogue) -> None:
    row = _check("backlash", EVERYTHING, catalogue, "en")
    assert "".join("".join(part) for part in row["relation"]) == "j ≤ jreq"
    assert (row["demand"], row["sign"], row["limit"]) == ("5\u202farcmin", "≤", "7\u202farcmin")


def _check(check: str, case: Json, catalogue: Catalogue, code: str) -> dict[str, Any]:
    """Row of the report on a check."""
    return {row["code"]: row for row in checks(typed_export_of(case, catalogue), language(code))}[check]
