"""Differences of replies and catalogues as a reader sees them."""

import pytest
from msgspec import structs

from hpn.account import published
from hpn.account.account import Account
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import Selection, select
from hpn.explain.changes import ReplyChange
from hpn.explain.comparison import rows_of
from hpn.explain.differences import differences
from hpn.words.reader import Reader
from tests.build import TURNING, cycle, phase
from tests.conftest import Supplement

EFFICIENCY = "size,ratio,torque_Nm,efficiency,source\n20A,5,80,0.9,\n20A,5,20,{},\n"


def changes(before: Selection, after: Selection, application: Application, catalogue: Catalogue) -> list[ReplyChange]:
    """Differences of two selections for an English reader."""
    one, other = (Account(each, each.foremost, application, catalogue) for each in (before, after))
    return [ReplyChange(each, (one, other), Reader()) for each in differences(before, after)]


def with_duty(selection: Selection, **figures: float) -> Selection:
    """A selection with other figures of its cycle."""
    return structs.replace(selection, duty=structs.replace(selection.duty, **figures))


@pytest.mark.parametrize(
    ("before", "after", "numbers"),
    [
        (40.0, 41.0, ("40", "41")),
        (40.0, 40.00001, ("40", "40.00001")),
        (1.2341e-7, 1.2342e-7, ("1.2341·10⁻⁷", "1.2342·10⁻⁷")),
    ],
)
def test_numbers_that_differ_read_differently(
    before: float, after: float, numbers: tuple[str, str], catalogue: Catalogue
) -> None:
    application = Application.model_validate(cycle(phase(40, 100)))
    selection = select(application, catalogue, lambda _: "")
    one, other = (with_duty(selection, average_torque_Nm=value) for value in (before, after))

    (change,) = changes(one, other, application, catalogue)

    assert change.row.head.named.name == "Average torque"
    assert (change.numbers, change.is_wording) == (numbers, False)


def test_lives_beyond_what_is_written_out_read_differently_beside_each_other() -> None:
    reader = Reader()
    assert reader.figure(2e8, "h") == reader.figure(3e8, "h")
    assert (reader.figure(2e8, "h", 3e8), reader.figure(3e8, "h", 2e8)) == (
        "200\u202f000\u202f000",
        "300\u202f000\u202f000",
    )


def test_a_figure_that_nothing_limited_reads_as_unlimited(catalogue: Catalogue) -> None:
    """A cycle without torque has an endless life, with torque one in hours."""
    idle, loaded = (Application.model_validate(cycle(phase(torque, 100))) for torque in (0, 40))
    before, after = (select(one, catalogue, lambda _: "") for one in (idle, loaded))

    lives = [
        each
        for each in changes(before, after, loaded, catalogue)
        if (each.difference.candidate, each.difference.field) == ("HPN-20A-5", "life_L10_h")
    ]

    assert [each.numbers[0] for each in lives] == ["unlimited"]


def test_points_of_a_curve_stand_as_they_were_supplied(supplemented: Supplement) -> None:
    sides = (supplemented(efficiency=EFFICIENCY.format(value)) for value in (0.7, 0.75))

    rows = [row for row in rows_of(*(published.whole(side, "HPN-20A-5") for side in sides)) if row.differs]

    assert [row.numbers(Reader("de")) for row in rows] == [("20 / 0,7; 80 / 0,9", "20 / 0,75; 80 / 0,9")]


def test_a_difference_in_a_phase_of_a_motion_says_which_and_what(catalogue: Catalogue) -> None:
    application = Application.model_validate({"duty_cycle": {"motion": TURNING}})
    before = select(application, catalogue, lambda _: "")
    phases = list(before.duty.phases)
    phases[3] = structs.replace(phases[3], peak_torque_Nm=99.0)
    duty = structs.replace(before.duty, phases=tuple(phases), load_inertia_kgm2=1.5)

    result = changes(before, structs.replace(before, duty=duty), application, catalogue)

    assert [(each.phase, each.row.head.named.name, each.numbers[1]) for each in result] == [
        (4, "Peak torque", "99"),
        (None, "Inertia of the load", "1.5"),
    ]
