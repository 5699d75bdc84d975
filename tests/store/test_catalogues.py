"""The catalogue that selections were saved under is kept with them, once, and comes back as it was."""

import asyncio
import dataclasses
from multiprocessing.context import ForkServerContext
from multiprocessing.synchronize import Barrier
from typing import Any

import numpy as np
import orjson
import pytest
from sqlalchemy import event, text

from hpn.catalogue import Catalogue, load_catalogue
from hpn.catalogue.copy import FORMAT, UnreadableCopyError, copy_of, read_copy
from hpn.store import Draft, Store
from tests.conftest import Supplement
from tests.store.drafts import change, draft

pytestmark = pytest.mark.anyio

SUPPLEMENT = {
    "weights": "size,stages,weight_kg,source\n20A,1,2.6000000000000001,scales\n",
    "ratings": "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    "40A,5,,400,,ä 'x'\n",
    "bearing_envelopes": "size,load_coefficient,axial_N,radial_N,source\n"
    "20A,1,0,900.1,graph\n20A,1,300.3,700,graph\n20A,1,800,0,graph\n",
    "efficiency": "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.9,graph\n20A,5,40,0.95,graph\n",
}


def plain(value: Any) -> Any:
    """A catalogue as plain values, with the type of every array."""
    if isinstance(value, np.ndarray):
        return (str(value.dtype), value.tolist())
    if dataclasses.is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return tuple(map(plain, value)) if isinstance(value, tuple) else value


async def copies(store: Store) -> int:
    """Number of catalogues in the database."""
    async with store._engine.connect() as connection:
        return int((await connection.execute(text("SELECT count(*) FROM catalogues"))).scalar_one())


def under(catalogue: Catalogue, **parts: Any) -> Draft:
    """A draft under a catalogue."""
    return draft(catalogue=catalogue, catalogue_version=catalogue.version, **parts)


def test_a_copy_gives_the_catalogue_exactly(catalogue: Catalogue, supplemented: Supplement) -> None:
    rich = supplemented(**SUPPLEMENT)
    assert rich.curves and rich.efficiency and rich.supplement

    for one in (catalogue, rich):
        again = read_copy(copy_of(one))
        assert plain(again) == plain(one)
        assert again.gears == one.gears
        assert [type(f.value) for f in again.series.values()] == [type(f.value) for f in one.series.values()]
        assert copy_of(again) == copy_of(one)


def test_every_way_to_use_a_catalogue_leaves_its_copy_the_same(catalogue: Catalogue) -> None:
    used = load_catalogue()
    assert used.find("HPN-20A-5") and used.restricted(("20A",), None) and used.sizes and used.bearing_reference

    assert copy_of(used) == copy_of(catalogue)


def test_fields_of_this_format_stay_as_they_are(catalogue: Catalogue) -> None:
    """A field that is renamed or dropped needs another FORMAT, and a way for the copies that are kept."""
    document = orjson.loads(copy_of(catalogue))

    assert (document["format"], FORMAT) == (1, 1)
    assert set(document["catalogue"]) >= {"version", "gears", "series", "curves", "efficiency", "supplement"}
    assert set(document["catalogue"]["gears"][0]) >= {
        *("designation", "size", "ratio", "stages", "sources", "note", "clamp_bolts", "housing_bolts"),
        *("repeated_peak_torque_Nm", "rated_torque_Nm", "momentary_peak_torque_Nm", "weight_kg"),
        *("maximum_input_speed_rpm", "average_input_speed_rpm", "backlash_arcmin", "transmission_accuracy_arcmin"),
        *("ambient_temperature_minimum_degC", "ambient_temperature_maximum_degC", "torsional_stiffness_Nm_per_rad"),
        *("length_min_mm", "length_max_mm", "dynamic_radial_load_N", "dynamic_axial_load_N"),
    }


def test_a_figure_that_a_version_did_not_know_yet_is_not_published_in_its_copy(catalogue: Catalogue) -> None:
    document = orjson.loads(copy_of(catalogue))
    for gear in document["catalogue"]["gears"]:
        del gear["torsional_stiffness_Nm_per_rad"]
        gear["colour"] = "grey"  # of a version that knew more

    again = read_copy(orjson.dumps(document))

    assert {gear.torsional_stiffness_Nm_per_rad for gear in again.gears} == {None}
    assert [gear.weight_kg for gear in again.gears] == [gear.weight_kg for gear in catalogue.gears]


