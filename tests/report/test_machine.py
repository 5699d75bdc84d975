"""Report of a machine, read back: against the answers of its axes."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from msgspec import structs
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.application.faults import sentences_of
from hpn.catalogue import Catalogue, load_catalogue
from hpn.documents.answers import AxisFault
from hpn.documents.revision import Frozen
from hpn.documents.summary import gear_of, order_of, summary_of
from hpn.engine.checks import name_of
from hpn.engine.selection import select
from hpn.files.machine.axis_page import axis_page
from hpn.files.machine.content import content
from hpn.files.machine.export import MOST_FULL, MOST_PAGES, exports_of, pages_of
from hpn.files.machine.pdf import pdf
from hpn.files.machine.words import fault_of, ranges
from hpn.words.reader import Reader
from hpn.words.wording import Sentence
from tests.build import TURNING, Json, cycle, phase, worked_example
from tests.machines import COMMON, axis, frozen, packing_line
from tests.report.cases import language
from tests.report.machines import AMERICAN, BEYOND, LINK, TITLE, export_of, plain, with_and_without_tolerance
from tests.report.test_pdf import page_texts, pixels, read

ENGLISH, GERMAN = language("en"), language("de")


@pytest.fixture(scope="module")
def pages(line: Frozen) -> Callable[[Reader], list[str]]:
    """Texts of the pages of the report on the line, each made once."""
    catalogue = load_catalogue()
    before = frozen(packing_line(), catalogue, COMMON, title=TITLE)

    @cache
    def made(reader: Reader) -> list[str]:
        document = pdf(export_of(line, catalogue, before), reader)
        return [plain(each) for each in page_texts(document, len(read(document).pages))]

    return made


# --- Title page and table ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN, AMERICAN], ids=lambda reader: reader.marker or "en")
def test_the_title_page_says_what_the_answers_say(
    line: Frozen, catalogue: Catalogue, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    title, summary = pages(reader)[0], summary_of(line, catalogue)
    order = order_of(line.axes, catalogue)
    for gear in order.gears:
        assert gear.ordering_code in title
        assert plain(reader.with_unit(reader.mass(gear.weight_kg), "kg")) in title
    weight = plain(reader.with_unit(reader.mass(summary.weight_kg), "kg"))
    assert weight in title and plain(reader.percent(summary.utilisation, 0.9)) in title
    said = f"{summary.suitable}{reader.text('of {count} axes suitable').format(count=40)}"
    assert plain(said).replace(" ", "") in title.replace(" ", "")
    assert plain(reader.figure(summary.shortest_life_h, "h")) in title
    for wanting in (34, 38, 13):
        assert f"{wanting} {line.axes[wanting - 1].name}" in title
    assert LINK in title.replace(" ", "") and "HB-2431" in title


def test_the_title_page_names_axes_that_do_not_hold_over_their_tolerance(catalogue: Catalogue) -> None:
    export = with_and_without_tolerance(catalogue)
    summary = content(export, pages_of(export.document), ENGLISH)["summary"]

    assert [each.answer.status for each in export.document.axes] == ["suitable"] * 3
    assert summary["word"] == "1 suitable as given, but not over the whole tolerance: 2"
    assert summary["status"] == "unrated"


def test_axes_that_do_not_hold_over_their_tolerance_are_to_be_decided(catalogue: Catalogue) -> None:
    """The page says of such an axis what the axis says of itself: 280 Nm of 256 Nm in the worst case."""
    export = export_of(frozen([axis("exact", worked_example()), axis("far", BEYOND)], catalogue), catalogue)
    (row,) = content(export, pages_of(export.document), ENGLISH)["decided"]["rows"]
    answer = export.document.axes[1].answer

    assert (row["status"], row["axis"]) == ("inside", "2 far")
    assert answer.worst_utilisation == pytest.approx(280 / 256, rel=1e-12)
    used, worst = (plain(ENGLISH.percent(share)) for share in (answer.utilisation, 280 / 256))
    assert plain(row["text"]) == f"{used}, at worst {worst}; momentary peak torque"
    assert "± 2 far" in plain(page_texts(pdf(export, ENGLISH), 1)[0])


def test_the_table_of_axes_has_the_worst_case_of_those_with_tolerances(catalogue: Catalogue) -> None:
    """Two ways that agree: the table, and the largest torque of each stop over the limit of 256 Nm."""
    export = with_and_without_tolerance(catalogue)
    used, near, far = (plain(ENGLISH.percent(torque / 256)) for torque in (200, 240, 280))
    text = plain(page_texts(pdf(export, ENGLISH, axes="none"), 1)[0])

    assert "Utilisation Worst case Shortest life" in text
    assert all(f"{used} ✓ {worst}" in text for worst in (f"{near} ✓", f"{far} ✗", "–"))
    rows = content(export, pages_of(export.document), ENGLISH)["axes"]["rows"]
    assert [row["whisker"] for row in rows] == pytest.approx([240 / 256, 280 / 256, rows[2]["share"]], rel=1e-12)


def test_a_machine_without_tolerances_has_no_column_of_worst_cases(catalogue: Catalogue) -> None:
    export = export_of(frozen([axis("bare", worked_example())], catalogue), catalogue)
    assert "Worst case" not in page_texts(pdf(export, ENGLISH, axes="none"), 1)[0]


def test_axes_in_lines_have_their_worst_case(catalogue: Catalogue) -> None:
    document = with_and_without_tolerance(catalogue).document
    axes = tuple(structs.replace(document.axes[k % 3], number=k + 1) for k in range(1002))
    machine = structs.replace(document, axes=axes)
    listing = content(export_of(machine, catalogue), pages_of(machine, "none"), GERMAN)["axes_listing"]
    first, second, third = listing["groups"][0].splitlines()[:3]

    assert "Ungünstigster Fall" in listing["head"]
    assert GERMAN.percent(240 / 256) in first and GERMAN.percent(280 / 256) in second and " –  " in third


SIDES = {"minus": {"percent": 0.0}, "plus": {"absolute": 3.0}}


def test_common_tolerances_stand_on_the_title_page_as_they_are_read(catalogue: Catalogue) -> None:
    common = {"tolerances": {"torque_Nm": {"percent": 5.0}, "emergency_stop.torque_Nm": SIDES}}
    export = export_of(frozen([axis("near", worked_example())], catalogue, common), catalogue)
    rows = content(export, pages_of(export.document), GERMAN)["common"]["rows"]

    texts = {"".join(map(str, row["label"])): plain(row["text"]) for row in rows}
    assert texts == {
        "± Drehmoment, alle Phasen": "±5 %",
        "± Not-Halt-Drehmoment": "+3 Nm −0 %",
    }


def test_a_title_page_is_filled_and_a_small_machine_has_its_axes_there(line: Frozen, catalogue: Catalogue) -> None:
    """Of 40 axes the decisions, the gear list and the link take two thirds of the page; five axes have room below."""
    title = pixels(pdf(export_of(line, catalogue), ENGLISH, axes="1"), 0)
    inked, height = np.flatnonzero((title < 128).any(axis=1)), title.shape[0]
    assert inked[inked < 0.92 * height].max() > 2 / 3 * height  # the footer stands below

    small = pdf(export_of(frozen(packing_line()[:5], catalogue, COMMON), catalogue), ENGLISH)
    first, *others = page_texts(small, 9)
    assert len(others) == 5 and "Governing check" in first
    assert all(name in first for name in ("X1 gantry, left", "A wrist swivel"))


def test_the_page_of_an_axis_says_that_its_gear_fails_inside_the_tolerance(catalogue: Catalogue) -> None:
    export = export_of(frozen([axis("far", BEYOND)], catalogue), catalogue)
    (page,) = content(export, pages_of(export.document), ENGLISH)["pages"]

    told = "".join(map(str, page["selection"]["verdict"]["text"]))
    assert "Fails inside the tolerance" in told


def test_the_shortest_life_and_the_largest_utilisation_are_those_of_suitable_axes(
    line: Frozen, catalogue: Catalogue
) -> None:
    """Two ways that agree: the summary, and the answers sorted by themselves."""
    summary, sound = summary_of(line, catalogue), [one for one in line.axes if one.answer.status == "suitable"]
    lives = sorted((one.answer.shortest_life_h, one.number) for one in sound if one.answer.shortest_life_h is not None)
    used = sorted((one.answer.utilisation or 0.0, -one.number) for one in sound)

    assert len(lives) > 1 and lives[0][0] < lives[-1][0]
    assert (summary.shortest_life_h, summary.shortest_life_axis) == lives[0]
    assert (summary.utilisation, summary.utilisation_axis) == (used[-1][0], -used[-1][1])


def test_kinds_are_counted_by_designation(catalogue: Catalogue) -> None:
    """Two codes of one gear are two lines of the order and one kind, as the fewest kinds count them."""
    gear = select(Application.model_validate(worked_example()), catalogue).selected
    axes = [axis("bare", worked_example()), axis("coded", worked_example(), ordering_code=f"{gear}-J6-BH-AF1")]
    document = frozen(axes, catalogue)

    assert len(order_of(document.axes, catalogue).gears) == 2
    assert summary_of(document, catalogue).kinds == 1


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN], ids=["en", "de"])
def test_the_table_has_every_axis_with_gear_check_utilisation_and_life(
    line: Frozen, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    table = pages(reader)[1]
    for each in line.axes:
        answer = each.answer
        assert f"{each.number} {each.name}" in table
        if answer.status == "open":
            assert {"en": "Speed of phase 2 is required", "de": "Drehzahl der Phase 2 fehlt"}[reader.language] in table
            continue
        assert (gear_of(each) or answer.designation or "") in table
        assert reader.text(name_of(answer.governing_check or "")) in table
        bound = 0.8 if each.number == 20 else 0.9
        assert plain(reader.percent(answer.utilisation, bound)) in table
        assert plain(reader.figure(answer.shortest_life_h, "h")) in table


def test_what_changed_since_the_revision_before_is_marked(pages: Callable[[Reader], list[str]]) -> None:
    title, table = pages(ENGLISH)[:2]
    assert "Changed since A" in title and table.count("△") == 2  # the legend and the pallet lift


# --- Pages of axes ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN, AMERICAN], ids=lambda reader: reader.marker or "en")
def test_a_page_has_the_figures_that_select_answers_for_its_axis(
    line: Frozen, catalogue: Catalogue, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    """Two ways that agree: the page, of axes judged together, and `select` of each axis alone."""
    texts = pages(reader)[2:]
    for number in (2, 19, 34, 38):
        asked = Application.model_validate_json(bytes(line.axes[number - 1].resolved))
        selection = select(asked, catalogue)
        shown = selection.candidate(line.axes[number - 1].answer.designation or "")
        name = line.axes[number - 1].name or ""
        place = next(place for place, text in enumerate(texts) if f"{number} {name}" in text)
        page = " ".join(texts[place : place + 2])  # long remedies take a few checks to a second page
        assert shown is not None and shown.designation in page
        for check in shown.checks:
            assert plain(reader.percent(check.utilisation, 1.0 if check.code in ("weight", "length") else 0.9)) in page
        for torque in (asked.duty_cycle.load_phases[0].torque_Nm, asked.duty_cycle.load_phases[1].torque_Nm):
            assert plain(reader.exact(torque, "Nm")) in page


ROW_3 = Sentence("row {number}: {reason}", {"number": "3", "reason": Sentence("is required")})
FOUND = Sentence("must be a number, such as 9.3, not {found}", {"found": '"x"'})


@pytest.mark.parametrize(
    ("pointer", "sentence", "english", "german"),
    [
        ("/radial_N", ROW_3, "Radial load in row 3 is required", "Radiallast in Zeile 3 fehlt"),
        (
            "/pause_s",
            FOUND,
            'Pause must be a number, such as 9.3, not "x"',
            'Pause muss eine Zahl sein, z. B. 9.3, nicht "x"',
        ),
        ("/duty_cycle", Sentence("is required"), "Duty cycle is required", "Lastzyklus fehlt"),
        (
            "/duty_cycle/phases/0/torque_Nm",
            Sentence("must be a JSON number, such as 9.3"),
            "Torque of phase 1 must be a number, such as 9.3",
            "Drehmoment der Phase 1 muss eine Zahl sein, z. B. 9.3",
        ),
        (
            "/duty_cycle/motion/moves/1/time_s",
            Sentence("must be greater than {bound}", {"bound": "0"}),
            "Time of move 2 must be greater than 0",
            "Zeit der Bewegung 2 muss größer als 0 sein",
        ),
        (
            "/duty_cycle/phases",
            Sentence("give phases, or a motion"),
            "Duty cycle: give phases, or a motion",
            "Lastzyklus: ",
        ),
        (
            "",
            Sentence("{text}", {"text": "torque_Nm: is required"}),
            "torque_Nm: is required",
            "torque_Nm: is required",
        ),
    ],
)
def test_a_fault_is_said_as_an_engineer_says_it(pointer: str, sentence: Sentence, english: str, german: str) -> None:
    fault = fault_of(AxisFault.at(pointer, sentence, "code"))
    assert ENGLISH.sentence(fault) == english and GERMAN.sentence(fault).startswith(german)


GRAVITY = {"inertia_kgm2": 0.1, "gravity_mass_kg": 12, "gravity_radius_mm": 250}


@pytest.mark.parametrize(
    ("mechanism", "move", "english", "german"),
    [
        (
            GRAVITY,
            {"profile": "modified_sine", "angle_deg": 90, "time_s": 1},
            "Moment of inertia includes the gravity mass and must be at least 0.75 kg·m²",
            "Trägheitsmoment enthält die Schwerkraftmasse und muss mindestens 0,75 kg·m² betragen",
        ),
        (
            {"inertia_kgm2": 1},
            {"profile": "trapezoidal", "angle_deg": 90, "time_s": 1, "speed_rpm": 1},
            "Peak speed of move 1 must be above 15 rpm (distance over time)",
            "Spitzendrehzahl der Bewegung 1 muss über 15 min⁻¹ liegen (Weg durch Zeit)",
        ),
        (
            {"inertia_kgm2": 1},
            {"profile": "trapezoidal", "angle_deg": 90},
            "Move 1: a move with the profile trapezoidal needs ",
            "Teilbewegung 1: eine Teilbewegung mit dem Profil trapezoidal braucht ",
        ),
        ({"inertia_kgm2": 1}, {"profile": "dwell", "time_s": 1}, "Moves: nothing", "Teilbewegungen: nichts"),
    ],
    ids=["inertia", "speed", "a whole move", "all moves"],
)
def test_a_fault_of_a_motion_is_in_the_readers_language(mechanism: Json, move: Json, english: str, german: str) -> None:
    motion = {"mechanism": {"type": "rotary", **mechanism}, "moves": [move]}
    with pytest.raises(ValidationError) as error:
        Application.model_validate({"duty_cycle": {"motion": motion}})
    (fault,) = AxisFault.of(sentences_of(error.value))
    assert fault.detail == error.value.errors()[0]["msg"]
    for reader, text in ((ENGLISH, english), (GERMAN, german)):
        assert plain(reader.sentence(fault_of(fault))).startswith(plain(text))


def test_every_axis_has_its_page_and_an_open_one_says_why(line: Frozen, pages: Callable[[Reader], list[str]]) -> None:
    texts = pages(ENGLISH)[2:]
    for each in line.axes:
        assert any(f"{each.number} {each.name} axis {each.number} of 40 · quantity {each.quantity}" in t for t in texts)
    erector = next(text for text in texts if "13 Carton erector" in text)
    assert "Open: this axis has no answer." in erector and "Speed of phase 2 is required" in erector


def test_values_of_the_machine_are_marked_and_own_ones_are_not(line: Frozen, catalogue: Catalogue) -> None:
    ram = line.axes[19]
    ((_, export),) = exports_of(export_of(line, catalogue), [ram])
    page = axis_page(ram, export, (20, 40), ENGLISH, full=False)
    rows = {row["code"]: row["is_inherited"] for row in page["selection"]["requirements"] + page["selection"]["loads"]}
    assert rows["requirements.life_h"] and rows["rank_by"]
    assert not rows["requirements.utilisation"] and not rows["duty_cycle.pause_s"]


def test_a_revision_whose_answer_is_another_says_so_on_its_page(line: Frozen, catalogue: Catalogue) -> None:
    gantry = line.axes[0]
    aged = structs.replace(gantry, answer=structs.replace(gantry.answer, utilisation=0.5, engine_version="1.0.4"))
    ((_, export),) = exports_of(export_of(line, catalogue), [aged])
    told = axis_page(aged, export, (1, 40), ENGLISH, full=False)["was"]
    assert "1.0.4" in told and "50" in told
    assert axis_page(gantry, export, (1, 40), ENGLISH, full=False)["was"] == ""


def test_the_whole_calculation_has_equations_and_a_motion_its_moves(catalogue: Catalogue) -> None:
    axes = [axis("Turret", worked_example()), axis("Swivel", {"duty_cycle": {"motion": TURNING}})]
    document = pdf(export_of(frozen(axes, catalogue, COMMON), catalogue), ENGLISH, full=True)
    text = plain(" ".join(page_texts(document, len(read(document).pages))))
    assert text.count("to nine digits") >= 2 and "Assumptions" in text and "turn" in text


def test_hostile_names_and_notes_are_printed_as_they_are(catalogue: Catalogue) -> None:
    hostile = '#eval("1") $x$ <label> "'
    axes = [axis(hostile, worked_example(), note="*b* @ref བོད"), axis("", {"duty_cycle": 7, "more": [[1]]})]
    document = pdf(export_of(frozen(axes, catalogue), catalogue), ENGLISH)
    text = plain(" ".join(page_texts(document, len(read(document).pages))))
    assert '#eval("1")' in text and "@ref" in text


# --- Bounds -----------------------------------------------------------------------------------------------------------


def many(count: int, catalogue: Catalogue) -> Frozen:
    """A machine of many axes that are all alike, each with its own number."""
    (one,) = frozen([axis("a", cycle(phase(10, 100)))], catalogue).axes
    line = frozen([], catalogue)
    return structs.replace(line, axes=tuple(structs.replace(one, number=number) for number in range(1, count + 1)))


def test_pages_go_up_to_their_bound_and_beyond_it_a_list_chooses(catalogue: Catalogue) -> None:
    within, beyond = many(MOST_PAGES, catalogue), many(MOST_PAGES + 1, catalogue)
    assert len(pages_of(within).axes) == MOST_PAGES
    assert pages_of(beyond).axes == ()
    assert [each.number for each in pages_of(beyond, "3,7-9, 501").axes] == [3, 7, 8, 9, 501]
    assert pages_of(beyond, "none").axes == ()
    assert len(pages_of(within, f"1-{MOST_FULL}", full=True).axes) == MOST_FULL
    notes = content(export_of(beyond, catalogue), pages_of(beyond), ENGLISH)["notices"]
    assert "at most 500" in notes[0][0]


@pytest.mark.parametrize("text", ["", "x", "3-", "7-3", "0", "3;4", "1-501", "99999999", "502", "٣"])
def test_a_list_of_axes_that_is_none_is_refused(text: str, catalogue: Catalogue) -> None:
    with pytest.raises(InputError):
        pages_of(many(MOST_PAGES + 1, catalogue), text)


def test_too_many_whole_calculations_are_refused(catalogue: Catalogue) -> None:
    with pytest.raises(InputError, match="100"):
        pages_of(many(MOST_FULL + 1, catalogue), full=True)


def test_a_large_machine_has_its_axes_in_lines(catalogue: Catalogue) -> None:
    machine = many(1200, catalogue)
    data = content(export_of(machine, catalogue), pages_of(machine), ENGLISH)
    assert data["axes"] is None and sum(group.count("\n") + 1 for group in data["axes_listing"]["groups"]) == 1200
    assert pdf(export_of(machine, catalogue), ENGLISH).startswith(b"%PDF")


def test_numbers_are_written_in_ranges() -> None:
    assert ranges([4, 1, 2, 3, 7, 9, 10]) == "1–4, 7, 9, 10"
