"""The shaft's centre in fleets: a number, or an object by size as JSON in its cell, as `select` takes it."""

import io
import json
import random
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from hpn.catalogue import Catalogue
from tests.build import Json
from tests.fleet.conftest import Size
from tests.fleet.tables import CENTRE, row_of, table_of
from tests.fleet.test_equality import expected
from tests.property.draw import at_random

CENTRES: tuple[Any, ...] = (
    21,
    21.1,
    {"20A": 21.1},
    {"20A": 30, "others": 18},
    {"20A": None, "32": 30.0},
    {"others": 18},
    {},
    None,
)
NO_CENTRE = 'must be a number, such as 21, or an object by size, such as {"20A": 21, "others": 18}'


def axes(centres: Any) -> list[Json]:
    """Applications with a lever and these centres."""
    result: list[Json] = []
    chance = random.Random(7)
    for centre in centres:
        application = at_random(chance)
        load = {"radial_N": 100.0, "radial_position_mm": 45.0, "shaft_centre_mm": centre}
        result.append(application | {"output_load": application.get("output_load", {}) | load})
    return result


def in_parquet(table: pa.Table) -> bytes:
    """The table as a file."""
    content = io.BytesIO()
    pq.write_table(table, content)
    return content.getvalue()


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_every_form_of_a_centre_is_read_in_every_format(suffix: str, size: Size, catalogue: Catalogue) -> None:
    applications = axes(CENTRES * 5)
    rows = [row_of(f"a{place}", application) for place, application in enumerate(applications)]

    answers = size(rows, suffix)

    assert answers == [expected(f"a{k}", application, catalogue) for k, application in enumerate(applications)]


@pytest.mark.parametrize(
    "column",
    [
        pa.array([21.5, None, 30.0], pa.float32()),
        pa.array([21, None, 30], pa.int16()),
        pa.array(['{"20A": 21.5}', None, " 3e1 "]),
        pa.array(['{"20A": 21.5}', None, "30"]).dictionary_encode(),
        pa.array(['{"20A": 21.5}', None, "30"], pa.large_string()),
        pa.nulls(3),
    ],
    ids=lambda column: str(column.type)[:20],
)
def test_a_column_of_parquet_holds_numbers_or_json(column: pa.Array, size: Size, catalogue: Catalogue) -> None:
    values = [json.loads(cell) if isinstance(cell, str) else cell for cell in column.to_pylist()]
    applications = axes(values)
    rows = [row_of(f"a{place}", application) for place, application in enumerate(applications)]
    plain = [{name: value for name, value in row.items() if name != CENTRE} for row in rows]
    written = table_of(plain).append_column(CENTRE, column)

    answers = size(in_parquet(written), ".parquet")

    assert answers == [expected(f"a{k}", application, catalogue) for k, application in enumerate(applications)]


@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ("21 mm", NO_CENTRE),
        ("[21]", NO_CENTRE),
        ("nan", "must be a finite number"),
        ("0", "must be greater than 0"),
        ('{"20A": 21, "20A": 22}', NO_CENTRE),
        ('{"20A": 21, "20": 22}', "size 20: is given twice: 20A"),
        ('{"20A": "21"}', "size 20A: must be a JSON number, such as 9.3"),
        ('{"20A": NaN}', "size 20A: must be a finite number"),
        ('{"20A": 21', NO_CENTRE),
        ("{" * 900, NO_CENTRE),
        ('{"99A": 21}', "size 99A: the catalogue has no 99A (available: 11A, 14A, 20A, 32A, 40A, others)"),
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_wrong_cell_rejects_its_axis_by_the_column(suffix: str, cell: str, reason: str, size: Size) -> None:
    [sound] = [row_of("a", application) for application in axes([21])]
    wrong = sound | {"axis": "b", CENTRE: cell}
    if suffix == ".parquet":
        plain = table_of([{n: v for n, v in row.items() if n != CENTRE} for row in (sound, wrong)])
        answers = size(in_parquet(plain.append_column(CENTRE, pa.array(["21", cell]))), suffix)
    else:
        answers = size([sound, wrong], suffix)

    assert [row["error"] for row in answers] == [None, f"{CENTRE}: {reason}"]
