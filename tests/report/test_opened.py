"""A sizing by IDTA 02021 is opened: by its meanings, as AASX or JSON, ours and others', within bounds."""

import io
import json
import math
import zipfile
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.files.aas.courses import LINEAR, ROTATIVE
from hpn.files.aas.opened import MOST_BYTES, OpenedSizing, is_shell, sizing_in
from hpn.files.aas.sizing_ids import SIZING
from hpn.files.aas.submodel import package
from tests.build import Json, cycle, phase, worked_example
from tests.report.cases import CASES, EVERYTHING, MOVING, typed_export_of
from tests.report.sizings import element, packed, section, shell

Alter = Callable[[str, bytes], bytes | None]


@pytest.fixture(autouse=True)
def _no_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """Packages without the report, which takes most of the time of making one and of which nothing is read here."""
    monkeypatch.setattr("hpn.files.aas.submodel.has_extra", lambda extra: False)


def rezipped(content: bytes, alter: Alter) -> bytes:
    """A package with its parts altered; None leaves one out."""
    output = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as source, zipfile.ZipFile(output, "w") as target:
        for name in source.namelist():
            part = alter(name, source.read(name))
            if part is not None:
                target.writestr(name, part)
    return output.getvalue()


def without_application(content: bytes) -> bytes:
    """A package as another tool would write it: with the elements of the template alone."""
    return rezipped(content, lambda name, part: None if name == "aasx/application.json" else part)


def application_of(found: OpenedSizing) -> Application:
    """The application of what was opened."""
    assert found.problem is None, found.problem
    return Application.model_validate_json(found.text)


@pytest.mark.parametrize("case", [*CASES, *MOVING])
def test_a_package_comes_back_as_its_application(case: str, catalogue: Catalogue) -> None:
    export = typed_export_of((CASES | MOVING)[case], catalogue)
    content = package(export)

    sizing = sizing_in(content)

    assert is_shell(content)
    assert application_of(sizing) == export.application
    assert "SizingResult" in sizing.unused
    assert not any("MotionPatternSections" in place for place in sizing.unused)


def as_numbers(application: Application) -> list[list[float]]:
    """Torque, speed, duration and loads of the phases, and the pause."""
    phases = application.duty_cycle.load_phases
    rows = [[p.torque_Nm, p.speed_rpm, p.duration_s, p.radial_N or 0.0, p.axial_N or 0.0] for p in phases]
    return [*rows, [application.duty_cycle.pause_s] * 5]


@pytest.mark.parametrize("case", ["example", "everything", "twenty phases", "ten thousand phases"])
def test_phases_come_back_out_of_the_elements_alone(case: str, catalogue: Catalogue) -> None:
    """Two ways that agree: application.json, and the sections with their courses, in SI units and back."""
    export = typed_export_of(CASES[case], catalogue)

    result = application_of(sizing_in(without_application(package(export))))

    np.testing.assert_allclose(as_numbers(result), as_numbers(export.application), rtol=1e-9)  # ends are sums of times


def test_elements_that_another_tool_has_changed_count_and_not_the_stale_application(catalogue: Catalogue) -> None:
    content = package(typed_export_of(EVERYTHING, catalogue))

    sizing = sizing_in(rezipped(content, lambda name, part: part.replace(b">-40.0<", b">-44<")))

    assert application_of(sizing).duty_cycle.load_phases[0].torque_Nm == 44.0
    assert "SizingProjectInformation" in sizing.unused


# --- Sizings of other tools -------------------------------------------------------------------------------------------


def test_a_rotary_course_of_another_tool_comes_to_phases_by_its_inertia_and_friction() -> None:
    """A trapezoid of 2 rad/s up in 1 s, 3 s on, down in 1 s: T = J α + T_f − T_load, by hand."""
    course = "Time;AngularPosition;AngularVelocity;AngularAcceleration\n0;0;0;2\n1;1;2;0\n4;7;2;-2\n5;8;0;0\n"
    inputs = section(
        "RotativeSection", ROTATIVE, "/aasx/a.csv", MomentOfInertiaOfLoad=3, FrictionTorque="1", LoadTorque=-4.0
    )

    application = application_of(sizing_in(packed(shell([inputs]), a=course)))

    up, on, down = application.duty_cycle.load_phases
    assert (up.torque_Nm, on.torque_Nm, down.torque_Nm) == (3 * 2 + 1 + 4, 5, -6 + 5)
    assert up.speed_rpm == pytest.approx(1 * 30 / math.pi, rel=1e-12)
    assert up.peak_speed_rpm == pytest.approx(2 * 30 / math.pi, rel=1e-12)
    assert (up.duration_s, on.duration_s, down.duration_s) == (1, 3, 1)


