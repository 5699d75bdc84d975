"""Buttons of the form that edit what is given, played on it one after the other."""

import re
from collections.abc import Callable

from hpn.application import Application
from hpn.links.rows import OPTIONAL
from hpn.web.form import helpers, offers, ramps, ways
from hpn.web.form.given import REVERSES, SortedQuery

MOST_PRESSES = 50

Reads = Callable[[SortedQuery], Application | None]
"""Reading of what is given; None where it describes no application."""


def play(query: SortedQuery, application_of: Reads) -> str | None:
    """Play the buttons that were pressed; the element to go on from, if there is one."""
    example = Application.worked_example()
    if any(press.startswith("way:") for press in query.presses) and application_of(query) == example:
        query.keep_cycle()  # nobody has given the rest
    focus = None
    for press in query.presses[:MOST_PRESSES]:
        do, _, what = press.partition(":")
        focus = _press(query, do, what, application_of)
    return focus


def _press(query: SortedQuery, do: str, what: str, application_of: Reads) -> str | None:
    """Play one button, which may say what or which row it is for; the element to go on from."""
    focus: str | None = do
    match do:
        case _ if do in _SETS:
            name, text = _SETS[do]
            query.put(name, text)
            focus = f"f-{name}"
        case "give":
            focus = what
        case "inertia" | "gravity":
            helpers.hand_over(query, gravity=do == "gravity")
        case "way":
            ways.switch(query, what)
            focus = f"way-{what}"
        case "take" if what:
            offers.take(query, what)
            focus = what.partition(":")[0]
        case "take":
            focus = f"way-{ways.PHASES}" if ways.take_over(query, application_of(query)) else None
        case "ramps":
            ramps.press(query, what, application_of)
            focus = f"ramps-{what}" if what else do
        case _ if do in OPTIONAL:
            query.toggle(do)
        case "tolerances":
            query.toggle_tolerances()
        case _:
            k = int(what) - 1 if re.fullmatch(r"[0-9]{1,5}", what) else -1
            table = query.bodies if do.endswith("_body") else query.duty
            focus = table.press(do.removesuffix("_body"), k)
    return focus


_SETS = {
    "one_way": (REVERSES, "0"),
    "from_motion": ("fm", "1"),
    "iso281": ("bm", "iso281"),
    "linear": ("bm", ""),
    "by_L10": ("Lbb", "L10"),
}
"""Buttons that give a single value."""
