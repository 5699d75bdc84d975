"""Documents by example: what an axis inherits, what stays open, labels of revisions, and what is frozen."""

from typing import Any

import pytest
from msgspec import UNSET, Raw
from pydantic import ValidationError

from hpn.application import Application
from hpn.application.input_fields import FIELDS
from hpn.catalogue import Catalogue
from hpn.documents import revision
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.documents.answers import answer_of as selection_answer
from hpn.documents.axis import MOST_AXES, MOST_PHASES, Axis, phases_of
from hpn.documents.common import COMMON, OWN, OWN_PARTS, Common
from hpn.documents.document import Document
from hpn.documents.merge import resolve
from hpn.engine.selection import Selection, select
from tests.build import Json, cycle, phase, worked_example


def answer_of(own: Json, common: Json, catalogue: Catalogue, code: str | None = None, **rest: Any) -> AxisAnswer:
    """Answer to one axis."""
    (answer,) = answers([AxisQuestion(resolve(own, common, **rest), code)], catalogue)
    return answer


def test_an_own_value_that_equals_a_default_survives_a_common_one_that_does_not() -> None:
    own = worked_example(requirements={"utilisation": 1.0, "position_error_at": "cycle"}, rank_by="weight")
    common = {"requirements": {"utilisation": 0.8, "position_error_at": "rest"}, "rank_by": "life"}

    application = resolve(own, common).application

    assert application is not None
    assert application.requirements.utilisation == 1.0
    assert (application.requirements.position_error_at, application.rank_by) == ("cycle", "weight")


def test_null_and_absent_are_inherited_and_without_is_not() -> None:
    common = {"requirements": {"utilisation": 0.8, "life_h": 20000.0}}
    for case in ({}, {"utilisation": None}, None):
        result = resolve(worked_example(requirements=case), common)
        assert result.whole["requirements"] == common["requirements"]

    result = resolve(worked_example(), common, ["requirements.life_h"])
    assert result.whole["requirements"] == {"utilisation": 0.8}


def test_a_list_is_replaced_whole() -> None:
    result = resolve(worked_example(requirements={"ratios": [10]}), {"requirements": {"ratios": [4, 5]}})
    assert result.whole["requirements"] == {"ratios": [10]}


def test_centres_by_size_are_one_value_that_an_axis_inherits_or_replaces() -> None:
    common = Common.model_validate({"output_load": {"shaft_centre_mm": {"others": 18, "20": 21}}}).as_json
    own, inherited = (
        resolve(worked_example(output_load={"radial_N": 400.0, "radial_position_mm": 45.0} | load), common)
        for load in ({"shaft_centre_mm": {"32A": 30.0}}, {})
    )

    assert own.application and own.application.output_load
    assert own.application.output_load.shaft_centre_mm == {"32A": 30.0}
    assert inherited.application and inherited.application.output_load
    assert inherited.application.output_load.shaft_centre_mm == {"20A": 21.0, "others": 18.0}


def test_what_a_common_value_needs_is_not_asked_where_the_axis_lacks_it() -> None:
    common = {"requirements": {"natural_frequency_Hz": 20.0}, "rank_by": "natural_frequency"}

    without, known = (
        resolve(worked_example(), common),
        resolve(worked_example(requirements={"load_inertia_kgm2": 1}), common),
    )

    assert set(without.not_asked) == {"requirements.natural_frequency_Hz", "rank_by"}
    assert known.not_asked == () and known.application is not None
    assert known.application.requirements.natural_frequency_Hz == 20


def test_an_own_value_that_lacks_something_leaves_the_axis_open(catalogue: Catalogue) -> None:
    answer = answer_of(worked_example(requirements={"natural_frequency_Hz": 20}), {}, catalogue)
    assert answer.status == "open"
    assert [fault.pointer for fault in answer.faults] == ["/requirements/natural_frequency_Hz"]


