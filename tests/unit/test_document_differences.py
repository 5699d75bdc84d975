"""Differences of two documents: inputs own and common, verdicts, figures, and the order of what differs."""

import copy

import msgspec
import pytest
from msgspec import structs

from hpn.catalogue import Catalogue
from hpn.documents.differences import DifferentAxis, DocumentDifferences, differences, today
from hpn.documents.revision import Frozen
from hpn.documents.summary import summary_of
from hpn.files.machine.changes import input_cells
from hpn.words.reader import Reader
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.machines import COMMON, axis, frozen, packing_line

ALONE = {"requirements": {"utilisation": 0.9}}


def compared(one: Frozen, other: Frozen, catalogue: Catalogue) -> DocumentDifferences:
    return differences(one, other, (catalogue, catalogue))


def of_one(before: Json, after: Json, catalogue: Catalogue, common: Json | None = None) -> DifferentAxis:
    """The difference of the one axis of two documents."""
    one, other = (frozen([axis], catalogue, common) for axis in (before, after))
    (result,) = compared(one, other, catalogue).axes
    return result


def inputs_of(found: DifferentAxis) -> dict[str, tuple[object, object]]:
    return {each.pointer: (each.value_from, each.value_to) for each in found.inputs}


def test_the_same_document_has_no_difference(catalogue: Catalogue) -> None:
    line = frozen(packing_line(), catalogue, COMMON)
    result = compared(line, frozen(packing_line(), catalogue, COMMON), catalogue)
    assert (result.common, result.axes, result.same, result.order) == ((), (), 40, False)
    assert compared(line, today(line, catalogue), catalogue).axes == ()


def test_a_changed_phase_is_one_input_and_says_what_it_did(catalogue: Catalogue) -> None:
    before, after = axis("Turret", worked_example()), axis("Turret", worked_example())
    after["application"]["duty_cycle"]["phases"][1]["torque_Nm"] = 38.0

    result = of_one(before, after, catalogue)

    assert inputs_of(result) == {"/resolved/duty_cycle/phases/1/torque_Nm": (32, 38.0)}
    figures = {each.field: (each.value_from, each.value_to) for each in result.figures}
    assert "average_torque_Nm" in figures and "weight_kg" not in figures
    assert result.verdicts == () and result.effect == 0.0  # the stop torque decides


def test_a_common_value_that_differs_stands_once_and_its_effect_with_each_axis(catalogue: Catalogue) -> None:
    axes = [axis("a", worked_example()), axis("b", worked_example(requirements={"utilisation": 1.0}))]
    one, other = (frozen(axes, catalogue, {"requirements": {"utilisation": u}}) for u in (1.0, 0.7))

    result = compared(one, other, catalogue)

    assert [(each.pointer, each.value_from, each.value_to) for each in result.common] == [
        ("/common/requirements/utilisation", 1.0, 0.7)
    ]
    assert [(each.number, each.inputs) for each in result.axes] == [(1, ())]
    assert result.same == 1


def test_a_common_value_that_one_document_lacks_is_no_input_of_its_axes(catalogue: Catalogue) -> None:
    one, other = (frozen([axis("a", worked_example())], catalogue, common) for common in (None, ALONE))
    result = compared(one, other, catalogue)
    assert [each.pointer for each in result.common] == ["/common/requirements/utilisation"]
    assert all(each.inputs == () for each in result.axes)


def test_an_own_value_that_equals_the_common_one_differs_from_an_inherited_one(catalogue: Catalogue) -> None:
    own = axis("a", worked_example(requirements={"utilisation": 0.9}))
    result = of_one(own, axis("a", worked_example()), catalogue, ALONE)
    (only,) = result.inputs
    assert (only.pointer, only.value_from, only.value_to) == ("/resolved/requirements/utilisation", 0.9, 0.9)
    assert (only.inherited_from, only.inherited_to) == (False, True)


def test_name_quantity_note_code_and_what_does_not_hold_are_inputs(catalogue: Catalogue) -> None:
    before = axis("a", worked_example(), note="x")
    after = axis("b", worked_example(), 2, ordering_code="HPN-20A-5", without=["requirements.utilisation"])
    assert inputs_of(of_one(before, after, catalogue, ALONE)) == {
        "/name": ("a", "b"),
        "/quantity": (1, 2),
        "/note": ("x", None),
        "/ordering_code": (None, "HPN-20A-5"),
        "/without": ([], ["requirements.utilisation"]),
    }


def test_what_does_not_hold_is_said_by_the_names_of_its_inputs(catalogue: Catalogue) -> None:
    common = ALONE | {"tolerances": {"torque_Nm": {"percent": 10}}}
    after = axis("a", worked_example(), without=["requirements.utilisation", "tolerances.torque_Nm"])
    result = of_one(axis("a", worked_example()), after, catalogue, common)
    cells = [input_cells(result.inputs, reader)[0] for reader in (Reader(), Reader("de"))]
    assert cells[0] == ("Common values that do not hold", "–", "Maximum utilisation; ± Torque, all phases")
    assert cells[1][2] == "Maximale Auslastung; ± Drehmoment, alle Phasen"


