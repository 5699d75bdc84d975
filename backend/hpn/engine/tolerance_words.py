"""Verdict on a gear over its whole tolerance, in words."""

from hpn.engine.candidates import Candidate, WorstCase
from hpn.engine.checks import BY_CODE, name_of
from hpn.words.wording import N_, Quantity, Sentence

HOLDS = N_("Holds over the whole tolerance: {check} at most at {percent} of its limit.")
NONE_FOUND = N_("Holds at every sample of the tolerance: {check} at most at {percent} of its limit.")
FAILS = N_("Fails inside the tolerance: {check} reaches {percent} of its limit.")
FAILS_SO = N_("Fails inside the tolerance: {check}.")
NOT_RATED = N_("Not rated inside the tolerance.")


def tolerance_of(candidate: Candidate) -> Sentence | None:
    """Sentence on a candidate's worst case; None without tolerances."""
    worst = candidate.worst
    if not isinstance(worst, WorstCase):
        return None
    if worst.governing_check is None or worst.governing_check not in BY_CODE:
        return Sentence(NOT_RATED)
    check = name_of(worst.governing_check)
    if worst.utilisation is None:
        return Sentence(FAILS_SO, {"check": check}, ("check",))
    proved = all(each.exact is True for each in candidate.checks)
    template = FAILS if worst.status == "unsuitable" else HOLDS if proved else NONE_FOUND
    percent = Quantity(100 * worst.utilisation, "percent", 4, "up")
    return Sentence(template, {"check": check, "percent": percent}, ("check",))
