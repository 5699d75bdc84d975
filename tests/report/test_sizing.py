"""Sizing of Power Drive Trains in the package: what the template asks for, in SI units, out of the account."""

import csv
import io
import math
from dataclasses import replace
from io import BytesIO
from typing import Any

import msgspec
import pytest
from basyx.aas import model

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.kept import decode
from hpn.engine.selection import encode
from hpn.files.aas.sizing_ids import meaning
from hpn.files.aas.submodel import package
from hpn.files.export import DIGITS, ExportTitle
from hpn.words.reader import Reader
from tests.build import Json, cycle, phase, worked_example
from tests.report.cases import CASES, CREATED, EVERYTHING, MOVING, typed_export_of
from tests.report.test_submodel import read

TEMPLATE = "https://admin-shell.io/idta/PowerDriveTrainSizing/1/0"
BRAKED = cycle(
    phase(40, 250),
    emergency_stop={"brake": {"torque_Nm": 20, "speed_rpm": 250, "load_torque_Nm": 12}},
    requirements={
        "ratios": [5],
        "load_inertia_kgm2": 0.05,
        "motor": {"peak_torque_Nm": 20, "rated_torque_Nm": 9, "maximum_speed_rpm": 4000, "inertia_kgm2": 0.001},
    },
)

Sized = tuple[model.Submodel, dict[str, bytes]]


@pytest.fixture(autouse=True)
def _no_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """Packages without the report, which takes most of the time of making one and of which nothing is read here."""
    monkeypatch.setattr("hpn.files.aas.submodel.has_extra", lambda extra: False)


def sized(application: Json, known: Catalogue, **changes: Any) -> Sized:
    """The submodel of an application's package, and the files beside it."""
    submodels, files = read(package(replace(typed_export_of(application, known), **changes), "3.1"))
    contents = {}
    for name in files:
        content = BytesIO()
        files.write_file(name, content)
        contents[name] = content.getvalue()
    return submodels["PowerDriveTrainSizing"], contents


def part(submodel: model.Submodel, *path: str) -> dict[str, Any]:
    """Elements of a collection or an entity of it, by short id."""
    result: Any = submodel.get_referable(list(path))
    return {str(one.id_short): one for one in (result.statement if isinstance(result, model.Entity) else result.value)}


def values(elements: dict[str, Any]) -> dict[str, Any]:
    """Values of the properties among elements."""
    return {name: one.value for name, one in elements.items() if isinstance(one, model.Property)}


def course(content: bytes) -> list[dict[str, float]]:
    """Rows of a course."""
    rows = csv.DictReader(io.StringIO(content.decode(), newline=""))
    return [{name: float(value) for name, value in row.items()} for row in rows]


SECTIONS = ("ApplicationRequirements", "MotionPattern", "MotionPatternSections")


@pytest.mark.parametrize("case", [*CASES, *MOVING])
def test_it_has_every_part_that_the_template_requires(case: str, catalogue: Catalogue) -> None:
    submodel, files = sized((CASES | MOVING)[case], catalogue)

    assert submodel.semantic_id is not None
    assert submodel.semantic_id.key[0].value == TEMPLATE
    assert {"SizingProjectInformation", *SECTIONS[:1], "SizingResult"} <= {one.id_short for one in submodel}
    required = {"ClientName", "SizingProjectName", "SizingProjectLink", "SizingToolName", "DateCreated", "DateChanged"}
    assert {*required, "ContactInformation"} <= part(submodel, "SizingProjectInformation").keys()
    assert {"Messages", "MainComponent_1"} <= part(submodel, "SizingResult").keys()
    identified = {"MainComponentType", "ManufacturerName", "ManufacturerArticleNumber", "ManufacturerOrderCode"}
    assert identified <= part(submodel, "SizingResult", "MainComponent_1").keys()
    for section in part(submodel, *SECTIONS).values():
        inside = {one.id_short: one for one in section}
        assert inside["MotionSectionFile"].value in files
    assert Application.model_validate_json(files["/aasx/application.json"])
    assert "UsageProfile" not in part(submodel, "ApplicationRequirements")


