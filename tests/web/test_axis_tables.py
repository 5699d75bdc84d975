"""Tables of axes as spreadsheets write them: no number is silently another one, and what has two readings is asked."""

import io
import zipfile
from itertools import product
from typing import Any

import pytest
from openpyxl import Workbook

from hpn.tables.axes import AxisTable, read_axes
from hpn.tables.columns import Choices
from hpn.tables.reading import Choice
from hpn.tables.sheets import grids_of
from hpn.tables.workbooks import sheets_of
from hpn.web.form.symbols import AXIS_INPUTS
from hpn.words import units
from hpn.words.reader import LANGUAGES, Reader

WIRE = tuple(AXIS_INPUTS.units)
HEAD = "Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]"


def read(*lines: str, assumed: tuple[str, ...] = WIRE, **said: Any) -> AxisTable:
    """What a table is read as."""
    return read_axes(grids_of("\n".join(lines))[0], AXIS_INPUTS, Choices(**said), assumed)


def asked(table: AxisTable) -> list[str]:
    """Questions that are open."""
    return [question.text for question in table.questions]


def offered(table: AxisTable, name: str) -> Choice:
    """A choice that a table leaves."""
    choice = table.choice(name)
    assert choice is not None
    return choice


def test_a_number_with_two_readings_is_asked() -> None:
    open_ = read(HEAD, "A;1.234;100;1", "B;2.500;100;1")

    assert asked(open_) == ["Which is the decimal mark?"] and not open_.axes
    assert offered(open_, "decimal").numbers == {".": "1.234", ",": "1234"}
    for mark, torque in ((".", 1.234), (",", 1234.0)):
        assert read(HEAD, "A;1.234;100;1", "B;2.500;100;1", decimal=mark).axes[0]["torque_Nm"] == [torque]


def test_times_that_go_on_in_every_axis_may_be_points_in_time() -> None:
    head, *rows = "Achse;Moment [Nm];Drehzahl [1/min];Zeit [s]", "A;1;10;1", "A;2;20;3", "B;1;10;2", "B;2;20;5"

    assert asked(read(head, *rows)) == ["Do the times say how long a phase lasts, or when it is?"]
    said = {times: read(head, *rows, times=times).axes for times in ("durations", "ends", "starts")}
    assert [axis["duration_s"] for axis in said["durations"]] == [[1, 3], [2, 5]]
    assert [axis["duration_s"] for axis in said["ends"]] == [[1, 2], [2, 3]]
    assert [(axis["duration_s"], axis["torque_Nm"]) for axis in said["starts"]] == [([2], [1]), ([3], [1])]
    assert asked(read(head, "A;1;10;3", "A;2;20;1", "B;1;10;2")) == []


def test_times_that_are_named_as_points_in_time_are_asked_even_where_they_go_back() -> None:
    head = "Achse;Moment [Nm];Drehzahl [1/min];Endzeit [s]"

    assert asked(read(head, "A;1;10;3", "B;2;20;1")) == ["Do the times say how long a phase lasts, or when it is?"]
    assert [axis["duration_s"] for axis in read(head, "A;1;10;3", "B;2;20;1", times="ends").axes] == [[3], [1]]


def test_units_are_those_of_headings_and_cells() -> None:
    head = "Axis;Torque [lbf·in];Speed [rad/s];Duration;Required gear life [h];Weight"
    table = read(head, "A;10;1;500 ms;20000;")

    axis = table.axes[0]
    assert axis["torque_Nm"] == [pytest.approx(1.12984829, rel=1e-8)]
    assert axis["speed_rpm"] == [pytest.approx(9.54929659, rel=1e-8)]
    assert (axis["duration_s"], axis["requirements.life_h"]) == ([0.5], 20000)


def test_a_unit_that_nobody_says_is_asked_where_the_reader_sees_another() -> None:
    table = read("Achse;Moment;Drehzahl [1/min];Dauer [s]", "A;1;10;1", assumed=())

    assert asked(table) == ["Which unit is column “Moment” in?"]


