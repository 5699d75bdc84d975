"""Every figure of the catalogue as loaded, beside a second transcription of the handbook that was typed without it."""

import dataclasses

import pytest

from hpn.catalogue import Catalogue, GearColumns, OutputVersion
from hpn.catalogue.gear import Gear
from tests.reference import handbook

RATED_SIZES = ("11A", "14A", "20A", "32A")


def typed_by_hand(size: str, ratio: int) -> dict[str, object]:
    """Printed figures of a gear, by the name of the catalogue's field; None where the handbook's text has none."""
    stages = handbook.STAGES[ratio]
    place = handbook.RATIOS[size].index(ratio)
    rated = size in handbook.RATED_TORQUE_NM
    length = handbook.LENGTH_MM.get((size, stages), (None, None))
    ambient = handbook.AMBIENT_TEMPERATURE_DEGC.get(size, (None, None))
    return {
        "designation": f"HPN-{size}-{ratio}",
        "size": size,
        "ratio": ratio,
        "stages": stages,
        "repeated_peak_torque_Nm": handbook.REPEATED_PEAK_TORQUE_NM[size][place] if rated else None,
        "rated_torque_Nm": handbook.RATED_TORQUE_NM[size][place] if rated else None,
        "momentary_peak_torque_Nm": handbook.MOMENTARY_PEAK_TORQUE_NM[size][place] if rated else None,
        "maximum_input_speed_rpm": handbook.MAXIMUM_INPUT_SPEED_RPM.get(size),
        "average_input_speed_rpm": handbook.AVERAGE_INPUT_SPEED_RPM.get(size),
        "ambient_temperature_minimum_degC": ambient[0],
        "ambient_temperature_maximum_degC": ambient[1],
        "weight_kg": handbook.WEIGHT_KG.get((size, stages)),
        "backlash_arcmin": handbook.BACKLASH_ARCMIN[size, stages],
        "transmission_accuracy_arcmin": handbook.TRANSMISSION_ACCURACY_ARCMIN[size, stages],
        "torsional_stiffness_Nm_per_rad": handbook.TORSIONAL_STIFFNESS_NM_PER_RAD[size, stages],
        "length_min_mm": length[0],
        "length_max_mm": length[1],
        "dynamic_radial_load_N": handbook.DYNAMIC_RADIAL_LOAD_N.get(size),
        "dynamic_axial_load_N": handbook.DYNAMIC_AXIAL_LOAD_N.get(size),
    }


ALL = [(size, ratio) for size, ratios in handbook.RATIOS.items() for ratio in ratios]
ELSEWHERE = {"clamp_bolts", "housing_bolts", "note", "sources"}
UNPUBLISHED = {"shaft_centre_mm": None, "inertia_kgm2": None, "no_load_torque_Nm": None}


@pytest.mark.parametrize(("size", "ratio"), ALL, ids=[f"HPN-{size}-{ratio}" for size, ratio in ALL])
def test_every_figure_of_a_gear_is_the_printed_one(catalogue: Catalogue, size: str, ratio: int) -> None:
    gear = catalogue.by_designation[f"HPN-{size}-{ratio}"]
    figures = {f.name: getattr(gear, f.name) for f in dataclasses.fields(Gear) if f.name not in ELSEWHERE}

    assert figures == typed_by_hand(size, ratio) | UNPUBLISHED


def test_the_catalogue_holds_the_64_printed_gears_and_no_other_in_the_order_of_size_and_ratio(
    catalogue: Catalogue,
) -> None:
    assert [(gear.size, gear.ratio) for gear in catalogue.gears] == ALL
    assert len(catalogue.gears) == 64


def test_51_gears_are_rated_and_the_13_of_size_40a_are_not(catalogue: Catalogue) -> None:
    rated = [gear for gear in catalogue.gears if gear.rated_torque_Nm is not None]
    unrated = [gear for gear in catalogue.gears if gear.rated_torque_Nm is None]

    assert len(rated) == 51
    assert len(unrated) == 13
    assert {gear.size for gear in rated} == set(RATED_SIZES)
    assert {gear.size for gear in unrated} == {"40A"}


def test_of_size_40a_is_known_what_the_text_prints_and_the_rest_is_missing_not_zero(catalogue: Catalogue) -> None:
    known = {
        "backlash_arcmin",
        "transmission_accuracy_arcmin",
        "torsional_stiffness_Nm_per_rad",
    }
    for gear in catalogue.gears:
        if gear.size == "40A":
            figures = {name for name in GearColumns.__annotations__ if getattr(gear, name) is not None}
            assert figures | {"transmission_accuracy_arcmin"} == known | {"ratio"}
            assert gear.clamp_bolts and gear.housing_bolts
            assert gear.note and "752 Nm" in gear.note


@pytest.mark.parametrize("size", handbook.RATIOS)
def test_the_bolts_of_a_size_are_the_printed_ones(catalogue: Catalogue, size: str) -> None:
    clamp = [(bolt, torque) for owner, bolt, torque in handbook.CLAMP_BOLTS if owner == size]
    for gear in catalogue.gears:
        if gear.size == size:
            assert gear.housing_bolts is not None
            assert dataclasses.astuple(gear.housing_bolts)[:-1] == handbook.HOUSING_BOLTS[size]
            assert "table 27.1" in gear.housing_bolts.source
            assert [(bolt.bolt_size, bolt.tightening_torque_Nm) for bolt in gear.clamp_bolts] == clamp
            assert all("table 26.2" in bolt.source for bolt in gear.clamp_bolts)


