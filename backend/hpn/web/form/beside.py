"""Inputs that are typed beside a note or a figure that lacks them, in place of their field of the form.

`give-Nk` stands for the field `Nk`, and `give-xc-20A` for the number of one size in `xc`. They belong to the form
element, so that one submission has them; their names are no others' of a link.
"""

from hpn.links.symbols import BY_NAME, BY_SIZE
from hpn.web.form.given import Pairs

PREFIX = "give-"


def with_beside(pairs: Pairs) -> Pairs:
    """Pairs with what was typed beside a note in the fields that it is for, and on from the last of these."""
    typed = [(name.removeprefix(PREFIX), text) for name, text in pairs if name.startswith(PREFIX)]
    if not typed:
        return pairs
    others, focus = [(name, text) for name, text in pairs if not name.startswith(PREFIX)], ""
    for place, text in typed:
        name, _, size = place.partition("-")
        if name in BY_NAME and text.strip():
            is_part = bool(size) and name in BY_SIZE
            others = [(other, said) for other, said in others if other != name or (is_part and said.strip())]
            others.append((name, f"{size[:20]}: {text}" if is_part else text))
            focus = f"f-{name}"
    return [*others, ("do", f"give:{focus}")] if focus else others
