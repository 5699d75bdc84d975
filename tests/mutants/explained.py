"""Mutants that no test can or should find, and why."""

SAME_TYPE = "what is computed is float64 already"
ZERO = "0 divided by whatever stands for a largest of 0 is 0"
CORNER = "on a corner both sides of it say 1, and the outermost are held by the clip"
LENGTHS = "the lengths are equal by construction; strict says so"
SAME_QUOTIENT = "demand over limit is the printed equation too; the name is for readers"

EXPLAINED: dict[str, str] = {
    "equations module: \"P\" -> 'PX'": "the name of a type parameter",
    "equations average_output_torque: 1.0 -> 2.0": ZERO,
    "equations rms_torque: 1.0 -> 2.0": ZERO,
    "bearing mean_equivalent_load: 1.0 -> 2.0": ZERO,
    "bearing Curve.equivalent_load: dtype=float -> nothing": SAME_TYPE,
}