def test_a_linear_course_comes_to_phases_by_mass_weight_and_feed() -> None:
    """m (a + g sin β) ρ, ρ the feed over 2 π, over the efficiency where the motor drives."""
    course = "Time,Position,LinearVelocity,LinearAcceleration\n0,0,0,0.5\n2,1,1,0.5\n"
    inputs = section("LinearSection", LINEAR, "/aasx/a.csv", LoadMass=100)
    values = {"Efficiency": 0.8, "FeedConstant": 0.02, "InclinationAngle": math.pi / 6}
    spindle = element("SpindleDrive", [element(name, value) for name, value in values.items()], "Entity")

    application = application_of(sizing_in(packed(shell([inputs], spindle), a=course)))

    (lift,) = application.duty_cycle.load_phases
    radius = 0.02 / (2 * math.pi)
    assert lift.torque_Nm == pytest.approx(100 * (0.5 + 9.80665 / 2) * radius / 0.8, rel=1e-12)
    assert lift.speed_rpm == pytest.approx(0.5 / radius * 30 / math.pi, rel=1e-12)


def test_rest_at_the_end_is_the_pause_and_a_change_of_direction_ends_a_phase() -> None:
    course = "Time,AngularPosition,AngularVelocity,AngularAcceleration\n0,0,1,-1\n2,0,-1,-1\n"
    rest = "Time,AngularPosition,AngularVelocity,AngularAcceleration\n0,0,0,0\n3,0,0,0\n"
    sections = [
        section("RotativeSection", ROTATIVE, f"/aasx/{name}.csv", LoadTorque=load)
        for name, load in (("a", -5), ("b", 0))
    ]

    application = application_of(sizing_in(packed(shell(sections), a=course, b=rest)))

    assert [phase.speed_rpm > 0 for phase in application.duty_cycle.load_phases] == [True, False]
    assert application.duty_cycle.pause_s == 3.0


def test_what_is_not_used_is_listed_by_its_path_and_what_is_used_is_not() -> None:
    course = "Time,AngularPosition,AngularVelocity,AngularAcceleration\n0,0,2,0\n1,2,2,0\n"
    inputs = section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=-4.0, LeverArmAxialForce=0.1)
    span = {**element("AmbientTemperatureMotor", "", "Range"), "min": "10", "max": 35}
    surroundings = element("Environmental", [span, element("Atex2Gas", "true")], "SubmodelElementCollection")

    sizing = sizing_in(packed(shell([inputs], Environmental=surroundings), a=course))

    assert application_of(sizing).requirements.ambient_temperature_degC == 35.0
    place = "ApplicationRequirements/MotionPattern/MotionPatternSections/RotativeSection/theirLeverArmAxialForce"
    assert sizing.unused == (place, "ApplicationRequirements/Environmental/Atex2Gas")


@pytest.mark.parametrize(
    ("name", "value", "named"),
    [
        *(("StaticEccentricity", "0.2 m", True), ("InclinationAngle", 0.5, True), ("InclinationAngle", 0, False)),
        *(("LeverArmRadialForce", "1,1 m", True), ("Efficiency", 0, True), ("Efficiency", "0,98", False)),
        *(("Efficiency", 200, True), ("NoLoadTorque", "1,1 Nm", False)),
    ],
)
def test_what_acts_on_the_load_and_is_in_no_phase_is_said_apart(name: str, value: object, named: bool) -> None:
    """Of a table that turns: the weight of a mass off its centre would be missing without a word."""
    inputs = section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=-4.0, CompensationForce=0)
    table = element("RotraryTable", [element(name, value)], "Entity")

    sizing = sizing_in(packed(shell([inputs], table), a=COURSE))

    assert sizing.problem is None
    assert (sizing.note is not None and f": {name}. Add" in sizing.note.text) == named
    assert ("TransformationMechanism/RotraryTable" in sizing.unused) == (named or value == 0)


def test_a_package_with_its_application_has_nothing_to_be_added(catalogue: Catalogue) -> None:
    assert sizing_in(package(typed_export_of(MOVING["rotary table"], catalogue))).note is None


def test_a_temperature_that_is_no_number_of_degrees_is_listed_as_not_used() -> None:
    inputs = section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=-4.0)
    surroundings = element(
        "Environmental", [element("AmbientTemperatureMotor", "-10 – 60 °C")], "SubmodelElementCollection"
    )

    sizing = sizing_in(packed(shell([inputs], Environmental=surroundings), a=COURSE))

    assert application_of(sizing).requirements.ambient_temperature_degC is None
    assert "ApplicationRequirements/Environmental" in sizing.unused


def test_json_alone_has_no_course_and_says_what_is_missing() -> None:
    inputs = section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=-4.0)

    sizing = sizing_in(json.dumps(shell([inputs])).encode())

    assert sizing.problem is not None
    assert sizing.problem.text.startswith("RotativeSection: its course can’t be read")


def test_json_with_its_courses_inside_a_package_is_read_as_xml_is(catalogue: Catalogue) -> None:
    assert is_shell(json.dumps(shell([])).encode())
    assert not is_shell(json.dumps(worked_example()).encode())
    assert not is_shell(b"Time;Torque\n1;2\n")


COURSE = "Time,AngularPosition,AngularVelocity,AngularAcceleration\n0,0,2,0\n1,2,2,0\n"
ONE = section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=-4.0)


