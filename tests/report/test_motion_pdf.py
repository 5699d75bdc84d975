"""The PDF report of motions and of phases that vary."""

import math
import re
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pypdfium2
import pytest
from pypdf import PdfReader

from hpn.catalogue import Catalogue
from hpn.files.report.content import content
from hpn.files.report.pdf import pdf
from hpn.files.report.plots import COLOURS, ON_PAPER
from hpn.words.reader import Reader
from hpn.words.symbols import formula
from tests.conftest import Supplement
from tests.property.test_varying_remedy import MOTORS
from tests.report.cases import CASES, MOVING, language, typed_export_of

ENGLISH, GERMAN = language("en"), language("de")
US = Reader("de", units=("lb_in", "in", "lb"), digits=4)


def pages(document: bytes) -> list[str]:
    opened = pypdfium2.PdfDocument(document)
    return [page.get_textpage().get_text_range().replace("\r\n", "\n") for page in opened]


def columns(case: str, catalogue: Catalogue) -> list[str]:
    """Symbols and units of the table of phases."""
    header = content(typed_export_of((CASES | MOVING)[case], catalogue), ENGLISH)["phases"]["header"]
    return ["".join("_".join(part) for part in symbol) + f" {unit}" for symbol, unit in header[1:]]


def test_peaks_and_RMS_have_columns_where_a_phase_has_them(catalogue: Catalogue) -> None:
    assert columns("example", catalogue) == ["T_ Nm", "n_ rpm", "t_ s"]
    assert columns("phases that vary", catalogue)[3:] == ["T_pk Nm", "n_pk rpm", "T_rms Nm", "F_R N"]


def test_a_motion_is_printed_as_given_with_the_phases_that_come_out(catalogue: Catalogue) -> None:
    first = pages(pdf(typed_export_of(MOVING["rotary table"], catalogue), GERMAN))[0]
    for line in ("Mechanismus Drehachse", "0,8 kg·m²", "250 mm", "1 turn Trapez 90 0,8 900", "3 S-Kurve −90 1 25 0,5"):
        assert line in re.sub(r"[\u2009\u202f\xa0]", " ", first), line
    assert "Lastphasen der Bewegung" in first
    rows = re.findall(r"^(\d) (\d)(?: turn)? (\S+) (\S+) (\S+) (\S+) (\S+) (\S+) (\S+)$", first, re.M)
    assert [row[:2] for row in rows] == [*zip("12345678", "11123333", strict=True)]  # each with its move
    assert rows[0][2:4] == ("48,12", "11,63")
    assert float(rows[0][8].replace(",", ".")) < 48.12 < float(rows[0][5].replace(",", "."))  # least torque and peak


def test_a_bracket_behind_a_symbol_is_no_part_of_its_index() -> None:
    assert formula("J_L / (i² · J_m) ≤ r_J")[-3:] == [("J", "m"), ") ≤ ", ("r", "J")]
    assert formula("n_in(max)/i") == [("n", "in(max)"), "/", ("i", "")]


def test_its_figures_are_in_the_units_of_the_reader(catalogue: Catalogue) -> None:
    view = content(typed_export_of(MOVING["rotary table"], catalogue), US)
    texts = {"".join(line["label"]): line["text"] for line in view["motion"]["mechanism"]}
    assert texts["Reibmoment"].startswith("13,2761")
    assert view["motion"]["moves"]["header"][-1][1] == "lb·in"
    assert view["phases"]["header"][2][1].startswith("lb")


def test_the_motor_that_turns_its_own_inertia_is_named_so(catalogue: Catalogue) -> None:
    text = "\n".join(pages(pdf(typed_export_of(MOVING["rotary table"], catalogue), ENGLISH)))
    assert re.search(r"include\s+the\s+motor’s\s+own\s+inertia", text)
    assert "Tin,max" in text and "Tmax / (i" not in text.split("Assumptions")[0]
    steady = "\n".join(pages(pdf(typed_export_of(MOVING["phases that vary"], catalogue), ENGLISH)))
    assert re.search(r"leave\s+out\s+the\s+inertia\s+of\s+motor\s+and\s+gear", steady)


