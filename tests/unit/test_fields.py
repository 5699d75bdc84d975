"""Fields of the input models: nulls that count as not given, and names that are none."""

from typing import Any, Literal

import pytest
from pydantic import BaseModel, ValidationError

from hpn.application import Application
from hpn.application.faults import faults_of
from hpn.application.motion import LinearMotion, RotaryMotion
from hpn.web.archive import SaveRequest
from hpn.words.fields import Model
from tests.build import Json, cycle, phase

MOVE = {"profile": "trapezoidal", "time_s": 0.8}
ROTARY = {"mechanism": {"type": "rotary", "inertia_kgm2": 0.8}, "moves": [{**MOVE, "angle_deg": 90.0}]}
BELT = {
    "mechanism": {"type": "belt", "mass_kg": 8.0, "diameter_mm": 50.0},
    "moves": [{**MOVE, "distance_mm": 500.0}],
}
WHOLE = cycle(
    phase(40, 250),
    emergency_stop={"brake": {"torque_Nm": 8.0}},
    output_load={"radial_N": 500.0},
    requirements={"motor": {"peak_torque_Nm": 20.0}},
)
MOVED = [{"duty_cycle": {"motion": motion}} for motion in (ROTARY, BELT)]


def with_nulls(model: BaseModel) -> Json:
    """Given fields of a model, with null for every field that was left out, in every object of it."""
    by_name = {name: getattr(model, name) for name in model.model_fields_set}
    return dict.fromkeys(type(model).model_fields) | {name: _with_nulls(value) for name, value in by_name.items()}


def _with_nulls(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_with_nulls(item) for item in value]
    return with_nulls(value) if isinstance(value, Model) else value


@pytest.mark.parametrize("inputs", [WHOLE, *MOVED], ids=["whole", "rotary", "belt"])
def test_a_null_for_any_field_that_may_be_left_out_counts_as_not_given(inputs: Json) -> None:
    plain = Application.model_validate(inputs)
    sent = with_nulls(plain)

    assert sent["requirements"] is None or sent["requirements"]["utilisation"] is None
    assert Application.model_validate(sent) == plain


@pytest.mark.parametrize("inputs", [WHOLE, *MOVED], ids=["whole", "rotary", "belt"])
def test_a_null_for_a_default_is_kept_nowhere(inputs: Json) -> None:
    """Saved application and digest are as if the field had been left out; nulls that were taken before stay."""
    application = Application.model_validate(inputs | {"requirements": inputs.get("requirements"), "rank_by": None})

    assert application.model_dump(exclude_unset=True) == Application.model_validate(inputs).model_dump(
        exclude_unset=True
    )


def test_a_null_for_what_is_required_or_is_no_field_is_refused() -> None:
    with pytest.raises(ValidationError) as refused:
        Application.model_validate(cycle(phase(1, 1) | {"torque_Nm": None, "speed": None}, price=None))

    assert {fault.location[-1]: fault.text for fault in faults_of(refused.value)} == {
        "torque_Nm": "must be a JSON number, such as 9.3",
        "speed": "is not a field of this object; it looks like speed_rpm",
        "price": "is not a field of this object",
    }


def _motion(kind: Literal["rotary", "belt"], **move: Any) -> Json:
    motion = ROTARY if kind == "rotary" else BELT
    return {"duty_cycle": {"motion": motion | {"moves": [motion["moves"][0] | move]}}}  # type: ignore[index]


@pytest.mark.parametrize(
    ("inputs", "pointer", "near"),
    [
        (WHOLE | {"requirement": {}}, ("requirement",), "requirements"),
        (WHOLE | {"requirements": {"life": 20000}}, ("requirements", "life"), "life_h"),
        (cycle(phase(1, 1) | {"RADIAL_n": 5}), ("duty_cycle", "phases", 0, "RADIAL_n"), "radial_N"),
        (_motion("rotary", speed=25), ("duty_cycle", "motion", "moves", 0, "speed"), "speed_rpm"),
        (_motion("belt", speed=25), ("duty_cycle", "motion", "moves", 0, "speed"), "speed_mm_per_s"),
        (
            _motion("belt", external_torque=5),
            ("duty_cycle", "motion", "moves", 0, "external_torque"),
            "external_force_N",
        ),
    ],
)
def test_a_misspelt_field_is_said_to_look_like_one_of_its_own_object(
    inputs: Json, pointer: tuple[str | int, ...], near: str
) -> None:
    with pytest.raises(ValidationError) as refused:
        Application.model_validate(inputs)

    [fault] = faults_of(refused.value)
    assert (fault.location, fault.code) == (pointer, "extra_forbidden")
    assert fault.text == f"is not a field of this object; it looks like {near}"


def test_other_errors_beside_a_misspelt_field_are_as_without_it() -> None:
    wrong = cycle(phase(1, 1) | {"duration_s": -1}, rank_by="price", output_load={"radial_N": 5, "model": 3})
    result = []
    for inputs in (wrong, wrong | {"rankby": "weight"}):
        with pytest.raises(ValidationError) as refused:
            SaveRequest.model_validate({"application": inputs})
        result.append(faults_of(refused.value))

    plain, beside = result
    assert len(plain) == 3
    assert [fault for fault in beside if fault.location[-1] != "rankby"] == plain
    assert beside[-1].text == "is not a field of this object; it looks like rank_by"


def test_an_object_of_another_kind_has_its_names_refused_without_likeness() -> None:
    """Comparing names takes a while each: many of them are no slips."""
    with pytest.raises(ValidationError) as refused:
        Application.model_validate(WHOLE | {f"requirement{k}": 1 for k in range(50)})

    assert {fault.text for fault in faults_of(refused.value)} == {"is not a field of this object"}


@pytest.mark.parametrize("model", [Application, RotaryMotion, LinearMotion, SaveRequest])
def test_the_schema_lets_be_null_what_may_be_left_out(model: type[Model]) -> None:
    schema = model.model_json_schema()
    objects = [schema, *schema["$defs"].values()]

    names = {
        name: ({"type": "null"} in entry.get("anyOf", entry.get("oneOf", ()))) == (name not in part.get("required", ()))
        for part in objects
        for name, entry in part.get("properties", {}).items()
    }
    assert len(names) > 20
    assert all(names.values()), names
