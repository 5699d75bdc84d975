"""Account of a gear over the tolerances: what was asked, the worst case of each check, and which inputs decide."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.account.account import Account, CheckLine
from hpn.account.readings import CheckReading, readings_of
from hpn.application import Application
from hpn.application.tolerances import Deviation, Interval, Tolerance
from hpn.engine.checks import allowed
from hpn.engine.room import Room, Share, allowed_of, room_of, scaled, share_of
from hpn.engine.worst_corner import Corner, corners_of
from hpn.words.motion import MOTION
from hpn.words.quantities import INPUTS
from hpn.words.reader import MINUS, Reader
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Quantity, Sentence

ALL_PHASES, ONE_PHASE, ONE_MOVE = N_("{quantity}, all phases"), N_("{quantity}, phase {k}"), N_("{quantity}, move {k}")
MAY_GROW = N_("All tolerances may grow together: × {factor}.")
MUST_SHRINK = N_("It holds up to × {factor} of all these tolerances.")
HOLDS_WITH = N_("holds if the tolerance of {symbol} is at most {tolerance}")
PROVED = N_("proved: at a corner of the tolerances, not by samples")
SAMPLED = N_("≈ sampled, so that a worse case may lie between; the others are proved at a corner")
SOME_FAIL = N_("Of {samples} cases at random {failing} fail: with 95 % confidence at most {share}.")
NONE_FAILS = N_("Of {samples} cases at random none fails: with 95 % confidence fewer than {share} do.")
SPREAD = N_(
    "Each input is spread evenly over its tolerance, independent of the others; the worst case does not depend on that."
)

SHARE_SAMPLES = 4096
"""Cases at random that a page or a file looks at."""


@dataclass(frozen=True, slots=True)
class WorstLine:
    """The worst case of a check: utilisation, demand and limit in that case, and the inputs that lie high and low.

    It is proved where it `is_exact`, else the worst of samples.
    """

    check: CheckLine
    worst: float | None
    bound: float
    is_exact: bool
    corner: Corner | None
    reading: CheckReading | None
    high: tuple[str, ...]
    low: tuple[str, ...]

    @property
    def status(self) -> str:
        """Verdict in the worst case."""
        if self.worst is None:
            fails = self.corner and next(c for c in self.corner.candidate.checks if c.code == self.check.code)
            return fails.status if fails else "not_rated"
        return "fail" if self.worst > self.bound * (1 + 1e-12) else "pass"


@dataclass(frozen=True, slots=True)
class ToleranceLine:
    """A tolerance as it was given: its input, and how far it lies below and above."""

    path: str
    named: Named
    tolerance: Tolerance
    place: Sentence

    @property
    def symbol(self) -> str:
        """Symbol of the input."""
        return self.named.symbol

    def text(self, reader: Reader, factor: float = 1.0) -> str:
        """How far the input may lie from its value, or a multiple of it, rounded down: `±10 %`, `+5 % −2 %`."""
        tolerance = self.tolerance if factor == 1 else scaled(self.tolerance, factor)
        return tolerance_text(tolerance, suffix_of(self.path), reader)


@dataclass(frozen=True, slots=True)
class DecidingLine:
    """An input whose tolerance decides: the worst case with it exact, and by which factor its tolerance may change."""

    given: ToleranceLine
    worst: float | None
    allowed: float | None


@dataclass(frozen=True)
class OverTolerance:
    """A gear over the tolerances of an application that is known."""

    account: Account
    application: Application

    @cached_property
    def given(self) -> list[ToleranceLine]:
        """Tolerances as they were given."""
        return [line_of(path, tolerance) for path, tolerance in (self.application.tolerances or {}).items()]

    @cached_property
    def checks(self) -> list[WorstLine]:
        """Worst case of every check, that which governs first among equals in the order of the reply."""
        corners = self._corners
        return [self._worst(line, corners.get(line.code)) for line in self.account.checks]

    @cached_property
    def _corners(self) -> dict[str, Corner]:
        gear, catalogue = self.account.gear, self.account.catalogue
        if gear is None or catalogue is None:
            return {}
        return corners_of(self.application, gear, catalogue, [line.code for line in self.account.checks])

    def _worst(self, line: CheckLine, corner: Corner | None) -> WorstLine:
        requirements, worst, exact = self.application.requirements, line.result.worst, line.result.exact
        u = requirements.worst_case_utilisation or requirements.utilisation
        reading = None
        if corner is not None:
            account = self.account
            reading = readings_of(corner.candidate, account.selection, corner.application, account.catalogue)[line.code]
        return WorstLine(
            line,
            worst if isinstance(worst, float) else None,
            allowed(line.code, u),
            exact is True,
            corner,
            reading,
            symbols_of(corner.high, self.application.intervals) if corner else (),
            symbols_of(corner.low, self.application.intervals) if corner else (),
        )

    @property
    def governing(self) -> WorstLine | None:
        """The check that is worst."""
        worst = self.account.candidate.worst
        code = getattr(worst, "governing_check", None)
        return next((line for line in self.checks if line.check.code == code), None)

    @cached_property
    def room(self) -> Room | None:
        """Growth and deciding inputs; those of the answer where it has them."""
        account = self.account
        tolerance = account.selection.tolerance
        if isinstance(tolerance, Room) and account.candidate.designation == account.selection.selected:
            return tolerance
        if account.gear is None or account.catalogue is None or account.equipped is None:
            return None
        return room_of(self.application, account.equipped, account.gear, account.catalogue, lambda _: "")

    @cached_property
    def deciding(self) -> list[DecidingLine]:
        """Inputs without whose tolerance the worst case falls, the greatest fall first."""
        by_path = {line.path: line for line in self.given}
        gear, catalogue = self.account.gear, self.account.catalogue
        lines = []
        for one in self.room.deciding if self.room else ():
            factor = None
            if gear is not None and catalogue is not None:
                factor = allowed_of(self.application, gear, catalogue, one.path)
            lines.append(DecidingLine(by_path[one.path], one.worst, factor))
        return lines

    @cached_property
    def share(self) -> Share | None:
        """Share of cases at random in which the gear fails."""
        gear, catalogue = self.account.gear, self.account.catalogue
        return share_of(self.application, gear, catalogue, SHARE_SAMPLES) if gear and catalogue else None

    @property
    def growth(self) -> Sentence | None:
        """Sentence on how far all tolerances may grow together, rounded to the safe side; None without a limit."""
        if self.room is None or self.room.growth is None:
            return None
        factor = Quantity(self.room.growth, "", 3, "down")
        return Sentence(MAY_GROW if self.room.holds else MUST_SHRINK, {"factor": factor})

    @property
    def standing(self) -> Sentence:
        """Note on what is proved and what is sampled."""
        return Sentence(PROVED if all(line.is_exact for line in self.checks) else SAMPLED)

    @property
    def failing(self) -> tuple[Sentence, ...]:
        """Sentences on the share of cases that fail, as a bound of it."""
        if self.share is None:
            return ()
        bound = Quantity(100 * self.share.upper, "percent", 2, "up")
        counts = {"samples": Quantity(self.share.samples, "", 6), "failing": Quantity(self.share.failing, "", 6)}
        return Sentence(SOME_FAIL if self.share.failing else NONE_FAILS, {**counts, "share": bound}), Sentence(SPREAD)

    @staticmethod
    def remedy(line: "DecidingLine", reader: Reader) -> str:
        """Tolerance of one input with which the gear holds, in words."""
        values = {
            "symbol": line.given.symbol or line.given.named.name,
            "tolerance": line.given.text(reader, line.allowed or 0.0),
        }
        return reader.told(Sentence(HOLDS_WITH, values))

    @property
    def holding(self) -> list[DecidingLine]:
        """Inputs with a smaller tolerance of which the gear would hold, where it fails."""
        fails = self.room is not None and not self.room.holds
        return [line for line in self.deciding if fails and line.allowed is not None and 0 < line.allowed < 1]


def over_tolerance(account: Account) -> OverTolerance | None:
    """The gear of an account over the tolerances; None without any, or where its answer knows none."""
    application = account.application
    known = any(isinstance(line.worst, float) or line.worst is None for line in account.candidate.checks)
    return OverTolerance(account, application) if application and application.tolerances and known else None


# --- Words ------------------------------------------------------------------------------------------------------------


def line_of(path: str, tolerance: Tolerance) -> ToleranceLine:
    """A tolerance with the name of its input."""
    *table, field = path.split(".")
    if table and table[-1].isdigit():
        k = int(table[-1])
        is_phase = table[0] == "phases"
        named = INPUTS[f"phase.{field}"] if is_phase else _of_move(field)
        return ToleranceLine(
            path, _numbered(named, k), tolerance, _placed(ONE_PHASE if is_phase else ONE_MOVE, named, k)
        )
    if not table and f"phase.{field}" in INPUTS:
        named = INPUTS[f"phase.{field}"]
        return ToleranceLine(path, named, tolerance, _placed(ALL_PHASES, named))
    named = _single(path)
    return ToleranceLine(path, named, tolerance, Sentence("{text}", {"text": named.name}, ("text",)))


def _single(path: str) -> Named:
    if path.startswith("motion."):
        return MOTION[path.removeprefix("motion.")]
    return INPUTS[f"duty_cycle.{path}" if path == "pause_s" else path]


def _of_move(field: str) -> Named:
    return MOTION[f"move.{field}"] if f"move.{field}" in MOTION else INPUTS[f"phase.{field}"]


def _placed(template: str, named: Named, k: int | None = None) -> Sentence:
    quantity = Sentence("{text}", {"text": named.name}, ("text",))
    return Sentence(template, {"quantity": quantity} | ({} if k is None else {"k": str(k + 1)}))


def _numbered(named: Named, k: int) -> Named:
    """Name with its symbol numbered: `T_1`, `F_R,1`."""
    if not named.symbol:
        return named
    return Named(named.name, f"{named.symbol}{',' if '_' in named.symbol else '_'}{k + 1}")


def tolerance_text(tolerance: Tolerance, unit: str, reader: Reader) -> str:
    """A tolerance as it is read."""
    minus, plus = tolerance.sides
    below, above = (_side(side, unit, reader) for side in (minus, plus))
    return f"±{above}" if minus == plus else f"+{above} {MINUS}{below}"


def _side(side: Deviation | None, unit: str, reader: Reader) -> str:
    if side is None or side.absolute is None:
        return reader.with_unit(reader.exact((side and side.percent) or 0.0, "percent"), "percent")
    if unit == "degC":  # a difference, whatever scale the reader has
        return f"{reader.exact(side.absolute)} K"
    return reader.with_unit(reader.exact(side.absolute, unit), unit)


def symbols_of(moved: Sequence[Interval], every: Iterable[Interval]) -> tuple[str, ...]:
    """Symbols of inputs that lie to one side; those of all rows of one field together."""
    rows: dict[str, list[int]] = {}
    for one in every:
        if len(one.place) > 2 and isinstance(one.place[-2], int):
            rows.setdefault(str(one.place[-1]), []).append(one.place[-2])
    symbols: list[str] = []
    for one in moved:
        field = str(one.place[-1])
        if len(one.place) > 2 and isinstance(one.place[-2], int):
            same = [each.place[-2] for each in moved if each.place[-1] == field and isinstance(each.place[-2], int)]
            named = INPUTS[f"phase.{field}"] if one.place[0] == "phases" else _of_move(field)
            whole = len(same) == len(rows[field]) > 1
            symbols.append(
                named.symbol or named.name if whole else _numbered(named, one.place[-2]).symbol or named.name
            )
        else:
            path = ".".join(map(str, one.place)).removeprefix("duty_cycle.")
            named = _single(path)
            symbols.append(named.symbol or named.name)
    return tuple(dict.fromkeys(symbols))
