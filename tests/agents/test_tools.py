"""The tools: a small schema, answers that fit, every limit with its source, and refusals that say what to ask for."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

from hpn.agents.brief import LONG_LINK, MOST_BYTES
from hpn.agents.schema import INSTRUCTIONS, TOOLS
from hpn.agents.tools import ASK, answer
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.links.writer import to_link
from tests.build import LIFTING, TURNING, Json, cycle, phase, worked_example
from tests.report.cases import CASES

SERVICE = "https://plm.example"
EVERYTHING: Json = {
    "life_h": 20000,
    "backlash_arcmin": 7,
    "torsional_stiffness_Nm_per_rad": 500,
    "natural_frequency_Hz": 5,
    "position_error_arcmin": 60,
    "weight_kg": 30,
    "length_mm": 400,
    "ambient_temperature_degC": 25,
    "motor": {
        "maximum_speed_rpm": 4000,
        "peak_torque_Nm": 200,
        "rated_torque_Nm": 80,
        "inertia_kgm2": 0.01,
        "inertia_ratio": 100,
    },
}

BOX: Json = {"motion.mechanism.inertia_kgm2": {"percent": 5}}


def told(tool: str, catalogue: Catalogue, **arguments: Any) -> Json:
    """Answer of a tool, which is no refusal."""
    text, is_refusal = answer(tool, arguments, catalogue, SERVICE)
    assert not is_refusal, text
    reply: Json = json.loads(text)
    return reply


def refused(tool: str, catalogue: Catalogue, **arguments: Any) -> str:
    """Refusal of a tool."""
    text, is_refusal = answer(tool, arguments, catalogue, SERVICE)
    assert is_refusal, text
    return text


def rows(reply: Json) -> dict[str, Json]:
    """Limits of an answer by the name of the check."""
    columns = reply["limits"]["columns"]
    return {row[0]: dict(zip(columns, row, strict=True)) for row in reply["limits"]["rows"]}


def test_three_tools_are_described_in_two_to_three_thousand_characters() -> None:
    tools = [{"name": name, "description": text, "inputSchema": schema} for name, (text, schema) in TOOLS.items()]

    assert list(TOOLS) == ["select", "explain", "catalogue"]
    assert 2000 < len(json.dumps(tools, separators=(",", ":"))) + len(INSTRUCTIONS) < 3000


def named(schema: Json, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Path of every field that a schema names."""
    for name, part in schema.get("properties", {}).items():
        yield (*path, name)
        yield from named(part.get("items", part), (*path, name))


def test_the_schema_names_inputs_that_there_are(catalogue: Catalogue) -> None:
    """One of its own names would be refused as an unknown field."""
    (_, schema) = TOOLS["select"]
    whole = Application.model_json_schema()

    def resolved(part: Json) -> Json:
        for choice in (part, *part.get("anyOf", ())):
            if "$ref" in choice:
                return resolved(whole["$defs"][choice["$ref"].rpartition("/")[2]])
            if choice.get("type") == "array":
                return resolved(choice["items"])
        return part

    for path in named(schema["properties"]["application"]):
        part = whole
        for name in path:
            assert name in part["properties"], path
            part = resolved(part["properties"][name])


def test_select_gives_the_decision_every_limit_with_its_source_and_a_link(catalogue: Catalogue) -> None:
    application = worked_example()
    selection = select(Application.model_validate(application), catalogue, to_link)

    reply = told("select", catalogue, application=application)

    assert (reply["selected"], reply["gear"], reply["status"]) == (selection.selected, selection.selected, "suitable")
    assert reply["link"] == SERVICE + selection.link
    assert reply["versions"] == {"engine": selection.engine_version, "catalogue": selection.catalogue_version}
    checks = {selection.check_definitions[check.code].title: check for check in selection.candidates[0].checks}
    assert rows(reply).keys() == checks.keys()
    for title, row in rows(reply).items():
        assert row["status"] == checks[title].status
        assert row["utilisation"] == pytest.approx(checks[title].utilisation, rel=1e-5)  # six digits
        assert "p. " in row["source"], title
    torque = rows(reply)["Load limit 1: average torque"]
    assert torque["source"].startswith("eq. 17.2 · table 1")


def test_explain_says_what_fails_and_what_would_let_it_fit(catalogue: Catalogue) -> None:
    reply = told("explain", catalogue, application=worked_example(), designation="HPN-14-5")

    assert (reply["gear"], reply["status"]) == ("HPN-14A-5", "unsuitable")
    failing = [title for title, row in rows(reply).items() if row["status"] == "fail"]
    assert "Load limit 3: momentary peak torque" in failing
    assert rows(reply)[failing[0]]["is"] == ">"
    assert reply["fits_if"].startswith("Fits if")
    assert reply["next"][0]["gear"] == reply["selected"]


def test_a_gear_that_was_not_asked_for_is_explained_too(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"ratios": [5]})

    reply = told("explain", catalogue, application=application, designation="HPN-20A-7")

    assert (reply["gear"], reply["selected"]) == ("HPN-20A-7", "HPN-20A-5")
    assert rows(reply)