def test_the_bolts_of_the_motor_flange_are_the_printed_ones(catalogue: Catalogue) -> None:
    loaded = {bolt.bolt_size: bolt.tightening_torque_Nm for bolt in catalogue.flange_bolts}

    assert loaded == handbook.MOTOR_FLANGE_BOLT_TORQUE_NM


def test_figures_of_the_whole_series_are_the_printed_ones(catalogue: Catalogue) -> None:
    series = {name: (figure.value, figure.unit) for name, figure in catalogue.series.items()}
    smallest = min(min(row) for row in handbook.REPEATED_PEAK_TORQUE_NM.values())

    assert series == {
        "rated_input_speed": (handbook.RATED_INPUT_SPEED_RPM, "rpm"),
        "life_at_rated_torque": (handbook.LIFE_BASIS_H, "h"),
        "largest_repeated_peak_torque": (handbook.LARGEST_REPEATED_PEAK_TORQUE_OF_SERIES_NM, "Nm"),
        "smallest_repeated_peak_torque": (smallest, "Nm"),
        "lubricant": (handbook.LUBRICANT, None),
        "lubricant_ambient_temperature_minimum": (handbook.LUBRICANT_AMBIENT_DEGC[0], "degC"),
        "lubricant_ambient_temperature_maximum": (handbook.LUBRICANT_AMBIENT_DEGC[1], "degC"),
        "lubricant_operating_temperature_maximum": (handbook.LUBRICANT_MAXIMUM_OPERATING_TEMPERATURE_DEGC, "degC"),
        "storage_temperature_minimum": (handbook.STORAGE_TEMPERATURE_DEGC[0], "degC"),
        "storage_temperature_maximum": (handbook.STORAGE_TEMPERATURE_DEGC[1], "degC"),
        "bearing_reference_speed": (handbook.BEARING_REFERENCE_SPEED_RPM, "rpm"),
        "bearing_reference_life_L50": (handbook.BEARING_REFERENCE_LIFE_H, "h"),
    }


def test_the_ordering_options_are_the_printed_ones(catalogue: Catalogue) -> None:
    outputs = {option.code: option for option in catalogue.output_versions if option.position == "output"}
    others = [option for option in catalogue.output_versions if option.position != "output"]

    assert set(outputs) == set(handbook.OUTPUT_VERSIONS)
    for code, words in handbook.OUTPUT_VERSIONS.items():
        # The transcription is in other words: with a key or without one is what both must agree on.
        assert ("no key" in words) == ("without key" in outputs[code].description)
    assert [isinstance(option, OutputVersion) and option.code for option in others] == ["xx.xx"]


def test_no_graph_that_the_text_lost_is_in_the_catalogue(catalogue: Catalogue) -> None:
    assert catalogue.curves == {}
    assert catalogue.efficiency == {}
    assert catalogue.supplement is None


TABLE_OF_RATINGS = {"11A": "table 10.1", "14A": "table 10.2", "20A": "table 12.1", "32A": "table 12.2"}
TABLE_OF_LENGTHS = {"11A": "table 11.2", "14A": "table 11.4", "20A": "table 13.2", "32A": "table 13.4"}
PAGES = {"table 10": 10, "table 11": 11, "table 12": 12, "table 13": 13, "table 15": 15}


def test_every_figure_names_the_table_that_the_transcription_names(catalogue: Catalogue) -> None:
    ratings = (
        "repeated_peak_torque_Nm",
        "rated_torque_Nm",
        "momentary_peak_torque_Nm",
        "maximum_input_speed_rpm",
        "average_input_speed_rpm",
        "ambient_temperature_minimum_degC",
        "ambient_temperature_maximum_degC",
        "weight_kg",
        "dynamic_radial_load_N",
        "dynamic_axial_load_N",
    )
    for gear in catalogue.gears:
        expected = {
            "backlash_arcmin": "table 15.1",
            "transmission_accuracy_arcmin": "table 15.1",
            "torsional_stiffness_Nm_per_rad": "table 15.2",
        }
        if gear.size in RATED_SIZES:
            expected |= dict.fromkeys(ratings, TABLE_OF_RATINGS[gear.size])
            expected |= dict.fromkeys(("length_min_mm", "length_max_mm"), TABLE_OF_LENGTHS[gear.size])
        for field, table in expected.items():
            page = PAGES[table.split(".")[0]]
            assert gear.sources[field] == f"{table}, page {page}", (gear.designation, field)


def test_every_figure_that_is_known_has_a_source_and_no_other_has_one(catalogue: Catalogue) -> None:
    identity = {"designation", "size"}
    for gear in catalogue.gears:
        known = {
            f.name
            for f in dataclasses.fields(Gear)
            if f.name not in identity | {"clamp_bolts", "housing_bolts", "sources"}
            and getattr(gear, f.name) is not None
        }
        assert set(gear.sources) == known, gear.designation