def test_a_tolerance_that_differs_is_said_by_the_name_of_its_input(catalogue: Catalogue) -> None:
    both_sides = {"torque_Nm": {"percent": 10}}
    apart = {"phases.0.speed_rpm": {"minus": {"percent": 2}, "plus": {"absolute": 5.0}}, "unheard_of": {"percent": 1}}
    one = frozen([axis("a", worked_example())], catalogue, {"tolerances": both_sides})
    other = frozen(
        [axis("a", worked_example(tolerances=apart))],
        catalogue,
        {"tolerances": both_sides | {"torque_Nm": {"percent": 5}}},
    )

    result = compared(one, other, catalogue)

    assert input_cells(result.common, Reader()) == [("± Torque, all phases", "10\u202f%", "5\u202f%")]
    assert input_cells(result.axes[0].inputs, Reader()) == [
        ("− Speed, phase 1", "–", "2\u202f%"),
        ("+ Speed, phase 1", "–", "5\u202frpm"),
        ("tolerances.unheard_of.percent", "–", "1"),
    ]
    assert input_cells(result.common, Reader("de"))[0][0] == "± Drehmoment, alle Phasen"


def test_other_last_bits_are_no_difference_and_a_relative_ppt_more_is_one(catalogue: Catalogue) -> None:
    line = frozen([axis("a", worked_example())], catalogue)
    for factor, count in ((1 + 4e-13, 0), (1 + 4e-12, 1)):
        (only,) = line.axes
        life = (only.answer.shortest_life_h or 0.0) * factor
        other = structs.replace(only, answer=structs.replace(only.answer, shortest_life_h=life))
        result = compared(line, structs.replace(line, axes=(other,)), catalogue).axes
        assert len(result) == count


def test_lost_gears_come_first_then_other_gears_then_new_axes_then_by_effect(catalogue: Catalogue) -> None:
    names = ("same", "small", "large", "other", "lost", "removed")
    before = [
        axis(name, cycle(phase(10, 100, 1.0), phase(5, 50, 1.0))) | {"number": n} for n, name in enumerate(names, 1)
    ]
    after = copy.deepcopy(before)
    for place, torque in ((1, 10.5), (2, 11.5), (3, 100.0), (4, 9000.0)):
        after[place]["application"]["duty_cycle"]["phases"][0]["torque_Nm"] = torque
    after[5] = axis("added", worked_example()) | {"number": 9}

    result = compared(frozen(before, catalogue), frozen(after, catalogue), catalogue)

    assert [each.name for each in result.axes] == ["lost", "other", "removed", "added", "large", "small"]
    assert [each.change for each in result.axes[2:4]] == ["removed", "added"]
    assert result.axes[0].lost_its_gear and result.axes[1].has_another_gear and result.same == 1
    assert result.axes[0].side_to and result.axes[0].side_to.gear is None
    assert result.side_from.suitable == 6 and result.side_to.suitable == 5


def test_an_axis_that_turns_open_and_one_that_is_answered_say_so(catalogue: Catalogue) -> None:
    whole, lacking = axis("a", worked_example()), axis("a", worked_example())
    del lacking["application"]["duty_cycle"]["phases"][0]["speed_rpm"]
    result = of_one(whole, lacking, catalogue)
    assert {each.field: each.value_to for each in result.verdicts}["status"] == "open"
    assert result.lost_its_gear and result.effect is None
    assert inputs_of(result) == {
        "/resolved/duty_cycle/phases/0/speed_rpm": (whole["application"]["duty_cycle"]["phases"][0]["speed_rpm"], None)
    }


def test_values_that_no_application_has_are_compared_as_they_are(catalogue: Catalogue) -> None:
    """An open axis keeps what was sent: integers beyond floats, and objects as deep as they are."""
    deep: Json = {}
    for _ in range(50):
        deep = {"in": deep}
    sides = [worked_example(requirements={"life_h": value}, more=deep | {"x": value}) for value in (10**400, 5)]
    result = inputs_of(of_one(axis("a", sides[0]), axis("a", sides[1]), catalogue))
    assert result == {"/resolved/requirements/life_h": (10**400, 5), "/resolved/more/x": (10**400, 5)}


def test_another_order_is_said_and_is_no_difference_of_an_axis(catalogue: Catalogue) -> None:
    line = frozen([axis("a", worked_example()), axis("b", worked_example())], catalogue)
    result = compared(line, structs.replace(line, axes=line.axes[::-1]), catalogue)
    assert (result.order, result.axes) == (True, ())


def test_today_asks_todays_catalogue_and_keeps_what_was_resolved(
    catalogue: Catalogue, supplemented: Supplement
) -> None:
    line = frozen([axis("a", worked_example()), axis("b", {})], catalogue, ALONE, title="Line")
    later = msgspec.json.decode(msgspec.json.encode(line), type=Frozen)
    other = supplemented(weights="size,stages,weight_kg,source\n20A,1,3.6,p\n")
    result = differences(later, today(later, other), (catalogue, other))
    (only,) = result.axes
    assert (only.number, only.inputs) == (1, ())
    assert [(each.field, each.value_to) for each in only.figures] == [("weight_kg", 3.6)]
    assert result.side_to.catalogue_versions == (other.version,)


def test_the_summary_counts_what_the_list_of_gears_counts(catalogue: Catalogue) -> None:
    line = frozen(packing_line(), catalogue, COMMON)
    summary = summary_of(line, catalogue)
    gears = [each for each in line.axes if each.ordering_code or each.answer.selected]
    weights = [each.quantity * (each.answer.weight_kg or 0.0) for each in gears]
    assert summary.weight_kg == pytest.approx(sum(weights), rel=1e-12)
    assert summary.gears == sum(each.quantity for each in gears)
    assert summary.axes == 40 == summary.suitable + summary.unsuitable + summary.unrated + summary.open
    assert summary.open == 1
    of_most = next(each for each in line.axes if each.number == summary.utilisation_axis)
    assert of_most.answer.utilisation == summary.utilisation