def test_the_unit_of_an_angular_velocity_is_asked_where_nothing_says_it() -> None:
    assert asked(read("Achse;Moment;ω;Dauer", "A;1;10;1")) == ["Which unit is column “ω” in?"]
    assert asked(read("Achse;Moment;ω [1/min];Dauer", "A;1;10;1")) == []


@pytest.mark.parametrize("form", ["{} {}", "{} [{}]"])
def test_a_unit_behind_a_name_is_never_taken_for_another(form: str) -> None:
    wrong = []
    for role, held in AXIS_INPUTS.by_role.items():
        quantity = held.quantity
        names = {Reader(language).text(held.named.name) for language in LANGUAGES} if quantity else ()
        for name, spelling in product(names, units.SPELLINGS):
            codes = units.codes_for(spelling, quantity)
            _, column, *_ = read(f"Achse;{form.format(name, spelling)};Nr.;Pos.", "A;1;1;1").columns
            if len(codes) == 1 and column.role == role and column.unit not in ("", codes[0]):
                wrong.append(form.format(name, spelling))
    assert wrong == []
    columns = read("Achse;Moment kNm;Drehzahl;Dauer ms;Pause", ";;rad/s;;min", "A;1;1;1;1").columns
    assert [column.unit for column in columns] == ["", "kNm", "rad_per_s", "ms", "min"]


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("Wert;Moment [Nm];Drehzahl [1/min];Dauer [s]", "Which column names the axis?"),
        ("Achse;Moment [Nm];Drehzahl [1/min];Wert", "What is column “Wert”?"),
        ("Achse;Moment [Nm];Drehzahl [1/min];Drehzahl motor;Dauer [s]", "What is column “Drehzahl motor”?"),
        ("Achse;Moment [Nm];Drehzahl [1/min];Motormoment [Nm];Dauer [s]", "What is column “Motormoment [Nm]”?"),
        ("Achse;Moment [Nm];Drehzahl [1/min];Lebensdauer [h];Dauer [s]", "What is column “Lebensdauer [h]”?"),
        ("Axis;Torque [Nm];Speed [rpm];Emergency stop;Duration [s]", "What is column “Emergency stop”?"),
        ("Axis;Torque [Nm];Speed [rpm];Duration [s];utilisation", "What is column “utilisation”?"),
    ],
)
def test_a_column_that_nobody_knows_is_asked(head: str, said: str) -> None:
    cells = ["A", *"1234"][: head.count(";") + 1]

    assert said in asked(read(head, ";".join(cells)))


@pytest.mark.parametrize(
    ("heading", "cells", "counts"),
    [
        ("No.", "5 5 200", True),
        ("Nr.", "1 2 1 4 3 2", True),
        ("Nr.", "1,1 1,2 2,1", True),
        ("Nr.", "1 2 3", False),
        ("Nr.", "1. 1. 2. 3.", False),
        ("Pos.", "0 1 0 1 2", False),
        ("Step", "10 20 10 20 30", False),
        ("Phase", "accel run accel", False),
    ],
)
def test_a_column_under_a_name_of_an_index_is_one_where_its_numbers_go_on(
    heading: str, cells: str, counts: bool
) -> None:
    rows = [f"A{k};12,5;100;1;{cell}" for k, cell in enumerate(cells.split())]
    table = read(f"{HEAD};{heading}", *rows)

    assert asked(table) == ([f"What is column “{heading}”?"] if counts else [])
    assert read(f"{HEAD};{heading}", *rows, roles={4: "skip"}).whole
    if cells == "5 5 200":
        taken = read(f"{HEAD};{heading};Tk", *(f"{row};300" for row in rows), roles={4: "Nk", 5: "Tk"})
        assert [axis["emergency_stop.count"] for axis in taken.axes] == [5, 5, 200]


def test_cells_in_a_unit_of_something_else_are_said_before_their_axes_are_rejected() -> None:
    table = read(HEAD, "A;40 lb;100;1", "B;40;10 1/s;1", "C;40 Nm;100;300 ms", "D;n. b.;100;1")

    assert [note.text for note in table.notes] == [
        "Cells that are no numbers, such as n. b.: 1. Their axes are rejected.",
        "Cells in a unit that is not of their column, such as 40 lb: 2. Their axes are rejected.",
    ]
    assert [axis["torque_Nm"] for axis in table.axes] == [["40 lb"], [40], [40], ["n. b."]]


