"""Differences of two replies as rows of two accounts, then and today: the comparer's result in words and units."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hpn.account.account import Account
from hpn.account.lines import Line, Value
from hpn.engine.candidates import FIGURES, reason_of
from hpn.engine.selection import CheckDefinition
from hpn.explain.comparison import Row, is_number
from hpn.explain.differences import Difference
from hpn.words.quantities import QUANTITIES
from hpn.words.reader import Reader
from hpn.words.terms import VERDICTS
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Sentence

PLACES: Mapping[str, str] = {
    "/candidates/checks/": "check.",
    "/candidates/reserve/": "reserve.",
    "/candidates/": "candidate.",
    "/duty/phases/": "phase.",
    "/duty/": "duty.",
}
"""Prefixes of pointers without their numbers -> prefixes of places in `QUANTITIES`."""

NAMES: Mapping[str, str] = {"selected": N_("Selected gear"), "text": N_("Notice")}
"""Names of fields that are no quantities; any other field has its own name."""

SHARES = ("utilisation", "torque_factor", "speed_factor", "load_factor")
"""Fields shown as percentages."""

NO_CANDIDATE = N_("no candidate")


@dataclass(frozen=True)
class ReplyChange:
    """A difference of two replies as a reader sees it; the second account is None without a reply today."""

    difference: Difference
    accounts: tuple[Account, Account | None]
    reader: Reader

    @property
    def check(self) -> str:
        """Title of its check; blank without one."""
        return self._definition.title if self._definition else self.difference.check or ""

    @property
    def phase(self) -> int | None:
        """Number of its load phase; None without one."""
        parts = self.difference.pointer.split("/")
        return int(parts[3]) + 1 if parts[1:3] == ["duty", "phases"] else None

    @cached_property
    def row(self) -> Row:
        """Both values; two texts that today's words would make equal stay as each was written."""
        if self._reads_alike:
            return Row(tuple(self._line(Sentence("{text}", {"text": text})) for text in self._values))
        return self._as_read

    @property
    def numbers(self) -> tuple[str, str]:
        """Both values without units."""
        return self.row.numbers(self.reader)

    @property
    def is_wording(self) -> bool:
        """True for a text with only a new wording: about a check, a notice, or the reason why a gear does not fit."""
        if self._reads_alike:
            return True
        notices = (notice for one in self.accounts if one for notice in one.selection.notices)
        values = {notice.text: notice.values for notice in notices}
        before, after = (values.get(str(text)) for text in self._values)
        of_check = self.difference.pointer.startswith("/check_definitions/")
        return self.difference.change == "changed" and (of_check or (before is not None and before == after))

    @property
    def _definition(self) -> CheckDefinition | None:
        return self.accounts[0].selection.check_definitions.get(self.difference.check or "")

    @property
    def _values(self) -> tuple[Any, Any]:
        return self.difference.saved, self.difference.today

    @cached_property
    def _as_read(self) -> Row:
        return Row(tuple(map(self._line_of, self._values, self.accounts)))

    @cached_property
    def _reads_alike(self) -> bool:
        one, other = self._as_read.numbers(self.reader)
        return one == other and all(isinstance(value, str) for value in self._values)

    # --- Lines --------------------------------------------------------------------------------------------------------

    def _line_of(self, value: Any, account: Account | None) -> Line:
        """A value as a line of its reply's account."""
        field, name = self.difference.field, self.difference.candidate or ""
        candidate = account.selection.candidate(name) if account else None
        if account and candidate and self._code == f"candidate.{field}" and field in FIGURES and candidate.says(field):
            return account.of(candidate).figure(field)
        if field in SHARES and is_number(value):
            return self._line(100 * value)
        return self._line(self._value(value, account))

    def _line(self, value: Value | None) -> Line:
        return Line(self._code, self._named, value, self._unit, "computed")

    @property
    def _unit(self) -> str:
        field = self.difference.field
        if self._definition and field in ("demand", "limit"):
            return self._definition.unit
        return "%" if field in SHARES else suffix_of(field)

    @cached_property
    def _code(self) -> str:
        place = re.sub(r"/\d+(?=/|$)", "", self.difference.pointer)
        start = next((start for start in PLACES if place.startswith(start)), "")
        return PLACES.get(start, "") + place.removeprefix(start)

    @property
    def _named(self) -> Named:
        field = self.difference.field
        known = (self._code, f"candidate.{field}", f"check.{field}", f"requirements.{field}")
        quantity = next((QUANTITIES[code] for code in known if code in QUANTITIES), None)
        return quantity or Named(NAMES.get(field, field))

    def _value(self, value: Any, account: Account | None) -> Value | None:
        """A value in words; the written text if its version kept no values for it."""
        if account is None or value is None:
            is_whole = self.difference.change != "changed" and self._code == "candidate.status"
            return NO_CANDIDATE if account and is_whole else None
        if is_number(value):
            number: float = value
            return number
        return self._words(str(value), account)

    def _words(self, text: str, account: Account) -> str | Sentence:
        candidate = account.selection.candidate(self.difference.candidate or "")
        if self.difference.field == "reason" and candidate and account.application:
            return reason_of(candidate, account.utilisation)
        if notice := next((notice for notice in account.selection.notices if notice.text == text), None):
            return notice.sentence
        definition = account.selection.check_definitions.get(text)
        return definition.title if definition else VERDICTS.get(text, text)
