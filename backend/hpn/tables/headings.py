"""Headings of a table in several languages: the quantity of a column, and its unit."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from re import IGNORECASE

from hpn.tables.cells import TIME_FORMAT, is_blank, tidy
from hpn.tables.shafts import is_of_motor, without_index, without_motor, without_output
from hpn.words import spellings, units
from hpn.words.patterns import Pattern

QUANTITIES = {
    **{"T": "torque", "n": "speed", "t": "time"},
    **{"FRi": "force", "FAi": "force"},
    **{"Tpk": "torque", "npk": "speed", "Trms": "torque", "Tlo": "torque"},
}
"""Link symbols of the duty table's columns -> measured quantity."""

INDEX, SUM, UNIT = "index", "sum", "unit"
LONGEST = 80

LONGEST_WRITTEN = 1000
"""The same limit before blanks are removed."""

_EXACT = {"T": "T", "n": "n", "t": "t", "ω": "n", "Md": "T", "Δt": "t", "dt": "t", "FR": "FRi", "FA": "FAi"}
_MEASURED = {
    "M": "T",
    "M2": "T",
    "T2": "T",
    "τ": "T",
    "n2": "n",
    "Velocity": "n",
    "velocity": "n",
    "Giri": "n",
    "giri": "n",
}
"""Names that mean a quantity only beside a unit of it."""

_SYMBOLS = {**_EXACT, **_MEASURED, "Fr": "FRi", "Fa": "FAi", "t2": "t", "ω2": "n"}
"""Symbols that may stand behind a name, as in `Drehmoment T2 [Nm]`; symbols of the motor’s side are not among them."""

_INSTANTS = (
    "zeitpunkt; instant; timestamp; zeitstempel; uhrzeit; datetime; date time; endzeit; startzeit; end time; "
    "start time; ende; end; start; beginn; bis; von; until; from; "
    "horodatage; heure; date/heure; date heure; ora; orario; data/ora; data ora"
)
INSTANTS = set(_INSTANTS.split("; "))
"""Names of a point in time, never of a duration."""

_WORDS = {
    "T": "torque; drehmoment; moment; lastmoment; abtriebsmoment; abtriebsdrehmoment; output torque; load torque; "
    "t out; torque out; couple; couple résistant; coppia; coppia resistente; momento; momento torcente; par; "
    "vridmoment; koppel",
    "n": "speed; drehzahl; abtriebsdrehzahl; output speed; rotational speed; winkelgeschwindigkeit; angular velocity; "
    "angular speed; omega; n out; vitesse; vitesse de rotation; velocità; velocità di rotazione; velocidad; "
    "velocidad de giro; varvtal; toerental; vitesse angulaire; velocità angolare; numero di giri",
    "t": "duration; dauer; zeitdauer; phasendauer; time; zeit; durée; temps; durata; tempo; duración; tiempo; tid; "
    "varaktighet; tijd; duur; delta t; " + _INSTANTS,
    "FRi": "radial; radial load; radial force; radialkraft; radiallast; fr; fri; f r; charge radiale; force radiale; "
    "carico radiale; carga radial; fuerza radial; radiallast; effort radial; forza radiale",
    "FAi": "axial; axial load; axial force; axialkraft; axiallast; fa; fai; f a; charge axiale; force axiale; "
    "carico assiale; carga axial; fuerza axial; effort axial; forza assiale",
    "Tpk": "peak torque; maximum torque; max torque; torque peak; torque max; tpk; t pk; t max; tmax; m max; mmax; "
    "spitzenmoment; spitzendrehmoment; maximalmoment; maximaldrehmoment; maximales moment; maximales drehmoment; "
    "größtes moment; größtes drehmoment; max drehmoment; max moment; drehmoment max; moment max",
    "npk": "peak speed; maximum speed; max speed; speed peak; speed max; npk; n pk; n max; nmax; "
    "spitzendrehzahl; maximaldrehzahl; maximale drehzahl; größte drehzahl; höchste drehzahl; max drehzahl; "
    "drehzahl max",
    "Trms": "rms torque; torque rms; effective torque; trms; t rms; t eff; teff; m eff; meff; "
    "effektivmoment; effektivdrehmoment; effektives moment; effektives drehmoment; drehmoment eff; "
    "moment eff; drehmoment effektiv",
    "Tlo": "least torque; minimum torque; min torque; torque min; lowest torque; smallest torque; tlo; t lo; "
    "mmin; kleinstes moment; kleinstes drehmoment; minimalmoment; minimaldrehmoment; "
    "minimales moment; minimales drehmoment; min drehmoment; min moment; drehmoment min; moment min",
    INDEX: "nr; no; #; №; n°; nº; pos; index; idx; id; lfd nr; lfd-nr; lfdnr; nummer; number; num; phase; phase nr; "
    "phase no; phasen-nr; phasennr; phasennummer; step; schritt; segment; abschnitt; row; zeile; étape; fase; steg; "
    "i; k; line; item; point; punkt; quantity; quantity unit; größe; größe einheit; grandeur; grandeur unité; "
    "grandezza; grandezza unità; parameter; parameter unit",
}
_NAMES = {word.strip(): kind for kind, words in _WORDS.items() for word in words.split(";")}
DURATIONS = {"duration", "dauer", "zeitdauer", "phasendauer", "durée", "durata", "duración", "varaktighet", "duur"} | {
    *("delta t", "δt", "dt")
}
"""Names of a duration, never of a point in time."""

