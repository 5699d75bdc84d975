"""`PowerDriveTrainSizing` by IDTA 02021-1-0-1: application and answer in the form that sizing tools exchange.

Short ids and meanings are those of the template letter by letter, with its spelling mistakes: readers look for those.
The template types 142 real quantities as integers; here they are doubles, since hardly any figure is whole. Inputs
without a place in the template are in `application.json`, to which `SizingProjectLink` leads. `UsageProfile` is left
out, since the user is not asked for it. Torques and forces act on the load from outside: the gear's are their negative.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime

from basyx.aas import model

from hpn.account.account import Account
from hpn.application import Application
from hpn.application.motion import LinearMotion, RotaryMotion
from hpn.engine.candidates import reason_of
from hpn.files.aas.concepts import reference, translations, urn
from hpn.files.aas.courses import sections_of
from hpn.files.aas.elements import NOT_GIVEN, group, template, text, words
from hpn.files.aas.sections import elements_of, number
from hpn.files.aas.sizing_ids import ASSET, SIZING, TEMPLATE, meaning
from hpn.files.aas.technical import MANUFACTURER, dated, order_code, product_names
from hpn.files.carried import APPLICATION
from hpn.files.export import Export
from hpn.physics.motion.mechanisms import RackAndPinion
from hpn.words.wording import Sentence

Statements = list[model.SubmodelElement]

FOLDER = "/aasx/"
ENTITIES: Mapping[str, str] = {
    "rotary": "RotraryTable",
    "rack_and_pinion": "RackDrive",
    "belt": "BeltDrive",
    "ball_screw": "SpindleDrive",
}
"""Entities of the template by the mechanism of a motion."""

SAYS = {
    "en": "Written by an independent tool: check the selection with the manufacturer before ordering. Real quantities "
    "are doubles, where the template has integers. Torques and forces of the sections act on the load from outside; "
    "what the template has no place for is in application.json.",
    "de": "Von einem unabhängigen Werkzeug geschrieben: Die Auswahl ist vor der Bestellung mit dem Hersteller zu "
    "prüfen. Reelle Größen sind Gleitkommazahlen, wo die Vorlage ganze Zahlen hat. Momente und Kräfte der Abschnitte "
    "wirken von außen auf die Last; wofür die Vorlage keinen Platz hat, steht in application.json.",
}


def files_of(export: Export) -> Mapping[str, bytes]:
    """Files of the sections by their places in the package."""
    sections = sections_of(export.application.duty_cycle)
    return {_place(number): section.csv() for number, section in enumerate(sections, 1)}


def _place(number: int) -> str:
    return f"{FOLDER}motion_{number}.csv"


def sizing(export: Export) -> model.Submodel:
    """Submodel of an export."""
    moment = dated(export)
    parts = [
        *([_information(export, moment)] if moment else []),
        _requirements(export),
        *_mechanism(export.application),
        _answer(export),
    ]
    return model.Submodel(
        urn("sizing", export.link),
        parts,
        id_short="PowerDriveTrainSizing",
        administration=model.AdministrativeInformation(version="1", revision="0", template_id=TEMPLATE),
        semantic_id=template(SIZING),
    )


def _text(name: str, value: str) -> model.Property:
    return text(name, value, meaning(name))


def _group(name: str, elements: Iterable[model.SubmodelElement]) -> model.SubmodelElementCollection:
    return group(name, elements, meaning(name))


def _information(export: Export, moment: datetime) -> model.SubmodelElementCollection:
    heading = export.heading
    dates = [
        model.Property(name, datetime, moment, semantic_id=reference(meaning(name)))
        for name in ("DateCreated", "DateChanged")
    ]
    axis = [_text("SizingProjectAxisReference", heading.reference)] if heading.reference else []
    link = reference(meaning("SizingProjectLink"))
    contact = words("NameOfContact", {"en": heading.author or NOT_GIVEN}, meaning("NameOfContact"))
    return _group(
        "SizingProjectInformation",
        [
            _text("ClientName", NOT_GIVEN),
            _text("SizingProjectName", heading.title or NOT_GIVEN),
            *axis,
            model.File("SizingProjectLink", "application/json", FOLDER + APPLICATION, semantic_id=link),
            _text("SizingToolName", f"HPN Select {export.selection.engine_version}"),
            *dates,
            _group("ContactInformation", [contact]),
        ],
    )


# --- Requirements -----------------------------------------------------------------------------------------------------


def _requirements(export: Export) -> model.SubmodelElementCollection:
    application = export.application
    sections = elements_of((each, _place(k)) for k, each in enumerate(sections_of(application.duty_cycle), 1))
    name = [_text("MotionPatternName", export.heading.title)] if export.heading.title else []
    pattern = _group("MotionPattern", [*name, _group("MotionPatternSections", sections)])
    brake = application.emergency_stop is not None and application.emergency_stop.brake is not None
    system = [_group("OverallSystemRequirements", [_text("BrakePresent", "true")])] if brake else []
    return _group("ApplicationRequirements", [pattern, *_environment(application), *system])


def _environment(application: Application) -> Iterator[model.SubmodelElementCollection]:
    if (degrees := application.requirements.ambient_temperature_degC) is not None:
        name = "AmbientTemperatureMotor"
        span = model.Range(name, float, degrees, degrees, semantic_id=reference(meaning(name)))
        yield _group("Environmental", [span])


def _mechanism(application: Application) -> Iterator[model.SubmodelElementCollection]:
    motion = application.duty_cycle.motion
    if motion is None:
        return
    kind = ENTITIES[motion.mechanism.type]
    values = _of_rotary(motion) if isinstance(motion, RotaryMotion) else _of_linear(motion, application)
    statements = [number(name, value) for name, value in values.items()]
    entity = model.Entity(
        kind,
        model.EntityType.SELF_MANAGED_ENTITY,
        statements,
        global_asset_id=ASSET,
        semantic_id=reference(meaning(kind)),
    )
    yield _group("TransformationMechanism", [entity])


def _of_rotary(motion: RotaryMotion) -> dict[str, float]:
    mechanism = motion.mechanism
    values = {"Efficiency": mechanism.efficiency}
    if mechanism.gravity_radius_mm is None:
        return values
    off_centre = {"StaticEccentricity": mechanism.gravity_radius_mm / 1000}
    return values | off_centre | {"CentroidAngle": math.radians(motion.start_deg)}


def _of_linear(motion: LinearMotion, application: Application) -> dict[str, float]:
    mechanism = motion.mechanism
    values = {
        "Efficiency": mechanism.efficiency,
        "InertiaMotorSide": mechanism.inertia_kgm2,
        "NoLoadTorque": mechanism.friction_torque_Nm,
        "InclinationAngle": math.radians(mechanism.incline_deg),
        "FrictionCoefficient": mechanism.friction_coefficient,
        "FeedConstant": 2 * math.pi * mechanism.radius_mm / 1000,
    }
    if isinstance(mechanism, RackAndPinion):
        values["DiameterPinion"] = mechanism.diameter_mm / 1000
        helix = application.output_load and application.output_load.rack_helix_deg
        if helix:
            values["HelixAngle"] = math.radians(helix)
    return values


# --- Answer -----------------------------------------------------------------------------------------------------------


def _answer(export: Export) -> model.SubmodelElementCollection:
    account = export.account
    return _group(
        "SizingResult",
        [
            _entity("OverallSystem", _system(account)),
            _entity("MainComponent_1", _gearbox(export)),
            *_motor(account),
            _messages(export),
            words("TextStatement", SAYS, meaning("TextStatement")),
        ],
    )


def _entity(name: str, statements: Statements) -> model.Entity:
    kind = name.partition("_")[0]
    return model.Entity(name, model.EntityType.CO_MANAGED_ENTITY, statements, semantic_id=reference(meaning(kind)))


def _numbers(values: Mapping[str, float | None]) -> Statements:
    """Quantities with a value."""
    return [number(name, value) for name, value in values.items() if value is not None]


def _system(account: Account) -> Statements:
    """Inertias at the gear's output, and the emergency stop by the brake."""
    candidate, application = account.candidate, account.equipped
    requirements = application.requirements if application else None
    typed = requirements.load_inertia_kgm2 if requirements else None
    load = account.selection.duty.load_inertia_kgm2 or typed
    motor = requirements.motor.inertia_kgm2 if requirements and requirements.motor else None
    own = None if motor is None else motor * candidate.ratio**2
    angle, lasting = (_figure(account, name) for name in ("stopping_angle_deg", "stopping_time_s"))
    brake = application.emergency_stop.brake if application and application.emergency_stop else None
    speed = brake and (brake.speed_rpm or account.selection.duty.maximum_output_speed_rpm)
    return _numbers(
        {
            "ExternalMomentOfInertia": load,
            "InternalMomentOfIntertia": own,
            "MassInertiaRatio": load / own if load and own else None,
            "DecelerationForEmergencyStop": speed / lasting if speed and lasting else None,
            "DisplacementDuringEmergencyStop": None if angle is None else math.radians(angle),
        }
    )


