"""`hpn.size`: frames of pandas, polars and Arrow in and out, without files in between, as `hpn.select` answers each."""

import builtins
import random
from typing import Any

import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

import hpn

LIST: dict[str, list[Any]] = {
    "axis": ["lift", "gripper", "press", "twice", "other", "twice"],
    "torque_Nm": [[40.0, 32.0], [9.3], [4000.0], [1.0], [1e9], [1.0]],
    "speed_rpm": [[250.0, 500.0], [60.0], [10.0], [1.0], [1.0], [1.0]],
    "duration_s": [[0.3, 3.0], [8.0], [1.0], [1.0], [1.0], [1.0]],
    "requirements.life_h": [20000, None, None, None, None, None],
}
LONG: dict[str, list[Any]] = {
    "axis": [7, 7, 8],
    "torque_Nm": [40.0, 32.0, -9.3],
    "speed_rpm": [250.0, 500.0, 60.0],
    "duration_s": [0.3, 3.0, 8.0],
    "pause_s": [4.0, None, None],
}
MAKERS = {"pandas": pd.DataFrame, "polars": pl.DataFrame, "arrow": pa.table, "dict": dict}


def columns(frame: Any) -> dict[str, list[Any]]:
    """Columns of a frame as plain lists, with None for what pandas has in its place."""
    if isinstance(frame, dict):
        return frame
    if isinstance(frame, pd.DataFrame):
        plain = frame.astype(object).where(frame.notna(), None)
        return {str(name): plain[name].tolist() for name in plain}
    return dict(frame.to_pydict() if isinstance(frame, pa.Table) else frame.to_dict(as_series=False))


@pytest.mark.parametrize("table", [LIST, LONG], ids=["list", "long"])
@pytest.mark.parametrize("library", MAKERS)
def test_a_frame_of_any_library_comes_back_as_one_of_it_with_the_same_answers(library: str, table: Any) -> None:
    frame = MAKERS[library](table)

    answers = hpn.size(frame)

    assert type(answers) is type(frame)
    assert columns(answers) == hpn.size(table)


def test_each_answer_is_that_of_select_bit_for_bit() -> None:
    draw = random.Random(53)
    axes: dict[str, list[Any]] = {name: [] for name in ("axis", "torque_Nm", "speed_rpm", "duration_s", "pause_s")}
    for number in range(60):
        count = draw.randint(1, 4)
        axes["axis"].append(number)
        for name, most in (("torque_Nm", 300), ("speed_rpm", 900), ("duration_s", 5)):
            axes[name].append([draw.uniform(0.1, most) for _ in range(count)])
        axes["pause_s"].append(draw.choice([0.0, draw.uniform(0, 9)]))

    sized = hpn.size(pl.DataFrame(axes))

    rows = zip(*axes.values(), strict=True)
    for (axis, T, n, t, pause), answer in zip(rows, sized.iter_rows(named=True), strict=True):
        phases = [
            dict(zip(("torque_Nm", "speed_rpm", "duration_s"), one, strict=True)) for one in zip(T, n, t, strict=True)
        ]
        alone = hpn.select({"duty_cycle": {"phases": phases, "pause_s": pause}})
        best = alone.candidates[0]
        assert (answer["axis"], answer["selected"], answer["error"]) == (axis, alone.selected, None)
        assert answer["average_torque_Nm"] == alone.duty.average_torque_Nm
        if alone.selected:
            assert (answer["utilisation"], answer["life_L10_h"]) == (best.utilisation, best.life_L10_h)
            assert answer["governing_check"] == best.governing_check


def test_faults_and_candidates_come_as_they_are_asked_for() -> None:
    answers = hpn.size(LIST)
    rejected, candidates = hpn.size(LIST, give="rejected"), hpn.size(pd.DataFrame(LIST), give="candidates")

    assert answers["axis"] == ["lift", "gripper", "press", "twice", "other"]
    assert [error is None for error in answers["error"]] == [True, True, True, False, False]
    assert answers["selected"][2] is None
    assert rejected["axis"] == ["twice", "other"]
    assert rejected["code"] == ["repeated", "less_than_equal"]
    assert candidates.groupby("axis").size().to_dict() == {"gripper": 64, "lift": 64, "press": 64}


def test_whole_numbers_of_pandas_stay_whole_beside_gaps_and_its_index_is_no_column() -> None:
    frame = pd.DataFrame(LIST, index=[f"row {number}" for number in range(6)])

    answers = hpn.size(frame)

    assert answers["suitable"].tolist()[:2] == hpn.size(LIST)["suitable"][:2]
    assert answers["suitable"].dtype == "Int64"


def test_a_stream_of_arrow_is_answered_by_a_table_and_nothing_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    table = pa.table(LONG)
    hpn.size(table)

    def refuse(*path: object, **_: object) -> None:
        raise AssertionError(f"opens {path}")

    for place, name in ((pa, "OSFile"), (builtins, "open")):
        monkeypatch.setattr(place, name, refuse)
    answers = hpn.size(pa.RecordBatchReader.from_batches(table.schema, table.to_batches()))

    assert answers.equals(hpn.size(table))


def test_no_rows_are_no_answers() -> None:
    empty = pa.table(LIST).slice(0, 0)

    assert hpn.size(empty).num_rows == 0
    assert hpn.size(empty).schema == hpn.size(pa.table(LIST)).schema


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ({"axis": [1]}, "frame: column torque_Nm is missing"),
        (LONG | {"torque": [1, 1, 1]}, "frame: column 'torque' is unknown; it looks like torque_Nm"),
        (LONG | {"torque_Nm": ["a", "b", "c"]}, "frame: column torque_Nm is string, where numbers belong"),
        (LONG | {"pause_s": [1]}, "can’t be read as a table"),
        (LONG | {"pause_s": [1, "x", {}]}, "can’t be read as a table"),
        (pd.DataFrame(LONG | {"torque_Nm": [[1.0], 2.0, 3.0]}), "as a table: cannot mix list and non-list"),
        (pl.DataFrame(LONG).lazy(), "LazyFrame can’t be read as a table"),
        *((other, "can’t be read as a table") for other in (7, None, "axes.csv", [LONG])),
    ],
)
def test_a_frame_that_cannot_be_used_is_a_sentence(frame: Any, words: str) -> None:
    with pytest.raises(hpn.ApplicationError) as caught:
        hpn.size(frame)
    assert words in str(caught.value)


def test_a_column_may_be_left_out_and_a_kind_that_there_is_none_of_is_refused() -> None:
    assert hpn.size(LONG | {"colour": ["a", "b", "c"]}, ignore=["colour"], workers=1) == hpn.size(LONG)
    with pytest.raises(hpn.ApplicationError, match="give: must be answers, candidates or rejected"):
        hpn.size(LONG, give="everything")  # type: ignore[call-overload]
