"""Broken rows: each is rejected with its reason, in time that grows with their number alone, up to a stated bound."""

import time
from pathlib import Path

import pytest

from hpn.fleet.csv_tables import MOST_BROKEN
from hpn.fleet.order import FleetError
from tests.fleet.conftest import Size
from tests.fleet.tables import read

HEAD, SOUND, BROKEN, LACKING = "axis,torque_Nm,speed_rpm,duration_s\n", '@,"[1]","[100]","[1]"\n', "@\n", ",,,\n"
MOST_TIMES = 10
"""Processor time for 100,000 broken rows by that for as many sound ones: about 4, and above 20 cell by cell."""


def test_every_broken_row_is_told_in_its_place_however_many_there_are(size: Size, tmp_path: Path) -> None:
    kinds = (SOUND, BROKEN, SOUND, LACKING, SOUND, SOUND, SOUND)
    count = 50_000  # some batches and slices, none of whose ends falls on a like row
    lines = [kinds[row % len(kinds)].replace("@", f"a{row}") for row in range(count)]

    answers = size("".join([HEAD, SOUND, *lines]), ".csv")

    rejected = read(tmp_path / "rejected.parquet")
    assert len(answers) == count + 1
    for row, answer in enumerate(answers[1:]):
        kind = kinds[row % len(kinds)]
        assert (answer["error"] is None) == (kind is SOUND)
        if kind is SOUND:
            assert answer["axis"] == f"a{row}"
    lacking = sum(kinds[row % len(kinds)] is LACKING for row in range(count))
    broken = sum(kinds[row % len(kinds)] is BROKEN for row in range(count))
    assert len(rejected) == 4 * lacking + broken  # axis, torque, speed and duration are required


@pytest.fixture
def sound_s(size: Size, tmp_path: Path) -> float:
    """Processor time for 100,000 sound rows in s, in the same run."""
    start = time.process_time()
    size(HEAD + "".join(SOUND.replace("@", str(row)) for row in range(100_000)), ".csv")
    taken = time.process_time() - start
    (tmp_path / "out.csv").unlink()
    return taken


def test_rows_that_lack_everything_take_time_by_their_number_alone(size: Size, sound_s: float) -> None:
    start = time.process_time()

    answers = size(HEAD + SOUND + 100_000 * LACKING, ".csv")

    assert time.process_time() - start < MOST_TIMES * sound_s
    assert sum(answer["error"] is not None for answer in answers) == 100_000


def test_a_file_of_which_hardly_a_line_is_a_row_ends_the_run_with_a_sentence(
    size: Size, sound_s: float, tmp_path: Path
) -> None:
    head = HEAD + SOUND
    start = time.process_time()

    with pytest.raises(FleetError, match=rf"in.csv: more than {MOST_BROKEN} lines .* the first of them is x1; mend"):
        size(head + "x1\n" + 2_000_000 * "x\n", ".csv")

    assert time.process_time() - start < 2 * MOST_TIMES * sound_s
    assert not (tmp_path / "out.csv").exists()


def test_as_many_broken_lines_as_are_taken_are_all_told(size: Size, tmp_path: Path) -> None:
    head = HEAD + SOUND

    size(head + MOST_BROKEN * "x\n", ".csv")

    assert len(read(tmp_path / "rejected.parquet")) == MOST_BROKEN
