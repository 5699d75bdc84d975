"""Tables of axes from spreadsheets: no number silently changes, and ambiguous cells lead to a question."""

from typing import Any

import pytest

from tests.web.axes import HEAD, asked, offered, read


def test_a_number_with_two_readings_is_asked() -> None:
    open_ = read(HEAD, "A;1.234;100;1", "B;2.500;100;1")

    assert asked(open_) == ["Which is the decimal mark?"] and not open_.axes
    assert offered(open_, "decimal").numbers == {".": "1.234", ",": "1234"}
    for mark, torque in ((".", 1.234), (",", 1234.0)):
        assert read(HEAD, "A;1.234;100;1", "B;2.500;100;1", decimal=mark).axes[0]["torque_Nm"] == [torque]


def test_times_that_go_on_in_every_axis_may_be_points_in_time() -> None:
    head, *rows = "Achse;Moment [Nm];Drehzahl [1/min];Zeit [s]", "A;1;10;1", "A;2;20;3", "B;1;10;2", "B;2;20;5"

    assert asked(read(head, *rows)) == ["Are the times durations, starts or ends of the phases?"]
    by_name = {times: read(head, *rows, times=times).axes for times in ("durations", "ends", "starts")}
    assert [axis["duration_s"] for axis in by_name["durations"]] == [[1, 3], [2, 5]]
    assert [axis["duration_s"] for axis in by_name["ends"]] == [[1, 2], [2, 3]]
    assert [(axis["duration_s"], axis["torque_Nm"]) for axis in by_name["starts"]] == [([2], [1]), ([3], [1])]
    assert asked(read(head, "A;1;10;3", "A;2;20;1", "B;1;10;2")) == []


def test_times_that_are_named_as_points_in_time_are_asked_even_where_they_go_back() -> None:
    head = "Achse;Moment [Nm];Drehzahl [1/min];Endzeit [s]"

    assert asked(read(head, "A;1;10;3", "B;2;20;1")) == ["Are the times durations, starts or ends of the phases?"]
    assert [axis["duration_s"] for axis in read(head, "A;1;10;3", "B;2;20;1", times="ends").axes] == [[3], [1]]


def test_cells_in_a_unit_of_something_else_are_said_before_their_axes_are_rejected() -> None:
    table = read(HEAD, "A;40 lb;100;1", "B;40;10 1/s;1", "C;40 Nm;100;300 ms", "D;n. b.;100;1")

    assert [note.text for note in table.notes] == [
        "Cells that are not numbers, such as n. b. in row 5: 1. Their axes stay open.",
        "Cells with a unit that does not fit their column, such as 40 lb in row 2: 2. Their axes stay open.",
    ]
    assert [axis["torque_Nm"] for axis in table.axes] == [["40 lb"], [40], [40], ["n. b."]]


def test_bars_between_ratios_part_no_columns() -> None:
    table = read("Axis,T,n,t,Ratio", "A,40,250,1,4|5|7", "B,40,250,1,4|5|10")

    assert [axis["requirements.ratios"] for axis in table.axes] == [[4, 5, 7], [4, 5, 10]]


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

    assert asked(read(head, *GOING_ON, other)) == ["Are the times durations, starts or ends of the phases?"]
    message = read(head, *GOING_ON, other, times="ends")
    assert [axis["duration_s"] for axis in message.axes[:2]] == [[1, 2], [2, 3]]
    falling = read(head, "A;1;10;3", "A;2;20;1", "B;1;10;2")
    assert offered(falling, "times").chosen == "durations"


def test_two_decimal_marks_in_a_table_are_asked_and_what_no_longer_is_a_number_is_told() -> None:
    rows = "A;12,5;100;1,5", "B;13,5;100;1.125", "C;2;100;0.5"

    assert asked(read(HEAD, *rows)) == ["Both decimal marks are written, as in 0.5 and 12,5: which one counts?"]
    comma = read(HEAD, *rows, decimal=",")
    assert [axis["duration_s"] for axis in comma.axes] == [[1.5], [1125.0], ["0.5"]]
    assert [note.text for note in comma.notes][-1] == (
        "Cells that are not numbers, such as 0.5 in row 4: 1. Their axes stay open."
    )
    sure = read(HEAD, "A;12,5;100;1,5", "C;2;100;0.5")
    assert asked(sure) == [] and sure.axes[1]["duration_s"] == ["0.5"]


SUM = "has no axis, while other rows have one: leave it out if it is a sum, or enter its axis."


