"""Files of the catalogue and of a supplement that can't be read: each stops the start, named, in words, and at once."""

import os
import re
import socket
import tempfile
from collections.abc import Callable
from pathlib import Path

import orjson
import pytest

from hpn.catalogue import HANDBOOK_FOLDER, Catalogue, CatalogueError, load_catalogue
from hpn.cli import main
from tests.build import worked_example
from tests.reliability.faults import as_user

RATINGS = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
CURVE = "size,load_coefficient,axial_N,radial_N,source\n"
ROW = "20A,5,,82,,mine\n"
WINDOWS = (RATINGS + "20A,5,,82,,Prüfung\n").encode("cp1252")


def text(content: str | bytes, name: str = "ratings.csv") -> Callable[[Path], None]:
    """Write a file of the supplement."""
    return lambda folder: void((folder / name).write_bytes(content if isinstance(content, bytes) else content.encode()))


def void(result: object) -> None:
    """Nothing, whatever a call returns."""


def endless(folder: Path) -> None:
    with (folder / "ratings.csv").open("wb") as file:
        file.truncate(1 << 40)  # takes no room


def listening(folder: Path) -> None:
    os.chdir(folder)  # the address of a socket is short
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("ratings.csv")


def out_of_the_folder(folder: Path) -> None:
    outside = folder.parent / "elsewhere.csv"
    outside.write_text(RATINGS + ROW, encoding="utf-8")
    (folder / "ratings.csv").symlink_to(outside)


def to_itself(folder: Path) -> None:
    (folder / "ratings.csv").symlink_to("ratings.csv")


# Change to the supplement; file, line and column that the message begins with; words of the message.
WRONG: dict[str, tuple[Callable[[Path], None], str, str]] = {
    "a dangling link": (
        lambda folder: (folder / "ratings.csv").symlink_to("none.csv"),
        "ratings.csv",
        "link that leads nowhere",
    ),
    "a link to itself": (to_itself, "ratings.csv", "can’t be read"),
    "a link out of the folder": (out_of_the_folder, "ratings.csv", "link out of its folder, to .*elsewhere.csv"),
    "a link to an endless device": (
        lambda folder: (folder / "ratings.csv").symlink_to("/dev/zero"),
        "ratings.csv",
        "link out of its folder, to /dev/zero",
    ),
    "a capital letter": (text(RATINGS + ROW, "Ratings.csv"), "Ratings.csv", "its name is ratings.csv, in small"),
    "capital letters at the end": (text(RATINGS + ROW, "ratings.CSV"), "ratings.CSV", "its name is ratings.csv"),
    "a name that is none": (text(RATINGS + ROW, "rating.csv"), "rating.csv", "there are .*ratings.csv"),
    "a hidden second ending": (text(RATINGS + ROW, "ratings.csv.txt"), "ratings.csv.txt", "there are .*ratings.csv"),
    "a workbook": (text(b"PK\x03\x04", "ratings.xlsx"), "ratings.xlsx", "there are .*ratings.csv"),
    "a folder": (lambda folder: (folder / "ratings.csv").mkdir(), "ratings.csv", "is a folder, where a file belongs"),
    "a pipe": (lambda folder: os.mkfifo(folder / "ratings.csv"), "ratings.csv", "is a pipe, where a file belongs"),
    "a socket": (listening, "ratings.csv", "is a socket, where a file belongs"),
    "an endless file": (endless, "ratings.csv", "is larger than 4000000 bytes"),
    "nothing": (text(""), "ratings.csv, line 1", "the header must have the columns"),
    "a header alone": (text(RATINGS), "ratings.csv, line 1", "no row below it"),
    "NUL": (text(RATINGS + "20A,5,,82,,mi\x00ne\n"), "ratings.csv, line 2, column source", r"U\+0000 does not belong"),
    "NUL in a key": (text(RATINGS + "20A\x00,5,,82,,mine\n"), "ratings.csv, line 2, column size", r"U\+0000"),
    "a mark that turns text": (text(RATINGS + "20A,5,,82,,mi‮ne\n"), "ratings.csv, line 2, column source", "202E"),
    "two byte order marks": (text("\ufeff\ufeff" + RATINGS + ROW), "ratings.csv, line 1", r"U\+FEFF"),
    "UTF-16": (text((RATINGS + ROW).encode("utf-16")), "ratings.csv, line 1", "is not UTF-8 text; save the file as"),
    "UTF-16 without mark": (text((RATINGS + ROW).encode("utf-16-le")), "ratings.csv, line 1", r"U\+0000 .*save"),
    "UTF-32": (text((RATINGS + ROW).encode("utf-32")), "ratings.csv, line 1", "save the file as UTF-8"),
    "Windows-1252": (text(WINDOWS), "ratings.csv, line 2, column source", "0xfc"),
    "a wrong byte after a long line": (text(b"a" * 200_000 + b"\xff"), "ratings.csv, line 1", "byte 0xff is not UTF-8"),
    "a wrong byte after a mark": (text(b"\xef\xbb\xbfsize\xff"), "ratings.csv, line 1", "byte 0xff is not UTF-8"),
    "an open quote": (text(RATINGS + '20A,5,,82,,"mine\n'), "ratings.csv, line 2", "quote is opened and not closed"),
    "columns without end": (text("a," * 200_000), "ratings.csv, line 1", "the header must have the columns"),
    "cells without end": (text(RATINGS + "," * 1_000_000), "ratings.csv, line 2, column source", "1000001 cells"),
    "a long cell": (text(RATINGS + f"20A,5,,82,,{'m' * 1001}\n"), "ratings.csv, line 2, column source", "1000 char"),
    "a very long cell": (text(RATINGS + f"20A,5,,82,,{'m' * 200_000}\n"), "ratings.csv, line 2", "field larger than"),
    "a number without end": (text(RATINGS + f"20A,5,,{'8' * 900},,\n"), "ratings.csv, line 2, column rated", ""),
    "rows without end": (
        text(RATINGS + "".join(f"20A,{ratio},,82,,mine\n" for ratio in range(1, 100_000))),
        "ratings.csv, line 1002",
        "more than 1000 rows",
    ),
    "points without end": (
        text(CURVE + "".join(f"14A,1,0,{n},mine\n" for n in range(100_000)), "bearing_envelopes.csv"),
        "bearing_envelopes.csv, line 10002",
        "more than 10000 rows",
    ),
}