_LARGEST = {"max", "maximum", "maximal", "maximale", "maxi", "massima", "massimo", "peak", "spitze", "crête", "picco"}
_EFFECTIVE = {"rms", "eff", "effective", "effektiv", "efficace"}
_QUALIFIED = {
    **{(word, kind): f"{kind}pk" for word in _LARGEST for kind in ("T", "n")},
    **{(word, "T"): "Trms" for word in _EFFECTIVE},
}
"""A word before or behind the name of a quantity, and its kind -> meaning of both together."""

QUALIFIERS = {
    *_LARGEST,
    *_EFFECTIVE,
    *("min", "minimum", "mean", "average", "avg", "mittel", "mittelwert", "nominal", "rated", "nenn"),
}
"""Words below the name of a quantity that tell which figure of it a column holds."""

OF_NAMES = {"name", "phase name", "bezeichnung", "benennung", "phasenname", "nom", "nome", "nombre", "namn", "naam"}
"""Headings of a column of phase names; the heading of an index may stand there as well."""

OF_PHASES = {"phase", "step", "schritt", "segment", "abschnitt", "étape", "fase", "steg", "stap", "bewegung", "move"}
"""Headings of a column with numbers or names of an axis's phases, never of axes."""

OF_REMARKS = {"remark", "remarks", "comment", "note", "notes", "bemerkung", "bemerkungen", "anmerkung", "kommentar"}
"""Headings of a column of remarks, which are no names."""

OF_LOAD = {"load", "last", "load cycle", "lastzyklus", "duty cycle", "cycle", "zyklus"}
"""Words above the name of a quantity that don't change its meaning."""

ANGULAR = {"ω", "omega", "winkelgeschwindigkeit", "angular velocity", "angular speed"} | {
    *("vitesse angulaire", "velocità angolare"),
}
"""Names of a speed that is as likely in rad/s as in rpm."""

_RATED = {"M_N", "T_N", "n_N", "P_N"}
"""Symbols of rated figures, whose index is no unit."""

