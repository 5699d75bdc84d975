"""A wrong catalogue file stops the start, and the text names file, line and column."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from hpn.catalogue import CatalogueError, load_catalogue
from hpn.catalogue.tables import TABLES, CatalogueRow
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.conftest import Supplement

Change = Callable[[str], str]


def replace(old: str, new: str) -> Change:
    """Replace one text of a file, which must be there."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


def append(row: str) -> Change:
    return lambda text: text + row + "\n"


def without_column(name: str) -> Change:
    def change(text: str) -> str:
        rows = [line.split(",") for line in text.splitlines()]
        index = rows[0].index(name)
        return "\n".join(",".join(row[:index] + row[index + 1 :]) for row in rows) + "\n"

    return change


def line_of(text: str, start: str) -> int:
    """Number of the line that starts so, in the shipped file."""
    return next(number for number, line in enumerate(text.splitlines(), 1) if line.startswith(start))


# File, change, start of the line that is wrong in the changed file (None: no line), column named, words of the text.
WRONG: dict[str, tuple[str, Change, str | None, str | None, str]] = {
    "a missing column": ("weights.csv", without_column("weight_kg"), "size,", "weight_kg", "header"),
    "an extra column": (
        "weights.csv",
        lambda text: "\n".join(line + (",colour" if n == 0 else ",red") for n, line in enumerate(text.splitlines())),
        "size,",
        "colour",
        "header",
    ),
    "a repeated column": ("stiffness.csv", replace("size,stages", "size,size"), "size,size", "stages", "header"),
    "an empty file": ("weights.csv", lambda text: "", None, "size", "header"),
    "a text for a number": ("weights.csv", replace("11A,1,0.44", "11A,1,light"), "11A,1", "weight_kg", "light"),
    "not a number": ("weights.csv", replace("0.44", "nan"), "11A,1", "weight_kg", "nan"),
    "a misspelt check": (
        "facts.csv",
        replace(
            'not occur in the normal operating cycle.",momentary', 'not occur in the normal operating cycle.",momentry'
        ),
        "momentary_peak_torque,",
        "check",
        "must be 'average_torque', 'repeated_peak_torque',",
    ),
    "infinity": ("weights.csv", replace("0.44", "inf"), "11A,1", "weight_kg", "inf"),
    "an underscore in a number": (
        "ratings.csv",
        replace("11A,4,14,", "11A,4,1_4,"),
        "11A,4,",
        "repeated_peak_torque_Nm",
        "",
    ),
    "a decimal comma in quotes": ("weights.csv", replace("0.44", '"0,44"'), "11A,1", "weight_kg", "decimal point"),
    "zero": ("weights.csv", replace("0.44", "0"), "11A,1", "weight_kg", "greater than 0"),
    "a negative figure": ("lengths.csv", replace("11A,1,60", "11A,1,-60"), "11A,1", "length_min_mm", "greater than 0"),
    "half a stage": ("gears.csv", replace("11A,4,1", "11A,4,1.5"), "11A,4,", "stages", "integer"),
    "a wrong ratio": ("gears.csv", replace("11A,4,1", "11A,four,1"), "11A,four", "ratio", "four"),
    "a wrong size": ("gears.csv", replace("11A,4,1", "large,4,1"), "large,4", "size", "large"),
    "a blank key": ("gears.csv", replace("11A,4,1", ",4,1"), ",4,1", "size", "blank"),
    "T_R at T_M": (
        "ratings.csv",
        replace("11A,4,14,14,40", "11A,4,40,14,40"),
        "11A,4,",
        "repeated_peak_torque_Nm",
        "below",
    ),
    "T_R above T_M": (
        "ratings.csv",
        replace("11A,4,14,14,40", "11A,4,41,14,40"),
        "11A,4,",
        "repeated_peak_torque_Nm",
        "below",
    ),
    "T_N above T_R": (
        "ratings.csv",
        replace("11A,4,14,14,40", "11A,4,14,15,40"),
        "11A,4,",
        "rated_torque_Nm",
        "at most",
    ),
    "T_N above T_M": ("ratings.csv", replace("11A,4,14,14,40", "11A,4,14,44,40"), "11A,4,", "rated_torque_Nm", "below"),
    "n_av above n_max": (
        "sizes.csv",
        replace("11A,10000,3000", "11A,1000,3000"),
        "11A,",
        "average_input_speed_rpm",
        "at most",
    ),
    "a cold range": (
        "sizes.csv",
        replace("3000,0,40,480", "3000,50,40,480"),
        "11A,",
        "ambient_temperature_minimum_degC",
        "below",
    ),
    "L min above L max": ("lengths.csv", replace("14A,1,70", "14A,1,76"), "14A,1", "length_min_mm", "at most"),
    "stages against the other sizes": ("gears.csv", replace("20A,15,2", "20A,15,1"), None, "stages", "contradicts"),
    "stages against the ratio": ("gears.csv", replace("20A,3,1", "20A,3,2"), None, "stages", "contradicts"),
    "an unknown source": (
        "weights.csv",
        replace("11A,1,0.44,table 10.1", "11A,1,0.44,table 99"),
        "11A,1",
        "source",
        "table 99",
    ),
    "a blank source": (
        "weights.csv",
        replace("11A,1,0.44,table 10.1", "11A,1,0.44,"),
        "11A,1",
        "source",
        "sources.csv",
    ),
    "a repeated row": ("weights.csv", append("11A,1,0.5,table 10.1"), "11A,1,0.5", "size", "line 2"),
    "a repeated row in another spelling": (
        "weights.csv",
        append("HPN-11,1,0.5,table 10.1"),
        "HPN-11",
        "size",
        "line 2",
    ),
    "a blank rating in a rated size": (
        "ratings.csv",
        replace("11A,4,14,14,40", "11A,4,14,,40"),
        "11A,4,",
        "rated_torque_Nm",
        "blank",
    ),
    "a blank weight in a rated size": ("weights.csv", replace("0.44", ""), "11A,1", "weight_kg", "blank"),
    "a blank limit in a rated size": (
        "sizes.csv",
        replace(",480,640", ",,640"),
        "11A,",
        "dynamic_radial_load_N",
        "blank",
    ),
    "an unknown size": ("weights.csv", append("99A,1,5,table 10.1"), "99A", "size", "99A"),
    "an unknown ratio": ("ratings.csv", append("11A,3,14,14,40,table 10.1"), "11A,3,", "ratio", "ratio 3"),
    "a ratio that is only a number of stages": (
        "ratings.csv",
        append("11A,2,14,14,40,table 10.1"),
        "11A,2,",
        "ratio",
        "ratio 2",
    ),
    "a number of stages that is only a ratio": (
        "weights.csv",
        append("11A,4,5,table 10.1"),
        "11A,4",
        "stages",
        "stages 4",
    ),
    "a wrong unit": ("series.csv", replace("3000,rpm", "3000,s"), "rated_input_speed", "unit", "rpm"),
    "an unknown unit": ("series.csv", replace("3000,rpm", "3000,1/min"), "rated_input_speed", "unit", "1/min"),
    "a series figure that is a text": (
        "series.csv",
        replace("3000,rpm", "fast,rpm"),
        "rated_input_speed",
        "value",
        "fast",
    ),
    "a series figure of zero": ("series.csv", replace("3000,rpm", "0,rpm"), "rated_input_speed", "value", "above 0"),
    "an efficiency above 1": ("efficiency.csv", append("11A,4,10,1.2,table 10.1"), "11A,4", "efficiency", "1"),
    "an open quote": ("weights.csv", replace("0.44", '"0.44'), None, None, ""),
}


