"""Broken tables: each is sized or refused by its name, and nothing else happens."""

import random
from pathlib import Path

import numpy as np
import pytest

from hpn.catalogue import Catalogue
from hpn.fleet import axes, outcome
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from tests.fleet.tables import in_long_form, read, row_of, write
from tests.fuzz.mutation import mutated
from tests.property.draw import at_random

WORDS = [b"torque_Nm", b"axis", b"null", b"NaN", b"[", b"]", b'"', b",", b"\n", b"{", b"}", b":", b"1e999", b"\\u0000"]


@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_a_broken_table_is_sized_or_refused(
    suffix: str, form: str, tmp_path: Path, catalogue: Catalogue, soak: bool
) -> None:
    rows = [row_of(f"a{seed}", at_random(random.Random(seed))) for seed in range(12)]
    path = write(tmp_path / f"in{suffix}", in_long_form(rows) if form == "long" else rows, unit_rows=20)
    corpus, outcomes = [path.read_bytes()], set()
    for seed in range(5000 if soak else 40):
        path.write_bytes(mutated(random.Random(seed), corpus, WORDS) or b"\n")
        order = Order(path, tmp_path / "out.parquet", rejected=tmp_path / "rejected.csv")
        try:
            size_fleet(order, catalogue)
            outcomes.add("sized")
        except FleetError as error:
            assert path.name in str(error), seed
            outcomes.add("refused")
    assert outcomes == {"sized", "refused"} or suffix in (".parquet", ".arrow")


def test_axis_that_only_the_rules_for_columns_refuse_is_rejected_and_ends_no_fleet(
    tmp_path: Path, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(axes, "_have_sound_lists", lambda table: np.arange(table.num_rows) > 0)
    path = write(tmp_path / "in.parquet", [row_of(f"a{seed}", at_random(random.Random(seed))) for seed in range(2)])
    size_fleet(Order(path, tmp_path / "out.parquet"), catalogue)
    refused, sized = read(tmp_path / "out.parquet")
    assert refused["error"] == f"axis: {outcome.DISAGREED.text}"
    assert sized["error"] is None