def with_column(value: str) -> Json:
    """A section whose time is in a unit."""
    inputs = json.loads(json.dumps(ONE))
    inputs["value"][1]["value"][0]["value"] = value
    return dict(inputs)


@pytest.mark.parametrize(
    ("environment", "course", "text"),
    [
        (shell([]), COURSE, "has no section of a motion"),
        ({"submodels": []}, COURSE, "has no Sizing of Power Drive Trains"),
        (shell([ONE]), "", "its course can’t be read"),
        (shell([ONE]), COURSE + "2,x,2,0\n", "its course can’t be read"),
        (shell([ONE]), COURSE + "2,nan,2,0\n", "its course can’t be read"),
        (shell([ONE]), COURSE + "2,1\n", "its course can’t be read"),
        (shell([ONE]), "Time,AngularVelocity\n1,2\n0,2\n", "neither speed nor position"),
        (shell([with_column("1 ms")]), COURSE, "Time is in '1 ms', and has to be in SI units"),
        (shell([with_column("1000")]), COURSE, "Time is in '1000', and has to be in SI units"),
        (shell([section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque="much")]), COURSE, "is no number"),
        (
            shell([section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque="4000 Nmm")]),
            COURSE,
            "LoadTorque is in 'Nmm', and has to be in SI units",
        ),
        (
            shell([ONE], element("SpindleDrive", [element("NoLoadTorque", "10 lb in")], "Entity")),
            COURSE,
            "NoLoadTorque is in 'lb in', and has to be in SI units",
        ),
        (
            shell([section("RotativeSection", ROTATIVE, "/aasx/a.csv", LoadTorque=1e300)]),
            COURSE,
            "/duty_cycle/phases/0",
        ),
        (
            shell([section("LinearSection", LINEAR, "/aasx/a.csv", LoadMass=1)]),
            "Time,Position,LinearVelocity\n0,0,1\n1,1,1\n",
            "lacks FeedConstant",
        ),
    ],
    ids=range(14),
)
def test_what_can_not_be_read_is_said(environment: Json, course: str, text: str) -> None:
    sizing = sizing_in(packed(environment, a=course))

    assert sizing.problem is not None
    assert text in sizing.problem.text


def bomb() -> bytes:
    """A package of kilobytes that unpacks to more than it may."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as target:
        target.writestr("aasx/data.xml", SIZING.encode() + b" " * (MOST_BYTES + 1))
    return output.getvalue()


def of_xml(text: str) -> bytes:
    """A package with this XML."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w") as target:
        target.writestr("aasx/data.xml", text)
    return output.getvalue()


LAUGHS = (
    '<!DOCTYPE e [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True))
    + f"]><e>{SIZING}&i;</e>"
)
OUTSIDE = f'<!DOCTYPE e [<!ENTITY x SYSTEM "file:///etc/passwd">]><e>{SIZING}&x;</e>'


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (bomb(), "unpacks to more than 50 MB"),
        (of_xml(LAUGHS), "declares entities"),
        (of_xml(OUTSIDE), "declares entities"),
        (of_xml("<e>" * 100_000 + SIZING), "more elements than a sizing has"),
        (of_xml(f"<e>{SIZING}"), "can’t be read"),
        (b"PK\x03\x04aasx/", "can’t be read"),
        (b'{"submodelElements": ' + b"[" * 100_000 + b'"modelType"' + SIZING.encode(), "can’t be read"),
        (json.dumps({"submodelElements": [{"value": SIZING, "modelType": [[]]}] * 3}).encode(), "has no Sizing"),
        (json.dumps({"submodels": 3, "modelType": SIZING, "submodelElements": None}).encode(), "has no Sizing"),
    ],
    ids=range(9),
)
def test_hostile_packages_are_refused_in_words(content: bytes, text: str) -> None:
    sizing = sizing_in(content)

    assert sizing.problem is not None
    assert text in sizing.problem.text


def test_a_cut_or_broken_package_is_refused_or_read_and_never_an_error(catalogue: Catalogue) -> None:
    """Bytes that are turned at places all over the package."""
    content = package(typed_export_of(worked_example(), catalogue))
    for place in range(0, len(content), len(content) // 150):
        broken = bytearray(content)
        broken[place] ^= 0x55
        assert isinstance(sizing_in(bytes(broken)), OpenedSizing)
        assert isinstance(sizing_in(content[:place]), OpenedSizing)


def test_a_course_of_very_many_samples_is_refused(catalogue: Catalogue) -> None:
    rows = "".join(f"{k},{k % 7},{k * k % 5},0\n" for k in range(20_000))

    sizing = sizing_in(packed(shell([ONE]), a="Time,AngularPosition,AngularVelocity,AngularAcceleration\n" + rows))

    assert sizing.problem is not None
    assert "more than 10000 phases" in sizing.problem.text


def test_a_saved_order_code_and_title_change_nothing(catalogue: Catalogue) -> None:
    export = typed_export_of(cycle(phase(40, 250)), catalogue)
    named = replace(export, heading=replace(export.heading, title="<&>", ordering_code="HPN-20A-5-J6"))

    assert application_of(sizing_in(package(named))) == export.application
