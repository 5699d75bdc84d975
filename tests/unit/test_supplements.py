"""A supplement fills or corrects cells, says so wherever they show, and needs no change of code."""

import csv
import dataclasses
import io
from pathlib import Path
from typing import Any

import pytest

from hpn.application import Application, InputError
from hpn.catalogue import HANDBOOK_FOLDER, Catalogue, CatalogueError, load_catalogue
from hpn.catalogue.tables import TABLES
from hpn.engine.envelopes import EnvelopeQuery, life_envelopes
from hpn.engine.selection import select
from tests.build import answer, candidate, check, cycle, notices, phase, suitable, worked_example
from tests.conftest import Supplement

GEARS = "size,ratio,stages,source\n"
RATINGS = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
SIZES = (
    "size,maximum_input_speed_rpm,average_input_speed_rpm,ambient_temperature_minimum_degC,"
    "ambient_temperature_maximum_degC,dynamic_radial_load_N,dynamic_axial_load_N,note,source\n"
)
WEIGHTS = "size,stages,weight_kg,source\n"
LENGTHS = "size,stages,length_min_mm,length_max_mm,source\n"
ACCURACY = "size,stages,backlash_arcmin,transmission_accuracy_arcmin,source\n"
STIFFNESS = "size,stages,torsional_stiffness_Nm_per_rad,source\n"
CURVES = "size,load_coefficient,axial_N,radial_N,source\n"
EFFICIENCY = "size,ratio,torque_Nm,efficiency,source\n"


def test_one_gear_of_40a_is_rated_and_its_neighbours_stay_unrated(
    supplemented: Supplement, catalogue: Catalogue
) -> None:
    filled = supplemented(
        ratings=RATINGS + "40A,5,752,400,1250,page 12 of my print\n",
        sizes=SIZES + "HPN-40A,6000,3000,0,40,,,,page 12 of my print\n",
        weights=WEIGHTS + "40,1,14,\n",
    )
    wishes = {"sizes": ["11A", "14A", "20A", "32A", "40A"]}
    application = cycle(phase(380, 100), requirements=wishes)  # more than any of them carries on average

    before, after = answer(application, catalogue), answer(application, filled)

    assert before["selected"] is None
    assert after["selected"] == "HPN-40A-5"
    states = {c["designation"]: c["status"] for c in after["candidates"] if c["size"] == "40A"}
    assert states.pop("HPN-40A-5") == "suitable"
    # Speeds are known of the whole size now, so a ratio that runs too fast is out; the rest stays unrated.
    assert set(states.values()) == {"unrated", "unsuitable"}
    assert states["HPN-40A-4"] == "unrated"
    assert states["HPN-40A-50"] == "unsuitable"


def test_a_supplied_figure_says_so_and_the_others_stay(supplemented: Supplement, catalogue: Catalogue) -> None:
    filled = supplemented(ratings=RATINGS + "20A,5,,82,,measured\n", weights=WEIGHTS + "20A,1,2.7,\n")
    gear, printed = filled.by_designation["HPN-20A-5"], catalogue.by_designation["HPN-20A-5"]

    assert gear.rated_torque_Nm == 82
    assert gear.weight_kg == 2.7
    assert gear.sources["rated_torque_Nm"] == "supplied by the user: measured"
    assert gear.sources["weight_kg"] == "supplied by the user: weights.csv"
    changed = {"rated_torque_Nm", "weight_kg"}
    for f in dataclasses.fields(gear):
        if f.name not in changed | {"sources"}:
            assert getattr(gear, f.name) == getattr(printed, f.name), f.name
    for field, source in printed.sources.items():
        assert field in changed or gear.sources[field] == source, field
    others = [g for g in filled.gears if (g.size, g.stages) != ("20A", 1)]
    assert others == [g for g in catalogue.gears if (g.size, g.stages) != ("20A", 1)]