_SUMS = Pattern(
    r"(?:(?:summe|sum|total|gesamt|insgesamt|kumuliert\w*|kumulativ\w*|kum|cumul\w*|cum|somme|somma|suma|totale|summa)\b"
    r"|[σ∑]) *(?P<rest>.*)",
    LONGEST_WRITTEN,
)
_TOTALS = Pattern(
    r"[σ∑ø].*|.*\b(?:subtotal|zwischensumme|gesamtzeit|zykluszeit|cycle time|overall|ergebnis|"
    r"mittel|mittelwert\w*|mittlere\w*|average|mean|avg|durchschnitt\w*|moyenne|media|medelvärde|"
    r"max|maximum|maximal\w*|(?<![0-9] )min|minimum|minimal\w*|rms|effektivwert\w*|std|standardabweichung)\b.*",
    LONGEST_WRITTEN,
)
_STOPS = Pattern(
    r"(?<![^\W_])(?:e[ -]?stop|e[ -]?halt|emergency(?:[ -]?(?:stop|halt|off|brak(?:e|ing)))?|crash|collision|kollision|"
    r"not[ -]?(?:aus|halt|stopp?|bremsung)|arrêt d['’ ]urgence|urgence|arresto (?:di |d['’])emergenza|emergenza|"
    r"parada de emergencia|t[ _]?k)(?![^\W\d_])",
    LONGEST,
    IGNORECASE,
)
_PAUSES = Pattern(
    r"(?:pause(?:nzeit)?|pausa|dwell|idle|wait(?:ing)?|warten|stillstand|standstill|sosta|attesa|repos)[ _]?[0-9]{0,3}",
    LONGEST,
    IGNORECASE,
)
_BETWEEN = Pattern(r"\s+in\s+|\s*[/,]\s*|[\s_]+", LONGEST_WRITTEN)


@dataclass(frozen=True, slots=True)
class Heading:
    """Meaning of a heading: a quantity, an index, a sum, a unit alone, or nothing known (`kind` blank).

    Beside a word of the motor only `likely` is filled: the quantity may belong to another shaft than the output.
    """

    kind: str
    unit: str = ""
    likely: str = ""
    lasting: bool = False
    angular: bool = False
    instant: bool = False

    @property
    def names_quantity(self) -> bool:
        """True for the name of a phase's quantity, on either shaft."""
        return self.kind in QUANTITIES or bool(self.likely)


def heading_of(cell: str) -> Heading:
    """Meaning of a cell as a heading; a cell too long for a heading is not even cached."""
    return _heading_of(cell) if len(cell) <= LONGEST_WRITTEN else Heading("")


@lru_cache(maxsize=2000)
def _heading_of(cell: str) -> Heading:
    text = " ".join(tidy(cell).split()).rstrip(":").strip()
    if is_blank(text.strip("[]()")):
        return Heading(UNIT)
    if len(text) > LONGEST:
        return Heading("")
    if not _kind(text, "") and (unit := _unit_alone(text)):
        return Heading(UNIT, unit)
    name, unit = parts_of(text)
    folded = _folded(name)
    if summed := _SUMS.fullmatch(folded) or _SUMS.fullmatch(" ".join(reversed(folded.rsplit(" ", 1)))):
        of = _kind(summed["rest"], "")
        return Heading(SUM if of == "t" or (not of and spellings.codes_for(unit, "time")) else "", unit)
    codes = spellings.codes_for(unit)
    bare = without_index(name) if codes else name
    of_motor = bare != name or is_of_motor(name)
    kind = likely = _kind(without_motor(bare), unit) if of_motor else _kind(name, unit)
    if kind in QUANTITIES and codes and QUANTITIES[kind] not in {units.QUANTITY_OF[code] for code in codes}:
        return Heading("", unit)
    kind, likely = (kind, "") if not of_motor or kind == "t" else ("", kind if kind in QUANTITIES else "")
    words = {folded, *map(_folded, name.rpartition(" "))}
    lasting, angular, instant = (not words.isdisjoint(names) for names in (DURATIONS, ANGULAR, INSTANTS))
    return Heading(kind, unit, likely, lasting, angular, instant)


def _unit_alone(text: str) -> str:
    """Unit of a cell that is only a unit, else blank."""
    inner = _without_in(_without_in(text).strip("[]()<>{} "))
    if text == "d":  # more likely a symbol than days
        return ""
    known = inner in spellings.SPELLINGS if len(inner) == 1 else bool(spellings.codes_for(inner))
    return inner if known else ""