@pytest.mark.parametrize(
    "own",
    [
        {},
        {"duty_cycle": None},
        {"duty_cycle": 7, "requirements": [], "output_load": "much", "rank_by": {}},
        {"duty_cycle": {"phases": {"a": 1}}, "requirements": {"ratios": [9999]}},
        {"duty_cycle": {"phases": [None, 3, {"radial_N": []}]}},
        {"duty_cycle": {"motion": {"moves": [[]]}}, "output_load": {"from_motion": "yes"}},
        worked_example(unknown=1),
        worked_example(requirements={"sizes": ["99Z"]}),
        worked_example(output_load={"life_h": 5}),
        worked_example(requirements={"life_h": 10**400}),
    ],
)
def test_an_axis_that_cannot_be_calculated_is_open_and_says_why(own: Json, catalogue: Catalogue) -> None:
    common = Common.model_validate(
        {"requirements": {"utilisation": 0.9, "ratios": [5]}, "output_load": {"life_h": 1e4}, "rank_by": "life"}
    )
    answer = answer_of(own, common.as_json, catalogue)
    assert (answer.status, answer.designation) == ("open", None)
    assert answer.faults and all(fault.detail for fault in answer.faults)
    assert phases_of(own) >= 0


def test_the_gear_of_an_axis_is_that_of_its_ordering_code(catalogue: Catalogue) -> None:
    answer = answer_of(worked_example(), {}, catalogue, "hpn-14a-5-j6")

    assert (answer.selected, answer.designation, answer.status) == ("HPN-20A-4", "HPN-14A-5", "unsuitable")
    assert answer.utilisation == pytest.approx(200 / 107, rel=1e-12)  # T_k over T_M of table 5


@pytest.mark.parametrize("code", ["HPN-20A-5", "something"])
def test_a_code_of_no_candidate_leaves_the_axis_open(code: str, catalogue: Catalogue) -> None:
    answer = answer_of(worked_example(), {"requirements": {"ratios": [10]}}, catalogue, code)
    assert answer.status == "open" and [fault.pointer for fault in answer.faults] == ["/ordering_code"]


def test_every_field_of_an_application_is_common_or_own() -> None:
    own = {path for path in FIELDS if path in OWN or any(path.startswith(f"{part}.") for part in OWN_PARTS)}
    assert own | set(COMMON) == set(FIELDS)
    assert own >= set(OWN)


@pytest.mark.parametrize("path", sorted(OWN))
def test_common_values_refuse_what_is_the_axis_s_own(path: str) -> None:
    part, _, name = path.partition(".")
    with pytest.raises(ValidationError, match=r"extra_forbidden"):
        Common.model_validate({part: {name: 1}})


def test_common_values_have_the_bounds_of_an_application_and_one_of_a_pair() -> None:
    with pytest.raises(ValidationError, match="less than or equal to 1"):
        Common.model_validate({"requirements": {"utilisation": 2}})
    with pytest.raises(ValidationError, match="give one of"):
        Common.model_validate({"requirements": {"position_error_arcmin": 2, "position_error_mm": 2}})
    assert Common.model_validate({"requirements": {"utilisation": None}, "output_load": None}).as_json == {
        "requirements": {}
    }


def test_without_names_each_common_path_once() -> None:
    assert Axis.model_validate({"without": ["rank_by"]}).without == ("rank_by",)
    for wrong in (["duty_cycle"], ["rank_by", "rank_by"], ["requirements"], [5]):
        with pytest.raises(ValidationError):
            Axis.model_validate({"without": wrong})