def test_a_blank_cell_keeps_what_was_there(supplemented: Supplement, catalogue: Catalogue) -> None:
    filled = supplemented(ratings=RATINGS + "20A,5,,,,\n", sizes=SIZES + "20A,,,,,,,,\n")

    assert filled.gears == catalogue.gears


def test_a_supplement_changes_the_version_and_gives_a_notice(supplemented: Supplement, catalogue: Catalogue) -> None:
    first = supplemented(weights=WEIGHTS + "20A,1,2.7,\n")
    second = supplemented(weights=WEIGHTS + "20A,1,2.8,\n")

    assert len({catalogue.version, first.version, second.version}) == 3
    assert answer(cycle(phase(1, 1)), first)["catalogue_version"] == first.version
    assert "catalogue_supplement" in notices(answer(cycle(phase(1, 1)), first))
    assert "catalogue_supplement" not in notices(answer(cycle(phase(1, 1)), catalogue))


def test_the_version_follows_the_content_and_nothing_else(folder: Path, catalogue: Catalogue) -> None:
    assert load_catalogue(folder).version == catalogue.version
    path = folder / "weights.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("0.44", "0.45"), encoding="utf-8")
    assert load_catalogue(folder).version != catalogue.version


def test_a_new_size_needs_rows_alone(folder: Path, catalogue: Catalogue) -> None:
    rows = {
        "gears": GEARS + "99A,5,1,table 9.1\n99A,15,2,table 9.1\n",
        "ratings": RATINGS + "99A,5,1500,900,2500,table 9.1\n99A,15,1500,900,2500,table 9.1\n",
        "sizes": SIZES + "99A,4000,2500,0,40,9000,8000,,table 9.1\n",
        "weights": WEIGHTS + "99A,1,30,table 9.1\n99A,2,34,table 9.1\n",
        "lengths": LENGTHS + "99A,1,200,250,table 9.1\n99A,2,260,300,table 9.1\n",
        "accuracy": ACCURACY + "99A,1,5,8,table 9.1\n99A,2,7,10,table 9.1\n",
        "stiffness": STIFFNESS + "99A,1,400000,table 9.1\n99A,2,400000,table 9.1\n",
    }
    for stem, text in rows.items():
        path = folder / f"{stem}.csv"
        reader = csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))
        known = next(reader)  # so that a figure that is added needs no row here
        with path.open("a", encoding="utf-8") as file:
            written = csv.DictWriter(file, reader.fieldnames or (), lineterminator="\n")
            written.writerows(known | row for row in csv.DictReader(io.StringIO(text)))

    grown = load_catalogue(folder)
    wishes = {"sizes": ["32A", "99A"]}
    reply = answer(cycle(phase(700, 100), output_load={"radial_N": 5000}, requirements=wishes), grown)

    assert len(grown.gears) == len(catalogue.gears) + 2
    assert grown.sizes[-1] == "99A"
    assert suitable(reply) == {"HPN-99A-5", "HPN-99A-15"}
    assert reply["selected"] == "HPN-99A-5"
    assert select(Application.model_validate(cycle(phase(1, 1), requirements={"sizes": ["99"]})), grown)
    assert grown.gears[:-2] == catalogue.gears


def test_a_new_size_may_come_from_a_supplement(supplemented: Supplement) -> None:
    grown = supplemented(gears="size,ratio,stages,source\n99A,5,1,mine\n", ratings=RATINGS + "99A,5,1500,900,2500,\n")

    reply = answer(cycle(phase(700, 100)), grown)

    entry = candidate(reply, "HPN-99A-5")
    assert entry["status"] == "unrated"  # its speeds are still missing
    assert check(reply, "HPN-99A-5", "average_torque")["status"] == "pass"
    assert grown.by_designation["HPN-99A-5"].sources["ratio"] == "supplied by the user: mine"


def test_stages_that_contradict_the_catalogue_are_the_supplements_fault(supplemented: Supplement) -> None:
    with pytest.raises(CatalogueError, match=r"gears\.csv, line 2, column stages: ratio 10 with 2 stages contradicts"):
        supplemented(gears="size,ratio,stages,source\n99A,10,2,mine\n")