def _without_in(unit: str) -> str:
    """A unit without the word “in” before it; in `in lb` it is the inch."""
    return unit if spellings.codes_for(unit) else unit.removeprefix("in ")


def parts_of(text: str) -> tuple[str, str]:
    """Name and unit of `Drehzahl [1/min]`, `Drehzahl in 1/min`, `Drehzahl_1/min`, `n / min-1`.

    Other text in brackets is part of the name: `Speed motor` of `Speed (motor) [rpm]`. A short word in the last
    brackets may be an unknown unit; in round brackets it is part of the name as well, and the user is asked about both.
    """
    if len(text) > LONGEST_WRITTEN or _kind(text, "") or text.replace(" ", "_") in _RATED:
        return text, ""
    parts = _bracketed(text)
    inside = [k for k, (bracket, _) in enumerate(parts) if bracket]
    place = next((k for k in inside if _is_unit(parts[k][1])), None)
    if place is not None:
        return _joined(parts, place), _without_in(parts[place][1])
    for between in _BETWEEN.finditer(text):
        name, unit = text[: between.start()], text[between.end() :]
        if name and spellings.codes_for(unit):
            return name, unit
    bracket, unit = parts[inside[-1]] if inside else ("", "")
    if bracket and _may_be_unit(unit):
        return _joined(parts, None if bracket == "(" else inside[-1]), unit
    return _joined(parts), ""


def _bracketed(text: str) -> list[tuple[str, str]]:
    """Parts of a text outside and inside its outer brackets, each with its bracket."""
    parts, begin, depth, bracket = list[tuple[str, str]](), 0, 0, ""
    for k, sign in enumerate(text):
        opens, closes = sign in "[(<{", sign in "])>}" and depth > 0
        if (opens and not depth) or (closes and depth == 1):
            parts.append((bracket, text[begin:k].strip()))
            begin, bracket = k + 1, sign if opens else ""
        depth += opens - closes
    return [*parts, (bracket, text[begin:].strip())]


def _joined(parts: Sequence[tuple[str, str]], without: int | None = None) -> str:
    """Name from the parts of a text, without one of them and without empty brackets."""
    others = [part for k, (bracket, part) in enumerate(parts) if k != without and not (bracket and is_blank(part))]
    return " ".join(" ".join(others).split()).strip(" ,/")


def _is_unit(text: str) -> bool:
    return bool(spellings.codes_for(_without_in(text)) or TIME_FORMAT.fullmatch(text))


def _may_be_unit(text: str) -> bool:
    """True for a short word or a sign that has no meaning beside a name."""
    known = is_qualifier(text) or is_of_motor(text) or not without_output(text) or text in _SYMBOLS
    return (
        not known and not _SUMS.fullmatch(_folded(text)) and " " not in text and (len(text) < 6 or not text.isalpha())
    )


def _kind(name: str, unit: str) -> str:
    if name in _MEASURED:
        return _MEASURED[name] if spellings.codes_for(unit, QUANTITIES[_MEASURED[name]]) else ""
    if name in _EXACT:
        return _EXACT[name]
    folded = _folded(name)
    if len(folded) == 1 and folded in "tnm":
        return ""
    if kind := _NAMES.get(folded) or _qualified(folded):
        return kind
    if (of_output := without_output(name)) != name.strip() and of_output:
        return _kind(of_output, unit)
    word, _, symbol = name.strip().rpartition(" ")
    kind = _NAMES.get(_folded(word), "")
    return kind if kind and _SYMBOLS.get(symbol) == kind else ""


def _qualified(folded: str) -> str:
    """Largest or effective value of the quantity in the other words: `torque max`, `vitesse maximale`."""
    first, _, behind = folded.partition(" ")
    before, _, last = folded.rpartition(" ")
    ways = ((first, _NAMES.get(behind)), (last, _NAMES.get(before)))
    return next((quantity for word, kind in ways if kind and (quantity := _QUALIFIED.get((word, kind)))), "")


def _folded(name: str) -> str:
    return " ".join(name.replace("_", " ").replace(".", ". ").casefold().split()).replace(".", "").strip()


