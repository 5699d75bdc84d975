"""Meanings of the elements of IDTA 02021-1-0-1 by their short ids, letter by letter as in its template.

Most meanings are an address with the short id in it. The template has some as references to concept descriptions; a
reader compares only the addresses, without the blanks around them.
"""

from collections.abc import Mapping

BASE = "https://admin-shell.io/idta/PowerDriveTrainSizing/"
SIZING = BASE + "1/0"
TEMPLATE = "https://admin-shell.io/idta/SubmodelTemplate/SizingofPowerDriveTrains/1/0"
ASSET = "https://admin-shell.io/idta/SelfManagedEntity/1/0"
"""Asset of a mechanism in the template."""

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
"""Elements whose meaning is a reference to a concept description in the template."""


def meaning(name: str) -> str:
    """Meaning of an element by its short id in the template."""
    return _OTHERS.get(name, f"{BASE}{name}/1/0")