@pytest.mark.parametrize(
    ("head", "rows", "message"),
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
def test_a_row_without_an_axis_that_may_be_a_sum_is_asked(head: str, rows: str, message: str) -> None:
    assert asked(read(head, *rows.split("|"))) == ([message] if message else [])


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


def test_a_figure_that_an_axis_gives_twice_is_compared_as_a_number_and_spoils_that_axis_alone() -> None:
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


def test_a_column_that_is_named_as_a_duration_has_no_points_in_time() -> None:
    table = read("axis;torque_Nm;speed_rpm;duration_s", "A;40;250;1", "A;32;500;2")

    assert [axis["duration_s"] for axis in table.axes] == [[1, 2]]


def test_points_in_time_beyond_every_number_spoil_their_axis() -> None:
    table = read(HEAD.replace("Dauer", "Endzeit"), "A;40;250;1", "A;32;500;1e999", "B;1;2;3", times="ends")

    assert [axis["duration_s"] for axis in table.axes] == [[1, "1e999"], [3]]


def test_lines_above_the_header_are_skipped_and_that_is_said() -> None:
    lines = ["Project;X7", "Operator: M", "State: warm", "Date: March", "Sensor: T40"]
    table = read(*lines, f"# {HEAD}", "A;40;250;1")

    assert table.whole
    assert [note.text for note in table.notes] == ["5 rows above the header are skipped: 1 to 5."]


def test_a_cell_in_an_unknown_unit_is_said_with_those_that_are_known() -> None:
    (note,) = read(HEAD, "A;40 kgm;100;1", "B;40;100;1").notes

    assert "such as 40 kgm in row 2: 1. Known units: Nm, lb·in, lb·ft, kNm" in note.text


def test_times_of_clocks_and_dates_are_read() -> None:
    clock = read(HEAD.replace("Dauer [s]", "Dauer"), "A;40;250;0:00:30", "B;40;250;00:00:01,5")
    dates = ("A;1;9;2026-03-01T08:00:00", "A;2;9;2026-03-01T08:00:02,5", "B;1;9;2026-03-02T08:00:00")
    dated = HEAD.replace("Dauer [s]", "Timestamp"), *dates, "B;1;9;2026-03-02T08:00:01"

    assert [axis["duration_s"] for axis in clock.axes] == [[30], [1.5]]
    assert asked(read(*dated)) == ["Are the times durations, starts or ends of the phases?"]
    assert [axis["duration_s"] for axis in read(*dated, times="starts").axes] == [[2.5], [1]]
    assert [read(*dated, times=times).problem is None for times in ("durations", "ends")] == [False, False]


LOADED = (
    "Axis;Torque [Nm];Speed [rpm];Duration [s];Pause [s];Radial load [N]",
    "A;60;40;0.35;0.8;900",
    "A;25;70;1.4;;",
)


def test_a_load_in_the_first_row_of_an_axis_alone_is_asked() -> None:
    table = read(*LOADED)

    assert asked(table) == [
        "Column “Radial load [N]” has a number in the first row of an axis alone: where does the load act?"
    ]
    assert offered(table, "loads").chosen == ""


def test_a_load_in_the_first_row_counts_for_the_axis_or_for_its_phase_as_said() -> None:
    (whole,), (alone,) = read(*LOADED, loads="axis").axes, read(*LOADED, loads="phase").axes

    assert (whole.get("output_load.radial_N"), whole.get("radial_N")) == (900, None)
    assert (alone.get("output_load.radial_N"), alone.get("radial_N")) == (None, [900, None])


def test_a_load_in_the_first_row_counts_for_its_phase_beside_axes_with_several_loads_and_that_is_shown() -> None:
    table = read(*LOADED, "B;1;10;1;;5", "B;1;10;1;;6")

    assert (asked(table), offered(table, "loads").chosen) == ([], "phase")
    assert table.axes[0]["radial_N"] == [900, None]
    assert read(*LOADED, "B;1;10;1;;5", "B;1;10;1;;6", loads="axis").axes[1]["radial_N"] == [5, 6]


@pytest.mark.parametrize("rows", [["A;1;10;1;;5"], ["A;1;10;1;;5", "A;1;10;1;;5"], ["A;1;10;1;;", "A;1;10;1;;5"]])
def test_no_other_place_of_a_load_is_asked(rows: list[str]) -> None:
    table = read(LOADED[0], *rows)

    assert (table.questions, table.choice("loads")) == ((), None)


def test_times_of_axes_that_go_back_are_asked_with_the_row_where_they_do() -> None:
    shift = (
        HEAD.replace("Dauer [s]", "Zeit [s]"),
        "A;40;250;0",
        "A;20;100;2",
        "A;10;90;5",
        "A;0;0;3",
        "B;1;9;0",
        "B;2;8;4",
    )
    table = read(*shift)

    assert "In row 5 they fall, from 5 to 3." in asked(table)[0]
    assert "in row 5" in asked(read(*shift, times="starts"))[0]
    wrong = read(*shift, times="starts", falls="error").axes
    assert [axis["duration_s"] for axis in wrong] == [[2, 3, -2], [4]]  # the fleet rejects the first with a reason


def test_a_counter_of_axes_goes_on_and_phases_of_one_stamp_are_left_out() -> None:
    rows = ("A;40;250;65000", "A;20;100;65500", "A;5;50;65500", "A;10;90;464", "A;0;0;964")
    table = read(HEAD.replace("Dauer [s]", "Zeit [ms]"), *rows, times="starts", falls="8192/125")

    assert [axis["duration_s"] for axis in table.axes] == [[0.5, 0.5, 0.5]]
    assert [axis["torque_Nm"] for axis in table.axes] == [[40, 5, 10]]
    assert table.origins == {"A": (2, 4, 5, 6)}
    assert "Rows that last 0 s are left out: 3." in [note.text for note in table.notes]


def test_a_row_named_like_an_emergency_stop_is_asked_and_may_be_that_of_its_axis() -> None:
    rows = (HEAD + ";Phase name", "A;40;250;1;up", "A;200;;;E-stop", "Crash sled;9;90;2;run")

    assert asked(read(*rows)) == ["Named like an emergency stop: row 3 (E-stop). What is it?"]
    stopped, other = read(*rows, stop="stop").axes
    assert (stopped["torque_Nm"], stopped["emergency_stop.torque_Nm"]) == ([40], 200)
    assert "emergency_stop.torque_Nm" not in other
    assert read(*rows, stop="phase").axes[0]["torque_Nm"] == [40, 200]