def test_curve_points_of_a_supplement_make_the_digitised_model(supplemented: Supplement) -> None:
    drawn = supplemented(bearing_envelopes=CURVES + "14A,1,0,840,\n14A,1,450,900,\n14A,1,900,0,\n")
    load = {"model": "digitised", "radial_N": 450, "axial_N": 225}

    reply = answer(cycle(phase(1, 100), output_load=load), drawn)

    # Half of the corner point (900, 450): by hand, the utilisation is one half.
    assert check(reply, "HPN-14A-5", "output_bearing_load")["utilisation"] == 0.5
    assert check(reply, "HPN-14A-5", "output_bearing_life")["utilisation"] == pytest.approx(0.5, rel=1e-12)
    assert candidate(reply, "HPN-14A-5")["bearing_life_L50_h"] == pytest.approx(20000 * 8, rel=1e-12)
    for designation in ("HPN-20A-5", "HPN-40A-5"):
        assert check(reply, designation, "output_bearing_load")["status"] == "not_rated"
        assert candidate(reply, designation)["bearing_life_L50_h"] is None
    assert "bearing_envelope_supplied" in notices(reply)


def test_the_drawn_envelope_of_the_digitised_model_runs_through_its_points(supplemented: Supplement) -> None:
    drawn = supplemented(bearing_envelopes=CURVES + "14A,1,0,840,\n14A,1,450,900,\n14A,1,900,0,\n")
    gear = drawn.by_designation["HPN-14A-5"]
    query = EnvelopeQuery.model_validate({"model": "digitised", "load_coefficient": 1.2})

    curve = next(c for c in life_envelopes(drawn, gear, query) if c.load_coefficient == 1.2)

    assert curve.radial_N == pytest.approx([0, 900 / 1.2, 840 / 1.2], rel=1e-15)
    assert curve.axial_N == pytest.approx([900 / 1.2, 450 / 1.2, 0], rel=1e-15)


def test_a_size_without_published_limits_is_drawn_and_judged_along_the_points_that_are_supplied(
    supplemented: Supplement,
) -> None:
    """Check and picture must not part ways: what `select` judges, the envelope shows."""
    drawn = supplemented(bearing_envelopes=CURVES + "40A,1,0,8000,\n40A,1,6000,0,\n")
    gear = drawn.by_designation["HPN-40A-5"]

    reply = answer(cycle(phase(1, 100), output_load={"model": "digitised", "radial_N": 4000}), drawn)
    curves = life_envelopes(drawn, gear, EnvelopeQuery.model_validate({"model": "digitised"}))

    assert check(reply, "HPN-40A-5", "output_bearing_load")["utilisation"] == 0.5
    assert (curves[0].radial_N, curves[0].axial_N) == ([0, 8000], [6000, 0])
    with pytest.raises(InputError, match="not in this catalogue’s source"):
        life_envelopes(drawn, gear, EnvelopeQuery.model_validate({"model": "linear"}))


def test_the_digitised_model_without_points_is_an_input_error_that_says_where_to_put_them(
    catalogue: Catalogue, supplemented: Supplement
) -> None:
    application = cycle(phase(1, 100), output_load={"model": "digitised", "radial_N": 1})
    with pytest.raises(InputError, match=r"bearing_envelopes\.csv.*HPN_CATALOGUE_SUPPLEMENT") as refusal:
        answer(application, catalogue)
    assert [location for location, _ in refusal.value.problems] == [("output_load", "model")]

    drawn = supplemented(bearing_envelopes=CURVES + "14A,1,0,840,\n14A,1,900,0,\n")
    answer(application, drawn)
    with pytest.raises(InputError, match=r"bearing_envelopes\.csv"):
        answer(application | {"requirements": {"sizes": ["20A"]}}, drawn)