def test_ids_are_the_templates_to_the_letter(catalogue: Catalogue) -> None:
    """As the published JSON of 1.0.1 has them: a slash is missing, a blank too many, letters turn."""
    submodel, _ = sized(MOVING["rotary table"], catalogue)
    named = {
        "SizingProjectInformation": "https://admin-shell.io/idta/PowerDriveTrainSizing/SizingProjectInformation1/0",
        "RotraryTable": "https://admin-shell.io/idta/PowerDriveTrainSizing/RotraryTable/1/0",
        "InternalMomentOfIntertia": "https://admin-shell.io/idta/PowerDriveTrainSizing/InternalMomentOfInertia/1/0",
        "RotativeSection": "https://admin-shell.io/idta/PowerDriveTrainSizing/RotativeMotionPatternSection/1/0",
        "ManufacturerOrderCode": " 0173-1#02-AAO227#002",
    }

    assert {name: meaning(name) for name in named} == named
    (table,) = part(submodel, "TransformationMechanism").values()
    assert (table.id_short, table.semantic_id.key[0].value) == ("RotraryTable", named["RotraryTable"])
    order = part(submodel, "SizingResult", "MainComponent_1")["ManufacturerOrderCode"]
    assert order.semantic_id.key[0].value.strip() == named["ManufacturerOrderCode"].strip()


def test_the_project_is_that_of_the_title_block_and_what_nobody_typed_is_not_given(catalogue: Catalogue) -> None:
    typed, _ = sized(EVERYTHING, catalogue, heading=ExportTitle("Gantry", "axis-7", "MA"))
    blank, _ = sized(EVERYTHING, catalogue, heading=ExportTitle())

    of_typed, of_blank = (values(part(one, "SizingProjectInformation")) for one in (typed, blank))
    assert (of_typed["SizingProjectName"], of_typed["SizingProjectAxisReference"]) == ("Gantry", "axis-7")
    assert of_typed["DateCreated"] == of_typed["DateChanged"] == CREATED
    assert of_typed["SizingToolName"].startswith("HPN Select ")
    assert (of_blank["SizingProjectName"], of_blank["ClientName"]) == ("not given", "not given")
    contacts = [part(one, "SizingProjectInformation", "ContactInformation")["NameOfContact"] for one in (typed, blank)]
    assert [contact.value["en"] for contact in contacts] == ["MA", "not given"]


def test_phases_are_sections_in_SI_units_with_the_load_against_the_gear(catalogue: Catalogue) -> None:
    submodel, files = sized(EVERYTHING, catalogue)
    sections = part(submodel, *SECTIONS)

    assert len(sections) == 4  # three phases and the pause
    first = {one.id_short: one for one in sections["RotativeSection_1"]}
    assert values(first) == {"LoadTorque": -40.0, "RadialForce": 900.0, "AxialForce": 300.0}
    assert {one.id_short: one.value for one in first["MetadataRotativeMotionFile"]} == {
        name: 1.0 for name in ("Time", "AngularPosition", "AngularVelocity", "AngularAcceleration")
    }
    start, end = course(files[first["MotionSectionFile"].value])
    assert start["AngularVelocity"] == end["AngularVelocity"] == 250 * 2 * math.pi / 60
    assert (start["Time"], end["Time"]) == (0.0, 0.3)
    assert end["AngularPosition"] == pytest.approx(2 * math.pi * 250 / 60 * 0.3, rel=1e-12)
    pause = course(files["/aasx/motion_4.csv"])
    assert [row["AngularVelocity"] for row in pause] == [0.0, 0.0]
    assert pause[-1]["Time"] == 4.0


def test_very_many_phases_share_one_section(catalogue: Catalogue) -> None:
    phases = [phase(20 + k % 7, 100 + k, 0.5) for k in range(300)]
    submodel, files = sized(cycle(*phases), catalogue)

    assert list(part(submodel, *SECTIONS)) == ["RotativeSection_1"]
    rows = course(files["/aasx/motion_1.csv"])
    assert len(rows) == 600
    assert (rows[0]["LoadTorque"], rows[-1]["LoadTorque"], rows[-1]["Time"]) == (-20.0, -(20 + 299 % 7), 150.0)


