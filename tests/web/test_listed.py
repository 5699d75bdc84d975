"""Order of the page's candidates, ties that it names, and the component with the shortest life in the verdict."""

import pytest

from hpn.catalogue import Catalogue
from hpn.web.door.bodies import pairs_of
from hpn.web.form.link_reader import parse
from hpn.web.pages.calculator import LiveResult, form_and_answer

EXAMPLE = "T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200"


def answer_to(query: str, catalogue: Catalogue) -> LiveResult:
    """Result of a link."""
    form, answer = form_and_answer(parse(pairs_of(query)), catalogue)
    assert answer, form.problems
    return answer


@pytest.mark.parametrize(
    "query",
    [
        *(EXAMPLE, EXAMPLE + "&FR=2000&rank=life", "T=5000&n=10&t=1"),
        *(EXAMPLE + "&i=5&size=40A", EXAMPLE + "&FR=1201.7&xR=45"),
    ],
)
def test_every_candidate_is_listed_once_in_the_order_of_the_reply(catalogue: Catalogue, query: str) -> None:
    answer = answer_to(query, catalogue)
    listed, inputs = answer.listed, answer.selection.candidates

    rejected = [candidate for group in listed.rejected for candidate in group.candidates]
    assert listed.suitable == tuple(c for c in inputs if c.status == "suitable")
    assert listed.unrated == tuple(c for c in inputs if c.status == "unrated" and not c.missing)
    assert listed.lacking == tuple(c for c in inputs if c.missing)
    assert sorted(rejected, key=inputs.index) == [c for c in inputs if c.status == "unsuitable"]
    nearest = [inputs.index(group.candidates[0]) for group in listed.rejected]
    assert nearest == sorted(nearest)
    for group in listed.rejected:
        assert {candidate.size for candidate in group.candidates} == {group.size}
        assert list(group.candidates) == sorted(group.candidates, key=inputs.index)


def test_ties_differ_in_nothing_that_ranks_them_but_life(catalogue: Catalogue) -> None:
    answer = answer_to(EXAMPLE, catalogue)
    (run,) = (run for run in answer.listed.ties if run[0].size == "20A")

    # T_k over T_M of table 12.1 is the same for these three, and larger for ratios 3 and 10.
    assert [candidate.ratio for candidate in run] == [4, 5, 7]
    assert {candidate.utilisation for candidate in run} == {200 / 256}
    lives = [candidate.life_L10_h or 0 for candidate in run]
    assert lives == sorted(lives, reverse=True)
    assert answer_to(EXAMPLE + "&rank=life", catalogue).listed.ties == ()


@pytest.mark.parametrize(
    ("query", "check"),
    [
        (EXAMPLE + "&i=5&size=20A", "life"),
        (EXAMPLE + "&i=5&size=20A&FR=500", "output_bearing_life"),
        (EXAMPLE + "&i=5&size=20A&FR=1", "life"),
    ],
)
def test_the_shortest_life_is_the_gears_or_its_bearings(catalogue: Catalogue, query: str, check: str) -> None:
    answer = answer_to(query, catalogue)
    life, chosen = answer.account.shortest_life, answer.chosen

    assert life and life.check == check
    lives = [value for value in (chosen.life_L10_h, chosen.bearing_life_L10_h) if value is not None]
    assert chosen.life_L10_h is not None
    bearing = chosen.bearing_life_L50_h  # judged and shown as L50
    assert life.life_h == (bearing if check == "output_bearing_life" else chosen.life_L10_h)
    assert min(lives) == (chosen.bearing_life_L10_h if check == "output_bearing_life" else chosen.life_L10_h)


def test_a_life_that_nothing_limits_is_no_shortest_one_beside_another(catalogue: Catalogue) -> None:
    free = answer_to("T=0&n=10&t=1&size=20A", catalogue)
    value_held = answer_to("T=0&n=10&t=1&size=20A&FR=500", catalogue)
    unrated = answer_to("T=10&n=10&t=1&size=40A", catalogue)

    assert free.account.shortest_life and free.account.shortest_life.life_h is None
    assert value_held.account.shortest_life and value_held.account.shortest_life.check == "output_bearing_life"
    assert unrated.account.shortest_life is None
