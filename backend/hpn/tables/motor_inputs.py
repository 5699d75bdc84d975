"""Names of a motor's figures in the headings of data sheets, in several languages."""

from collections.abc import Collection, Sequence
from functools import cached_property

from hpn.tables import motor_points
from hpn.tables.headings import INDEX, LONGEST, UNIT, Over, heading_of, parts_of
from hpn.tables.inputs import Input, Inputs
from hpn.tables.shafts import without_motor
from hpn.words import spellings, units
from hpn.words.quantities import MOTOR
from hpn.words.wording import N_, Named

NAME = "mot"
POWER = "Pn"

_FIGURES = {
    "Tmn": "rated_torque_Nm",
    "Tm": "peak_torque_Nm",
    "Tst": "stall_torque_Nm",
    "nmr": "rated_speed_rpm",
    "nm": "maximum_speed_rpm",
    "Jm": "inertia_kgm2",
    "mmo": "weight_kg",
}
_NAMED = {**MOTOR, "stall_torque_Nm": Named(N_("Torque at standstill"), "M_0"), "weight_kg": Named(N_("Weight"), "m")}
OF_MOTOR = (
    Input(NAME, "designation", _NAMED["designation"], "text"),
    *(Input(role, place, _NAMED[place]) for role, place in _FIGURES.items()),
    Input(POWER, "rated_power_kW", Named(N_("Rated power"), "P_N")),
    *motor_points.COLUMNS,
)

_WORDS = {
    NAME: "designation; motor; motor type; type; model; name; part number; part no; article; article number; "
    "article no; order number; order no; ordering code; typ; motortyp; modell; bezeichnung; motorbezeichnung; "
    "artikel; artikelnummer; artikelnr; artikel-nr; bestellnummer; bestell-nr; moteur; modèle; désignation; "
    "référence; modello; motore; tipo; sigla; modelo; referencia",
    "Tmn": "rated torque; nominal torque; continuous torque; torque rated; torque nominal; torque continuous; "
    "nenndrehmoment; nennmoment; bemessungsdrehmoment; bemessungsmoment; dauerdrehmoment; dauermoment; "
    "drehmoment nenn; couple nominal; couple permanent; coppia nominale; par nominal; mn; tn; m rated; t "
    "rated; m nenn; m nom; t nom; m n; t n",
    "Tm": "peak torque; maximum torque; max torque; maximal torque; torque max; torque peak; spitzendrehmoment; "
    "spitzenmoment; maximaldrehmoment; maximalmoment; maximales drehmoment; max drehmoment; max moment; "
    "drehmoment max; instantaneous maximum torque; instantaneous peak torque; couple maximal; couple maxi; "
    "couple crête; coppia massima; coppia di picco; par máximo; par maximo; mmax; m max; tmax; t max; mp; tp; "
    "m peak; t peak; mpk; tpk; m p; t p; m pk; t pk",
    "Tst": "stall torque; continuous stall torque; static torque; standstill torque; torque at standstill; "
    "stillstandsdrehmoment; stillstandsmoment; stillstandmoment; dauerstillstandsmoment; couple à l'arrêt; "
    "couple de blocage; coppia di stallo; m0; t0; m stall; t stall; m 0; t 0",
    "nmr": "rated speed; nominal speed; rated motor speed; speed rated; speed nominal; nenndrehzahl; "
    "bemessungsdrehzahl; drehzahl nenn; vitesse nominale; velocità nominale; velocidad nominal; nn; n rated; "
    "n nenn; n nom; n n",
    "nm": "maximum speed; max speed; maximal speed; peak speed; speed max; top speed; maximaldrehzahl; "
    "höchstdrehzahl; spitzendrehzahl; maximale drehzahl; max drehzahl; drehzahl max; vitesse maximale; "
    "vitesse maxi; velocità massima; velocidad máxima; nmax; n max; nmot",
    "Jm": "inertia; rotor inertia; moment of inertia; rotor moment of inertia; motor inertia; motor moment of "
    "inertia; massenträgheitsmoment; trägheitsmoment; rotorträgheitsmoment; rotorträgheit; trägheit; "
    "motorträgheitsmoment; massenträgheit; inertie; moment d'inertie; inertie du rotor; inerzia; momento "
    "d'inerzia; inerzia del rotore; inercia; momento de inercia; j; jm; jr; jmot; j rotor; j mot; j m; j r",
    "mmo": "weight; mass; motor weight; gewicht; masse; motorgewicht; poids; peso; massa; m; wt",
    POWER: "power; rated power; rated output; output power; nominal power; motor power; power rated; nennleistung; "
    "bemessungsleistung; leistung; puissance; puissance nominale; potenza; potenza nominale; potencia; pn; p; "
    "p rated; p n",
    **motor_points.WORDS,
}
_BESIDE_UNITS = "mn;tn;m n;t n;mp;tp;m p;t p;m0;t0;m 0;t 0;nn;n n;j;jr;j r;m;p;pn;p n"
_SYMBOLS = frozenset(_BESIDE_UNITS.split(sep=";"))
"""Names that count only beside a unit of their quantity: `M_N` may be a torque or a name of something else."""