@pytest.mark.parametrize("case", WRONG, ids=list(WRONG))
def test_a_wrong_file_stops_the_start_and_is_named_with_line_and_column(folder: Path, case: str) -> None:
    name, change, start, column, words = WRONG[case]
    path = folder / name
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")

    with pytest.raises(CatalogueError) as refusal:
        load_catalogue(folder)

    text = str(refusal.value)
    assert text.startswith(str(path))
    assert re.search(r", line \d+", text)
    if start is not None:
        assert f", line {line_of(path.read_text(encoding='utf-8'), start)}" in text
    if column is not None:
        assert column in text
        if "header" not in words:
            assert f", column {column}:" in text
    assert words in text


def test_a_missing_series_figure_is_named_with_its_file(folder: Path) -> None:
    path = folder / "series.csv"
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not line.startswith("rated_input_speed")), encoding="utf-8")

    with pytest.raises(CatalogueError, match=r"series\.csv.*column name: rated_input_speed is missing"):
        load_catalogue(folder)


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("ratings.csv", "size 11A, ratio 4"),
        ("sizes.csv", "size 11A"),
        ("weights.csv", "size 11A, stages 1"),
        ("lengths.csv", "size 11A, stages 1"),
        ("accuracy.csv", "size 11A, stages 1"),
        ("stiffness.csv", "size 11A, stages 1"),
    ],
)
def test_a_missing_row_of_a_rated_size_is_named(folder: Path, name: str, key: str) -> None:
    path = folder / name
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(line for n, line in enumerate(lines) if n != 1), encoding="utf-8")  # the first of 11A

    message = rf"ratings\.csv, line 2, column size: {name} has no row of {key}, but 11A is rated$"
    with pytest.raises(CatalogueError, match=message):
        load_catalogue(folder)


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.file)
def test_every_missing_file_is_named(folder: Path, table: type[CatalogueRow]) -> None:
    path = folder / table.file
    path.unlink()

    with pytest.raises(CatalogueError, match=f"{re.escape(str(path))}: is missing"):
        load_catalogue(folder)


def test_a_decimal_comma_that_splits_a_cell_is_named_with_its_line(folder: Path) -> None:
    path = folder / "stiffness.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("14A,1,9300", "14A,1,9,3"), encoding="utf-8")

    with pytest.raises(CatalogueError, match=r"stiffness\.csv, line 4, .*decimal comma"):
        load_catalogue(folder)