def test_a_motion_has_its_mechanism_and_a_section_for_each_move(catalogue: Catalogue) -> None:
    submodel, files = sized(MOVING["rotary table"], catalogue)
    (table,) = part(submodel, "TransformationMechanism").values()
    mechanism = MOVING["rotary table"]["duty_cycle"]["motion"]["mechanism"]

    assert values({one.id_short: one for one in table.statement}) == {
        "Efficiency": mechanism["efficiency"],
        "StaticEccentricity": mechanism["gravity_radius_mm"] / 1000,
        "CentroidAngle": 0.0,
    }
    turn = {one.id_short: one for one in part(submodel, *SECTIONS)["RotativeSection_1"]}
    assert values(turn)["MomentOfInertiaOfLoad"] == mechanism["inertia_kgm2"]
    rows = course(files[turn["MotionSectionFile"].value])
    assert rows[-1]["Time"] == pytest.approx(0.8, rel=1e-12)
    assert rows[-1]["AngularPosition"] == pytest.approx(math.pi / 2, rel=1e-12)  # 90°
    fastest = max(row["AngularAcceleration"] for row in rows)
    assert fastest == pytest.approx(math.radians(900), rel=1e-12)


def test_utilisations_life_and_messages_are_those_of_the_answer(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    submodel, _ = sized(EVERYTHING, catalogue)
    gear, motor = (values(part(submodel, "SizingResult", f"MainComponent_{k}")) for k in (1, 2))
    check = {one.code: one for one in export.candidate.checks}

    assert gear["MainComponentType"] == "Gearbox"
    assert gear["MaxTorqueUtilizationPercentage"] == 100 * (check["repeated_peak_torque"].utilisation or 0.0)
    assert gear["MaxTorqueUtilization"] == check["repeated_peak_torque"].demand
    assert gear["MaxRotationSpeedUtilization"] == check["maximum_input_speed"].demand
    assert gear["CalculatedServiceLife"] == export.candidate.life_L10_h
    assert (motor["MainComponentType"], motor["ManufacturerName"]) == ("Motor", "not given")
    assert motor["RmsOfMotorTorque"] == export.candidate.motor_rated_torque_Nm
    messages = part(submodel, "SizingResult", "Messages").values()
    rows = [{one.id_short: one.value for one in message} for message in messages]
    assert [message["CriticalityOfMessage"] for message in rows] == ["Information"] * len(rows)
    english = Reader(digits=DIGITS)
    notices = [english.sentence(notice.sentence) for notice in export.selection.notices]
    assert [message["MessageText"]["en"] for message in rows[1:]] == notices


@pytest.mark.parametrize(
    ("case", "criticality"), [("nothing suitable", "Error"), ("not rated", "Warning"), ("example", "Information")]
)
def test_the_verdict_is_a_message_of_its_criticality(case: str, criticality: str, catalogue: Catalogue) -> None:
    submodel, _ = sized(CASES[case], catalogue)

    first = values(part(submodel, "SizingResult", "Messages", "Message_1"))
    assert first["CriticalityOfMessage"] == criticality


def test_the_system_has_its_inertias_and_its_emergency_stop(catalogue: Catalogue) -> None:
    export = typed_export_of(BRAKED, catalogue)
    submodel, _ = sized(BRAKED, catalogue)
    system = values(part(submodel, "SizingResult", "OverallSystem"))

    assert system["ExternalMomentOfInertia"] == 0.05
    assert system["InternalMomentOfIntertia"] == pytest.approx(0.001 * 25, rel=1e-12)
    assert system["MassInertiaRatio"] == pytest.approx(2.0, rel=1e-12)
    angle, lasting = export.candidate.stopping_angle_deg, export.candidate.stopping_time_s
    assert angle is not None
    assert lasting is not None
    assert system["DisplacementDuringEmergencyStop"] == math.radians(angle)
    assert system["DecelerationForEmergencyStop"] == 250 / lasting
    assert values(part(submodel, "ApplicationRequirements", "OverallSystemRequirements")) == {"BrakePresent": "true"}


def test_what_a_kept_answer_lacks_is_left_out(catalogue: Catalogue) -> None:
    export = typed_export_of(worked_example(), catalogue)
    reply = msgspec.json.decode(encode(export.selection))
    for candidate in reply["candidates"]:
        del candidate["life_L10_h"]
    record = decode(msgspec.json.encode(reply))

    submodel, _ = sized(worked_example(), catalogue, selection=record, catalogue=None)

    assert "CalculatedServiceLife" not in part(submodel, "SizingResult", "MainComponent_1")