def test_bars_between_ratios_part_no_columns() -> None:
    table = read("Axis,T,n,t,Ratio", "A,40,250,1,4|5|7", "B,40,250,1,4|5|10")

    assert [axis["requirements.ratios"] for axis in table.axes] == [[4, 5, 7], [4, 5, 10]]


def test_every_input_of_an_axis_is_known_by_the_name_of_its_column() -> None:
    names = {each.place: each.role for each in AXIS_INPUTS.by_role.values()}
    table = read(";".join(names), ";".join(["A", *("1" for _ in names)][:-1]))

    assert {column.heading: column.role for column in table.columns} == names


def test_a_cell_that_is_no_number_stays_as_it_is_written_and_spoils_its_axis_alone() -> None:
    table = read(HEAD, "A;n. b.;100;1", "B;2,5;100;1")

    assert [axis["torque_Nm"] for axis in table.axes] == [["n. b."], [2.5]]
    assert any("n. b." in note.text for note in table.notes)


def test_several_ratios_stand_in_a_cell_and_a_decimal_comma_parts_none() -> None:
    head = HEAD + ";Übersetzung;Baugröße"

    assert read(head, "A;1,5;100;1;4/5;14A, 20A").axes[0] | {"axis": ""} == {
        "axis": "",
        "torque_Nm": [1.5],
        "speed_rpm": [100],
        "duration_s": [1],
        "requirements.ratios": [4, 5],
        "requirements.sizes": ["14A", "20A"],
    }
    assert read(head, "A;1,5;100;1;4,5;14A").axes[0]["requirements.ratios"] == [4.5]


def test_a_number_that_is_too_large_is_no_number_that_is_left_out() -> None:
    axis = read(HEAD + ";Lebensdauer Getriebe [h]", "A;1;100;1;1e999").axes[0]

    assert axis["requirements.life_h"] == "1e999"


NUMBERED = "Phase;Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]"
GOING_ON = ("A;1;10;1", "A;2;20;3", "B;1;10;2", "B;2;20;5", "C;1;10;2", "C;2;20;5", "D;1;10;2", "D;2;20;5")


@pytest.mark.parametrize("other", ["E;1;10;k.A.\nE;2;20;2", "E;1;10;2\nE;2;20;1", "E;1;10;2"])
def test_one_axis_does_not_decide_what_the_times_of_the_others_are(other: str) -> None:
    head = "Achse;Moment [Nm];Drehzahl [1/min];Zeit [s]"

    assert asked(read(head, *GOING_ON, other)) == ["Do the times say how long a phase lasts, or when it is?"]
    said = read(head, *GOING_ON, other, times="ends")
    assert [axis["duration_s"] for axis in said.axes[:2]] == [[1, 2], [2, 3]]
    falling = read(head, "A;1;10;3", "A;2;20;1", "B;1;10;2")
    assert offered(falling, "times").chosen == "durations"


def test_two_decimal_marks_in_a_table_are_asked_and_what_no_longer_is_a_number_is_told() -> None:
    rows = "A;12,5;100;1,5", "B;13,5;100;1.125", "C;2;100;0.5"

    assert asked(read(HEAD, *rows)) == ["Both decimal marks are written, as in 0.5 and 12,5: which one counts?"]
    comma = read(HEAD, *rows, decimal=",")
    assert [axis["duration_s"] for axis in comma.axes] == [[1.5], [1125.0], ["0.5"]]
    assert [note.text for note in comma.notes][-1] == (
        "Cells that are no numbers, such as 0.5: 1. Their axes are rejected."
    )
    sure = read(HEAD, "A;12,5;100;1,5", "C;2;100;0.5")
    assert asked(sure) == [] and sure.axes[1]["duration_s"] == ["0.5"]


SUM = "has no axis, which other rows have: leave it out if it is a sum, or write its axis into it."


