"""Account of a gear over the tolerances: its tolerances, the worst case of each check, and the deciding inputs."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.account.account import Account, CheckLine
from hpn.account.readings import CheckReading, readings_of
from hpn.application import Application
from hpn.application.tolerances import Deviation, Interval, Tolerance
from hpn.engine.alone import Alone
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
SAMPLED = N_(
    "≈ sampled at cases that are always the same: a worse one may lie between; the others are proved at a corner"
)
ALL_SAMPLED = N_("≈ sampled at cases that are always the same: a worse one may lie between")
SOME_FAIL = N_("Of {samples} cases at random {failing} fail: with 95 % confidence at most {share}.")
NONE_FAILS = N_("Of {samples} cases at random none fails: with 95 % confidence fewer than {share} do.")
SPREAD = N_(
    "Each input is spread evenly over its tolerance, independent of the others; the worst case does not depend on that."
)

SHARE_SAMPLES = 4096
"""Random cases that a page or a file evaluates."""


@dataclass(frozen=True, slots=True)
class WorstLine:
    """The worst case of a check: utilisation, demand and limit in this case, and the inputs with high and low values.

    With `is_exact` it is proved, else it is the worst of samples.
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
    """A given tolerance: its input, and its deviations below and above."""

    path: str
    named: Named
    tolerance: Tolerance
    place: Sentence

    @property
    def symbol(self) -> str:
        """Symbol of the input."""
        return self.named.symbol

    def text(self, reader: Reader, factor: float = 1.0) -> str:
        """Deviation of the input, or a multiple of it rounded down, as text: `±10 %`, `+5 % −2 %`."""
        tolerance = self.tolerance if factor == 1 else scaled(self.tolerance, factor)
        return tolerance_text(tolerance, suffix_of(self.path), reader)


@dataclass(frozen=True, slots=True)
class DecidingLine:
    """An input with a deciding tolerance: the worst case with this input exact, and the factor by which it may
    change.
    """

    tolerance: ToleranceLine
    worst: float | None
    allowed: float | None

    def between(self, worst: float | None) -> float:
        """Utilisation half way between the worst case and this one: both percentages must differ from it."""
        return 1.0 if worst is None or self.worst is None else (worst + self.worst) / 2


@dataclass(frozen=True)
class OverTolerance:
    """A gear over the tolerances of a known application."""

    account: Account
    application: Application

    @cached_property
    def tolerances(self) -> list[ToleranceLine]:
        """Tolerances as given."""
        return [line_of(path, tolerance) for path, tolerance in (self.application.tolerances or {}).items()]

    @cached_property
    def checks(self) -> list[WorstLine]:
        """Worst case of every check, in the order of the reply."""
        codes = [line.code for line in self.account.checks]
        corners = corners_of(self._alone, codes) if self._alone else dict[str, Corner]()
        return [self._worst(line, corners.get(line.code)) for line in self.account.checks]

    @cached_property
    def _alone(self) -> Alone | None:
        """The gear by itself, the source of all other figures; None if its catalogue is not kept."""
        gear, catalogue = self.account.gear, self.account.catalogue
        return Alone.of(self.application, gear, catalogue) if gear and catalogue else None

    @cached_property
    def _intervals(self) -> tuple[Interval, ...]:
        return self.application.intervals

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
            symbols_of(corner.high, self._intervals) if corner else (),
            symbols_of(corner.low, self._intervals) if corner else (),
        )

    @property
    def governing(self) -> WorstLine | None:
        """The check that governs the worst case; None if unknown."""
        worst = self.account.candidate.worst
        code = getattr(worst, "governing_check", None)
        return next((line for line in self.checks if line.check.code == code), None)

    @cached_property
    def room(self) -> Room | None:
        """Growth and deciding inputs, from the answer if it has them."""
        account = self.account
        tolerance = account.selection.tolerance
        if isinstance(tolerance, Room) and account.candidate.designation == account.selection.selected:
            return tolerance
        return room_of(self._alone, lambda _: "") if self._alone else None

    @cached_property
    def deciding(self) -> list[DecidingLine]:
        """Inputs whose exact value would improve the worst case, the greatest improvement first."""
        by_path = {line.path: line for line in self.tolerances}
        return [
            DecidingLine(by_path[one.path], one.worst, allowed_of(self._alone, one.path) if self._alone else None)
            for one in (self.room.deciding if self.room else ())
        ]

    @cached_property
    def share(self) -> Share | None:
        """Share of random cases in which the gear fails."""
        return share_of(self._alone, SHARE_SAMPLES) if self._alone else None

    @property
    def growth(self) -> Sentence | None:
        """Sentence on the common growth of all tolerances, rounded to the safe side; None without a limit."""
        if self.room is None or self.room.growth is None:
            return None
        factor = Quantity(self.room.growth, "", 3, "down")
        return Sentence(MAY_GROW if self.room.holds else MUST_SHRINK, {"factor": factor})

    @property
    def standing(self) -> Sentence:
        """Note on proved and sampled checks."""
        proved = [line.is_exact for line in self.checks]
        return Sentence(PROVED if all(proved) else SAMPLED if any(proved) else ALL_SAMPLED)

    @property
    def failing(self) -> tuple[Sentence, ...]:
        """Sentences on the upper bound of the share of failing cases."""
        if self.share is None:
            return ()
        bound = Quantity(100 * self.share.upper, "percent", 2, "up")
        counts = {"samples": Quantity(self.share.samples, "", 6), "failing": Quantity(self.share.failing, "", 6)}
        return Sentence(SOME_FAIL if self.share.failing else NONE_FAILS, {**counts, "share": bound}), Sentence(SPREAD)

    @staticmethod
    def remedy(line: "DecidingLine", reader: Reader) -> str:
        """Tolerance of one input at which the gear holds, in words."""
        values = {
            "symbol": line.tolerance.symbol or line.tolerance.named.name,
            "tolerance": line.tolerance.text(reader, line.allowed or 0.0),
        }
        return reader.sentence(Sentence(HOLDS_WITH, values))

    @property
    def holding(self) -> list[DecidingLine]:
        """Inputs whose smaller tolerance would make a failing gear hold."""
        fails = self.room is not None and not self.room.holds
        return [line for line in self.deciding if fails and line.allowed is not None and 0 < line.allowed < 1]


def over_tolerance(account: Account) -> OverTolerance | None:
    """The gear of an account over the tolerances; None without any, or if its answer lacks the worst case."""
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
    """Quantity with a numbered symbol: `T_1`, `F_R,1`."""
    if not named.symbol:
        return named
    return Named(named.name, f"{named.symbol}{',' if '_' in named.symbol else '_'}{k + 1}")


def tolerance_text(tolerance: Tolerance, unit: str, reader: Reader) -> str:
    """A tolerance as text."""
    minus, plus = tolerance.sides
    below, above = (_side(side, unit, reader) for side in (minus, plus))
    return f"±{above}" if minus == plus else f"+{above} {MINUS}{below}"


def _side(side: Deviation | None, unit: str, reader: Reader) -> str:
    if side is None or side.absolute is None:
        return reader.with_unit(reader.exact((side and side.percent) or 0.0, "percent"), "percent")
    if unit == "degC":  # a difference, on any scale of the reader
        return f"{reader.exact(side.absolute)} K"
    return reader.with_unit(reader.exact(side.absolute, unit), unit)


def symbols_of(moved: Sequence[Interval], every: Iterable[Interval]) -> tuple[str, ...]:
    """Symbols of inputs on one side of their values; one symbol if all rows of a field are among them."""
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