class MotorInputs(Inputs):
    """Figures of a motor, and their names in headings."""

    def __init__(self) -> None:
        super().__init__()
        self.by_role = {each.role: each for each in OF_MOTOR}
        self.has_axes = self.has_motors = True

    def kind_of(self, headings: Sequence[str], over: Over) -> str:
        """Role of a column by the texts above it, else the index of rows, else blank."""
        return self.role_over(headings, over) or (INDEX if over.kind == INDEX and not over.units else "")

    def role_over(self, headings: Sequence[str], over: Over) -> str:
        """Role by the name that all texts above a column form, or that one of them is; blank for a unit that does not
        fit.
        """
        meanings = [heading_of(text) for text in headings]
        codes = over.codes | {code for each in meanings for code in spellings.codes_for(each.unit)}
        names = [text for text, each in zip(headings, meanings, strict=True) if each.kind != UNIT]
        both = [" ".join(names), " ".join(reversed(names))] if len(names) > 1 else []
        whole = next((role for text in both if (role := self._role_by(text, codes))), "")
        roles = {whole} if whole else {role for text in names if (role := self._role_by(text, codes))}
        return roles.pop() if len(roles) == 1 else ""

    def named_in(self, cells: Sequence[str]) -> int:
        """Number of figures that some cells name, each by itself, if only by a symbol."""
        roles = {self._role_by(cell, spellings.codes_for(heading_of(cell).unit)) for cell in cells if cell}
        symbols = {self._roles.get(folded(cell), "") for cell in cells if len(cell) <= LONGEST}
        return len((roles | symbols) - {"", NAME})

    def _role_by(self, heading: str, codes: Collection[str]) -> str:
        """Role by a name, or by a symbol beside a unit of its quantity; the unit must fit either."""
        if len(heading) > LONGEST:
            return ""
        name = parts_of(heading)[0]
        measured = {units.QUANTITY_OF[code] for code in codes}
        word, _, symbol = name.rpartition(" ")
        both = (word,) if self._roles.get(folded(word), "") == self._roles.get(folded(symbol), "") else ()
        for text in (heading, name, without_motor(name), *both):
            role = self._roles.get(folded(text), "")
            if role and (measured or folded(text) not in _SYMBOLS):
                fits = not measured or self.by_role[role].quantity in measured
                return role if fits else ""
        return ""

    @cached_property
    def _roles(self) -> dict[str, str]:
        places = {folded(each.place): each.role for each in OF_MOTOR}
        return places | {folded(word): role for role, words in _WORDS.items() for word in words.split("; ")}


def folded(name: str) -> str:
    """A name without the marks that data sheets write at will."""
    return " ".join(name.replace("_", " ").replace(",", " ").replace(".", " ").replace("-", " ").casefold().split())


MOTORS = MotorInputs()
