"""Savers who come together: each gets the draft of its own application, the very reply that `select` gives it alone."""

import random

import pytest
from starlette.datastructures import State

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.fleet import select_fleet
from hpn.selection import Selection, select
from hpn.store import Draft
from hpn.web.api.selection_schemas import Labels
from hpn.web.api.selections import Wanted, drafts
from hpn.web.door.metrics import Metrics
from hpn.web.form.write import to_link
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.property.draw import at_random
from tests.store.drafts import draft
from tests.store.test_catalogues import SUPPLEMENT

MODELS = ("linear", "iso281", "digitised")


def wanted(application: Json, title: str) -> Wanted:
    """What a saver wants."""
    return Wanted(Application.model_validate(application), Labels(title=title), None)


def alone(application: Application, catalogue: Catalogue) -> bytes | tuple[object, ...]:
    """Reply to one application, or its problems."""
    try:
        return select(application, catalogue).json(to_link(application))
    except InputError as error:
        return error.problems


def test_each_gets_the_draft_of_its_own(supplemented: Supplement) -> None:
    """With curves, efficiencies, cycles of 1 to 300 phases, some that are refused, and some that are drafts already."""
    catalogue = supplemented(**SUPPLEMENT)
    state = State({"catalogue": catalogue, "metrics": Metrics()})
    chance = random.Random(5)
    savers: list[Wanted | Draft] = [
        wanted(at_random(random.Random(seed), MODELS), f"random {seed}") for seed in range(300)
    ]
    savers += [wanted(worked_example(requirements={"ratios": [6]}), f"refused {k}") for k in range(9)]
    savers += [wanted(cycle(*[phase(10 + k, 100)] * 300), f"long {k}") for k in range(9)]
    savers += [draft(title=f"ready {k}") for k in range(9)]
    chance.shuffle(savers)

    made = [each for start in range(0, len(savers), 16) for each in drafts(state, savers[start : start + 16])]

    assert len(made) == len(savers)
    refused = 0
    for saver, outcome in zip(savers, made, strict=True):
        if isinstance(saver, Draft):
            assert outcome is saver
        elif isinstance(outcome, InputError):
            refused += 1
            assert outcome.problems == alone(saver.application, catalogue)
        else:
            assert outcome.title == saver.labels.title
            assert outcome.result == alone(saver.application, catalogue)
            assert Application.model_validate_json(outcome.application) == saver.application
    assert 9 <= refused < 100


def test_who_is_made_twice_is_counted_once(catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch) -> None:
    """The writer makes each alone where one of a group fails in a way that nobody has thought of."""

    def fail(application: Application) -> str:
        if application.duty_cycle.pause_s == 7:
            raise ZeroDivisionError
        return "/"

    monkeypatch.setattr("hpn.web.api.selections.to_link", fail)
    state = State({"catalogue": catalogue, "metrics": Metrics()})

    with pytest.raises(ZeroDivisionError):
        drafts(state, [wanted(cycle(phase(1, 1)), "good"), wanted(cycle(phase(1, 1), pause_s=7), "bad")])
    drafts(state, [wanted(cycle(phase(1, 1)), "good")])

    assert b'hpn_selections_total{verdict="selected"} 1.0' in state.metrics.exposition()


def test_a_long_cycle_does_not_lengthen_its_neighbours(catalogue: Catalogue) -> None:
    applications = [Application.model_validate(cycle(*[phase(1, 1)] * count)) for count in (3, 500, 20, 3, 32, 33, 140)]

    selections = select_fleet(applications, catalogue)

    padded = [s.evaluation.duty.phases.shape[1] for s in selections if isinstance(s, Selection)]
    assert padded == [32, 500, 32, 32, 32, 33, 140]