@pytest.mark.parametrize(
    ("head", "rows", "said"),
    [
        (NUMBERED, "1;A;12,5;100;1|2;;8;100;2|1;B;9;100;3", ""),
        (NUMBERED, "1;A;12,5;100;1|2;;8;100;2|1;B;9;100;3|;;29,5;300;6", f"Row 5 {SUM}"),
        (NUMBERED, "1;A;12,5;100;1|2;A;8;100;2|;;20,5;200;3", f"Row 4 {SUM}"),
        (HEAD, "A;12,5;100;1|A;8;100;2|;20,5;200;3", f"Row 4 {SUM}"),
        (HEAD, "A;12,5;100;1|;8;100;2|B;20,5;200;3", ""),
        (HEAD, ";12,5;100;1|A;8;100;2", "Row 2 names no axis, and none stands above it."),
        ("Lfd. Nr.;Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]", "1;A;12,5;100;1|;;8;100;2|2;B;9;100;3", ""),
    ],
)
def test_a_row_without_an_axis_that_may_be_a_sum_is_asked(head: str, rows: str, said: str) -> None:
    assert asked(read(head, *rows.split("|"))) == ([said] if said else [])


@pytest.mark.parametrize("name", ["Min-feeder", "Total stacker", "Max", "Summe"])
def test_an_axis_named_like_a_sum_is_an_axis(name: str) -> None:
    table = read(HEAD + ";Bemerkung", f"{name};12,5;100;1;", "B;8;100;2;max. load unknown", "C;9;100;3;")

    assert [axis["axis"] for axis in table.axes] == [name, "B", "C"]
    (without,) = [axis for axis in read(HEAD, "A;12,5;100;1", f"{name};;;6").axes if axis["axis"] == name]
    assert without["torque_Nm"] == [None]


def test_a_row_that_names_an_axis_alone_is_an_axis_without_numbers() -> None:
    table = read(HEAD, "A;12,5;100;1", "B;;;", ";8;100;2")

    assert [(axis["axis"], axis["torque_Nm"]) for axis in table.axes] == [("A", [12.5]), ("B", [None, 8])]


def test_a_sum_below_the_phases_of_an_axis_is_skipped_where_it_has_a_time_alone_and_asked_otherwise() -> None:
    head, rows = "Achse;Phase;Moment [Nm];Drehzahl [1/min];Dauer [s]", ["A;1;12,5;100;1", ";2;8;100;2"]

    skipped = read(head, *rows, ";Summe;;;3", "B;1;9;100;3")
    assert [axis["duration_s"] for axis in skipped.axes] == [[1, 2], [3]]
    assert "Row 4 is skipped: Summe" in [note.text for note in skipped.notes]
    assert asked(read(head, *rows, ";Summe;20,5;200;3", "B;1;9;100;3")) == [f"Row 4 {SUM}"]


def test_what_an_axis_says_twice_is_compared_as_numbers_and_spoils_that_axis_alone() -> None:
    table = read(f"{HEAD};Pause [s];Übersetzung", "A;1;9;1;2;5", "A;1;9;2;2,0;5", "B;1;9;1;2;5", "B;1;9;2;3;10")

    assert [axis["pause_s"] for axis in table.axes] == [2.0, "2 / 3"]
    assert [axis["requirements.ratios"] for axis in table.axes] == [[5.0], ["5 / 10"]]


@pytest.mark.parametrize(
    ("heading", "cell", "column", "value"),
    [
        ("Übersetzung", "5, 10", "requirements.ratios", [5, 10]),
        ("Übersetzung", "i = 5", "requirements.ratios", [5]),
        ("Übersetzung", "5:1 / 10:1", "requirements.ratios", [5, 10]),
        ("Auslastung u", "80 %", "requirements.utilisation", 0.8),
        ("Umgebungstemperatur [°C]", "25 °C", "requirements.ambient_temperature_degC", 25),
        ("Umgebungstemperatur [°C]", "25 %", "requirements.ambient_temperature_degC", "25 %"),
        ("Maximale Länge", "20 cm", "requirements.length_mm", 200),
        ("Auslastung u", "9.5e1 %", "requirements.utilisation", 0.95),
        ("Auslastung u", "0.1 %", "requirements.utilisation", 0.001),
        ("Auslastung u", "1e999 %", "requirements.utilisation", "1e999 %"),
        ("Maximales Gewicht", "9" * 5000 + " kg", "requirements.weight_kg", "9" * 5000 + " kg"),
        ("Torsionssteifigkeit K3", "14 %", "requirements.torsional_stiffness_Nm_per_rad", "14 %"),
        ("Übersetzung", "5:1.5", "requirements.ratios", ["5:1.5"]),
    ],
)
def test_cells_are_read_as_people_write_them(heading: str, cell: str, column: str, value: Any) -> None:
    roles = {4: {"Auslastung u": "u", "Torsionssteifigkeit K3": "K3", "Maximales Gewicht": "m"}.get(heading, "")}

    assert read(f"{HEAD};{heading}", f"A;1;9;1;{cell}", roles=roles).axes[0][column] == value