def _spoilt(catalogue: Catalogue) -> dict[str, bytes]:
    whole = orjson.loads(copy_of(catalogue))
    parts = whole["catalogue"]
    return {
        "other format": orjson.dumps(whole | {"format": 2}),
        "field missing": orjson.dumps(whole | {"catalogue": {k: v for k, v in parts.items() if k != "series"}}),
        "wrong type": orjson.dumps(whole | {"catalogue": parts | {"gears": [{"designation": 5}]}}),
        "no array": orjson.dumps(whole | {"catalogue": parts | {"curves": {"20A": {"radial_N": "x", "axial_N": []}}}}),
        "no head": orjson.dumps(parts),
        "not JSON": b"\xff\x00",
        "empty": b"",
    }


def test_a_copy_that_cannot_be_read_says_so(catalogue: Catalogue) -> None:
    for name, content in _spoilt(catalogue).items():
        with pytest.raises(UnreadableCopyError, match="the copy of the catalogue"):
            pytest.fail(f"{name}: {read_copy(content)}")


async def test_the_catalogue_is_written_once_for_each_version(
    store: Store, catalogue: Catalogue, supplemented: Supplement
) -> None:
    other = supplemented(**SUPPLEMENT)
    statements: list[str] = []
    event.listen(store._engine.sync_engine, "before_cursor_execute", lambda *args: statements.append(args[2]))

    for book in (catalogue, catalogue, other, catalogue, other):
        await store.save(under(book))

    assert sum("INSERT INTO catalogues" in statement for statement in statements) == 2
    for book in (catalogue, other):
        assert plain(await store.catalogue(book.version)) == plain(book)
    assert await store.catalogue("another") is None


async def test_catalogues_of_savers_at_once_are_all_kept(
    store: Store, catalogue: Catalogue, supplemented: Supplement
) -> None:
    other = supplemented(**SUPPLEMENT)

    await asyncio.gather(*(store.save(under(book)) for book in (catalogue, other, catalogue)), store.save(draft()))

    assert await copies(store) == 2


async def test_a_selection_that_is_refused_leaves_the_catalogue_to_the_next(store: Store, catalogue: Catalogue) -> None:
    outcomes = await asyncio.gather(
        *(store.save(under(catalogue, title=title)) for title in ("b\0", "c\0")), return_exceptions=True
    )
    await store.save(under(catalogue))

    assert len(outcomes) == 2
    assert plain(await store.catalogue(catalogue.version)) == plain(catalogue)


async def test_a_catalogue_that_cannot_be_read_counts_as_not_kept(store: Store, catalogue: Catalogue) -> None:
    await store.save(under(catalogue))
    statement = text("UPDATE catalogues SET content_brotli = :spoilt").bindparams(spoilt=b"\x00")
    await change(store, lambda connection: connection.execute(statement))

    assert await store.catalogue(catalogue.version) is None


def _save_under_two(database: str, barrier: Barrier, first: bool) -> None:
    books = [load_catalogue(), dataclasses.replace(load_catalogue(), version="another")]

    async def main() -> None:
        store = Store(database, seconds=20)
        await store.open()
        barrier.wait(180)
        await asyncio.gather(*(store.save(under(book)) for book in (books if first else books[::-1])))
        await store.close()

    asyncio.run(main())


def test_many_workers_can_keep_the_same_catalogues_at_once(
    ready_database: str, catalogue: Catalogue, processes: ForkServerContext
) -> None:
    barrier = processes.Barrier(4)
    workers = [processes.Process(target=_save_under_two, args=(ready_database, barrier, k % 2 == 0)) for k in range(4)]

    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(240)

    async def kept() -> tuple[int, Catalogue | None]:
        store = Store(ready_database)
        await store.open()
        result = await copies(store), await store.catalogue(catalogue.version)
        await store.close()
        return result

    assert [worker.exitcode for worker in workers] == [0, 0, 0, 0]
    count, results = asyncio.run(kept())
    assert count == 2
    assert plain(results) == plain(catalogue)
