"""Checks of properties against the user's requirements: temperature, stiffness, accuracy, weight and length."""

from typing import Any

import numpy as np

from hpn.engine.check import RATING_TABLES, Case, Check, Kind
from hpn.physics.equations import FloatArray
from hpn.physics.stiffness import ARCMIN_PER_RAD
from hpn.words.wording import N_


def _middle_and_half(case: Case) -> tuple[FloatArray, FloatArray]:
    lowest, highest = case.gears.ambient_temperature_minimum_degC, case.gears.ambient_temperature_maximum_degC
    return (lowest + highest) / 2, (highest - lowest) / 2


def _nearer_end(case: Case) -> FloatArray:
    """The end of the permitted temperature range on the same side of the middle as the asked temperature."""
    ambient, gears = case.inputs["requirements.ambient_temperature_degC"], case.gears
    middle, _ = _middle_and_half(case)
    end = np.where(ambient >= middle, gears.ambient_temperature_maximum_degC, gears.ambient_temperature_minimum_degC)
    return np.where(np.isnan(middle), np.nan, end)


def _distance_from_middle(case: Case) -> FloatArray:
    middle, half = _middle_and_half(case)
    distance: FloatArray = np.abs(case.inputs["requirements.ambient_temperature_degC"] - middle) / half
    return distance


_MIDDLE = "(({amb_min}+{amb_max})/2)"


def _permitted_error(case: Case) -> FloatArray:
    """Permitted position error in arcmin: as given, else from the length at its radius."""
    angle, length = case.inputs["requirements.position_error_arcmin"], case.inputs["requirements.position_error_mm"]
    by_length = length / case.inputs["requirements.position_radius_mm"] * ARCMIN_PER_RAD
    return np.where(np.isnan(angle), by_length, angle)


def _of_figure(figure: str, kind: Kind, **texts: Any) -> Check:
    """Check of a published figure against the requirement of the same name; `texts` are further fields of `Check`."""
    trigger = f"requirements.{figure}"
    return Check(
        **texts,
        kind=kind,
        group="property",
        limit_name=N_("your limit"),
        trigger=trigger,
        demand=lambda case: getattr(case.gears, figure),
        limited_by=figure,
        over={trigger: "rising" if kind == "minimum" else "falling"},
    )