@pytest.mark.parametrize(
    ("heading", "foreign"),
    [
        ("Minimum torsional stiffness [Nm/arcmin]", "Nm/arcmin"),
        ("Minimum torsional stiffness [Nm/rad]", ""),
        ("requirements.torsional_stiffness_Nm_per_rad", ""),
        ("Inertia of the load [kg cm²]", ""),
        ("Inertia of the load [kg·m²]", ""),
        ("Inertia of the load [kgm2]", ""),
        ("Maximum utilisation [%]", "%"),
        ("Expected emergency stops [1000]", "1000"),
        ("Expected emergency stops [-]", ""),
        ("Ratio (i)", ""),
    ],
)
def test_a_unit_that_a_column_is_not_read_in_is_told(heading: str, foreign: str) -> None:
    table = read(f"{HEAD};{heading}", "A;1;9;1;14")

    assert table.columns[4].role
    assert [foreign for question in asked(table) if f": {foreign} is not read there" in question] == [foreign] * bool(
        foreign
    )


def test_a_unit_row_below_the_names_of_columns_is_asked_where_it_says_otherwise() -> None:
    rows = "axis;torque_Nm;speed_rpm;duration_s", ";kNm;rpm;ms", "A;40;250;300"

    assert asked(read(*rows)) == [
        "Which unit is column “torque_Nm kNm” in?",
        "Which unit is column “duration_s ms” in?",
    ]


def test_a_row_of_units_lets_no_name_vanish() -> None:
    table = read("Axis;Duration;Motor speed;Torque", ";s;rpm;Nm", "A;1;2500;40")

    assert asked(table) == ["What is column “Motor speed rpm”?", "Which column is the speed?"]
    assert [column.role for column in table.columns] == ["axis", "t", "", "T"]


@pytest.mark.parametrize(("unit", "factor"), [("d", 86_400), ("min", 60), ("ms", 0.001), ("[s]", 1)])
def test_a_row_of_units_counts_for_axes_as_for_cycles(unit: str, factor: float) -> None:
    (axis,) = read("Achse;Moment;Drehzahl;Zeit", f";Nm;rpm;{unit}", "A;40;250;2").axes

    assert axis["duration_s"] == [2 * factor]


def test_units_of_cells_count_where_each_has_one_and_are_asked_where_some_have_none() -> None:
    head = "Achse;Moment;Drehzahl [1/min];Dauer [hh:mm:ss]"
    table = read(head, "A;40 Nm;250;0:00:30", "A;0.3 kNm;250;0:01:00", assumed=())

    assert [axis["torque_Nm"] for axis in table.axes] == [[40, 300]]
    assert [axis["duration_s"] for axis in table.axes] == [[30, 60]]
    assert asked(read(head, "A;40 Nm;250;0:00:30", "A;300;250;0:01:00")) == ["Which unit is column “Moment” in?"]


def test_a_column_that_is_named_as_a_duration_has_no_points_in_time() -> None:
    table = read("axis;torque_Nm;speed_rpm;duration_s", "A;40;250;1", "A;32;500;2")

    assert [axis["duration_s"] for axis in table.axes] == [[1, 2]]


def test_points_in_time_beyond_every_number_spoil_their_axis() -> None:
    table = read(HEAD.replace("Dauer", "Endzeit"), "A;40;250;1", "A;32;500;1e999", "B;1;2;3", times="ends")

    assert [axis["duration_s"] for axis in table.axes] == [[1, "1e999"], [3]]


