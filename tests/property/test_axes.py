"""A duty cycle is a table of one axis: what the one reading makes of its numbers, the other makes as well."""

import re
from dataclasses import replace
from decimal import Decimal

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.axes import read_axes
from hpn.tables.columns import Choices
from hpn.tables.cycles import read_text
from hpn.tables.sheets import grids_of
from tests.property.test_pasted import LOCALES, WRITINGS, Writing, numbers, written

PARTED = WRITINGS.filter(lambda how: how.separator in "\t;,").map(
    lambda how: replace(how, headings=max(how.headings, 0), last="none", turned=False, above=0, marked=False)
)


def with_axis(text: str, how: Writing) -> str:
    """A table with a first column that names one axis."""
    name, *rest = text.splitlines()
    before = ["", *["A"] * len(rest)] if how.place_of_units == "row" else ["A"] * len(rest)
    return "\n".join(
        f"{axis}{how.separator}{line}" for axis, line in zip(["Axis", *before], [name, *rest], strict=False)
    )


@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=5), PARTED, st.sampled_from([True, False]))
def test_a_cycle_and_the_same_rows_as_an_axis_are_the_same_numbers(
    rows: list[tuple[Decimal, ...]], how: Writing, assumed: bool
) -> None:
    text, _ = written(rows, how)
    choices = Choices(decimal=LOCALES[how.locale][0], times="ends" if how.instants else "durations", last="phase")
    units = ("Nm", "rpm", "s") if assumed else ()
    cycle = read_text(text, choices, units)
    table = read_axes(grids_of(with_axis(text, how))[0], AXIS_INPUTS, choices, units)
    assume(cycle.whole)

    assert table.whole, [question.text for question in table.questions]
    (axis,) = table.axes
    assert [axis["torque_Nm"], axis["speed_rpm"], axis["duration_s"]] == [
        [float(phase[k]) for phase in cycle.phases] for k in range(3)
    ]


@given(st.text("0123456789.,-e Nmkrads%\u202f'/:[]TntDauer\t;\n", max_size=120))
def test_any_table_of_axes_is_read_or_asked_about_or_refused_with_a_reason(text: str) -> None:
    text = f"Axis;T;n;t\n{re.sub('^', 'A;', text, flags=re.MULTILINE)}"
    table = read_axes(grids_of(text)[0], AXIS_INPUTS)
    assert (table.problem is not None) + bool(table.questions) + table.whole == 1


@pytest.mark.parametrize("digits", ["1.234567890123", "0.1234567890123", "99999999999.99"])
def test_a_figure_of_an_axis_keeps_every_digit(digits: str) -> None:
    table = read_axes(grids_of(f"Axis;T [Nm];n [rpm];t [s]\nA;{digits};9.5;2.5")[0], AXIS_INPUTS, Choices(decimal="."))
    assert table.axes[0]["torque_Nm"] == [float(digits)]
