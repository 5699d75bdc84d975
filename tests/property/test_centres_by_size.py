"""Centres by size against plain ones: every candidate has what its own number alone, for all sizes, gives it."""

import random
from collections.abc import Iterator

import pytest

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.selection import Selection, select
from tests.build import Json
from tests.property.draw import at_random

OTHERS = "others"


def with_centres_by_size(count: int) -> Iterator[Json]:
    """Random applications with centres by size, and levers in most."""
    seed = 0
    while count:
        application = at_random(random.Random(seed))
        seed += 1
        if isinstance(application.get("output_load", {}).get("shaft_centre_mm"), dict):
            count -= 1
            yield application


def with_centre(application: Json, centre_mm: float | None) -> Json:
    """The application with one centre for all sizes."""
    return application | {"output_load": application["output_load"] | {"shaft_centre_mm": centre_mm}}


def of_sizes(application: Json, catalogue: Catalogue) -> dict[str, Selection]:
    """Answer by size to an application that gives the number of that size for all."""
    centres = application["output_load"]["shaft_centre_mm"]
    numbers = {size: centres.get(size, centres.get(OTHERS)) for size in catalogue.sizes}
    return {
        size: select(Application.model_validate(with_centre(application, number)), catalogue)
        for size, number in numbers.items()
    }


def test_a_candidate_is_judged_as_with_the_number_of_its_size_for_all(catalogue: Catalogue) -> None:
    """All but the rank, which is among all sizes, to the bit: no other size enters a candidate's figures."""
    compared = lacking = 0
    for application in with_centres_by_size(60):
        try:
            selection = select(Application.model_validate(application), catalogue)
        except InputError:
            continue
        alone = of_sizes(application, catalogue)
        for gear in selection.candidates:
            expected = alone[gear.size].candidate(gear.designation)
            assert expected is not None
            names = [name for name in gear.__struct_fields__ if name != "rank"]
            assert [getattr(gear, name) for name in names] == [getattr(expected, name) for name in names], application
            compared += 1
            lacking += bool(gear.missing)
    assert compared > 1000
    assert lacking > 10


@pytest.mark.parametrize("seed", range(3))
def test_axes_of_a_batch_keep_their_own_centres(seed: int, catalogue: Catalogue) -> None:
    """Together, with axes that give one for all, none, or other sizes, each has what it has alone."""
    chance = random.Random(seed)
    drawn = list(with_centres_by_size(20))
    drawn += [with_centre(application, chance.choice([None, 21.0])) for application in drawn[::2]]
    chance.shuffle(drawn)
    applications = [Application.model_validate(each) for each in drawn]

    together = judge_batch(applications, catalogue, lambda judged: judged.selection())

    for application, result in zip(applications, together, strict=True):
        if isinstance(result, InputError):
            with pytest.raises(InputError):
                select(application, catalogue)
        else:
            assert result == select(application, catalogue)