PROPERTIES: tuple[Check, ...] = (
    Check(
        code="ambient_temperature",
        name=N_("ambient temperature"),
        title=N_("Ambient temperature"),
        unit="°C",
        kind="range",
        group="property",
        limit_name=N_("permitted range"),
        source=RATING_TABLES,
        tests=N_("The ambient temperature lies in the range of the rating table."),
        consequence=N_("Cold grease does not flow; warm grease ages and leaks."),
        basis=N_(
            "Utilisation is the distance from the middle of the range divided by half the range. The lubricant’s "
            "range reaches down to −10 °C, the gear’s does not."
        ),
        remedy=N_("Heat, cool or shield the gear, or ask the manufacturer for another lubricant."),
        trigger="requirements.ambient_temperature_degC",
        demand=lambda c: c.inputs["requirements.ambient_temperature_degC"],
        limit=_nearer_end,
        share=_distance_from_middle,
        limited_by="ambient_temperature_maximum_degC",
        relation="t_min ≤ t_amb ≤ t_max",
        over={"requirements.ambient_temperature_degC": "ends"},
    ),
    _of_figure(
        "backlash_arcmin",
        "maximum",
        code="backlash",
        name=N_("backlash"),
        title=N_("Backlash"),
        unit="arcmin",
        source=N_("table 15.1"),
        tests=N_("The largest backlash of the gear stays within your limit."),
        consequence=N_("Positioning error and knocking at reversal."),
        basis=N_("The published figure is an upper limit for new gears and depends on the number of stages."),
        remedy=N_("Choose a single-stage ratio, or accept more backlash."),
        relation="j ≤ j_req",
        accepted=N_("the backlash limit rises to {value}"),
    ),
    _of_figure(
        "torsional_stiffness_Nm_per_rad",
        "minimum",
        code="torsional_stiffness",
        name=N_("torsional stiffness"),
        title=N_("Torsional stiffness"),
        unit="Nm/rad",
        source=N_("table 15.2"),
        tests=N_("The torsional stiffness K_3 of the gear reaches the required one."),
        consequence=N_("The output winds up under torque and oscillates after a move."),
        basis=N_("K_3 holds above 15 % of the rated torque (glossary)."),
        remedy=N_("Choose a larger size."),
        relation="K_3 ≥ K_3,req",
        accepted=N_("the required torsional stiffness drops to {value}"),
    ),
    Check(
        code="natural_frequency",
        name=N_("natural frequency"),
        title=N_("Natural frequency"),
        unit="Hz",
        kind="minimum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("table 15.2"),
        tests=N_("With the motor held, the natural frequency of the load on the gear reaches the required one."),
        consequence=N_("The axis rings after each move and can’t be controlled stiffly."),
        basis=N_(
            "√(K_3 / J_L) / 2π with the torsional stiffness of the gear alone: an upper bound, which couplings and the "
            "gear’s own inertia lower. K_3 holds above 15 % of the rated torque (glossary)."
        ),
        remedy=N_("Choose a larger size, or a load with less inertia."),
        trigger="requirements.natural_frequency_Hz",
        demand=lambda c: c.figures.natural_frequency_Hz,
        limited_by="torsional_stiffness_Nm_per_rad",
        relation="√(K_3 / J_L) / 2π ≥ f_req",
        accepted=N_("the required natural frequency drops to {value}"),
        over={
            "requirements.natural_frequency_Hz": "rising",
            "requirements.load_inertia_kgm2": "rising",
            "motion": "ends",
        },
    ),
    Check(
        code="position_error",
        name=N_("position error"),
        title=N_("Position error"),
        unit="arcmin",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("tables 15.1 and 15.2"),
        tests=N_(
            "Transmission accuracy, wind-up between the smallest and the largest torque of the cycle or of its rest, "
            "and the backlash where the torque passes 0, together stay within your limit."
        ),
        consequence=N_("The axis deviates from its position by more than the task allows."),
        basis=N_(
            "Approximate: arithmetic sum of the limits of a new gear. The wind-up is a lower bound, since the gear is "
            "softer below 15 % of the rated torque (glossary). At rest dry friction holds the axis to either side."
        ),
        remedy=N_(
            "Choose a larger size or a single-stage ratio, lower the torque, or measure the position at the load."
        ),
        trigger="requirements.position_error_arcmin",
        instead="requirements.position_error_mm",
        demand=lambda c: c.figures.position_error_arcmin,
        limit=_permitted_error,
        limited_by="torsional_stiffness_Nm_per_rad",
        relation="φ_e ≤ φ_req",
        accepted=N_("the permitted position error rises to {value}"),
        over={
            "peak_torque_Nm": "rising",
            "torque_sign": "unproven",
            "requirements.rest_friction_Nm": "rising",
            "requirements.position_error_arcmin": "falling",
            "requirements.position_error_mm": "falling",
            "requirements.position_radius_mm": "rising",
            "motion": "unproven",
        },
        proven=lambda c: c.duty.torque_both_ways,
    ),
    _of_figure(
        "weight_kg",
        "maximum",
        code="weight",
        name=N_("weight"),
        title=N_("Weight"),
        unit="kg",
        source=RATING_TABLES,
        tests=N_("The net weight of the standard version stays within your limit."),
        consequence=N_("The axis that carries the gear becomes slower."),
        basis=N_("Net weight without packing, by number of stages."),
        remedy=N_("Choose a smaller size or a single-stage ratio."),
        relation="m ≤ m_req",
        accepted=N_("the weight limit rises to {value}"),
    ),
    Check(
        code="length",
        name=N_("length"),
        title=N_("Length"),
        unit="mm",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("tables 11.2 to 13.4"),
        tests=N_("The largest length L of the gear, which depends on the motor, stays within your limit."),
        consequence=N_("The gear does not fit the installation space."),
        basis=N_("L_max of the table; with a small motor the gear may be as short as L_min."),
        remedy=N_("Choose a smaller size or a single-stage ratio, or check the drawing for your motor."),
        trigger="requirements.length_mm",
        demand=lambda c: c.gears.length_max_mm,
        limited_by="length_max_mm",
        relation="L_max ≤ L_req",
        accepted=N_("the length limit rises to {value}"),
        over={"requirements.length_mm": "falling"},
    ),
)
