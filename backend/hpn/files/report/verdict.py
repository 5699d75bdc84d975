"""Verdict of the report, its figures at a glance, and the alternatives to the reported gear."""

from collections.abc import Iterable, Mapping
from typing import Any

from hpn.account.readings import shortest_life
from hpn.engine.candidates import Candidate, reason_of
from hpn.engine.remedy import remedy_of
from hpn.engine.tolerance_words import tolerance_of
from hpn.engine.tried import needed_of
from hpn.files.export import Export
from hpn.files.report.checks import bar, failures
from hpn.files.words import bound_of, exact_percent, title_of, utilisation_text
from hpn.words.quantities import GEAR
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import sentence
from hpn.words.terms import RANKINGS, VERDICTS
from hpn.words.wording import N_, Quantity, Sentence

REASONS: Mapping[str, str] = {
    "unsuitable": N_("No gear is suitable. {gear} comes closest; “{check}” fails at {percent}."),
    "unlimited": N_(
        "No gear is suitable. {gear} comes closest, but T_k is too high: no emergency stop is permitted (eq. 17.9)."
    ),
    "never_stops": N_("No gear is suitable. {gear} comes closest, but the brake does not stop the load."),
    "unrated": N_(
        "No gear is suitable. {gear} can’t be rated: figures that the checks need are not in this catalogue’s source."
    ),
}
"""Sentences on the reported gear where none is suitable."""

CHOSEN: Mapping[str, str] = {
    "unsuitable": N_("{gear} was chosen, but “{check}” fails at {percent}."),
    "unlimited": N_("{gear} was chosen, but T_k is too high: no emergency stop is permitted (eq. 17.9)."),
    "never_stops": N_("{gear} was chosen, but the brake does not stop the load."),
    "unrated": N_(
        "{gear} was chosen, but can’t be rated: figures that the checks need are not in this catalogue’s source."
    ),
}
"""Sentences on a chosen gear that fails, in place of a suitable one or of the nearest miss."""

SUITABLE, NONE = N_("{selected} would be suitable."), N_("No gear is suitable.")
OUTSIDE = N_("It passes every check, but its ratio or size was not asked for.")
ONLY = N_("It is the only suitable gear.")
RANKED = N_("It was chosen; {selected} ranks first of {count} suitable gears.")

PLACE = N_("rank {rank} of {count} suitable out of {all}")
NO_PLACE = N_("{count} of {all} gears are suitable")


def verdict(export: Export, reader: Reader) -> dict[str, Any]:
    """Data of the verdict: gear, status and rank, a sentence, and the governing check."""
    candidate, code = export.candidate, export.candidate.governing_check
    limit = export.account.torque_limit
    lines = limit.lines if limit.warns or candidate.status == "suitable" else ()
    of_worst = tolerance_of(candidate)
    sentences = (*_sentences(export, reader), *((of_worst,) if of_worst else ()), *lines)
    texts = [reader.sentence(sentence) for sentence in sentences]
    return {
        "gear": candidate.designation,
        "word": reader.text(VERDICTS[candidate.status]),
        "rank": reader.sentence(_rank(export)),
        "text": sentence(" ".join(texts)),
        **bar(candidate.utilisation, bound_of(export, code), candidate.status, reader),
        "governing": reader.text(export.selection.name_of(code)) if code else "",
        "allowed": exact_percent(export.application.requirements.utilisation, reader),
        "facts": [[sentence(label), text] for label, text in _facts(export, reader) if text],
    }


def _rank(export: Export) -> Sentence:
    values = {"rank": export.candidate.rank or 0, "count": len(_suitable(export)), "all": len(export.within_request)}
    return Sentence(PLACE if export.candidate.rank else NO_PLACE, values)


def _facts(export: Export, reader: Reader) -> Iterable[tuple[str, str]]:
    """Ordering code, lives, weight and length: label and text, blank where there is none."""
    account, load = export.account, export.application.loads
    yield reader.text(N_("Ordering code")), export.heading.ordering_code.strip()
    if load and (check := account.check("output_bearing_life")) and check.result.status != "not_rated":
        values = {"basis": load.life_basis, "life": Quantity(load.life_h, "h", 6)}
        requirement = Sentence(N_("Bearing life {basis}, asked {life}"), values)
        yield reader.sentence(requirement), account.text(f"candidate.bearing_life_{load.life_basis}_h", reader)
    yield reader.text(N_("Gear life L_10")), account.text("candidate.life_L10_h", reader)
    yield reader.text(GEAR["weight_kg"].name), account.text("gear.weight_kg", reader)
    yield reader.text(N_("Length")), account.text("gear.length", reader)


