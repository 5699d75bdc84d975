"""Buttons that edit the form's content, applied to its query one after the other."""

import re
from collections.abc import Callable

from hpn.application import Application
from hpn.links.rows import OPTIONAL
from hpn.web.form import helpers, offers, ramps, ways
from hpn.web.form.query import REVERSES, SortedQuery

MOST_PRESSES = 50

Reads = Callable[[SortedQuery], Application | None]
"""Function from a query to its application; None if the query describes none."""


def play(query: SortedQuery, application_of: Reads) -> str | None:
    """Apply the pressed buttons to a query; id of the element to focus, or None."""
    example = Application.worked_example()
    if any(press.startswith("way:") for press in query.presses) and application_of(query) == example:
        query.keep_cycle()  # the rest is the example's, not the reader's
    focus = None
    for press in query.presses[:MOST_PRESSES]:
        do, _, what = press.partition(":")
        focus = _press(query, do, what, application_of)
    return focus


def _press(query: SortedQuery, do: str, what: str, application_of: Reads) -> str | None:
    """Apply one button, with its argument or row number in `what`; id of the element to focus."""
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
"""Buttons that set a single value."""