def test_a_name_above_that_of_a_quantity_counts() -> None:
    table = read("Achse;Motor;;Dauer", ";Drehmoment;Drehzahl;", "A;4;2500;1")

    assert [column.role for column in table.columns] == ["axis", "", "", "t"]
    assert "What is column “Motor Drehzahl”?" in asked(table)
    joined = read("Achse;Drehmoment;;Drehzahl;Dauer", ";;max;;", "A;40;55;250;1", roles={1: "T"})
    assert [column.role for column in joined.columns] == ["axis", "T", "Tpk", "n", "t"]


def test_lines_above_the_header_are_skipped_and_that_is_said() -> None:
    lines = ["Project;X7", "Operator: M", "State: warm", "Date: March", "Sensor: T40"]
    table = read(*lines, f"# {HEAD}", "A;40;250;1")

    assert table.whole
    assert [note.text for note in table.notes] == ["5 rows above the header are skipped: 1 to 5."]


def test_columns_that_nobody_knows_are_skipped_at_once() -> None:
    table = f"{HEAD};Temp;Motormoment [Nm];Lebensdauer [h]", "A;40;250;1;20;4;9"

    assert read(*table).unknown == 3
    assert read(*table, rest="skip").whole
    taken = read(*table, rest="skip", roles={6: "Lh"})
    assert taken.axes[0]["requirements.life_h"] == 9


@pytest.mark.parametrize("unit", ["kg·cm²", "kgcm2"])
def test_an_inertia_is_read_in_the_unit_of_its_heading_or_cell(unit: str) -> None:
    headed = read(f"{HEAD};Inertia of the load [{unit}]", "A;40;250;1;12")
    in_cells = read(f"{HEAD};Inertia of the load", f"A;40;250;1;12 {unit}")

    assert headed.axes == in_cells.axes
    assert headed.axes[0]["requirements.load_inertia_kgm2"] == 0.0012


def test_an_inertia_in_an_unknown_unit_names_those_that_are_known() -> None:
    (said,) = asked(read(f"{HEAD};Inertia of the load [kgm]", "A;40;250;1;12"))

    assert "kgm is none that is known; known are kg·m², kg·cm²" in said


def test_a_cell_in_an_unknown_unit_is_said_with_those_that_are_known() -> None:
    (note,) = read(HEAD, "A;40 kgm;100;1", "B;40;100;1").notes

    assert "such as 40 kgm: 1. Known are Nm, lb·in, lb·ft, kNm" in note.text


def test_times_of_clocks_and_dates_are_read() -> None:
    clock = read(HEAD.replace("Dauer [s]", "Dauer"), "A;40;250;0:00:30", "B;40;250;00:00:01,5")
    dates = ("A;1;9;2026-03-01T08:00:00", "A;2;9;2026-03-01T08:00:02,5", "B;1;9;2026-03-02T08:00:00")
    dated = HEAD.replace("Dauer [s]", "Timestamp"), *dates, "B;1;9;2026-03-02T08:00:01"

    assert [axis["duration_s"] for axis in clock.axes] == [[30], [1.5]]
    assert asked(read(*dated)) == ["Do the times say how long a phase lasts, or when it is?"]
    assert [axis["duration_s"] for axis in read(*dated, times="starts").axes] == [[2.5], [1]]
    assert [read(*dated, times=times).problem is None for times in ("durations", "ends")] == [False, False]


def test_a_frequency_of_a_speed_is_asked() -> None:
    assert asked(read("Achse;Moment [Nm];Drehzahl [Hz];Dauer [s]", "A;40;50;1")) == [
        "Which unit is column “Drehzahl [Hz]” in? It can be rev/s or an electrical frequency."
    ]


def test_a_number_that_a_workbook_shows_in_thousands_is_asked() -> None:
    table = sheet_of("0.0", "0.9")
    assert table.choice("scales") is None
    book = Workbook()
    sheet: Any = book.active
    sheet.append(HEAD.split(";"))
    sheet.append(["A", 40_000, 250, 1])
    sheet["B2"].number_format = "0.0,"
    book.save(file := io.BytesIO())
    grid = next(iter(sheets_of(file.getvalue()).values())).grid()

    assert asked(read_axes(grid, AXIS_INPUTS, assumed=WIRE)) == [
        "The workbook shows 40 where the cell holds 40000. Which number counts?"
    ]
    for scales, torque in (("shown", 40), ("held", 40_000)):
        assert read_axes(grid, AXIS_INPUTS, Choices(scales=scales), WIRE).axes[0]["torque_Nm"] == [torque]


