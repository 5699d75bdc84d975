"""Inputs that the columns of a table may hold, and their names in headings.

A table without a column of axes is one duty cycle and has the nine quantities of a phase. A table with one has many
cycles, and beside the phases may have a column for every other input of an application.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.tables.headings import LONGEST, UNIT, Over, heading_of, parts_of
from hpn.tables.numbers import Kind
from hpn.words import quantities, units
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.wording import N_, Named

AXIS = "axis"

FURTHER = {
    AXIS: "axis name, achse, achsname, achsbezeichnung, achse nr, antrieb, drive, joint, gelenk, bezeichnung, name, "
    "axe, asse, eje",
    "qty": "qty, quantities, amount, pieces, pcs, number of axes, no of axes, number off, anzahl, anz, anzahl achsen, "
    "achsanzahl, stück, stückzahl, stk, stückz, menge, quantité, qté, qte, nombre d'axes, nb d'axes, nb axes, pièces, "
    "quantità, qtà, qta, q.tà, q.ta, numero assi, numero di assi, n assi, pezzi, cantidad, antal, aantal",
    "pn": "phase name, name of the phase, phasenname, phasenbezeichnung",
    "tp": "pause, pausenzeit, dwell, pausa, temps de pause, durée de pause, tempo di pausa",
    "Tk": "emergency stop torque, e-stop torque, not-halt-moment, nothaltmoment, not-halt-drehmoment, not-aus-moment, "
    "couple d'arrêt d'urgence, coppia di emergenza, coppia di arresto di emergenza",
    "Jm": "motor inertia, rotor inertia, motorträgheit, motorträgheitsmoment, rotorträgheit, "
    "inertie moteur, inertie du moteur, inertie du rotor, inerzia motore, inerzia del motore, inerzia del rotore",
    "bl": "backlash, max backlash, maximum backlash, spiel, verdrehspiel, jeu, jeu angulaire, gioco, gioco angolare",
    "Nk": "emergency stops, not-halt-vorgänge, anzahl not-halt",
    "Lh": "gear life, lebensdauer getriebe, durée de vie du réducteur, durata del riduttore",
    "Lb": "bearing life, lagerlebensdauer, lebensdauer lager, durée de vie du roulement, durata del cuscinetto",
    "i": "ratio, ratios, übersetzung, übersetzungen, rapport de réduction, rapporto di riduzione",
    "size": "size, sizes, baugröße, baugrößen",
    "ta": "ambient, umgebungstemperatur, température ambiante, temperatura ambiente",
    "fw": "betriebsfaktor",
}
"""Further names by role. A name that fits two inputs, such as “life” or “motor torque”, is missing here: the user is
asked.
"""

_OF_STOP = "emergency stop, e stop, estop, not halt, nothalt, not aus, notaus, not stopp"
_MEASURED = dict.fromkeys(_OF_STOP.split(", "), "Tk")
"""Names that mean an input only beside a unit of that input."""


@dataclass(frozen=True)
class Input:
    """An input that a column may hold: its role, which is its symbol in links, and its place in an application.

    The place is its column's name in the tables of `hpn fleet`, which ends in the unit.
    """

    role: str
    place: str
    named: Named
    kind: Kind = "number"
    many: bool = False

    @cached_property
    def unit(self) -> str:
        """Suffix of its unit, blank for a pure number or a text."""
        return units.suffix_of(self.place)

    @cached_property
    def quantity(self) -> str:
        """Quantity that its unit measures; blank for a pure number, a text, or an input with one possible unit."""
        return units.quantity_of(self.unit)

    @property
    def is_number(self) -> bool:
        """True where its cells hold one number each."""
        return self.kind not in ("text", "curve") and not self.many


_OF_PHASE = {
    **{"T": "torque_Nm", "n": "speed_rpm", "t": "duration_s", "FRi": "radial_N", "FAi": "axial_N"},
    **{"Tpk": "peak_torque_Nm", "npk": "peak_speed_rpm", "Trms": "rms_torque_Nm", "Tlo": "least_torque_Nm"},
}
PHASE = tuple(Input(role, place, quantities.INPUTS[f"phase.{place}"]) for role, place in _OF_PHASE.items())
PHASE_ROLES = tuple(_OF_PHASE)
NAME = Input("pn", "name", quantities.INPUTS["phase.name"], "text")
"""Name of a phase."""

QUANTITY = Input("qty", "quantity", Named(N_("Number of such axes")), "whole")
"""Quantity of an axis."""


class Inputs:
    """Inputs by role, and the names of the inputs that don't belong to a phase."""

    def __init__(self, *further: Input) -> None:
        of_axis = (Input(AXIS, AXIS, Named(N_("Axis")), "text"), QUANTITY) if further else ()
        named = (*of_axis, *PHASE, NAME, *further)
        self.by_role: Mapping[str, Input] = {each.role: each for each in named}
        self.has_axes, self.has_motors = bool(further), False

    @property
    def units(self) -> set[str]:
        """Suffixes of the units of all inputs."""
        return {each.unit for each in self.by_role.values()} - {""}

    def kind_of(self, headings: Sequence[str], over: Over) -> str:
        """Role of a column by the texts above it, else the quantity or index that they name, else blank."""
        return self.role_over(headings, over) or over.kind

    def role_over(self, headings: Sequence[str], over: Over) -> str:
        """Role by an input's name that all texts above a column form together, or that each of them is."""
        if not self.has_axes:
            return ""
        roles = {role for text in headings if (role := self._role_of(text) or self._measured(text, over))}
        names = [text for text in headings if heading_of(text).kind != UNIT]
        if len(names) > 1:
            roles = {role} if (role := self._role_of(over.name)) else roles if len(roles) == len(names) == 1 else set()
        return roles.pop() if len(roles) == 1 else ""

    def _role_of(self, heading: str) -> str:
        """Role by a name of an input, with or without a unit behind it."""
        if len(heading) > LONGEST:
            return ""
        name = parts_of(heading)[0]
        word, _, symbol = name.rpartition(" ")
        role = self._roles.get(_folded(word), "")
        with_symbol = role if role and symbol in (role, self.by_role[role].named.symbol) else ""
        return self._roles.get(_folded(heading)) or self._roles.get(_folded(name)) or with_symbol

    def _measured(self, heading: str, over: Over) -> str:
        """Role by a name that counts only beside a unit of its input."""
        role = _MEASURED.get(_folded(parts_of(heading)[0]), "") if len(heading) <= LONGEST else ""
        measured = {units.QUANTITY_OF[code] for code in over.codes}
        return role if role and measured == {self.by_role[role].quantity} else ""

    @cached_property
    def _roles(self) -> dict[str, str]:
        roles: dict[str, str] = {}
        readers = [Reader(language) for language in LANGUAGES]
        for each in self.by_role.values():
            if each.role not in _OF_PHASE:
                texts = (each.place, *(reader.text(each.named.name) for reader in readers))
                roles |= {_folded(text): each.role for text in texts}
                if len(each.named.symbol) > 2:
                    roles[_folded(each.named.symbol)] = each.role
        roles |= {_folded(place): role for role, place in _OF_PHASE.items()} | {_folded(AXIS): AXIS}
        return roles | {_folded(word): role for role, words in FURTHER.items() for word in words.split(", ")}


CYCLE = Inputs()
"""Inputs of a table with one duty cycle."""


def _folded(text: str) -> str:
    return " ".join(text.casefold().replace("_", " ").replace("-", " ").split()).strip(" :.")
