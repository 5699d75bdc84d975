"""A table of motors, as data sheets have them: a row is a motor; what a cell leaves open is asked."""

from collections.abc import Collection, Sequence
from functools import cached_property
from math import isfinite, pi
from typing import Any

from hpn.tables.bodies import body_of
from hpn.tables.cells import is_blank
from hpn.tables.columns import NO_CHOICES, Choices, Column, proposed, settled
from hpn.tables.headings import INDEX, LONGEST, UNIT, Over, heading_of, parts_of
from hpn.tables.heads import MOST_NAMED
from hpn.tables.inputs import Input, Inputs
from hpn.tables.interpreter import Interpreter
from hpn.tables.questions import Questions
from hpn.tables.shafts import without_motor
from hpn.tables.sheets import Grid, RefusedError
from hpn.tables.table import Choice, Table
from hpn.words import spellings, units
from hpn.words.quantities import MOTOR
from hpn.words.wording import N_, Named, Sentence

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
}
_BESIDE_UNITS = "mn;tn;m n;t n;mp;tp;m p;t p;m0;t0;m 0;t 0;nn;n n;j;jr;j r;m;p;pn;p n"
_SYMBOLS = frozenset(_BESIDE_UNITS.split(sep=";"))
"""Names that count beside a unit of what they mean alone: `M_N` may be a torque or a name of something else."""


class MotorInputs(Inputs):
    """Figures of a motor, and the names by which headings call them."""

    def __init__(self) -> None:
        super().__init__()
        self.by_role = {each.role: each for each in OF_MOTOR}
        self.has_axes = self.has_motors = True

    def kind_of(self, headings: Sequence[str], said: Over) -> str:
        """Role of a column by the texts above it, else that it numbers the rows."""
        return self.role_over(headings, said) or (INDEX if said.kind == INDEX and not said.units else "")

    def role_over(self, headings: Sequence[str], said: Over) -> str:
        """Role by the name that all texts above a column make, or one of them; of a unit that does not fit none."""
        meanings = [heading_of(text) for text in headings]
        codes = said.codes | {code for each in meanings for code in spellings.codes_for(each.unit)}
        names = [text for text, each in zip(headings, meanings, strict=True) if each.kind != UNIT]
        both = [" ".join(names), " ".join(reversed(names))] if len(names) > 1 else []
        found = next((role for text in both if (role := self._role_by(text, codes))), "")
        roles = {found} if found else {role for text in names if (role := self._role_by(text, codes))}
        return roles.pop() if len(roles) == 1 else ""

    def _role_by(self, heading: str, codes: Collection[str]) -> str:
        """Role by a name, or by a symbol beside a unit of what it means; the unit has to fit both."""
        if len(heading) > LONGEST:
            return ""
        name = parts_of(heading)[0]
        measured = {units.QUANTITY_OF[code] for code in codes}
        for text in (heading, name, without_motor(name)):
            role = self._roles.get(_folded(text), "")
            if role and (measured or _folded(text) not in _SYMBOLS):
                fits = not measured or self.by_role[role].quantity in measured
                return role if fits else ""
        return ""

    @cached_property
    def _roles(self) -> dict[str, str]:
        places = {_folded(each.place): each.role for each in OF_MOTOR}
        return places | {_folded(word): role for role, words in _WORDS.items() for word in words.split("; ")}


MOTORS = MotorInputs()

TWINS = Choice(
    "twins",
    {
        "first": N_("the first counts"),
        "last": N_("the last counts"),
        "both": N_("both are kept, the later with a number"),
    },
)
ZEROS = Choice("zeros", {"unknown": N_("not known"), "skip": N_("these motors are left out")})
BLANKS = Choice("blanks", {"unknown": N_("not known: not checked"), "above": N_("as in the row above")})


def read_motors(grid: Grid, inputs: Inputs, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()) -> Table:
    """Reading of a table of motors; raises nothing, `problem` says why there is none."""
    try:
        body = body_of(grid, choices.scales, named_rows=True)
        body = body.including(body.totals)  # a motor may be called Max
        columns = settled(proposed(body, inputs), body, inputs, choices, assumed)
        return _MotorsInterpreter(body, columns, Questions(choices)).table()
    except RefusedError as refused:
        return Table(problem=refused.sentence)


_Row = tuple[int, dict[str, Any]]
"""Number of a row, and the figures of its motor by their places."""


