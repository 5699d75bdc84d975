"""A fleet in a page and a report: counts over all axes, and the answer of `select` for each of the first ones."""

import random
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.selection import Selection, select
from hpn.fleet.listing import AxisRow, Listing, applications_of, listing_of, rows_of
from hpn.fleet.order import Order
from hpn.fleet.outcome import answer_fields
from hpn.fleet.run import size_fleet
from hpn.fleet.summary import summary_of
from hpn.links.writer import to_link
from tests.build import Json, cycle, phase
from tests.conftest import Supplement
from tests.fleet.tables import FAULTS, Row, in_long_form, row_of, spoiled, write
from tests.property.draw import at_random

AXES = 160


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    return load_catalogue()


@pytest.fixture(scope="module")
def fleet() -> tuple[list[Row], dict[str, Json]]:
    """Rows of random axes, some of them spoiled or refused, and the applications of the rest."""
    chance = random.Random(1717)
    rows, applications = [], {}
    for number in range(AXES):
        axis, application = str(number + 1), at_random(chance, ("linear", "iso281"))
        row = row_of(axis, application)
        if number % 10 == 3:
            row = spoiled(row, chance.choice(list(FAULTS)))
        else:
            applications[axis] = application
        rows.append(row)
    return rows, applications


def sized(rows: list[Row], suffix: str, form: str, folder: Path, catalogue: Catalogue) -> Listing:
    """Listing of rows that were written, sized in this process and read again."""
    rows = in_long_form(rows) if form == "long" else rows
    order = Order(write(folder / f"axes{suffix}", rows, unit_rows=40), folder / f"answers{suffix}")
    listings = list[Listing]()
    size_fleet(order, catalogue, use=lambda answers: listings.append(listing_of(order, answers, catalogue)))
    return listings[0]


@pytest.mark.parametrize(("suffix", "form"), [(".csv", "long"), (".parquet", "list"), (".arrow", "long")])
def test_rows_and_counts_say_what_select_says(
    suffix: str, form: str, fleet: tuple[list[Row], dict[str, Json]], catalogue: Catalogue, tmp_path: Path
) -> None:
    rows, applications = fleet
    replies: dict[str, Selection] = {}
    for axis, application in applications.items():
        with suppress(InputError):
            replies[axis] = select(Application.model_validate(application), catalogue)

    listing = sized(rows, suffix, form, tmp_path, catalogue)

    view = rows_of(listing.answers)
    assert [row.axis for row in view] == [row["axis"] for row in rows]
    assert {row.axis for row in view if row.state != "rejected"} == replies.keys()
    for row in view:
        assert bool(row.reasons) == (row.state == "rejected")
        if row.state != "rejected":
            assert_same(row, replies[row.axis])
    best = [reply.candidates[0] for reply in replies.values() if reply.selected]
    summary = listing.summary
    assert (summary.axes, summary.rejected) == (AXES, AXES - len(replies))
    assert (summary.selected, summary.unsuitable) == (len(best), len(replies) - len(best))
    assert dict(summary.gears) == Counter(one.designation for one in best)
    assert dict(summary.checks) == Counter(one.governing_check for one in best)
    used = [one.utilisation or 0 for one in best]
    assert list(summary.utilisation) == [
        sum((tenth == 0 and share == 0) or tenth / 10 < share <= (tenth + 1) / 10 for share in used)
        for tenth in range(10)
    ]


def assert_same(row: AxisRow, reply: Selection) -> None:
    """Shown is the selected gear, or the one that the page of the selection shows first where none suits."""
    first = reply.foremost
    assert (row.state == "selected") == (reply.selected is not None)
    assert (row.gear, row.utilisation) == (first.designation, first.utilisation)
    if first.status != "unrated":
        assert row.governing_check == first.governing_check


def test_listed_axes_are_the_applications_that_were_given(
    fleet: tuple[list[Row], dict[str, Json]], catalogue: Catalogue, tmp_path: Path
) -> None:
    rows, applications = fleet

    listing = sized(rows, ".arrow", "list", tmp_path, catalogue)

    result = dict(applications_of(listing.axes))
    assert len(result) == AXES - listing.summary.rejected
    for axis, application in result.items():
        assert to_link(application) == to_link(Application.model_validate(applications[axis]))


def test_a_fleet_without_a_gear_for_any_axis_has_counts_too(catalogue: Catalogue, tmp_path: Path) -> None:
    heavy = {"torque_Nm": [90_000.0], "speed_rpm": [10.0], "duration_s": [1.0]}
    rows: list[Row] = [{"axis": "lift", **heavy}, {"axis": "belt", **heavy, "speed_rpm": [0.0]}]

    listing = sized(rows, ".parquet", "list", tmp_path, catalogue)

    summary = listing.summary
    assert (summary.axes, summary.unsuitable, summary.rejected) == (2, 1, 1)
    assert summary.gears == () and sum(summary.utilisation) == 0
    assert [row.state for row in rows_of(listing.answers)] == ["unsuitable", "rejected"]


def test_a_share_that_is_a_whole_tenth_counts_in_the_tenth_that_ends_there() -> None:
    columns: dict[str, Any] = {field.name: pa.nulls(12, field.type) for field in answer_fields(pa.string())}
    columns["suitable"] = pa.array([1] * 12)
    columns["utilisation"] = pa.array([0.0, *(tenth / 10 for tenth in range(1, 11)), None])

    assert summary_of(pa.table(columns).to_batches()).utilisation == (2, 1, 1, 1, 1, 1, 1, 1, 1, 1)


def test_the_nearest_gear_is_that_with_the_motor_that_an_axis_names(supplemented: Supplement, tmp_path: Path) -> None:
    catalogue = supplemented(
        motors="designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
        "small,100,,0.1,0.1,,s\n"
    )
    application = cycle(phase(40, 250, 1), requirements={"motor": {"designation": "small"}})

    listing = sized([row_of("a", application)], ".parquet", "list", tmp_path, catalogue)

    (row,) = rows_of(listing.answers)
    assert row.governing_check == "motor_speed"
    assert_same(row, select(Application.model_validate(application), catalogue))
