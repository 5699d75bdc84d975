"""Mutants that no test can or should find, and why."""

ZERO = "0 divided by whatever stands for a largest of 0 is 0"
LENGTHS = "the lengths are equal by construction, and strict says so to the reader"

EXPLAINED: dict[str, str] = {
    "equations module: \"P\" -> 'PX'": "the name of a type parameter",
    "equations average_output_torque: 1.0 -> 2.0": ZERO,
    "equations rms_torque: 1.0 -> 2.0": ZERO,
    "bearing mean_equivalent_load: 1.0 -> 2.0": ZERO,
    "bearing Curve.equivalent_load: dtype=float -> nothing": "the quotient is float64 already",
    "checks CHECKS[repeated_peak_torque]: share=lambda c: equations.repeated_peak_torque_utilisation( "
    "maximum_torque_Nm=c.duty.maximum_torque_Nm, repeated_peak_torque_Nm=c.gears.repeated_peak_torque_Nm ) "
    "-> nothing": "demand over limit is the same quotient; the equation stands there by its name",
    "checks CHECKS[momentary_peak_torque]: share=lambda c: equations.momentary_peak_torque_utilisation( "
    "emergency_stop_torque_Nm=c.duty.emergency_stop_torque_Nm, "
    "momentary_peak_torque_Nm=c.gears.momentary_peak_torque_Nm, ) "
    "-> nothing": "demand over limit is the same quotient; the equation stands there by its name",
    **{f"selection candidates_of: True -> False{number}": LENGTHS for number in ("", " #2", " #3", " #4", " #5")},
}
