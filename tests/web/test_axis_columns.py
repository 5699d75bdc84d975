"""Columns of tables of axes: the input and unit of each, and the questions about them."""

from itertools import product

import pytest

from hpn.links.symbols import AXIS_INPUTS
from hpn.words import spellings
from hpn.words.reader import LANGUAGES, Reader
from tests.web.axes import HEAD, asked, read


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
def test_a_unit_behind_a_name_is_never_taken_for_another(form: str, soak: bool) -> None:
    wrong, count = [], 0
    for role, value_held in AXIS_INPUTS.by_role.items():
        quantity = value_held.quantity
        names = {Reader(language).text(value_held.named.name) for language in LANGUAGES} if quantity else ()
        for name, spelling in product(sorted(names), spellings.SPELLINGS):
            count += 1
            if not soak and count % 10:
                continue
            codes = spellings.codes_for(spelling, quantity)
            _, column, *_ = read(f"Achse;{form.format(name, spelling)};Nr.;Pos.", "A;1;1;1").columns
            if len(codes) == 1 and column.role == role and column.unit not in ("", codes[0]):
                wrong.append(form.format(name, spelling))
    assert wrong == []
    columns = read("Achse;Moment kNm;Drehzahl;Dauer ms;Pause", ";;rad/s;;min", "A;1;1;1;1").columns
    assert [column.unit for column in columns] == ["", "kNm", "rad_per_s", "ms", "min"]