@dataclass(frozen=True, slots=True)
class Over:
    """Meaning of all texts above a column together. A name outranks a unit, which then is only the unit.

    `kind` is blank for no known meaning, or for two; `name` is the column's name without its units. Beside a word of
    the motor only `likely` is filled.
    """

    kind: str
    name: str
    units: frozenset[str]
    likely: str = ""
    of_motor: bool = False
    lasting: bool = False
    angular: bool = False
    instant: bool = False

    @property
    def may_be_time(self) -> bool:
        """True for a time, or a column without a name."""
        return self.kind == "t" or not self.name

    @property
    def codes(self) -> frozenset[str]:
        """Codes of all meanings of its units."""
        return frozenset(code for unit in self.units for code in spellings.codes_for(unit))


def heading_over(texts: Sequence[str]) -> Over:
    """Meaning of the texts above a column together: `Torque` over `max` is the largest torque, over `Nm` one in Nm."""
    meanings = [heading_of(text) for text in texts]
    measured = frozenset(each.unit for each in meanings) - {""}
    names = [text for text, each in zip(texts, meanings, strict=True) if each.kind != UNIT]
    if len(names) < 2:
        kind, likely = next(((each.kind, each.likely) for each in meanings if each.kind != UNIT), ("", ""))
        headings, name = meanings, names[0] if names else ""
    else:
        headings, name = _together(names)
        kind, likely = headings[0].kind, headings[0].likely
        measured |= {each.unit for each in headings} - {""}
    return Over(
        kind,
        name,
        measured,
        likely,
        bool(likely) or any(is_of_motor(parts_of(" ".join(text.split()))[0]) for text in names),
        lasting=any(each.lasting for each in headings),
        angular=any(each.angular for each in headings),
        instant=any(each.instant for each in headings),
    )


def _together(names: Sequence[str]) -> tuple[list[Heading], str]:
    """Headings from the names above one another, read downwards or upwards, and the name they form."""
    bare = [parts_of(" ".join(name.split()))[0] for name in names]
    bare = [name for name in bare if _folded(name) not in OF_LOAD and without_output(name)] or bare
    for name in (" ".join(bare), " ".join(reversed(bare))):
        if (whole := heading_of(name)).kind or whole.likely:
            return [whole], name
    each = [heading_of(name) for name in bare]
    same = len({heading.kind for heading in each}) == 1
    return (each if same else [Heading("")]), " ".join(bare)


def is_qualifier(cell: str) -> bool:
    """True for a word that tells which figure of the quantity above it a column holds."""
    return len(cell) <= LONGEST and _folded(cell.strip("[]()")) in QUALIFIERS


def is_name(cell: str) -> bool:
    """True for a heading of names, which are texts that identify each row."""
    return len(cell) <= LONGEST and (_folded(cell) in OF_NAMES or heading_of(cell).kind == INDEX)


def is_of_phase(cell: str) -> bool:
    """True for a heading of numbers or names of phases."""
    return len(cell) <= LONGEST and _folded(cell) in OF_PHASES


def is_remark(cell: str) -> bool:
    """True for a heading of remarks."""
    return len(cell) <= LONGEST and _folded(cell) in OF_REMARKS


def quantities_of(unit: str) -> set[str]:
    """Quantities that a unit may measure."""
    return {units.QUANTITY_OF[code] for code in spellings.codes_for(unit)}


def is_total(cell: str) -> bool:
    """True where a cell may label its row as a sum or another figure of the whole table."""
    if len(cell) > LONGEST:
        return False
    folded = _folded(cell.rstrip(":"))
    return bool(_SUMS.fullmatch(folded) or _TOTALS.fullmatch(folded))


def is_stop(cell: str) -> bool:
    """True where a cell may label its row as the emergency stop."""
    return bool(_STOPS.search(cell))


def is_pause(cell: str) -> bool:
    """True where a cell names its row as a pause."""
    return bool(_PAUSES.fullmatch(cell))
