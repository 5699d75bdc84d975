"""What each check tests, what goes wrong physically, on which basis it stands, and what to turn."""

from dataclasses import dataclass
from typing import Literal

from hpn.wording import N_


@dataclass(frozen=True, slots=True)
class Explanation:
    """Everything about a check that is the same for every candidate. Texts are English msgids for translation."""

    title: str
    equation: str | None
    unit: str
    kind: Literal["maximum", "minimum", "range"]
    group: Literal["load", "property"]
    limit_name: str
    source: str
    tests: str
    consequence: str
    basis: str
    remedy: str


RATING_TABLES = N_("rating tables 10.1 to 12.2")
BEARING_LIMITS = N_("F_R dyn(max) and F_A dyn(max), rating tables 10.1 to 12.2")

EXPLANATIONS: dict[str, Explanation] = {
    "average_torque": Explanation(
        title=N_("Load limit 1: average torque"),
        equation="17.2",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_A = T_N"),
        source=RATING_TABLES,
        tests=N_(
            "The average output torque T_av of the moving phases, weighted with speed and time to the power 10/3,"
            " stays within the permissible average torque."
        ),
        consequence=N_("Teeth and planet bearings fatigue: pitting and wear long before the life that was planned."),
        basis=N_(
            "The handbook tabulates no average torque T_A for HPN. Its worked example uses the rated torque T_N "
            "as T_A (equation 18.2), and so does this check."
        ),
        remedy=N_("Lower or shorten the phases with high torque, or take a gear with a larger rated torque."),
    ),
    "repeated_peak_torque": Explanation(
        title=N_("Load limit 2: repeated peak torque"),
        equation="17.7",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_R"),
        source=RATING_TABLES,
        tests=N_(
            "The largest torque of the cycle T_max, holding phases included, stays within the repeated peak torque."
        ),
        consequence=N_("Every start and stop overloads teeth and shaft; cracks grow from the tooth roots."),
        basis=N_("Limit T_R of the rating table."),
        remedy=N_("Accelerate and brake more gently, or take a gear with a larger repeated peak torque."),
    ),
    "momentary_peak_torque": Explanation(
        title=N_("Load limit 3: momentary peak torque"),
        equation="17.8",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_M"),
        source=RATING_TABLES,
        tests=N_("The emergency-stop or collision torque T_k stays within the momentary peak torque."),
        consequence=N_("A single event can deform or break teeth, or make the input coupling slip."),
        basis=N_("Limit T_M of the rating table. Such a torque must not belong to the normal cycle."),
        remedy=N_("Limit the braking torque, or take a gear with a larger momentary peak torque."),
    ),
    "momentary_peak_count": Explanation(
        title=N_("Number of momentary peak torques"),
        equation="17.9",
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("N_k max"),
        source=RATING_TABLES,
        tests=N_("The expected number of emergency stops stays within the number that T_k / T_R allows."),
        consequence=N_("Each stop uses up part of a fatigue budget; when it is spent, teeth may break."),
        basis=N_(
            "The equation holds where T_k is above T_R; at or below T_R it sets no limit. The number is a count, "
            "rounded down."
        ),
        remedy=N_(
            "Make emergency stops rarer or gentler: the allowed number grows tenfold when T_k falls by two thirds"
            " of T_R."
        ),
    ),
    "average_input_speed": Explanation(
        title=N_("Average input speed"),
        equation="17.5",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("n_av(max)"),
        source=RATING_TABLES,
        tests=N_(
            "The average output speed of the cycle, pause included, times the ratio stays within the average "
            "input speed for grease lubrication."
        ),
        consequence=N_("The gear heats up; grease thins and ages, seals wear."),
        basis=N_("Limit n_av(max) of the rating table, for grease."),
        remedy=N_("Add pause, run slower, or take a smaller ratio."),
    ),
    "maximum_input_speed": Explanation(
        title=N_("Maximum input speed"),
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("n_in(max)"),
        source=RATING_TABLES,
        tests=N_("The largest output speed of the cycle times the ratio stays within the maximum input speed."),
        consequence=N_("Input bearing and seal overheat, and the lubricant film breaks down."),
        basis=N_("Limit n_in(max) of the rating table, for grease."),
        remedy=N_("Lower the top speed, or take a smaller ratio."),
    ),
    "life": Explanation(
        title=N_("Life"),
        equation="17.10",
        unit="h",
        kind="minimum",
        group="load",
        limit_name=N_("L10 required"),
        source=RATING_TABLES,
        tests=N_("The calculated life of the gear reaches the life that you require."),
        consequence=N_("The gear wears out before the planned end of its service."),
        basis=N_(
            "The equation prints the result as L10 and so does this tool. The glossary describes the rated torque"
            " on a basis of 50 % failures; the handbook does not settle which holds. Rated input speed 3000 rpm "
            "(glossary)."
        ),
        remedy=N_("Lower the torque (life grows with the power 10/3), the speed or the duty, or take a larger gear."),
    ),
    "output_bearing_load": Explanation(
        title=N_("Output bearing: largest load"),
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("1"),
        source=BEARING_LIMITS,
        tests=N_("In every phase the load times f_w stays inside the envelope of the published maxima."),
        consequence=N_("Balls and raceways are indented, or the shaft deflects so far that the teeth run crooked."),
        basis=N_(
            "Computed between the two published limits; the handbook's printed curve was not available. That the "
            "limits belong to f_w = 1 is our reading. Slower running never enlarges this envelope."
        ),
        remedy=N_("Support the load outside the gear, move it, or take a larger size."),
    ),
    "output_bearing_life": Explanation(
        title=N_("Output bearing: life"),
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("k"),
        source=BEARING_LIMITS,
        tests=N_(
            "The equivalent load f_w P_m of the cycle stays within the load k at which the bearing reaches the "
            "required life at the average output speed."
        ),
        consequence=N_("The output bearing pits: play, noise and leakage at the shaft seal."),
        basis=N_(
            "Life by ISO 281 with exponent 3 from the published condition of 100 rpm and 20000 h as L50. L10 = "
            "L50 / 5 is the relation of the maker's other handbooks, not printed in this one."
        ),
        remedy=N_("Lower load, speed or required life, choose f_w with more care, or take a larger size."),
    ),
    "motor_speed": Explanation(
        title=N_("Motor speed"),
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("motor's maximum"),
        source=N_("your input"),
        tests=N_("The largest output speed times the ratio stays within the motor's maximum speed."),
        consequence=N_("The motor can't reach the speed that the cycle asks for."),
        basis=N_("Limit as you stated it."),
        remedy=N_("Take a smaller ratio, a faster motor, or a lower top speed."),
    ),
    "motor_peak_torque": Explanation(
        title=N_("Motor peak torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor's peak torque"),
        source=N_("your input"),
        tests=N_(
            "The largest torque of the cycle over ratio and efficiency stays within the motor's peak torque. The "
            "emergency stop does not count."
        ),
        consequence=N_("The motor can't accelerate the load as the cycle asks."),
        basis=N_(
            "T_max / (i eta) with the efficiency that you state or a supplement gives; without one loss-free, a "
            "lower bound: the handbook's efficiency curves were not available."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or accelerate more gently."),
    ),
    "motor_rated_torque": Explanation(
        title=N_("Motor rated torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor's rated torque"),
        source=N_("your input"),
        tests=N_(
            "The RMS of the torque over the cycle, pause included, over ratio and efficiency stays within the "
            "motor's rated torque."
        ),
        consequence=N_("The motor overheats."),
        basis=N_(
            "RMS of T / (i eta) with the efficiency that you state or a supplement gives; without one loss-free, "
            "a lower bound: the handbook's efficiency curves were not available."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or add pause."),
    ),
    "ambient_temperature": Explanation(
        title=N_("Ambient temperature"),
        equation=None,
        unit="°C",
        kind="range",
        group="property",
        limit_name=N_("permitted range"),
        source=RATING_TABLES,
        tests=N_("The ambient temperature lies in the range of the rating table."),
        consequence=N_("Cold grease does not flow; warm grease ages and leaks."),
        basis=N_(
            "Utilisation is the distance from the middle of the range over half the range. The lubricant's own "
            "lower limit of -10 °C is not the gear's."
        ),
        remedy=N_("Heat, cool or shield the gear, or ask the maker for another lubricant."),
    ),
    "backlash": Explanation(
        title=N_("Backlash"),
        equation=None,
        unit="arcmin",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("table 15.1"),
        tests=N_("The largest backlash of the gear stays within what you accept."),
        consequence=N_("Positioning error and knocking at reversal."),
        basis=N_("The published figure is an upper limit for new gears and follows the number of stages."),
        remedy=N_("Take a single-stage ratio, or accept more backlash."),
    ),
    "torsional_stiffness": Explanation(
        title=N_("Torsional stiffness"),
        equation=None,
        unit="Nm/rad",
        kind="minimum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("table 15.2"),
        tests=N_("The torsional stiffness K3 of the gear reaches what you require."),
        consequence=N_("The output winds up under torque and swings after a move."),
        basis=N_("K3 holds above 15 % of the rated torque (glossary)."),
        remedy=N_("Take a larger size."),
    ),
    "weight": Explanation(
        title=N_("Weight"),
        equation=None,
        unit="kg",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=RATING_TABLES,
        tests=N_("The net weight of the standard version stays within what you accept."),
        consequence=N_("The axis that carries the gear becomes slower."),
        basis=N_("Net weight without packing, by number of stages."),
        remedy=N_("Take a smaller size or a single-stage ratio."),
    ),
    "length": Explanation(
        title=N_("Length"),
        equation=None,
        unit="mm",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("tables 11.2 to 13.4"),
        tests=N_("The largest length L of the gear, which depends on the motor, stays within what you accept."),
        consequence=N_("The gear does not fit its space."),
        basis=N_("L max of the table; with a small motor the gear may be as short as L min."),
        remedy=N_("Take a smaller size or a single-stage ratio, or check the drawing for your motor."),
    ),
}