def test_catalogue_lists_every_gear_and_gives_each_figure_with_its_page(catalogue: Catalogue) -> None:
    every, one = told("catalogue", catalogue), told("catalogue", catalogue, designation="HPN-20-05")

    assert every["gears"] == [gear.designation for gear in catalogue.gears]
    figures = {row[0]: row[1:] for row in one["figures"]["rows"]}
    assert figures["rated_torque_Nm"] == [80.0, "Nm", "table 12.1, p. 12"]
    assert "shaft_centre_mm" in one["not_published"]
    assert one["link"] == f"{SERVICE}/catalogue/HPN-20A-5"


@pytest.mark.parametrize(
    "application",
    [
        worked_example(),
        worked_example(requirements=EVERYTHING | {"load_inertia_kgm2": 0.5}, output_load={"radial_N": 500}),
        {"duty_cycle": {"motion": TURNING}, "requirements": EVERYTHING, "tolerances": BOX},
        {"duty_cycle": {"motion": LIFTING}, "requirements": EVERYTHING},
        cycle(*[phase(20 + number % 7, 100 + number, 1) for number in range(2000)]),
    ],
    ids=["worked example", "everything", "turning", "lifting", "long"],
)
@pytest.mark.parametrize("tool", ["select", "explain"])
def test_an_answer_stays_below_four_thousand_bytes_as_it_travels(
    tool: str, application: Json, catalogue: Catalogue
) -> None:
    designation = {"designation": "HPN-14A-5"} if tool == "explain" else {}

    text, is_refusal = answer(tool, {"application": application, **designation}, catalogue, SERVICE)
    reply = json.loads(text)

    assert not is_refusal
    assert len(json.dumps(text)) <= MOST_BYTES < 4000
    assert reply["limits"]["rows"]
    assert {"selected", "gear", "status", "reason", "link", "versions"} <= reply.keys()
    assert reply["link"].startswith(SERVICE) or reply["link"] == LONG_LINK


def test_what_an_answer_leaves_out_is_named(catalogue: Catalogue) -> None:
    application = {"duty_cycle": {"motion": TURNING}, "requirements": EVERYTHING}

    assert "figures" in told("select", catalogue, application=application)["left_out"]
    assert "left_out" not in told("select", catalogue, application=cycle(phase(40, 250)))


def test_notices_beyond_those_of_an_answer_are_named_as_left_out(catalogue: Catalogue) -> None:
    application = CASES["everything"]
    notices = select(Application.model_validate(application), catalogue, to_link).notices

    reply = told("select", catalogue, application=application)

    assert len(notices) > len(reply.get("notices", ())) and "notices" in reply["left_out"]


def test_what_holds_over_the_tolerances_is_said(catalogue: Catalogue) -> None:
    application = worked_example(tolerances={"torque_Nm": {"percent": 5}})

    assert told("select", catalogue, application=application)["over_tolerance"].startswith("Holds over the whole")


def test_a_refusal_names_the_input_with_its_unit_and_says_to_ask(catalogue: Catalogue) -> None:
    text = refused("select", catalogue, application=cycle({"torque_Nm": 3, "speed_rmp": 4}))

    assert text.splitlines()[0] == ASK
    assert "/duty_cycle/phases/0/duration_s (Duration, s): is required" in text
    assert "/duty_cycle/phases/0/speed_rmp: is not a field of this object; it looks like speed_rpm" in text


def test_an_input_that_a_gear_lacks_is_to_be_asked_for(catalogue: Catalogue) -> None:
    load = {"radial_N": 100, "radial_position_mm": 30}

    reply = told("select", catalogue, application=worked_example(output_load=load))

    assert reply["ask_for"] == ["output_load.shaft_centre_mm"]


@pytest.mark.parametrize(
    ("tool", "arguments", "text"),
    [
        ("order", {}, "there is no tool 'order'; there are select, explain, catalogue"),
        ("select", {}, "select takes application: application is required"),
        ("select", {"application": worked_example(), "gear": 1}, "select takes application: gear is no argument"),
        ("explain", {"application": worked_example()}, "designation is required"),
        ("explain", {"application": worked_example(), "designation": 5}, "designation: must be text"),
        ("explain", {"application": worked_example(), "designation": "HPN-99"}, "the catalogue has no gear 'HPN-99'"),
        ("catalogue", {"designation": "\ud800"}, "the catalogue has no gear '\\ud800'"),
        ("select", {"application": []}, "/: must be an object"),
        ("select", {"application": {}}, "/duty_cycle: is required"),
        ("select", {"application": worked_example(requirements={"ratios": [6]})}, "/requirements/ratios"),
        ("select", {"application": {"\ud800": 1}}, "/: must be a valid string"),
        ("select", {"application": cycle(phase(float("nan"), 1))}, "must be a finite number"),
        ("select", {"application": cycle(*[{"x" * 500: 1}] * 500)}, "and 1992 more"),
    ],
    ids=range(13),
)
def test_hostile_arguments_are_refused_in_few_words(
    tool: str, arguments: Json, text: str, catalogue: Catalogue
) -> None:
    refusal = refused(tool, catalogue, **arguments)

    assert text in refusal
    assert len(json.dumps(refusal)) < 4000
