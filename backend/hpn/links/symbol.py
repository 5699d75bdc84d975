"""Input of the form: its symbol in links, its place in the application, and its appearance."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hpn.catalogue import Catalogue
from hpn.tables.numbers import Kind
from hpn.words.quantities import INPUTS, QUANTITIES
from hpn.words.units import suffix_of
from hpn.words.wording import Named

MOTION_PATH = ("duty_cycle", "motion")
"""Place of a motion in the application."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """Query name, its field of the application, and the texts beside it in the form.

    A number `by_size` is one number for all sizes, or one for each of some, repeated in links. `choices` are the codes
    of a text; the first holds where none is given. `offered` is a figure of the gears whose values the form offers, or
    such values themselves. `supplied` names, for a choice, the table of the catalogue that it needs.
    """

    name: str
    path: tuple[str, ...]
    kind: Kind = "number"
    many: bool = False
    choices: Mapping[str, str] = field(default_factory=dict)
    supplied: Mapping[str, str] = field(default_factory=dict)
    placeholder: str = ""
    hint: str = ""
    offered: str | tuple[float, ...] = ()

    @property
    def place(self) -> str:
        """Place of the input in `hpn.words.quantities`."""
        if self.path[:2] == MOTION_PATH:
            return ".".join(self.path[1:])
        if self.path[0] == "body":
            return ".".join(self.path)
        return ".".join(self.path if len(self.path) > 1 or self.path[0] in INPUTS else ("phase", *self.path))

    def is_offered(self, choice: str, catalogue: Catalogue) -> bool:
        """True for a choice that is usable with a catalogue; links with any other choice are read all the same."""
        return choice not in self.supplied or bool(getattr(catalogue, self.supplied[choice]))

    @property
    def named(self) -> Named:
        """Name and sign of the input."""
        return QUANTITIES[self.place]

    @property
    def unit(self) -> str:
        """Suffix of the input's unit, blank for a pure number or a text."""
        return suffix_of(self.path[-1])
