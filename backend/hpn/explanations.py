"""What each check tests, what goes wrong physically, on which basis it stands, and what to turn."""

from dataclasses import dataclass
from typing import Literal


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


RATING_TABLES = "rating tables 10.1 to 12.2"

EXPLANATIONS: dict[str, Explanation] = {
    "average_torque": Explanation(
        title="Load limit 1: average torque",
        equation="17.2",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name="T_A = T_N",
        source=RATING_TABLES,
        tests="The average output torque T_av of the moving phases, weighted with speed and time to the power 10/3, "
        "stays within the permissible average torque.",
        consequence="Teeth and planet bearings fatigue: pitting and wear long before the life that was planned.",
        basis="The handbook tabulates no average torque T_A for HPN. Its worked example uses the rated torque T_N as "
        "T_A (equation 18.2), and so does this check.",
        remedy="Lower or shorten the phases with high torque, or take a gear with a larger rated torque.",
    ),
    "repeated_peak_torque": Explanation(
        title="Load limit 2: repeated peak torque",
        equation="17.7",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name="T_R",
        source=RATING_TABLES,
        tests="The largest torque of the cycle T_max, holding phases included, stays within the repeated peak torque.",
        consequence="Every start and stop overloads teeth and shaft; cracks grow from the tooth roots.",
        basis="Limit T_R of the rating table.",
        remedy="Accelerate and brake more gently, or take a gear with a larger repeated peak torque.",
    ),
    "momentary_peak_torque": Explanation(
        title="Load limit 3: momentary peak torque",
        equation="17.8",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name="T_M",
        source=RATING_TABLES,
        tests="The emergency-stop or collision torque T_k stays within the momentary peak torque.",
        consequence="A single event can deform or break teeth, or make the input coupling slip.",
        basis="Limit T_M of the rating table. Such a torque must not belong to the normal cycle.",
        remedy="Limit the braking torque, or take a gear with a larger momentary peak torque.",
    ),
    "momentary_peak_count": Explanation(
        title="Number of momentary peak torques",
        equation="17.9",
        unit="",
        kind="maximum",
        group="load",
        limit_name="N_k max",
        source=RATING_TABLES,
        tests="The expected number of emergency stops stays within the number that T_k / T_R allows.",
        consequence="Each stop uses up part of a fatigue budget; when it is spent, teeth may break.",
        basis="The equation holds where T_k is above T_R; at or below T_R it sets no limit. The number is a count, "
        "rounded down.",
        remedy="Make emergency stops rarer or gentler: the allowed number grows tenfold when T_k falls by two thirds "
        "of T_R.",
    ),
    "average_input_speed": Explanation(
        title="Average input speed",
        equation="17.5",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name="n_av(max)",
        source=RATING_TABLES,
        tests="The average output speed of the cycle, pause included, times the ratio stays within the average input "
        "speed for grease lubrication.",
        consequence="The gear heats up; grease thins and ages, seals wear.",
        basis="Limit n_av(max) of the rating table, for grease.",
        remedy="Add pause, run slower, or take a smaller ratio.",
    ),
    "maximum_input_speed": Explanation(
        title="Maximum input speed",
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name="n_in(max)",
        source=RATING_TABLES,
        tests="The largest output speed of the cycle times the ratio stays within the maximum input speed.",
        consequence="Input bearing and seal overheat, and the lubricant film breaks down.",
        basis="Limit n_in(max) of the rating table, for grease.",
        remedy="Lower the top speed, or take a smaller ratio.",
    ),
    "life": Explanation(
        title="Life",
        equation="17.10",
        unit="h",
        kind="minimum",
        group="load",
        limit_name="L10 required",
        source=RATING_TABLES,
        tests="The calculated life of the gear reaches the life that you require.",
        consequence="The gear wears out before the planned end of its service.",
        basis="The equation prints the result as L10 and so does this tool. The glossary describes the rated torque on "
        "a basis of 50 % failures; the handbook does not settle which holds. Rated input speed 3000 rpm (glossary).",
        remedy="Lower the torque (life grows with the power 10/3), the speed or the duty, or take a larger gear.",
    ),
    "output_bearing_load": Explanation(
        title="Output bearing: largest load",
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name="1",
        source="F_R dyn(max) and F_A dyn(max), " + RATING_TABLES,
        tests="In every phase the load times f_w stays inside the envelope of the published maxima.",
        consequence="Balls and raceways are indented, or the shaft deflects so far that the teeth run crooked.",
        basis="Computed between the two published limits; the handbook's printed curve was not available. That the "
        "limits belong to f_w = 1 is our reading. Slower running never enlarges this envelope.",
        remedy="Support the load outside the gear, move it, or take a larger size.",
    ),
    "output_bearing_life": Explanation(
        title="Output bearing: life",
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name="k",
        source="F_R dyn(max) and F_A dyn(max), " + RATING_TABLES,
        tests="The equivalent load f_w P_m of the cycle stays within the load k at which the bearing reaches the "
        "required life at the average output speed.",
        consequence="The output bearing pits: play, noise and leakage at the shaft seal.",
        basis="Life by ISO 281 with exponent 3 from the published condition of 100 rpm and 20000 h as L50. "
        "L10 = L50 / 5 is the relation of the maker's other handbooks, not printed in this one.",
        remedy="Lower load, speed or required life, choose f_w with more care, or take a larger size.",
    ),
    "motor_speed": Explanation(
        title="Motor speed",
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name="motor's maximum",
        source="your input",
        tests="The largest output speed times the ratio stays within the motor's maximum speed.",
        consequence="The motor can't reach the speed that the cycle asks for.",
        basis="Limit as you stated it.",
        remedy="Take a smaller ratio, a faster motor, or a lower top speed.",
    ),
    "motor_peak_torque": Explanation(
        title="Motor peak torque",
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name="motor's peak torque",
        source="your input",
        tests="The largest torque of the cycle over ratio and efficiency stays within the motor's peak torque. The "
        "emergency stop does not count.",
        consequence="The motor can't accelerate the load as the cycle asks.",
        basis="T_max / (i eta) with the efficiency that you state or a supplement gives; without one loss-free, a "
        "lower bound: the handbook's efficiency curves were not available.",
        remedy="Take a larger ratio, a stronger motor, or accelerate more gently.",
    ),
    "motor_rated_torque": Explanation(
        title="Motor rated torque",
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name="motor's rated torque",
        source="your input",
        tests="The RMS of the torque over the cycle, pause included, over ratio and efficiency stays within the "
        "motor's rated torque.",
        consequence="The motor overheats.",
        basis="RMS of T / (i eta) with the efficiency that you state or a supplement gives; without one loss-free, a "
        "lower bound: the handbook's efficiency curves were not available.",
        remedy="Take a larger ratio, a stronger motor, or add pause.",
    ),
    "ambient_temperature": Explanation(
        title="Ambient temperature",
        equation=None,
        unit="°C",
        kind="range",
        group="property",
        limit_name="permitted range",
        source=RATING_TABLES,
        tests="The ambient temperature lies in the range of the rating table.",
        consequence="Cold grease does not flow; warm grease ages and leaks.",
        basis="Utilisation is the distance from the middle of the range over half the range. The lubricant's own lower "
        "limit of -10 °C is not the gear's.",
        remedy="Heat, cool or shield the gear, or ask the maker for another lubricant.",
    ),
    "backlash": Explanation(
        title="Backlash",
        equation=None,
        unit="arcmin",
        kind="maximum",
        group="property",
        limit_name="your limit",
        source="table 15.1",
        tests="The largest backlash of the gear stays within what you accept.",
        consequence="Positioning error and knocking at reversal.",
        basis="The published figure is an upper limit for new gears and follows the number of stages.",
        remedy="Take a single-stage ratio, or accept more backlash.",
    ),
    "torsional_stiffness": Explanation(
        title="Torsional stiffness",
        equation=None,
        unit="Nm/rad",
        kind="minimum",
        group="property",
        limit_name="your limit",
        source="table 15.2",
        tests="The torsional stiffness K3 of the gear reaches what you require.",
        consequence="The output winds up under torque and swings after a move.",
        basis="K3 holds above 15 % of the rated torque (glossary).",
        remedy="Take a larger size.",
    ),
    "weight": Explanation(
        title="Weight",
        equation=None,
        unit="kg",
        kind="maximum",
        group="property",
        limit_name="your limit",
        source=RATING_TABLES,
        tests="The net weight of the standard version stays within what you accept.",
        consequence="The axis that carries the gear becomes slower.",
        basis="Net weight without packing, by number of stages.",
        remedy="Take a smaller size or a single-stage ratio.",
    ),
    "length": Explanation(
        title="Length",
        equation=None,
        unit="mm",
        kind="maximum",
        group="property",
        limit_name="your limit",
        source="tables 11.2 to 13.4",
        tests="The largest length L of the gear, which depends on the motor, stays within what you accept.",
        consequence="The gear does not fit its space.",
        basis="L max of the table; with a small motor the gear may be as short as L min.",
        remedy="Take a smaller size or a single-stage ratio, or check the drawing for your motor.",
    ),
}