@pytest.mark.parametrize(
    ("head", "message"),
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
def test_a_column_that_nobody_knows_is_asked(head: str, message: str) -> None:
    cells = ["A", *"1234"][: head.count(";") + 1]

    assert message in asked(read(head, ";".join(cells)))


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


def test_every_input_of_an_axis_is_known_by_the_name_of_its_column() -> None:
    names = {each.place: each.role for each in AXIS_INPUTS.by_role.values()}
    table = read(";".join(names), ";".join(["A", *("1" for _ in names)][:-1]))

    assert {column.heading: column.role for column in table.columns} == names


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
    assert [foreign for question in asked(table) if f": {foreign} is not supported" in question] == [foreign] * bool(
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

    (question,) = asked(table)
    assert question.startswith("Motor speed rpm: named after the motor")
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


def test_a_name_above_that_of_a_quantity_counts() -> None:
    table = read("Achse;Motor;;Dauer", ";Drehmoment;Drehzahl;", "A;4;2500;1")

    assert [column.role for column in table.columns] == ["axis", "", "", "t"]
    (question,) = asked(table)
    assert question.startswith("Motor Drehmoment, Motor Drehzahl: named after the motor")
    joined = read("Achse;Drehmoment;;Drehzahl;Dauer", ";;max;;", "A;40;55;250;1", roles={1: "T"})
    assert [column.role for column in joined.columns] == ["axis", "T", "Tpk", "n", "t"]


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
    (message,) = asked(read(f"{HEAD};Inertia of the load [kgm]", "A;40;250;1;12"))

    assert "kgm is not known; known units: kg·m², kg·cm²" in message


def test_a_frequency_of_a_speed_is_asked() -> None:
    assert asked(read("Achse;Moment [Nm];Drehzahl [Hz];Dauer [s]", "A;40;50;1")) == [
        "Which unit is column “Drehzahl [Hz]” in? It can be rev/s or an electrical frequency."
    ]


@pytest.mark.parametrize("head", ["emergency stop [Nm]", "Not-Halt [kNm]", "Emergency stop in Nm", "NOT-AUS (Nm)"])
def test_an_emergency_stop_in_a_unit_of_torque_is_its_torque(head: str) -> None:
    *_, column = read(f"{HEAD};{head}", "A;1;10;1;30").columns

    assert column.role == "Tk"


@pytest.mark.parametrize("head", ["emergency stop", "Not-Halt", "emergency stop [1/h]", "emergency stop [s]"])
def test_an_emergency_stop_without_a_unit_of_torque_is_asked(head: str) -> None:
    assert asked(read(f"{HEAD};{head}", "A;1;10;1;30")) == [f"What is column “{head}”?"]


def test_a_row_of_units_makes_an_emergency_stop_a_torque() -> None:
    *_, column = read("Axis;Torque;Speed;Duration;Emergency stop", ";Nm;rpm;s;Nm", "A;1;10;1;30").columns

    assert (column.role, column.unit) == ("Tk", "Nm")


@pytest.mark.parametrize(
    ("heading", "role"),
    [
        ("Emergency stop torque [Nm]", "Tk"),
        ("Emergency-stop torque [Nm]", "Tk"),
        ("Motor inertia [kgm²]", "Jm"),
        ("Backlash [arcmin]", "bl"),
        ("Jeu angulaire [arcmin]", "bl"),
        ("Gioco [arcmin]", "bl"),
        ("Inertie du moteur [kg.cm²]", "Jm"),
        ("Inerzia motore [kgcm²]", "Jm"),
        ("Couple d'arrêt d'urgence [Nm]", "Tk"),
        ("Coppia di emergenza [Nm]", "Tk"),
        ("Temps de pause [s]", "tp"),
        ("Tempo di pausa [s]", "tp"),
        ("Rapport de réduction", "i"),
        ("Rapporto di riduzione", "i"),
        ("Température ambiante [°C]", "ta"),
        ("Lebensdauer Lager [h]", "Lb"),
        ("Durée de vie du réducteur [h]", "Lh"),
    ],
)
def test_a_column_with_one_possible_meaning_is_not_asked(heading: str, role: str) -> None:
    assert read(f"{HEAD};{heading}", "A;1;9;1;14").columns[4].role == role


@pytest.mark.parametrize(
    ("heading", "cell", "taken"),
    [
        ("Shaft’s centre at", "21", 21.0),
        ("output_load.shaft_centre_mm", '{"20A": 21, "others": 18.5}', {"20A": 21.0, "others": 18.5}),
        ("Wellenmitte bei", "20A: 21,5; übrige: 18", {"20A": 21.5, "others": 18.0}),
        ("Shaft’s centre at [in]", "20: 1; others: 18 mm", {"20A": 25.4, "others": 18.0}),
        ("Wellenmitte bei", "20A: 1,234", "20A: 1,234"),
        ("Wellenmitte bei", "20A: 21; 20: 22", "20A: 21; 20: 22"),
        ("output_load.shaft_centre_mm", '{"20A": 21, "20A": 22}', '{"20A": 21, "20A": 22}'),
        ("output_load.shaft_centre_mm", '{"20A": [21]}', '{"20A": [21]}'),
        ("output_load.shaft_centre_mm", '{"20A": 21', '{"20A": 21'),
        ("output_load.shaft_centre_mm", "{}", "{}"),
    ],
)
def test_the_shafts_centre_is_read_by_size_too(heading: str, cell: str, taken: object) -> None:
    """A cell that is neither a number nor numbers by size is named in a note, and its text stays as written."""
    lines = [f"Axis\tTorque [Nm]\tSpeed [rpm]\tDuration [s]\t{heading}", f"A\t10\t1\t1\t{cell}"]
    table = read(*lines)

    assert table.axes[0]["output_load.shaft_centre_mm"] == taken
    assert any("not numbers" in note.text for note in table.notes) == isinstance(taken, str)


@pytest.mark.parametrize(
    "heading",
    [
        *("required life", "Required life [h]", "Life [h]", "L10 [h]", "Service life (h)", "Lebensdauer [h]"),
        *("erforderliche Lebensdauer in h", "Nutzungsdauer [h]", "durée de vie [h]", "Durée de vie requise (h)"),
        *("durata di vita [h]", "Durata richiesta [h]", "vita utile [h]"),
    ],
)
def test_a_life_may_be_the_gears_or_the_bearings_and_is_asked(heading: str) -> None:
    table = read(f"{HEAD};{heading}", "A;1;9;1;20000")

    assert asked(table) == [f"What is column “{heading}”?"] and not table.axes
    for role, place in (("Lh", "requirements.life_h"), ("Lb", "output_load.life_h")):
        assert read(f"{HEAD};{heading}", "A;1;9;1;20000", roles={4: role}).axes[0][place] == 20000


@pytest.mark.parametrize("heading", ["Durata [h]", "Durée [h]", "Dauer [h]", "Duration (hours)"])
def test_so_many_hours_of_an_axis_may_be_its_phase_or_its_life(heading: str) -> None:
    table = read(f"Asse;Coppia [Nm];Velocità [rpm];{heading}", "A;1;9;20000")

    assert f"What is column “{heading}”?" in asked(table)


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("Achse;Phase", "hoch runter"),
        ("Achse;Schritt", "hoch runter"),
        ("Axis;Step", "up 2"),
        ("Axe;Étape", "montée descente"),
        ("Asse;Fase", "salita discesa"),
        ("Axis;Name", "up down"),
    ],
)
def test_names_of_the_phases_of_an_axis_are_kept(head: str, names: str) -> None:
    rows = [f"A;{name};1;10;1" for name in names.split()]

    assert read(f"{head};Torque [Nm];Speed [rpm];Time [s]", *rows).axes[0]["name"] == names.split()


def test_numbers_below_phase_name_none_and_a_column_called_so_comes_first() -> None:
    numbered = read("Axis;Phase;Torque;Speed;Duration", "A;1;1;10;1", "A;2;2;20;2")
    both = read("Axis;Phase;Phase name;Torque;Speed;Duration", "A;a1;up;1;10;1", "A;a2;down;2;20;2")

    assert "name" not in numbered.axes[0]
    assert both.axes[0]["name"] == ["up", "down"]
