"""Shafts in the names of columns: the motor's shaft, which is the gear's input, and the gear's output shaft."""

from re import IGNORECASE

from hpn.words.patterns import Pattern

_LONGEST = 1000
"""Characters of a name, or of the names above one another in a column together."""

_SIDE = r"(?:[ -]?(?:shaft|side|welle|seite|drive|motor))?"
_MOTOR = (
    r"(?:(?:servo|electric|elektro|getriebe)[ -]?)?(?:motor(?:en)?|servo|actuator)" + _SIDE,
    r"(?:(?:gear|gearbox|getriebe|reducer)[ -]?)?(?:input|eingangs?|antriebs?|drive|driving)" + _SIDE,
    r"(?:(?:high|fast)[ -]?speed shaft|hss|schnelle welle|primary|primärseite)",
    r"(?:arbre |côté |axe )?(?:d['’ ]|en |à l['’])?(?:moteur|entrée)(?: (?:du )?(?:réducteur|moteur))?",
    r"(?:albero |lato |asse )?(?:(?:all|d)['’ ]|in |del )?(?:motore|ingresso|entrata|azionamento)"
    r"(?: (?:del )?riduttore)?",
    r"(?:eje |lado )?(?:del |de )?(?:entrada)|mot|(?<=[nmt][ _])in$",
)
OF_MOTOR = Pattern(rf"(?<![^\W_])(?:{'|'.join(_MOTOR)})(?![^\W\d_])[ _-]*", _LONGEST, IGNORECASE)
_JOINED = Pattern(
    r"(?<![^\W_])(?:servo|elektro)?(?:motor|antriebs|eingangs|getriebeeingangs)(?=[^\W\d_]{3})", _LONGEST, IGNORECASE
)
"""The motor as the first part of a German word: `Motordrehzahl`."""

_INDEX = Pattern(r"(?<![^\W_][TMnω])(?<=[TMnω])_?1$", _LONGEST)
"""The index of the input behind a symbol: `T1`, `M_1`; the output has 2."""

_OUTPUT = (
    r"(?:(?:gear|gearbox|getriebe|reducer)[ -]?)?(?:output|abtriebs?|ausgangs?)" + _SIDE,
    r"(?:low|slow)[ -]?speed shaft|lss|langsame welle|load[ -]?side|lastseite|lastseitig|abtriebsseitig",
    r"(?:arbre |côté |axe )?(?:de |en |à la )?(?:sortie)(?: (?:du )?réducteur)?",
    r"(?:albero |lato |asse )?(?:(?:all|d)['’]|di |in )?(?:uscita)(?: (?:del )?riduttore)?",
    r"(?:eje |lado )?(?:de )?salida",
)
OF_OUTPUT = Pattern(rf"(?<![^\W_])(?:{'|'.join(_OUTPUT)})(?![^\W\d_])[ _-]*", _LONGEST, IGNORECASE)


def is_of_motor(name: str) -> bool:
    """True for a name with a word of the motor's side."""
    return bool(OF_MOTOR.search(name) or _JOINED.search(name))


def without_motor(name: str) -> str:
    """A name without words of the motor's side."""
    return _JOINED.sub("", OF_MOTOR.sub("", name)).strip(" _-")


def without_index(name: str) -> str:
    """A name without the index of the input behind its symbol."""
    return _INDEX.sub("", name)


def without_output(name: str) -> str:
    """A name without words of the output shaft, to which all inputs refer."""
    return OF_OUTPUT.sub("", name).strip(" _-")
