"""The application: the user's inputs, its phases or motion, and the faults of an input."""

from hpn.application.application import (
    LEAST_MOTION,
    STOP_LOADS,
    WORKED_EXAMPLE,
    Application,
    ApplicationArea,
    BatchItem,
    Brake,
    DutyCycle,
    EmergencyStop,
    RankBy,
)
from hpn.application.faults import InputError, Location
from hpn.application.motor import FURTHER_FIGURES, LISTED_FIGURES, CurvePoint, Motor
from hpn.application.pairing import MOST_MOTORS, MotorEntry, Pairing, PairRank
from hpn.application.requirements import (
    BEARING_LIFE_H,
    MOST_WISHES,
    BearingModel,
    Drive,
    LifeBasis,
    OutputLoad,
    Requirements,
)

__all__ = [
    "BEARING_LIFE_H",
    "FURTHER_FIGURES",
    "LEAST_MOTION",
    "LISTED_FIGURES",
    "MOST_MOTORS",
    "MOST_WISHES",
    "STOP_LOADS",
    "WORKED_EXAMPLE",
    "Application",
    "ApplicationArea",
    "BatchItem",
    "BearingModel",
    "Brake",
    "CurvePoint",
    "Drive",
    "DutyCycle",
    "EmergencyStop",
    "InputError",
    "LifeBasis",
    "Location",
    "Motor",
    "MotorEntry",
    "OutputLoad",
    "PairRank",
    "Pairing",
    "RankBy",
    "Requirements",
]
