"""A pasted table says what it said in the spreadsheet, or asks; it is never silently something else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hpn.application import DutyCycle, Phase
from hpn.web.form.pasted import Decimal, Reading, read_table, write_table

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False).map(lambda value: round(value, 4))
PHASES = st.builds(
    Phase,
    torque_Nm=NUMBERS,
    speed_rpm=st.floats(1, 1e4).map(lambda value: round(value, 3)),
    duration_s=st.floats(0.001, 1e4).map(lambda value: round(value, 3)),
    radial_N=st.none() | NUMBERS,
    axial_N=st.none() | NUMBERS,
)
CYCLES = st.lists(PHASES, min_size=1, max_size=8).map(lambda phases: DutyCycle(phases=tuple(phases)))


@given(CYCLES, st.sampled_from([".", ","]))
def test_a_written_table_is_among_the_readings_and_alone_unless_it_is_ambiguous(
    cycle: DutyCycle, decimal: Decimal
) -> None:
    pasted = read_table(write_table(cycle, decimal))
    read = [_cycle(reading) for reading in pasted.readings]
    assert [(p.torque_Nm, p.speed_rpm, p.duration_s, p.radial_N, p.axial_N) for p in cycle.phases] in read
    if len(read) > 1:  # only a mark before exactly three digits can be grouping as well
        assert any(
            len(str(value).split(".")[-1]) == 3 for row in read[0] + read[1] for value in row if value is not None
        )


def _cycle(reading: Reading) -> list[tuple[float | None, ...]]:
    order = ["T", "n", "t", "FRi", "FAi"]
    rows = []
    for row in reading.rows:
        values = dict(zip(reading.columns, row, strict=True))
        rows.append(tuple(float(values[name]) if values.get(name) else None for name in order))
    return rows


@given(st.text(max_size=200))
def test_any_text_is_read_or_refused_with_a_reason(text: str) -> None:
    pasted = read_table(text)
    assert bool(pasted.readings) != (pasted.problem is not None)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("9,3\t250\t0,3", [("9.3", "250", "0.3")]),
        ("1.234,5\t250\t9,3", [("1234.5", "250", "9.3")]),
        ("40,250,0.3", [("40", "250", "0.3")]),
        ("Drehmoment [Nm];Drehzahl [1/min];Dauer [s]\n9,3;1.500;0,25", [("9.3", "1500", "0.25")]),
        ("1\u202f234,5;250;1", [("1234.5", "250", "1")]),
        ("\N{MINUS SIGN}5,5\t250\t1", [("-5.5", "250", "1")]),
    ],
)
def test_what_has_one_reading_is_read_so(text: str, values: list[tuple[str, ...]]) -> None:
    pasted = read_table(text)
    assert [list(reading.rows) for reading in pasted.readings] == [values]


@pytest.mark.parametrize("text", ["1.234;5;6", "1,234\t5\t6", "1.234\t2.345\t1"])
def test_what_has_two_readings_is_asked(text: str) -> None:
    assert len(read_table(text).readings) == 2


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("", "nothing"),
        ("T\tn\tt", "no row"),
        ("40\t250", "2 cells"),
        ("40\tx1\t3", "x1 is not a number"),
        ("1\t2\te6", "e6 is not a number"),
        ("1,5\t2.5\t3", "different ways"),
        ("Torque (lb·in)\tSpeed\tDuration\n1\t2\t3", "lb·in"),
        ("T [Nm];n [rpm];t [ms]\n1;2;3", "ms"),
        ("1;2;3\n" * 10_002, "more than"),
    ],
)
def test_what_has_no_reading_says_why(text: str, part: str) -> None:
    problem = read_table(text).problem
    assert problem is not None
    assert part in problem.text