def _sentences(export: Export, reader: Reader) -> Iterable[Sentence]:
    candidate, selected = export.candidate, export.selection.selected
    status, code = candidate.status, candidate.governing_check
    without_number = "never_stops" if code == "momentary_peak_torque" else "unlimited"
    key = without_number if status == "unsuitable" and candidate.utilisation is None else status
    values = {
        "gear": candidate.designation,
        "selected": selected or "",
        "check": title_of(export, code, reader) if code else "",
        "percent": utilisation_text(export, code, candidate.utilisation, reader),
    }
    if status == "suitable":
        yield _place(export)
        return
    if candidate.missing:
        yield reason_of(candidate, export.application.requirements.utilisation)
    elif candidate is export.selection.foremost:
        yield Sentence(REASONS[key], values)
    else:
        yield Sentence(CHOSEN[key], values)
        yield Sentence(SUITABLE if selected else NONE, values)
    if remedy := _remedy(export, candidate):
        yield remedy


def _remedy(export: Export, candidate: Candidate) -> Sentence | None:
    """Sentence on changes that make a gear fit; None without any, or where its catalogue figures are unknown."""
    known = export.gear(candidate) and export.figures
    return remedy_of(candidate, needed_of(candidate, export.application, known) if known else ())


def _place(export: Export) -> Sentence:
    """Rank of a suitable gear among the suitable ones."""
    count, selected = len(_suitable(export)), export.selection.selected
    if export.candidate not in export.within_request:
        return Sentence(OUTSIDE)
    if export.candidate.designation != selected:
        return Sentence(RANKED, {"selected": selected or "", "count": count})
    return Sentence(RANKINGS[export.application.rank_by].first_of if count > 1 else ONLY, {"count": count})


def _suitable(export: Export) -> list[Candidate]:
    """Suitable gears among the requested ones."""
    return [candidate for candidate in export.within_request if candidate.status == "suitable"]


# --- Alternatives -----------------------------------------------------------------------------------------------------

MOST_SUITABLE = 6
"""Most suitable gears in the list, best first; the reported one is listed at any rank."""

HEADS = (
    N_("Rank"),
    N_("Gear"),
    N_("Utilisation"),
    N_("Governing check"),
    N_("Weight"),
    N_("Length"),
    N_("Shortest life"),
)
"""Columns of the candidates."""


def alternatives(export: Export, reader: Reader) -> dict[str, Any]:
    """Number of gears considered, the best suitable ones, and the reasons why a lighter or the next one fails."""
    counts = dict.fromkeys(("suitable", "unsuitable", "unrated"), 0)
    for candidate in export.within_request:
        counts[candidate.status] += 1
    overview = Sentence(
        N_("{total} gears considered: {suitable} suitable, {unsuitable} not suitable, {unrated} not rated."),
        {"total": len(export.within_request), **counts},
    )
    suitable = [candidate for candidate in export.selection.candidates if candidate.status == "suitable"]
    listed = [c for k, c in enumerate(suitable) if k < MOST_SUITABLE or c.designation == export.candidate.designation]
    rest = ", ".join(candidate.designation for candidate in suitable if candidate not in listed)
    return {
        "overview": reader.sentence(overview),
        "heads": [sentence(reader.text(head)) for head in HEADS],
        "rows": [_row(export, candidate, reader) for candidate in listed],
        "rest": reader.sentence(Sentence(N_("and {gears}"), {"gears": rest})) if rest else "",
        "misses": [
            [reader.text(N_("Nearest miss")), sentence(_missed(export, candidate, reader))]
            for candidate in export.misses
        ],
    }


def beside(export: Export, reader: Reader, most: int) -> dict[str, Any]:
    """Next suitable gears beside the reported one, or the nearest ones where none is suitable."""
    others = [candidate for candidate in export.selection.candidates if candidate is not export.candidate]
    suitable = [candidate for candidate in others if candidate.status == "suitable"]
    listed = suitable or [candidate for candidate in others if candidate.is_judged]
    return {
        "title": reader.text(N_("Next suitable gears") if suitable else N_("Next nearest gears")),
        "heads": [sentence(reader.text(head)) for head in HEADS],
        "rows": [_row(export, candidate, reader) for candidate in listed[:most]],
    }


def _row(export: Export, candidate: Candidate, reader: Reader) -> dict[str, Any]:
    """Cells of a suitable gear in the table."""
    account, code, life = export.account.of(candidate), candidate.governing_check, shortest_life(candidate)
    return {
        "rank": reader.exact(candidate.rank),
        "gear": candidate.designation,
        "is_reported": candidate.designation == export.candidate.designation,
        **bar(candidate.utilisation, bound_of(export, code), candidate.status, reader),
        "governing": reader.text(export.selection.name_of(code)) if code else "",
        "figures": [
            account.text("gear.weight_kg", reader) or NOTHING,
            account.text("gear.length", reader) or NOTHING,
            reader.sentence(life.sentence) if life else NOTHING,
        ],
    }


def _missed(export: Export, candidate: Candidate, reader: Reader) -> str:
    """Failed checks of a rejected gear, and the changes that make it fit."""
    account, name = export.account.of(candidate), candidate.designation
    if account.gear and account.gear.weight_kg:
        name = f"{name} ({account.text('gear.weight_kg', reader)})"
    failed = failures(account, reader)
    sentence = reader.sentence(Sentence(N_("{gear} fails: {failures}."), {"gear": name, "failures": failed}))
    remedy = _remedy(export, candidate)
    return f"{sentence} {reader.sentence(remedy)}" if remedy else sentence
