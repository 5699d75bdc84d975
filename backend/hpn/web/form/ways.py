"""Ways to give a duty cycle: as phases, or as the motion of a mechanism. Inputs of the other ways are kept aside.

A form has the inputs of one way; a field `aside` for each other way holds its inputs as a query.
"""

from urllib.parse import parse_qsl, urlencode

from hpn.application import Application, DutyCycle
from hpn.application.phase import Phase
from hpn.links.row_symbols import PHASE_SYMBOLS
from hpn.links.rows import OF_ANY_ROW
from hpn.links.symbols import mechanism_symbols
from hpn.links.writer import to_link
from hpn.physics.motion.mechanisms import CLASSES, TYPES
from hpn.tables.numbers import Entry
from hpn.web.form.query import REST_FRICTION, REVERSES, Pairs, SortedQuery, is_of_one_way
from hpn.words.wording import N_

PHASES, MOTION = "phases", "motion"

_OF_PHASES_ALONE = {symbol.name for symbol in PHASE_SYMBOLS}.difference(OF_ANY_ROW)

MOST_FIELDS = 20_000
DIGITS = 6
"""Significant digits of the phases that are taken over from a motion."""

START = {way: f"mech={way}&mv=trapezoidal&ms=&mt=" for way in TYPES} | {PHASES: "T=&n=&t="}
"""Query of each way with blank inputs; a motion has a profile, without which its move would have no open cell."""


EXAMPLES = {
    "/?mech=rotary&J=2.5&Tf=3&mv=trapezoidal&ms=90&mt=0.6&mv=dwell&ms=&mt=1.2": N_("rotary table"),
    "/?mech=ball_screw&J=0.0015&etam=0.9&h=20&ml=120&inc=90&mu=0.02"
    "&mv=s_curve&ms=400&mt=1.5&mv=dwell&ms=&mt=0.5&mv=s_curve&ms=-400&mt=1.5&mv=dwell&ms=&mt=0.5": N_("ball screw"),
}
"""Links of example motions, and their names."""


def way_of(pairs: Pairs) -> str:
    """Way in which the duty cycle of pairs is given."""
    code = next((text.strip() for name, text in pairs if name == "mech"), "")
    return code if code in TYPES else PHASES


def switch(current: SortedQuery, way: str) -> None:
    """Switch to another way: restore its inputs, put the present ones aside."""
    own = current.cycle()
    queries = {way_of(query): query for query in map(_pairs_of, current.asides)}
    here = way_of(own)
    if here != PHASES:
        stray = [pair for pair in own if pair[0] in _OF_PHASES_ALONE]  # given beside a motion
        own = [pair for pair in own if pair[0] not in _OF_PHASES_ALONE]
        if _says_anything(stray):
            queries[PHASES] = stray
    if way == MOTION:
        way = here if here != PHASES else next((other for other in reversed(queries) if other != PHASES), TYPES[0])
    if way != here and way in START:
        before, own = own, list(queries.pop(way, []) or _start(own, here, way))
        queries[here] = before
    current.put_cycle(own)
    current.asides = [_written(query) for query in queries.values() if _says_anything(query)]


def _says_anything(query: Pairs) -> bool:
    return any(text.strip() for name, text in query if name not in ("mech", "mv"))


def _start(own: Pairs, here: str, way: str) -> Pairs:
    """Pairs of a way that is new: inputs that both mechanisms have are kept, all others are blank."""
    if here in CLASSES and way in CLASSES:
        others = {symbol.name for symbol in mechanism_symbols(here)} - {s.name for s in mechanism_symbols(way)}
        return [(name, way if name == "mech" else text) for name, text in own if name not in others]
    return parse_qsl(START[way], keep_blank_values=True)


def take_over(current: SortedQuery, application: Application | None) -> bool:
    """Replace a motion by the phases that follow from it, and keep it aside; return False if there is no motion."""
    if application is None or not current.has_motion:
        return False
    phases = tuple(map(_rounded, application.duty_cycle.load_phases))
    cycle = to_link(Application(duty_cycle=DutyCycle(phases=phases))).removeprefix("/?")
    own = current.cycle()
    says = [(REVERSES, current.scalars.get(REVERSES, "0"))]
    if friction := application.duty_cycle.rest_friction_Nm:
        says.append((REST_FRICTION, repr(_in_few_digits(friction))))
    current.put_cycle([*_pairs_of(cycle), *says])
    asides = [query for query in current.asides if way_of(_pairs_of(query)) != PHASES]
    current.asides = [*asides, _written(own)]
    return True


def _rounded(phase: Phase) -> Phase:
    """Phase in fewer digits. Rounding keeps the order of numbers, so no peak falls below a mean."""
    return phase.model_copy(update={name: _in_few_digits(value) for name, value in phase if isinstance(value, float)})


def _in_few_digits(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _pairs_of(query: str) -> Pairs:
    """Pairs of a query that was kept aside, if they belong to a single way; none if the query is malformed."""
    try:
        pairs = parse_qsl(query, keep_blank_values=True, max_num_fields=MOST_FIELDS)
    except ValueError:
        return []
    return [(name, text) for name, text in pairs if is_of_one_way(name, text)]


def _written(pairs: Pairs) -> str:
    return urlencode(
        [(name, text.field_text if isinstance(text, Entry) and text.refusal else text) for name, text in pairs]
    )