def test_only_a_gear_with_a_curve_of_its_own_loses_the_torque_reserve_and_only_where_the_curve_counts(
    supplemented: Supplement, catalogue: Catalogue
) -> None:
    curved = supplemented(efficiency=EFFICIENCY + "20A,5,80,0.9,\n20A,5,20,0.7,\n")
    motor = {"motor": {"peak_torque_Nm": 20.0}}

    def torque_factor(designation: str, book: Catalogue, **asked: Any) -> Any:
        return candidate(answer(worked_example(requirements=asked), book), designation)["reserve"]["torque_factor"]

    assert torque_factor("HPN-20A-5", curved, **motor) is None
    for designation, case in (
        ("HPN-20A-4", motor),
        ("HPN-20A-5", {}),
        ("HPN-20A-5", motor | {"efficiency": 0.9}),
    ):
        assert torque_factor(designation, curved, **case) == torque_factor(designation, catalogue, **case) is not None


def test_an_efficiency_curve_of_a_supplement_is_followed_between_its_points_and_holds_beyond_its_ends(
    supplemented: Supplement,
) -> None:
    curved = supplemented(efficiency=EFFICIENCY + "20A,5,80,0.9,\n20A,5,20,0.7,\n")
    application = cycle(phase(50, 100), requirements={"motor": {"peak_torque_Nm": 100}})

    inside = answer(application, curved)
    above, below = (
        answer(cycle(phase(T, 100), requirements={"motor": {"peak_torque_Nm": 100}}), curved) for T in (90, 14)
    )
    stated = answer(application | {"requirements": {"efficiency": 0.5}}, curved)

    # Half way between 20 Nm and 80 Nm the efficiency is 0.8: 50 / (5 · 0.8), by hand.
    assert candidate(inside, "HPN-20A-5")["motor_peak_torque_Nm"] == pytest.approx(12.5, rel=1e-15)
    assert candidate(inside, "HPN-20A-4")["motor_peak_torque_Nm"] == 12.5
    # Beyond the ends 0.9 and 0.7 count: 90 / (5 · 0.9) and 14 / (5 · 0.7), by hand.
    assert candidate(above, "HPN-20A-5")["motor_peak_torque_Nm"] == pytest.approx(20, rel=1e-15)
    assert candidate(below, "HPN-20A-5")["motor_peak_torque_Nm"] == pytest.approx(4, rel=1e-15)
    for reply in (above, below):
        assert "efficiency curves of HPN-20A-5:" in notices(reply)["efficiency_beyond_curve"]
    assert not {"efficiency_beyond_curve"} & {*notices(inside), *notices(stated)}
    assert candidate(stated, "HPN-20A-5")["motor_peak_torque_Nm"] == 20
    assert "efficiency_supplied" in notices(inside)
    assert "efficiency_assumed" in notices(stated)


def test_the_shipped_folder_is_not_touched_by_any_of_this(catalogue: Catalogue) -> None:
    assert HANDBOOK_FOLDER.name == "catalogue"
    assert load_catalogue().gears == catalogue.gears


def test_length_is_ranked_and_checked_by_L_max(supplemented: Supplement) -> None:
    """In the handbook L min and L max give one order; here 14A is the shortest by L min and the longest by L max."""
    changed = supplemented(lengths=LENGTHS + "14A,1,50,200,\n")
    wishes = {"sizes": ["11A", "14A"], "ratios": [5]}

    ranked = answer(cycle(phase(1, 1), requirements=wishes, rank_by="length"), changed)
    limited = answer(cycle(phase(1, 1), requirements=wishes | {"length_mm": 100}), changed)

    assert [c["designation"] for c in ranked["candidates"]] == ["HPN-11A-5", "HPN-14A-5"]
    assert suitable(limited) == {"HPN-11A-5"}


