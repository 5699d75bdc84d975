"""Fleets that are kept: saved, renamed and deleted, by whom, and how many there may be."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.engine.selection import select
from hpn.store import AxisDraft, Machine, MachineDraft
from hpn.store.machines import MOST_OF_CALLER
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.fleet.page import HUB, post
from tests.fleet.tables import row_of, write
from tests.state import state_of
from tests.store.test_machines import MOST_BYTES


@pytest.fixture(scope="module")
def kept(client: TestClient, service: FastAPI, machine: str) -> MachineDraft:
    """The machine of the German table as it was kept."""
    assert client.portal is not None
    record = client.portal.call(service.state.store.find_machine, machine.rpartition("/")[2])
    return draft_of(record)


def draft_of(machine: Machine, caller: str = "") -> MachineDraft:
    """A machine once more, as if it had just been sized."""
    names = AxisDraft.__dataclass_fields__
    axes = [AxisDraft(**{name: getattr(axis, name) for name in names}) for axis in machine.items]
    return MachineDraft(axes, machine.engine_version, machine.catalogue_version, owner=machine.owner, caller=caller)


def keep(client: TestClient, service: FastAPI, draft: MachineDraft) -> str:
    """Address of a machine that is kept as if it had just been sized."""
    assert client.portal is not None
    return f"/machines/{client.portal.call(service.state.store.keep_machine, draft, MOST_BYTES)}"


def test_a_machine_is_saved_listed_and_never_changed(client: TestClient, service: FastAPI, kept: MachineDraft) -> None:
    address = keep(client, service, kept)
    assert "Save machine" in client.get(address).text

    wrong = client.post(address, data={"title": "x" * 300, "ref": "P-7"})
    assert wrong.status_code == 422 and 'value="P-7"' in wrong.text and "at most 200" in unescape(wrong.text)
    assert client.post(address, data={"title": "Line <4>", "ref": "P-7", "author": "", "rev": "B"}).status_code == 303
    client.post(address, data={"title": "another"})

    page = client.get(address).text
    assert "Line &lt;4&gt;" in page and "Save machine" not in page and "Differences today" not in page
    assert f'<a href="{address}">Line &lt;4&gt;</a>' in client.get("/machines").text
    assert client.post(f"{address}/delete").status_code == 303
    assert client.get(address).status_code == 404


def test_a_saved_machine_is_renamed_on_its_page(client: TestClient, service: FastAPI, kept: MachineDraft) -> None:
    address = keep(client, service, kept)
    assert client.post(f"{address}/rename", data={"title": "early"}).status_code == 404
    client.post(address, data={"title": "Line 4", "ref": "P-7", "author": "MM", "rev": "B"})
    assert f'action="{address}/rename"' in client.get(address).text

    wrong = client.post(f"{address}/rename", data={"title": "x" * 300})
    assert wrong.status_code == 422 and "at most 200" in unescape(wrong.text)
    renamed = client.post(f"{address}/rename", data={"title": "Line <5>", "ref": ""})

    assert renamed.status_code == 303 and renamed.headers["location"] == address
    page = client.get(address).text
    assert '<h1 id="machine-name">Line &lt;5&gt;</h1>' in page and "MM" in page
    assert page.count("P-7") == page.count("<del>P-7</del>") == 1  # beside the machine: what changed since its revision


def test_names_of_machines_that_look_like_others_are_refused(
    client: TestClient, service: FastAPI, kept: MachineDraft
) -> None:
    address = keep(client, service, kept)
    for name in ("title", "ref", "author", "rev"):
        wrong = client.post(address, data={name: "Line\u200b 4"})
        assert wrong.status_code == 422 and "U+200B ZERO WIDTH SPACE" in wrong.text
    client.post(address, data={"title": "Line 4"})

    wrong = client.post(f"{address}/rename", data={"title": "Line 4", "ref": "\U000e0041"})

    assert wrong.status_code == 422 and "Reference: must not contain the invisible character U+E0041" in unescape(
        wrong.text
    )


def test_a_machine_says_what_differs_today(client: TestClient, service: FastAPI, machine: str, tmp_path: Path) -> None:
    then = select(Application.model_validate(HUB), service.state.catalogue).candidates[0]
    columns = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    (tmp_path / "ratings.csv").write_text(f"{columns}{then.size},{then.ratio},0.4,0.3,0.5,weaker\n")
    url = service.state.settings.database_url
    with TestClient(create_app(Settings(database_url=url, catalogue_supplement=tmp_path))) as later:
        page = unescape(later.get(machine).text)
        now = select(Application.model_validate(HUB), state_of(later).catalogue).selected

    assert "1 axis gets another answer." in page
    changed = page[page.index("Differences today") : page.index('class="axes-grid"')]
    assert changed.index(then.designation) < changed.index(str(now))
    assert "Differences today" not in client.get(machine).text


def test_last_bits_of_another_processor_are_no_other_answer(
    client: TestClient, service: FastAPI, kept: MachineDraft
) -> None:
    def elsewhere(axis: AxisDraft) -> AxisDraft:
        used = axis.answer["utilisation"]
        moved = {"utilisation": used and math.nextafter(used, 9.0), "catalogue_version": "of another machine"}
        return replace(axis, answer={**axis.answer, **moved})

    moved = replace(kept, axes=[elsewhere(axis) for axis in kept.axes])

    assert "Every axis gets the same result." in unescape(client.get(keep(client, service, moved)).text)


def test_only_the_owner_s_key_renames_and_deletes_a_machine(kept: MachineDraft, tmp_path: Path) -> None:
    keys = {name: f"key of {name}" for name in ("anna", "bert")}
    pairs = [f"{name}:{hashlib.sha256(key.encode()).hexdigest()}" for name, key in keys.items()]
    settings = Settings.model_validate({"database_url": f"sqlite:///{tmp_path / 'db'}", "api_keys": " ".join(pairs)})
    anna, bert = ({"X-API-Key": key} for key in keys.values())
    service = create_app(settings)
    with TestClient(service, follow_redirects=False) as client:
        address = keep(client, service, kept)
        for guarded in ("/machines", address, f"{address}/delete"):
            assert client.post(guarded, data={"text": "x"}).status_code == 401
        client.headers |= anna
        client.post(address, data={"title": "Line 4"})

        assert client.post(f"{address}/delete", headers=bert).status_code == 403
        assert client.post(f"{address}/rename", data={"title": "Bert’s"}, headers=bert).status_code == 403
        assert client.post(f"{address}/delete", headers={"X-API-Key": ""}).status_code == 401
        assert client.get(address).status_code == 200
        assert client.post(f"{address}/delete").status_code == 303
        assert client.get(address).status_code == 404


@pytest.fixture
def keyed(tmp_path: Path) -> Iterator[TestClient]:
    """A service with keys."""
    pairs = [f"{name}:{hashlib.sha256(name.encode()).hexdigest()}" for name in ("anna", "bert", "admin")]
    settings = Settings.model_validate({"database_url": f"sqlite:///{tmp_path / 'db'}", "api_keys": " ".join(pairs)})
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


def test_a_machine_that_a_key_has_calculated_only_that_key_sees_and_saves(keyed: TestClient, tmp_path: Path) -> None:
    anna, bert, admin = ({"X-API-Key": name} for name in ("anna", "bert", "admin"))
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    sized = keyed.post("/machines", files={"file": ("axes.csv", table)}, headers=anna)
    assert sized.status_code == 303, sized.text
    place = sized.headers["location"]

    for other in (bert, admin):
        for address in (place, f"{place}/axes.csv", f"{place}/delete"):
            seen = keyed.get(address, headers=other)
            assert seen.status_code == 403 and "one" not in seen.text
        assert keyed.post(place, data={"title": "taken"}, headers=other).status_code == 403
        assert keyed.post(f"{place}/delete", headers=other).status_code == 403
    assert keyed.get(place).status_code == 401  # the browser asks for the key
    assert "Only the key that calculated" in keyed.get(place, headers=bert | {"Accept": "text/html"}).text

    assert keyed.get(place, headers=anna).status_code == 200
    assert keyed.post(place, data={"title": "Line 4"}, headers=anna).status_code == 303
    assert keyed.get(place, headers=bert).status_code == 200  # what is saved is there for all


def test_a_caller_with_many_unsaved_machines_is_told_what_to_do(keyed: TestClient, tmp_path: Path) -> None:
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    sized = keyed.post("/machines", files={"file": ("axes.csv", table)}, headers={"X-API-Key": "anna"})
    store, place = state_of(keyed).store, sized.headers["location"]
    assert keyed.portal is not None
    result = keyed.portal.call(store.find_machine, place.rpartition("/")[2])
    caller = hashlib.sha256(b"key anna").hexdigest()
    draft = draft_of(result, caller)
    for _ in range(MOST_OF_CALLER - 1):
        keyed.portal.call(store.keep_machine, draft, MOST_BYTES)

    refused = keyed.post("/machines", files={"file": ("axes.csv", table)}, headers={"X-API-Key": "anna"})

    assert (refused.status_code, int(refused.headers["retry-after"]) > 0) == (429, True)
    assert "20 of them are yours" in refused.text
    assert keyed.post("/machines", files={"file": ("a.csv", table)}, headers={"X-API-Key": "bert"}).status_code == 303
    assert keyed.post(f"{place}/delete", headers={"X-API-Key": "anna"}).status_code == 303
    assert keyed.post("/machines", files={"file": ("a.csv", table)}, headers={"X-API-Key": "anna"}).status_code == 303


def test_where_unsaved_machines_take_all_their_room_a_new_one_is_refused(tmp_path: Path) -> None:
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    settings = Settings(database_url=f"sqlite:///{tmp_path / 'db'}", maximum_unsaved_fleet_bytes=100)
    with TestClient(create_app(settings), follow_redirects=False) as client:
        refused = post(client, table)

        assert refused.status_code == 503 and "the space for them is full" in refused.text
        assert client.post("/api/v1/fleet", content=table, headers={"Content-Type": "text/csv"}).status_code == 200