def _figure(account: Account, name: str) -> float | None:
    """Figure of the gear; None also where a saved answer lacks it."""
    line = account.line(f"candidate.{name}")
    return line.value if line is not None and isinstance(line.value, float) else None


def _shares(account: Account, share: str, value: str, code: str) -> dict[str, float | None]:
    """Share of a limit in percent, and the demand."""
    check = account.check(code)
    if check is None:
        return {}
    used = check.result.utilisation
    return {share: None if used is None else 100 * used, value: check.result.demand}


def _gearbox(export: Export) -> Statements:
    account, designation = export.account, export.candidate.designation
    torque = _shares(account, "MaxTorqueUtilizationPercentage", "MaxTorqueUtilization", "repeated_peak_torque")
    speed = _shares(
        account, "MaxRotationSpeedUtilizationPercentage", "MaxRotationSpeedUtilization", "maximum_input_speed"
    )
    return [
        _text("MainComponentType", "Gearbox"),
        _text("ManufacturerName", MANUFACTURER),
        _text("ManufacturerArticleNumber", designation),
        words("ManufacturerProductDesignation", product_names(export), meaning("ManufacturerProductDesignation")),
        _text("ManufacturerOrderCode", order_code(export)),
        *_numbers({**torque, **speed, "CalculatedServiceLife": _figure(account, "life_L10_h")}),
    ]


