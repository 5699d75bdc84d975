"""Meanings of the elements of IDTA 02021-1-0-1, to the letter of its template, by their short ids.

Most are an address with the short id in it. The template has some as references to concept descriptions; a reader
compares the addresses alone, without the blanks around them.
"""

from collections.abc import Mapping

BASE = "https://admin-shell.io/idta/PowerDriveTrainSizing/"
SIZING = BASE + "1/0"
TEMPLATE = "https://admin-shell.io/idta/SubmodelTemplate/SizingofPowerDriveTrains/1/0"
ASSET = "https://admin-shell.io/idta/SelfManagedEntity/1/0"
"""Asset of a mechanism, as the template names it."""

_OTHERS: Mapping[str, str] = {
    "SizingProjectInformation": BASE + "SizingProjectInformation1/0",
    "RotativeSection": BASE + "RotativeMotionPatternSection/1/0",
    "LinearSection": BASE + "LinearMotionPatternSection/1/0",
    "Environmental": BASE + "EnvironmentalRequirements/1/0",
    "InternalMomentOfIntertia": BASE + "InternalMomentOfInertia/1/0",
    "MovingPart": BASE + "RackMovingPart/1/0",
    "Time": "https://admin-shell.io/idta/TimeSeries/RelativePointInTime/1/1",
    "BrakePresent": "0173-1#02-BAE085#007",
    "ContactInformation": "https://admin-shell.io/zvei/nameplate/1/0/ContactInformations/ContactInformation",
    "NameOfContact": "0173-1#02-AAO205#002",
    "ManufacturerName": "0173-1#02-AAO677#002",
    "ManufacturerArticleNumber": "0173-1#02-AAO676#003",
    "ManufacturerProductDesignation": "0173-1#02-AAW338#001",
    "ManufacturerOrderCode": " 0173-1#02-AAO227#002",
}
CONCEPTS = frozenset(
    ("StaticEccentricity", "CentroidAngle", "DiameterPinion", "HelixAngle", "MovingPart", "MainComponentType")
)
"""Elements whose meaning the template has as a reference to a concept description."""


def meaning(name: str) -> str:
    """Meaning of an element by its short id in the template."""
    return _OTHERS.get(name, f"{BASE}{name}/1/0")