def test_a_listed_motor_stands_with_its_figures(supplemented: Supplement) -> None:
    supplied = supplemented(motors=MOTORS)
    question = MOVING["rotary table"] | {"requirements": {"motor": {"designation": "M 8"}}}
    export = typed_export_of(question, supplied)
    wishes = {"".join(line["label"]): line["text"] for line in content(export, ENGLISH)["requirements"]}
    assert wishes["Motor of your list"] == "M 8"
    assert wishes["Inertia of the motor"].startswith("0.0005")
    assert pdf(replace(export, catalogue=None), ENGLISH)


@pytest.mark.parametrize("reader", [ENGLISH, US], ids=["en", "de"])
def test_every_move_of_many_is_printed_under_heads(reader: Reader, catalogue: Catalogue) -> None:
    document = pdf(typed_export_of(MOVING["many moves"], catalogue), reader)
    title = reader.text("Each move of the motion")
    result = pages(document)
    first = next(k for k, page in enumerate(result) if title in page)
    numbers = re.findall(r"^ *(\d+) +(?:Modifi|Triang|Dreieck|S-)", "\n".join(result[first:]), re.M)
    assert {int(number) for number in numbers} >= set(range(1, 121))
    assert len(PdfReader(BytesIO(document)).pages) <= 11


def test_a_motion_is_drawn_over_time_and_phases_as_steps(catalogue: Catalogue) -> None:
    drawn = {
        name: content(typed_export_of((CASES | MOVING)[name], catalogue), ENGLISH)["cycle"]
        for name in ("ball screw", "example")
    }
    assert "Distance in mm" in "".join(fromstring(drawn["ball screw"]["drawing"]).itertext())
    assert drawn["ball screw"]["alt"].startswith("Motion of ")
    assert "3 phases." in drawn["example"]["alt"]
    assert "Short phases" in drawn["example"]["note"]


def test_phases_that_govern_the_output_bearing_stand_out_in_the_cycle(catalogue: Catalogue) -> None:
    loads = [{"torque_Nm": 10, "speed_rpm": 100, "duration_s": 1, "radial_N": N} for N in (400, 900, 400)]
    export = typed_export_of({"duty_cycle": {"phases": loads}, "requirements": {"sizes": ["14A"]}}, catalogue)
    assert export.candidate.governing_check == "output_bearing_load"
    drawing = fromstring(content(export, ENGLISH)["cycle"]["drawing"])
    steps = [step for step in drawing.iter() if "phase-step" in step.get("class", "")]
    assert ["governing" in step.get("class", "") for step in steps] == [False, True, False]


def test_torque_is_drawn_against_speed_where_a_motion_or_a_motor_is_given(catalogue: Catalogue) -> None:
    def planes(case: str) -> list[dict[str, str]]:
        result: list[dict[str, str]] = content(typed_export_of((CASES | MOVING)[case], catalogue), ENGLISH)["planes"]
        return result

    assert planes("example") == []
    gear, motor = planes("rotary table")
    assert (gear["title"], motor["title"]) == ("Torque and speed at the gear’s output", "Torque and speed at the motor")
    selection = typed_export_of(MOVING["rotary table"], catalogue).selection
    for plane, torque in ((gear, selection.duty.maximum_torque_Nm), (motor, selection.foremost.motor_peak_torque_Nm)):
        match = re.search(r"Largest torque ([\d.]+)\u202fNm of", plane["alt"])
        assert match is not None and torque is not None
        assert math.isclose(float(match[1]), torque, rel_tol=5e-3), plane["alt"]  # three digits
    printed = "\n".join(pages(pdf(typed_export_of(MOVING["rotary table"], catalogue), ENGLISH)))
    assert "Torque and speed at the motor" in printed
    assert "include the motor’s own inertia; the gear’s inertia and no-load losses are not published" in "".join(
        map(str, motor["words"])
    )


def test_drawings_on_paper_have_the_colours_of_the_pages_light_theme() -> None:
    tokens = Path("frontend/static/tokens.css").read_text()
    light = dict(re.findall(r"--([\w-]+): light-dark\((#\w{6}),", tokens))
    shared = COLOURS.keys() & light.keys() - {"card"}  # paper is white
    assert {name: COLOURS[name] for name in shared} == {name: light[name] for name in shared}
    assert shared >= {"ink", "muted", "line", "edge", "governing", "fail"}
    assert "var(--" not in ON_PAPER