class _MotorsInterpreter(Interpreter):
    """A table on its way to motors."""

    required = (NAME,)
    any_unit = True

    def table(self) -> Table:
        """The table with what is to be asked, or with its motors."""
        self.ask_columns()
        self.read_numbers()
        self.ask_scale()
        rows = self._named_once(self._with_power(self._figures()))
        motors = () if self.questions.open else tuple(values for _, values in rows)
        origins = {values["designation"]: (number,) for number, values in rows}
        return Table(**self.said, motors=motors, origins=origins)

    def ask_side(self) -> list[Column]:
        """No column: every figure is at the motor."""
        return []

    def _figures(self) -> list[_Row]:
        """Motors by their rows: of a blank cell, and of one that is 0, what was answered."""
        name = next((column.place for column in self.columns if column.role == NAME), None)
        rows, wrong, unnamed, zero = list[_Row](), list[int](), list[int](), list[int]()
        zeros, blanks = self._ask_zeros(), self._ask_blanks()
        above: dict[str, Any] = {}
        for number, cells, read in zip(self.body.numbers, self.body.rows, self.rows, strict=True):
            values: dict[str, Any] = {"designation": "" if name is None else " ".join(str(cells[name]).split())[:100]}
            bad = False
            for column, found in zip(self.used, read, strict=True):
                cell, place = cells[column.place], column.held.place if column.held else ""
                if is_blank(cell):
                    if blanks == "above" and place in above:
                        values[place] = above[place]
                    continue
                text = self.in_wire(found, column) if found else ""
                value = float(text) if text else float("nan")
                if value == 0 and zeros != "skip":
                    continue
                bad |= not (isfinite(value) and value >= 0)
                values[place] = value
            if bad:
                wrong.append(number)
            elif 0 in values.values():
                zero.append(number)
            elif not values["designation"]:
                unnamed.append(number)
            else:
                rows.append((number, values))
            above = above | values
        for template, numbers in ((NO_FIGURE, wrong), (NO_NAME, unnamed), (_ZERO, zero)):
            if numbers:
                self.notes.append(Sentence(template, {"rows": _listed(numbers), "count": len(numbers)}))
        return rows

    def _ask_zeros(self) -> str:
        return self._ask_cells(ZEROS, N_("Cells that are 0, first in row {row} of {name}. What do they mean?"), 0.0)

    def _ask_blanks(self) -> str:
        return self._ask_cells(BLANKS, N_("Blank cells, first in row {row} of {name}. What do they mean?"), None)

    def _ask_cells(self, choice: Choice, template: str, wanted: float | None) -> str:
        """Answer about cells that are 0 or blank in a column that has other cells as well; blank without any."""
        for place, column in enumerate(self.used):
            cells = [row[column.place] for row in self.body.rows]
            if all(map(is_blank, cells)):
                continue
            for number, cell, row in zip(self.body.numbers, cells, self.rows, strict=True):
                found = row[place]
                is_zero = found is not None and float(found.number) == 0
                if is_blank(cell) if wanted is None else is_zero:
                    return self.choose(choice, Sentence(template, {"row": number, "name": column.called}))
        return ""

    def _with_power(self, rows: list[_Row]) -> list[_Row]:
        """Motors with the torque P / ω of rated power and speed where no column has the rated torque."""
        roles = {column.role for column in self.columns}
        if POWER not in roles:
            return rows
        derived = "Tmn" not in roles
        if derived:
            self.notes.append(Sentence(N_("Rated torque is rated power over rated speed, where both are given.")))
        else:
            self.notes.append(Sentence(N_("Rated power is not read: the rated torque is given.")))
        found = []
        for number, values in rows:
            power_kW, speed_rpm = values.pop(_POWER_PLACE, None), values.get("rated_speed_rpm")
            if derived and power_kW and speed_rpm:
                values["rated_torque_Nm"] = float(f"{power_kW * 1000 * 60 / (2 * pi * speed_rpm):.12g}")
            found.append((number, values))
        return found

    def _named_once(self, rows: list[_Row]) -> list[_Row]:
        """Motors of which each name stands once, by what was answered about those that stand there twice."""
        found: dict[str, _Row] = {}
        first, counts = dict[str, dict[str, Any]](), dict[str, int]()
        twins = [
            values["designation"] for _, values in rows if first.setdefault(values["designation"], values) != values
        ]
        answer = ""
        if twins:
            names = ", ".join([*dict.fromkeys(twins)][:MOST_NAMED])
            template = N_("Motors that stand there twice with other figures: {names}. Which one counts?")
            answer = self.choose(TWINS, Sentence(template, {"names": names}))
        for number, values in rows:
            name = values["designation"]
            if name in found and values == found[name][1]:
                continue
            if name in found and answer == "both":
                counts[name] = counts.get(name, 1) + 1
                name = f"{name} ({counts[name]})"
            if name not in found or answer == "last":
                found[name] = number, values | {"designation": name}
        return list(found.values())


_POWER_PLACE = "rated_power_kW"
NO_FIGURE = N_("Motors with a cell that is no number above 0 are left out ({count}): row {rows}.")
NO_NAME = N_("Rows without a name are left out ({count}): row {rows}.")
_ZERO = N_("Motors with a figure of 0 are left out ({count}): row {rows}.")


def _folded(name: str) -> str:
    return " ".join(name.replace("_", " ").replace(",", " ").replace(".", " ").replace("-", " ").casefold().split())


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join([*map(str, numbers[:MOST_NAMED]), *(["…"] if len(numbers) > MOST_NAMED else [])])
