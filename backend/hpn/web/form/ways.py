"""Ways to give a duty cycle: as phases, or as the motion of a mechanism. Inputs typed another way are kept aside.

A form has the inputs of one way; those of each other stand in a field `aside` of its own, as the query that they make.
"""

from collections.abc import Iterator, Sequence
from urllib.parse import parse_qsl, urlencode

from hpn.application import Application, DutyCycle
from hpn.application.phase import Phase
from hpn.physics.motion.mechanisms import CLASSES, TYPES
from hpn.tables.numbers import Entry
from hpn.web.form.link_writer import to_link
from hpn.web.form.rows import OF_ANY_ROW
from hpn.web.form.symbols import MECHANISM_SYMBOLS, PHASE_SYMBOLS, TURN_SYMBOLS, mechanism_symbols
from hpn.words.wording import N_

Pairs = Sequence[tuple[str, str]]

ASIDE, PHASES, MOTION = "aside", "phases", "motion"
REST_FRICTION, REVERSES = "rf", "lr"
"""Names of what phases have to say of their rest and of the sense of their torque, which a motion has by itself."""

CYCLE_NAMES = {symbol.name for symbol in (*PHASE_SYMBOLS, *TURN_SYMBOLS, *MECHANISM_SYMBOLS)}
"""Names of a link that make its duty cycle, as phases or as a motion."""

_OF_ITS_WAY = {*CYCLE_NAMES, REST_FRICTION, REVERSES}
"""Names of what belongs to one way alone."""

_OF_PHASES_ALONE = {symbol.name for symbol in PHASE_SYMBOLS} - {*OF_ANY_ROW}

MOST_FIELDS = 20_000
DIGITS = 6
"""Digits of the phases that are taken over from a motion."""

START = {way: f"mech={way}&mv=trapezoidal&ms=&mt=" for way in TYPES} | {PHASES: "T=&n=&t="}
"""Query of a way in which nothing is given yet; of a motion the profile, without which no cell of its move is open."""


EXAMPLES = {
    "/?mech=rotary&J=2.5&Tf=3&mv=trapezoidal&ms=90&mt=0.6&mv=dwell&ms=&mt=1.2": N_("rotary table"),
    "/?mech=ball_screw&J=0.0015&etam=0.9&h=20&ml=120&inc=90&mu=0.02"
    "&mv=s_curve&ms=400&mt=1.5&mv=dwell&ms=&mt=0.5&mv=s_curve&ms=-400&mt=1.5&mv=dwell&ms=&mt=0.5": N_("ball screw"),
}
"""Links of motions to begin with, and their names."""


def way_of(pairs: Pairs) -> str:
    """Way in which pairs give their duty cycle."""
    given = next((text.strip() for name, text in pairs if name == "mech"), "")
    return given if given in TYPES else PHASES


def switched(pairs: Pairs) -> Pairs:
    """Pairs after the buttons that choose another way: its inputs as they were left, those of before aside."""
    for wanted in [text.removeprefix("way:") for name, text in pairs if name == "do" and text.startswith("way:")]:
        pairs = list(_switched(pairs, wanted))
    return pairs


def _switched(pairs: Pairs, wanted: str) -> Iterator[tuple[str, str]]:
    own = [(name, text) for name, text in pairs if name in _OF_ITS_WAY]
    kept = {way_of(query): query for query in map(_read, (text for name, text in pairs if name == ASIDE))}
    here = way_of(own)
    if here != PHASES and (stray := [(name, text) for name, text in own if name in _OF_PHASES_ALONE]):
        kept[PHASES] = stray  # given beside a motion
        own = [pair for pair in own if pair not in stray]
    if wanted == MOTION:
        wanted = here if here != PHASES else next((way for way in reversed(kept) if way != PHASES), TYPES[0])
    if wanted != here and wanted in START:
        before, own = own, list(kept.pop(wanted, []) or _begun(own, here, wanted))
        kept[here] = before
    yield from own
    yield from ((name, text) for name, text in pairs if name not in _OF_ITS_WAY and name != ASIDE)
    for query in kept.values():
        if any(text.strip() for name, text in query if name not in ("mech", "mv")):
            yield (ASIDE, _written(query))


def _begun(own: Pairs, here: str, wanted: str) -> Pairs:
    """A way that nobody has been in: what another linear mechanism has too is the same, all else blank."""
    if here in CLASSES and wanted in CLASSES:
        others = {symbol.name for symbol in mechanism_symbols(here)} - {s.name for s in mechanism_symbols(wanted)}
        return [(name, wanted if name == "mech" else text) for name, text in own if name not in others]
    return parse_qsl(START[wanted], keep_blank_values=True)


def taken_over(pairs: Pairs, application: Application) -> Pairs:
    """Pairs with the phases that come out of a motion in place of the motion, which is kept aside."""
    phases = tuple(map(_rounded, application.duty_cycle.load_phases))
    cycle = to_link(Application(duty_cycle=DutyCycle(phases=phases))).removeprefix("/?")
    own = [(name, text) for name, text in pairs if name in _OF_ITS_WAY]
    rest = [(name, text) for name, text in pairs if name not in (*_OF_ITS_WAY, "do") and not _is_of_phases(name, text)]
    says = [(REVERSES, next((text for name, text in own if name == REVERSES and text.strip()), "0"))]
    if friction := application.duty_cycle.rest_friction_Nm:
        says.append((REST_FRICTION, repr(_in_few_digits(friction))))
    return [*_read(cycle), *says, *rest, (ASIDE, _written(own)), ("do", f"way:{PHASES}")]


def _is_of_phases(name: str, text: str) -> bool:
    return name == ASIDE and way_of(_read(text)) == PHASES


def _rounded(phase: Phase) -> Phase:
    """A phase in fewer digits. Rounding keeps the order of numbers, so that no peak comes to lie below a mean."""
    return phase.model_copy(update={name: _in_few_digits(value) for name, value in phase if isinstance(value, float)})


def _in_few_digits(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _read(query: str) -> Pairs:
    """Pairs of a query that stood aside; none where somebody else has written it."""
    try:
        pairs = parse_qsl(query, keep_blank_values=True, max_num_fields=MOST_FIELDS)
    except ValueError:
        return []
    return [(name, text) for name, text in pairs if name in _OF_ITS_WAY]


def _written(pairs: Pairs) -> str:
    return urlencode([(name, text.shown if isinstance(text, Entry) and text.refusal else text) for name, text in pairs])