@pytest.mark.parametrize("lacking", ["backlash_arcmin", "transmission_accuracy_arcmin"])
def test_a_file_written_before_a_published_figure_came_still_loads_and_corrects_the_others(
    lacking: str, supplemented: Supplement, catalogue: Catalogue
) -> None:
    columns = ["size", "stages", "backlash_arcmin", "transmission_accuracy_arcmin", "source"]
    cells = dict(zip(columns, ["20A", "1", "2.5", "3.5", "measured"], strict=True))
    del cells[lacking]
    filled = supplemented(accuracy=f"{','.join(cells)}\n{','.join(cells.values())}\n")

    gear, printed = filled.by_designation["HPN-20A-5"], catalogue.by_designation["HPN-20A-5"]
    inputs = next(name for name in columns[2:4] if name != lacking)
    assert getattr(gear, inputs) == float(cells[inputs])
    assert gear.sources[inputs] == "supplied by the user: measured"
    assert getattr(gear, lacking) == getattr(printed, lacking)
    assert gear.sources[lacking] == printed.sources[lacking]


@pytest.mark.parametrize("lacking", ["note", "source"])
def test_a_column_of_texts_that_a_file_lacks_counts_as_blank(
    lacking: str, supplemented: Supplement, catalogue: Catalogue
) -> None:
    cells = {"size": "40A", "shaft_centre_mm": "31.5", "note": "by hand", "source": "measured"}
    del cells[lacking]
    gear = supplemented(sizes=f"{','.join(cells)}\n{','.join(cells.values())}\n").by_designation["HPN-40A-5"]

    assert gear.shaft_centre_mm == 31.5
    assert gear.note == cells.get("note", catalogue.by_designation["HPN-40A-5"].note)
    assert gear.sources["shaft_centre_mm"] == f"supplied by the user: {cells.get('source', 'sizes.csv')}"


def test_every_table_of_a_supplement_may_lack_what_its_rows_do_not_change(
    supplemented: Supplement, folder: Path
) -> None:
    """The first row of every shipped table, with its key alone and with each other column alone, changes nothing."""
    for table in (table for table in TABLES if not table.may_be_empty):
        with (folder / table.file).open(newline="", encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        for more in ((), *((column,) for column in table.columns() if column in row and column not in table.key)):
            columns = [*table.key, *more]
            text = io.StringIO()
            csv.writer(text).writerows([columns, [row[column] for column in columns]])
            assert supplemented(**{table.file.removesuffix(".csv"): text.getvalue()}).gears
            (folder.parent / "supplement" / table.file).unlink()


def test_a_row_that_is_new_needs_what_no_other_file_gives(supplemented: Supplement) -> None:
    with pytest.raises(CatalogueError, match=r"gears\.csv, line 2, column stages: .*found ''"):
        supplemented(gears="size,ratio,source\n20A,60,measured\n")


@pytest.mark.parametrize("written", ["8.53e-05", "8.53E-5", "0.0000853", "+85.3e-6", "0.853 kg·cm²"])
def test_a_figure_may_be_written_with_a_power_of_ten(written: str, supplemented: Supplement) -> None:
    catalogue = supplemented(gears=f"size,ratio,inertia_kgm2,source\n20A,5,{written},measured\n")
    assert catalogue.by_designation["HPN-20A-5"].inertia_kgm2 == 8.53e-05


@pytest.mark.parametrize("written", ["1_000", "nan", "infinity", "1e999", "1e-999", "8.53e", "e-05", "0x10", "1.2.3"])
def test_what_is_no_number_or_another_one_is_refused(written: str, supplemented: Supplement) -> None:
    with pytest.raises(CatalogueError, match=r"sizes\.csv, line 2, column ambient_temperature_minimum_degC"):
        supplemented(sizes=f"size,ambient_temperature_minimum_degC,source\n20A,{written},measured\n")


@pytest.mark.parametrize("lacking", ["size", "stages"])
def test_no_file_may_lack_what_names_a_row(lacking: str, supplemented: Supplement) -> None:
    cells = {"size": "20A", "stages": "1", "weight_kg": "2.7", "source": "measured"}
    del cells[lacking]
    with pytest.raises(CatalogueError, match=rf"weights\.csv, line 1: the header must have .*see {lacking}$"):
        supplemented(weights=f"{','.join(cells)}\n{','.join(cells.values())}\n")