@pytest.mark.parametrize(
    ("written", "place"),
    [
        (b"14A,1,0.95,t\xe4ble", r"line 4, column source: byte 0xe4"),
        (b"14A,1,0.95\xb2,table", r"line 4, column weight_kg: byte 0xb2"),
        (b'"14A",1,"0,95",\xe4', r"line 4, column source: byte 0xe4"),
        (b"\xe4,1,0.95,table", r"line 4, column size: byte 0xe4"),
        (b"14A,1,0.95,table,,\xe4", r"line 4: byte 0xe4"),
    ],
)
def test_text_that_is_not_utf8_is_named_with_its_cell(folder: Path, written: bytes, place: str) -> None:
    path = folder / "weights.csv"
    path.write_bytes(path.read_bytes().replace(b"14A,1,0.95,table", written))

    with pytest.raises(CatalogueError, match=rf"weights\.csv, {place} is not UTF-8"):
        load_catalogue(folder)


def test_a_file_with_a_byte_order_mark_and_windows_line_ends_is_read_and_counts_as_the_same(folder: Path) -> None:
    before = load_catalogue(folder)
    path = folder / "weights.csv"
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert load_catalogue(folder).version == before.version

    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load_catalogue(folder).gears == before.gears


def test_columns_may_stand_in_another_order(folder: Path) -> None:
    path = folder / "weights.csv"
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    path.write_text("\n".join(",".join(reversed(row)) for row in rows), encoding="utf-8")

    assert load_catalogue(folder).gears == load_catalogue().gears


CURVES = {
    "no point on the radial axis": ("14A,1,900,0,\n14A,1,100,880,\n", 3, "radial axis"),
    "no point on the axial axis": ("14A,1,0,900,\n14A,1,900,10,\n", 3, "axial axis"),
    "two points in one direction": ("14A,1,0,900,\n14A,1,300,300,\n14A,1,400,400,\n14A,1,900,0,\n", 4, "star-shaped"),
    "two points on an axis": ("14A,1,0,900,\n14A,1,0,700,\n14A,1,900,0,\n", None, "star-shaped"),
    "one point": ("14A,1,0,900,\n", 2, "at least two"),
    "the origin": ("14A,1,0,900,\n14A,1,0,0,\n14A,1,900,0,\n", None, ""),
    "a negative load": ("14A,1,0,900,\n14A,1,-900,0,\n", 3, "greater than or equal to 0"),
    "a load coefficient below 1": ("14A,0.9,0,900,\n14A,0.9,900,0,\n", 2, "greater than or equal to 1"),
    "a size that is not there": ("15A,1,0,900,\n15A,1,900,0,\n", 2, "15A"),
    "a wrong curve of another load coefficient": ("14A,1.5,0,900,\n14A,1.5,900,5,\n", 3, "axial axis"),
}


@pytest.mark.parametrize("case", CURVES, ids=list(CURVES))
def test_a_curve_that_makes_no_envelope_is_refused_with_file_and_line(supplemented: Supplement, case: str) -> None:
    points, line, words = CURVES[case]

    with pytest.raises(CatalogueError) as refusal:
        supplemented(bearing_envelopes="size,load_coefficient,axial_N,radial_N,source\n" + points)

    text = str(refusal.value)
    assert re.search(r"supplement/bearing_envelopes\.csv, line \d+, column \w+:", text)
    assert line is None or f", line {line}," in text
    assert words in text


def test_an_unknown_file_in_a_supplement_is_refused_with_the_files_there_are(supplemented: Supplement) -> None:
    with pytest.raises(CatalogueError, match=r"rating\.csv: is not a table .*ratings\.csv"):
        supplemented(rating="size,ratio\n")


def test_a_supplement_that_is_no_folder_is_refused(tmp_path: Path) -> None:
    for place in (tmp_path / "nowhere", tmp_path / "file.csv"):
        if place.suffix:
            place.write_text("", encoding="utf-8")
        with pytest.raises(CatalogueError, match="is not a folder"):
            load_catalogue(supplement=place)


def test_a_wrong_figure_of_a_supplement_names_the_supplement(supplemented: Supplement) -> None:
    header = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    for row, column in (
        ("14A,5,,60,,", "rated_torque_Nm"),  # above the handbook's T_R of 50
        ("14A,5,,,20,", "momentary_peak_torque_Nm"),  # below the handbook's T_R
        ("14A,5,120,,,", "repeated_peak_torque_Nm"),  # above the handbook's T_M
        ("40A,2,120,100,200,", "ratio"),
    ):
        with pytest.raises(CatalogueError, match=rf"supplement/ratings\.csv, line 2, column {column}"):
            supplemented(ratings=header + row + "\n")


def test_the_service_does_not_start_on_a_wrong_catalogue(folder: Path) -> None:
    (folder / "weights.csv").unlink()

    with pytest.raises(CatalogueError, match=r"weights\.csv"):
        create_app(Settings(catalogue_folder=folder))