@pytest.fixture
def application(tmp_path: Path) -> str:
    path = tmp_path / "application.json"
    path.write_bytes(orjson.dumps(worked_example()))
    return str(path)


@pytest.mark.parametrize("case", WRONG, ids=list(WRONG))
def test_a_file_that_cannot_be_used_stops_every_command_with_its_name(
    case: str, application: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write, place, words = WRONG[case]
    folder = tmp_path / "supplement"
    folder.mkdir()
    monkeypatch.chdir(tmp_path)
    write(folder)
    monkeypatch.setenv("HPN_CATALOGUE_SUPPLEMENT", str(folder))

    for command in (["serve", "--port", "0"], ["select", application]):
        assert main(command) == 2
        out, error = capsys.readouterr()
        assert out == ""
        assert error.startswith(f"{folder}/{place}")
        assert re.search(words, error)
        assert error.count("\n") == 1 and len(error) < 1000


def test_a_device_in_the_place_of_a_file_is_refused_without_reading_it(folder: Path) -> None:
    (folder / "weights.csv").unlink()
    try:
        os.mknod(folder / "weights.csv", 0o600 | 0o020000, os.makedev(1, 5))  # /dev/zero
    except PermissionError:
        pytest.skip("needs the right to make devices")

    with pytest.raises(CatalogueError, match=r"weights\.csv: is a device, where a file belongs"):
        load_catalogue(folder)


@pytest.mark.parametrize("closed", ["", "ratings.csv"])
def test_a_folder_or_a_file_that_permissions_close_is_named(closed: str) -> None:
    with tempfile.TemporaryDirectory(dir="/tmp") as name:  # pytest's own folder is closed to others as well
        folder = Path(name)
        folder.chmod(0o755)
        (folder / "ratings.csv").write_text(RATINGS + ROW, encoding="utf-8")
        load_catalogue(supplement=folder)
        (folder / closed).chmod(0)

        with as_user(65534), pytest.raises(CatalogueError) as refusal:
            load_catalogue(supplement=folder)

        folder.chmod(0o755)
    assert str(refusal.value) == f"{folder / closed}: can’t be read: Permission denied"


def test_links_inside_the_folder_and_files_that_are_no_tables_are_let_be(tmp_path: Path) -> None:
    """As Kubernetes mounts a ConfigMap; the folder may itself be a link."""
    (tmp_path / "..2026").mkdir()
    (tmp_path / "..2026" / "ratings.csv").write_text(RATINGS + ROW, encoding="utf-8")
    (tmp_path / "..data").symlink_to("..2026")
    (tmp_path / "ratings.csv").symlink_to("..data/ratings.csv")
    (tmp_path / "README.md").write_text("From the test bench.", encoding="utf-8")
    (tmp_path / "ratings.csv~").write_text("of an editor", encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path)

    assert load_catalogue(supplement=tmp_path / "link").by_designation["HPN-20A-5"].rated_torque_Nm == 82


@pytest.mark.parametrize("names", [(), ("README.md", "ratings.csv~")])
def test_a_supplement_without_a_table_is_named(names: tuple[str, ...], tmp_path: Path) -> None:
    """A folder that is named is meant to count: a wrong one, or one that was not mounted, must not pass in silence."""
    for name in names:
        (tmp_path / name).write_text(RATINGS + ROW, encoding="utf-8")
    with pytest.raises(CatalogueError, match=f"^{tmp_path}: has no table of the catalogue; there are accuracy.csv, "):
        load_catalogue(supplement=tmp_path)


def test_a_catalogue_folder_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(CatalogueError, match="nowhere: is not a folder"):
        load_catalogue(tmp_path / "nowhere")


def test_a_table_of_the_catalogue_needs_rows_unless_the_handbook_prints_none(folder: Path) -> None:
    assert load_catalogue(folder).version == load_catalogue(HANDBOOK_FOLDER).version  # curves have none as shipped
    path = folder / "flange_bolts.csv"
    path.write_text(path.read_text(encoding="utf-8").splitlines()[0], encoding="utf-8")

    with pytest.raises(CatalogueError, match=r"flange_bolts\.csv, line 1: there is a header, but no row below it"):
        load_catalogue(folder)


def test_numbers_of_stages_stand_where_they_are_printed(catalogue: Catalogue) -> None:
    """The heads of the rating tables print them; table 9.1 lists ratios alone, and of HPN-40A nothing more is there."""
    printed = {"11A": "table 10.1, page 10", "14A": "table 10.2, page 10", "20A": "table 12.1, page 12"}
    printed |= {"32A": "table 12.2, page 12", "40A": "table 9.1, page 9"}
    assert {(gear.size, gear.sources["stages"]) for gear in catalogue.gears} == set(printed.items())
    [message] = {gear.note for gear in catalogue.gears if gear.size == "40A"}
    assert message and "stages are taken to be those of the other sizes" in message
