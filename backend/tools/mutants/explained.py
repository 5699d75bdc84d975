"""Mutants that no test can or should find, and why."""

ZERO = "0 divided by whatever stands for a largest of 0 is 0"
LENGTHS = "the lengths are equal by construction, and strict says so to the reader"
LAST_OF_TWO = "an array of applications and gears has two axes, of which 1 is the last"
LAST = "the last axis is what NumPy takes anyway"
ON_THE_BOUND = "no utilisation lies on a bound to its last bit"
SOONER = "the loop ends sooner or later with the same answer"
FIRST_TWO = "the first two checks are both of the load, on the same gears"

EXPLAINED: dict[str, str] = {
    "equations module: \"P\" -> 'PX'": "the name of a type parameter",
    "equations average_output_torque: 1.0 -> 2.0": ZERO,
    "equations rms_torque: 1.0 -> 2.0": ZERO,
    "bearing mean_equivalent_load: 1.0 -> 2.0": ZERO,
    "bearing Curve.equivalent_load: dtype=float -> nothing": "the quotient is float64 already",
    "checks CHECKS[repeated_peak_torque]: share=lambda c: equations.repeated_peak_torque_utilisation( "
    "maximum_torque_Nm=c.duty.maximum_torque_Nm, repeated_peak_torque_Nm=c.gears.repeated_peak_torque_Nm ) "
    "-> nothing": "demand over limit is the same quotient; the equation stands there by its name",
    "selection gears_for: \"\" -> 'X'": "any text that names no model says that no curve is asked for",
    'selection module: "Address of the page that shows this application. The page opens up to 60,000 bytes: save a '
    'longer application and " "share the address of the saved selection." -> \'Address of the page that shows this '
    "application. The page opens up to 60,000 bytes: save a longer application and share the address of the saved "
    "selection.X'": "words for readers of the OpenAPI document; test_openapi_truth holds the number in them",
    **{f"selection candidates_of: True -> False{number}": LENGTHS for number in ("", " #2", " #3", " #4", " #5")},
    "evaluation Evaluation.status: self.used <= self.bound -> (self.used) < (self.bound)": ON_THE_BOUND,
    "evaluation Evaluation.order: axis=-1 -> nothing": LAST,
    "evaluation Evaluation.order: -1 -> (1)": LAST_OF_TWO,
    "evaluation Evaluation.foremost: among.any -> among.all": SOONER,
    "evaluation Evaluation.foremost: axis=-1 -> nothing": SOONER,
    "evaluation Evaluation.foremost: -1 -> (1)": LAST_OF_TWO,
    "evaluation Evaluation.foremost: -1 -> (1) #2": LAST_OF_TWO,
    "evaluation Evaluation.foremost: -1 -> (1) #3": LAST_OF_TWO,
    "evaluation Evaluation.foremost: -1 -> (1) #4": LAST_OF_TWO,
    "evaluation Evaluation._first_that_reaches: used[loads:] > bound[loads:] -> (used[loads:]) >= (bound[loads:])": (
        ON_THE_BOUND
    ),
    "evaluation _verdicts: largest > bound[0] -> (largest) >= (bound[0])": ON_THE_BOUND,
    "evaluation _verdicts: property_used > bound[loads] -> (property_used) >= (bound[loads])": ON_THE_BOUND,
    "evaluation _verdicts: 0 -> 1 #2": FIRST_TWO,
}