def _motor(account: Account) -> Iterator[model.Entity]:
    motor = account.application.requirements.motor if account.application else None
    if motor is None:
        return
    torque = _shares(account, "MaxTorqueUtilizationPercentage", "MaxTorqueUtilization", "motor_peak_torque")
    speed = _shares(account, "MaxRotationSpeedUtilizationPercentage", "MaxRotationSpeedUtilization", "motor_speed")
    rated, ratio = account.check("motor_rated_torque"), account.check("inertia_ratio")
    used = rated.result.utilisation if rated else None
    named = motor.designation or NOT_GIVEN
    statements = [
        _text("MainComponentType", "Motor"),
        _text("ManufacturerName", NOT_GIVEN),
        _text("ManufacturerArticleNumber", named),
        _text("ManufacturerOrderCode", named),
        *_numbers(
            {
                **torque,
                **speed,
                "EffectiveUtilization": None if used is None else 100 * used,
                "MassInertiaRatio": ratio.result.demand if ratio else None,
                "RmsOfMotorTorque": _figure(account, "motor_rated_torque_Nm"),
            }
        ),
    ]
    yield _entity("MainComponent_2", statements)


def _messages(export: Export) -> model.SubmodelElementCollection:
    """Message with the verdict (an error for a rejected gear, a warning for an unrated one), and one for each
    notice."""
    candidate = export.candidate
    criticality = {"suitable": "Information", "unrated": "Warning", "unsuitable": "Error"}[candidate.status]
    texts: list[tuple[str, Sentence]] = [
        (criticality, reason_of(candidate, export.account.utilisation)),
        *(("Information", notice.sentence) for notice in export.selection.notices),
    ]
    messages = [
        group(
            f"Message_{place}",
            [
                _text("CriticalityOfMessage", level),
                words("MessageText", translations(sentence), meaning("MessageText")),
            ],
            meaning("Message"),
        )
        for place, (level, sentence) in enumerate(texts, 1)
    ]
    return _group("Messages", messages)