def sheet_of(format_: str, *values: str) -> AxisTable:
    """A table whose last column holds these numbers of a workbook in a format, read as weight and efficiency."""
    book = Workbook()
    sheet: Any = book.active
    sheet.append([*HEAD.split(";"), "m", "eta"])
    for place in range(len(values)):
        sheet.append(["ABC"[place], 1, 9, 1, 1000 + place, 1000 + place])
        sheet.cell(place + 2, 5).number_format = "0.0"
        sheet.cell(place + 2, 6).number_format = format_
    book.save(file := io.BytesIO())
    written = io.BytesIO()
    with zipfile.ZipFile(file) as before, zipfile.ZipFile(written, "w") as after:
        for name in before.namelist():
            text = before.read(name)
            for place, value in enumerate(values):
                text = text.replace(b"<v>%d</v>" % (1000 + place), b"<v>%b</v>" % value.encode())
            after.writestr(name, text)
    (read_,) = sheets_of(written.getvalue()).values()
    return read_axes(read_.grid(), AXIS_INPUTS, Choices(roles={4: "m", 5: "eta"}, units={4: "kg"}), WIRE)


HEADED = (*HEAD.split(";"), "Lebensdauer [h]")


def merged(*rows: tuple[object, ...], cells: str) -> AxisTable:
    """A table of a workbook, some of whose cells are merged."""
    book = Workbook()
    sheet: Any = book.active
    for row in (HEADED, *rows):
        sheet.append(row)
    sheet.merge_cells(cells)
    book.save(file := io.BytesIO())
    (read_,) = sheets_of(file.getvalue()).values()
    return read_axes(read_.grid(), AXIS_INPUTS, Choices(roles={4: "Lh"}), WIRE)


def test_merged_names_and_inputs_of_an_axis_count_for_its_rows() -> None:
    named = merged((7, 40, 250, 1, 20_000), (None, 32, 500, 3, None), (8, 1, 1, 1, 5), cells="A2:A3")
    lasting = merged((7, 40, 250, 1, 20_000), (7, 32, 500, 3, None), (8, 1, 1, 1, 5), cells="E2:E3")

    assert named.axes == lasting.axes
    assert [axis["requirements.life_h"] for axis in named.axes] == [20_000, 5]


@pytest.mark.parametrize(("cells", "field"), [("B2:B3", "torque_Nm"), ("E3:E4", "requirements.life_h")])
def test_a_number_that_is_merged_over_phases_or_axes_is_none_of_theirs(cells: str, field: str) -> None:
    axes = merged((7, 40, 250, 1, None), (7, None, 500, 3, 20_000), (8, 1, 1, 1, None), cells=cells).axes

    assert cells in str([axis.get(field) for axis in axes])


def test_a_formula_without_a_value_spoils_its_axis() -> None:
    axes = merged((7, "=20*2", 250, 1, None), (8, 1, 1, 1, None), cells="G1:G2").axes

    assert [axis["torque_Nm"] for axis in axes] == [["=20*2"], [1]]


def test_a_percentage_of_a_workbook_is_the_number_that_it_holds() -> None:
    axes = sheet_of("0%", "0.95", "1E-05").axes

    assert [axis["requirements.efficiency"] for axis in axes] == [0.95, 1e-5]


@pytest.mark.parametrize("format_", ["0%", "0.0"])
def test_an_infinite_number_of_a_workbook_spoils_its_axis_alone(format_: str) -> None:
    axes = sheet_of(format_, "1E+999", "-1E+999", "0.5").axes

    read_as = [(axis["requirements.weight_kg"], axis["requirements.efficiency"]) for axis in axes]
    assert read_as == [("inf", "inf"), ("-inf", "-inf"), (0.5, 0.5)]
