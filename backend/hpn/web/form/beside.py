"""Inputs typed beside a note or figure that needs them, instead of into their field of the form.

`give-Nk` stands for the field `Nk`, and `give-xc-20A` for the number of one size in `xc`. The inputs belong to the form
element and are submitted with it; no parameter of a link has such a name.
"""

from hpn.links.symbols import BY_NAME, BY_SIZE
from hpn.web.form.query import Pairs

PREFIX = "give-"


def with_beside(pairs: Pairs) -> Pairs:
    """Pairs with each text typed beside a note moved into its field, and a `do` that focuses the last such field."""
    typed = [(name.removeprefix(PREFIX), text) for name, text in pairs if name.startswith(PREFIX)]
    if not typed:
        return pairs
    others, focus = [(name, text) for name, text in pairs if not name.startswith(PREFIX)], ""
    for place, text in typed:
        name, _, size = place.partition("-")
        if name in BY_NAME and text.strip():
            is_part = bool(size) and name in BY_SIZE
            others = [(other, words) for other, words in others if other != name or (is_part and words.strip())]
            others.append((name, f"{size[:20]}: {text}" if is_part else text))
            focus = f"f-{name}"
    return [*others, ("do", f"give:{focus}")] if focus else others