def test_a_document_has_its_bounds() -> None:
    with pytest.raises(ValidationError, match="at most 10000"):
        Document.model_validate({"axes": [{}] * (MOST_AXES + 1)})
    long = {"application": cycle(*[phase(1, 1)] * (MOST_PHASES // 20 + 1))}
    with pytest.raises(ValidationError, match="200000"):
        Document.model_validate({"axes": [long] * 20})
    for wrong in ({"quantity": 0}, {"quantity": 10**6 + 1}, {"name": "x" * 41}, {"note": "x" * 2001}):
        with pytest.raises(ValidationError):
            Axis.model_validate(wrong)
    assert Axis.model_validate({"note": "one\nline"}).note == "one\nline"


@pytest.mark.parametrize("label", ["A", "1.2", "rev_B-3", "x" * 20])
def test_labels_keep_their_case(label: str) -> None:
    assert revision.RevisionBlock(label=label).label == label


@pytest.mark.parametrize("label", ["", "x" * 21, "a b", "ä", "a/b", ".", "..", "now", "Today", "SAVED", "a\n"])
def test_other_labels_are_refused(label: str) -> None:
    with pytest.raises(ValidationError):
        revision.RevisionBlock(label=label)


def test_what_is_frozen_comes_back_byte_for_byte(catalogue: Catalogue) -> None:
    own = b'{"duty_cycle": {"phases": []},  "x": 1.50}'
    axis = revision.FrozenAxis(
        1, "a", 2, None, None, ("rank_by",), Raw(own), Raw(b"{}"), answer_of(worked_example(), {}, catalogue)
    )
    frozen = revision.Frozen("title", None, None, None, {"rank_by": "life"}, (axis,))

    again = revision.decode(revision.encode(frozen))

    assert bytes(again.axes[0].application) == own
    assert again == frozen


# --- Tolerances among the common values -------------------------------------------------------------------------------

TEN = {"percent": 10.0}
TWENTY = {"absolute": 0.02}


def test_a_common_tolerance_is_inherited_replaced_whole_and_may_not_hold() -> None:
    common = {"tolerances": {"torque_Nm": TEN, "pause_s": TWENTY}}
    own = worked_example(tolerances={"pause_s": TEN})

    result = resolve(own, common)
    assert result.whole["tolerances"] == {"torque_Nm": TEN, "pause_s": TEN} and result.application is not None
    assert result.inherited == {"tolerances.torque_Nm"}
    assert resolve(own, common, ["tolerances.torque_Nm"]).whole["tolerances"] == {"pause_s": TEN}
    assert resolve(worked_example(tolerances={"pause_s": None}), common).whole["tolerances"] == common["tolerances"]


def test_an_axis_skips_a_common_tolerance_of_what_it_has_not() -> None:
    absent = ("motion.mechanism.mass_kg", "phases.7.torque_Nm", "requirements.load_inertia_kgm2")
    common = {"tolerances": dict.fromkeys(("torque_Nm", *absent), TEN)}
    result = resolve(worked_example(), common)
    assert result.application is not None and result.whole["tolerances"] == {"torque_Nm": TEN}
    assert set(result.not_asked) == {f"tolerances.{name}" for name in absent}
    own = resolve(worked_example(tolerances={"phases.7.torque_Nm": TEN}), {})
    assert own.application is None and own.faults[0][2] == "tolerance_path"


def test_a_common_tolerance_beyond_a_bound_leaves_the_axis_open() -> None:
    result = resolve(worked_example(), {"tolerances": {"speed_rpm": {"percent": 200.0}}})
    assert result.application is None and result.faults[0][0] == ("tolerances", "speed_rpm")


@pytest.mark.parametrize("path", ["torque", "phases.x.torque_Nm", "requirements.utilisation", "duty_cycle.pause_s", ""])
def test_common_tolerances_are_of_inputs(path: str) -> None:
    with pytest.raises(ValidationError, match="is not a path of an input"):
        Common.model_validate({"tolerances": {path: TEN}})
    with pytest.raises(ValidationError, match="is no path of a common value"):
        Axis.model_validate({"without": [f"tolerances.{path}"]})


def test_an_axis_with_a_tolerance_has_the_worst_case_of_its_gear(catalogue: Catalogue) -> None:
    own, common = worked_example(), {"tolerances": {"emergency_stop.torque_Nm": TEN}}
    answer = answer_of(own, common, catalogue)
    selection = select(Application.model_validate(own | common), catalogue)
    worst = selection.candidates[0].worst
    assert worst is not UNSET
    assert (answer.holds, answer.worst_governing_check) == (worst.status == "suitable", worst.governing_check)
    assert answer.worst_utilisation == pytest.approx(worst.utilisation, rel=1e-12)  # among others, and alone
    assert answer.utilisation is not None and worst.utilisation is not None and worst.utilisation > answer.utilisation
    assert answer_in_brief(selection, catalogue).worst_utilisation == worst.utilisation
    without = answer_of(own, {}, catalogue)
    assert (without.holds, without.worst_utilisation, without.worst_governing_check) == (None, None, None)


def answer_in_brief(selection: Selection, catalogue: Catalogue) -> AxisAnswer:
    return selection_answer(selection, selection.candidates[0], catalogue)
