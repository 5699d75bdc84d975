"""The report as data: every text in the reader's language, every number as it is printed. The template only sets it."""

import re
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import segno

from hpn.candidates import Candidate
from hpn.checks import allowed
from hpn.report import inputs, plots, standings
from hpn.report.export import Export
from hpn.report.language import Language
from hpn.report.symbols import formula, sentence
from hpn.units import symbol_of
from hpn.wording import N_

MOST_PHASES = 20
"""Phases up to which each is listed; beyond, their range and sum."""

LONGEST_TITLE = 160
LONGEST_QR_LINK = 600
LONGEST_PRINTED_LINK = 240
LONGEST_LINK = 2000
"""Readers open no longer address from a document."""

STATUS = {"pass": N_("passes"), "fail": N_("fails"), "not_rated": N_("not rated")}

VERDICTS = {
    "suitable": N_("{gear} is suitable. Every check passes; the closest is “{check}” at {percent} of its limit."),
    "unsuitable": N_("No gear is suitable. {gear} comes closest; it fails because of “{check}” at {percent}."),
    "unlimited": N_(
        "No gear is suitable. {gear} comes closest, but the emergency stop is so hard that none is allowed."
    ),
    "unrated": N_("No gear is suitable. {gear} can't be judged: figures that the checks need are not published."),
}

BEST = {
    "weight": N_("It is the lightest of {count} suitable gears."),
    "utilisation": N_("It has the largest reserve of {count} suitable gears."),
    "length": N_("It is the shortest of {count} suitable gears."),
    "motor_torque": N_("It needs the least motor torque of {count} suitable gears."),
    "life": N_("It has the longest life of {count} suitable gears."),
    "stiffness": N_("It is the stiffest of {count} suitable gears."),
}
ONLY = N_("It is the only suitable gear.")

LABELS = {
    "product": N_("HPN Select"),
    "heading": N_("Gear selection report"),
    "untitled": N_("Untitled selection"),
    "reference": N_("Reference"),
    "created": N_("Saved"),
    "loads": N_("Pause, emergency stop and loads"),
    "requirements": N_("Requirements"),
    "phases": N_("Duty cycle"),
    "derived": N_("What the cycle and the gear come to"),
    "cycle": N_("Torque and speed over one cycle"),
    "bearing": N_("Load on the output bearing"),
    "checks": N_("Checks of {gear}"),
    "ratings": N_("Published figures of {gear}"),
    "alternatives": N_("Alternatives"),
    "notices": N_("Assumptions and notes"),
    "basis": N_("Basis"),
    "versions": N_("Versions"),
    "check": N_("Check"),
    "relation": N_("Relation"),
    "demand": N_("Value"),
    "limit": N_("Limit"),
    "utilisation": N_("Utilisation"),
    "verdict": N_("Verdict"),
    "source": N_("Source"),
    "open": N_("Open"),
    "page": N_("Page {page} of {pages}"),
    "bars": N_("A bar's full width is 125 %; the stroke marks what is acceptable."),
    "disclaimer": N_(
        "Made by an independent tool from the maker's engineering data. Check the selection with the maker before you "
        "order."
    ),
    "unsaved": N_("Not saved: made from the link alone, therefore undated."),
    "too_long_link": N_("The link is too long to print; it carries every phase."),
    "unprintable": N_("□ stands for characters of the title or reference that the report's fonts lack."),
}

LEGEND = {
    "own": N_("life envelope, f_w as stated"),
    "printed": N_("life envelopes, f_w 1, 1.2, 1.5"),
    "published": N_("published limits over f_w"),
    "equivalent": N_("equivalent load P_m"),
    "point": N_("load of a phase"),
}


def content(export: Export, language: Language) -> dict[str, Any]:
    """Everything that the template sets, as JSON-ready data."""
    text = language.text
    candidate = export.candidate
    labels = {key: text(label) for key, label in LABELS.items()}
    labels |= {key: labels[key].format(gear=candidate["designation"]) for key in ("checks", "ratings")}
    return {
        "lang": language.code,
        "labels": labels,
        "legend": [[kind, sentence(text(label))] for kind, label in LEGEND.items()],
        "title": _shortened(export.title.strip() or labels["untitled"], LONGEST_TITLE),
        "reference": _shortened(export.reference.strip(), LONGEST_TITLE),
        "created": language.date(export.created) if export.created else "",
        **_link(export.link),
        "verdict": _verdict(export, language),
        "loads": [_input(row) for row in inputs.given(export.application, inputs.LOADS, language)],
        "requirements": [_input(row) for row in inputs.given(export.application, inputs.REQUIREMENTS, language)],
        "phases": _phases(export, language),
        "derived": _derived(export, language),
        "cycle": {"panels": plots.cycle(export, language), "alt": text(N_("Torque and speed of the cycle over time"))},
        "bearing": plots.envelope(export, language),
        "bearing_alt": text(N_("Loads of the phases within the envelopes of the output bearing")),
        "checks": [_check(export, check, language) for check in candidate["checks"]],
        "ratings": _ratings(export, language),
        "alternatives": _alternatives(export, language),
        "notices": [sentence(language.filled(notice["text"])) for notice in export.reply["notices"]],
        "versions": [
            [text(N_("Engine")), export.reply["engine_version"]],
            [text(N_("Catalogue")), catalogue_version(export, language)],
        ],
    }


def catalogue_version(export: Export, language: Language) -> str:
    """Version of the catalogue, and that its own figures are missing where it is not at hand."""
    version = str(export.reply["catalogue_version"])
    missing = language.text(N_("not kept: published figures stand only where the result names them"))
    return version if export.figures else f"{version} ({missing})"


def _input(row: inputs.Row) -> dict[str, Any]:
    return {"label": row.label, "symbol": formula(row.symbol), "text": row.text}


def _shortened(text: str, most: int) -> str:
    plain = " ".join(
        "".join(c if c.isprintable() or c.isspace() else "\N{REPLACEMENT CHARACTER}" for c in text).split()
    )
    return _breakable(plain if len(plain) <= most else plain[: most - 1] + "…")


def _breakable(text: str) -> str:
    """A text with places to break its line in long words."""
    return re.sub(r"\S{24}(?=\S)", "\\g<0>\N{ZERO WIDTH SPACE}", text)


def _link(link: str) -> dict[str, Any]:
    shown = link if len(link) <= LONGEST_PRINTED_LINK else link[: LONGEST_PRINTED_LINK - 1] + "…"
    target = link if len(link) <= LONGEST_LINK else ""
    return {
        "link": target,
        "link_text": _breakable(shown) if target else "",
        "qr": _qr(link) if len(link) <= LONGEST_QR_LINK else "",
    }


def _qr(link: str) -> str:
    """QR code as an SVG drawing."""
    drawing = BytesIO()
    segno.make(link, error="m", micro=False).save(drawing, kind="svg", border=0, xmldecl=False, svgclass=None)
    return drawing.getvalue().decode()


def _verdict(export: Export, language: Language) -> dict[str, Any]:
    candidate, status = export.candidate, export.candidate["status"]
    key = "unlimited" if status == "unsuitable" and candidate["utilisation"] is None else status
    suitable = sum(c["status"] == "suitable" for c in export.candidates)
    sentence = language.text(VERDICTS[key]).format(
        gear=candidate["designation"],
        check=_title(export, candidate["governing_check"], language) if candidate["governing_check"] else "",
        percent=_used(export, candidate["governing_check"], candidate["utilisation"], language),
    )
    best = language.text(BEST[export.application.rank_by] if suitable > 1 else ONLY).format(count=suitable)
    return {
        "status": status,
        "gear": candidate["designation"] if status == "suitable" else "–",
        "text": f"{sentence} {best}" if suitable else sentence,
        "utilisation": language.percent(candidate["utilisation"], _bound(export, candidate["governing_check"])),
        "word": language.text(
            {"suitable": N_("suitable"), "unsuitable": N_("none suitable")}.get(status, N_("unrated"))
        ),
    }


def _title(export: Export, code: str, language: Language) -> str:
    return language.text(export.definitions[code]["title"])


# --- Duty cycle -------------------------------------------------------------------------------------------------------


def _phases(export: Export, language: Language) -> dict[str, Any]:
    phases = export.application.duty_cycle.phases
    names = ["torque_Nm", "speed_rpm", "duration_s"]
    names += [name for name in ("radial_N", "axial_N") if any(getattr(p, name) is not None for p in phases)]
    symbols = {"torque_Nm": "T", "speed_rpm": "n", "duration_s": "t", "radial_N": "F_R", "axial_N": "F_A"}
    columns = [[getattr(phase, name) for phase in phases] for name in names]
    listed = len(phases) <= MOST_PHASES
    rows = (
        [[str(k), *(_cell(c[k - 1], language) for c in columns)] for k in range(1, len(phases) + 1)]
        if listed
        else _summary(names, columns, language)
    )
    note = "" if listed else language.text(N_("{count} phases, summarised here; the workbook and the link have each."))
    return {
        "header": [[[], ""], *([formula(symbols[name]), language.unit(symbol_of(name))] for name in names)],
        "rows": rows,
        "note": note.format(count=language.exact(len(phases))),
    }


def _cell(value: float | None, language: Language) -> str:
    return "" if value is None else language.exact(value)


def _summary(names: Sequence[str], columns: Sequence[Sequence[float | None]], language: Language) -> list[list[str]]:
    known = [[value for value in column if value is not None] for column in columns]
    sums = [language.figure(sum(c)) if name == "duration_s" else "" for name, c in zip(names, known, strict=True)]
    return [
        [language.text(N_("least")), *(language.figure(min(column)) for column in known)],
        [language.text(N_("largest")), *(language.figure(max(column)) for column in known)],
        [language.text(N_("sum")), *sums],
    ]


DERIVED = (
    ("average_torque_Nm", "T_av", N_("Average torque"), "17.2"),
    ("maximum_torque_Nm", "T_max", N_("Largest torque"), ""),
    ("average_output_speed_rpm", "n_out,av", N_("Average output speed"), "17.4"),
    ("maximum_output_speed_rpm", "n_out,max", N_("Largest output speed"), ""),
    ("average_input_speed_rpm", "n_in,av", N_("Average input speed"), "17.5"),
    ("maximum_input_speed_rpm", "n_in,max", N_("Largest input speed"), "17.6"),
    ("momentary_peak_count", "N_k,max", N_("Allowed emergency stops"), "17.9"),
    ("life_L10_h", "L_10", N_("Gear life"), "17.10"),
    ("bearing_life_L50_h", "L_b,50", N_("Bearing life L50"), ""),
    ("bearing_life_L10_h", "L_b,10", N_("Bearing life L10"), ""),
    ("motor_peak_torque_Nm", "T_max/(i·η)", N_("Peak motor torque needed"), ""),
    ("motor_rated_torque_Nm", "T_rms/(i·η)", N_("RMS motor torque needed"), ""),
)
"""Figures of the cycle and of the reported gear: field, symbol, name, equation."""


def _derived(export: Export, language: Language) -> list[dict[str, Any]]:
    known = {**export.candidate, **export.reply["duty"]}
    lower_bound = export.is_lower_bound(export.candidate)
    loss_free = lower_bound and not export.follows_efficiency_curve(export.candidate)
    rows = []
    for name, symbol, label, equation in DERIVED:
        value = known.get(name)
        if value is not None:
            unit, at_motor = language.unit(symbol_of(name)), name.startswith("motor_")
            where = language.text(N_("eq. {number}")).format(number=equation) if equation else ""
            bound = f", {language.text(N_('lower bound'))}" if lower_bound and at_motor else ""
            rows.append(
                {
                    "label": language.text(label) + bound,
                    "symbol": formula(symbol),
                    "text": f"{language.figure(value)}\N{NO-BREAK SPACE}{unit}" if unit else language.figure(value),
                    "where": "η = 1" if loss_free and at_motor else where,
                }
            )
    return rows


RATINGS = (
    ("rated_torque_Nm", "T_N", N_("Rated torque")),
    ("repeated_peak_torque_Nm", "T_R", N_("Repeated peak torque")),
    ("momentary_peak_torque_Nm", "T_M", N_("Momentary peak torque")),
    ("average_input_speed_rpm", "n_av(max)", N_("Average input speed")),
    ("maximum_input_speed_rpm", "n_in(max)", N_("Maximum input speed")),
    ("dynamic_radial_load_N", "F_R,dyn", N_("Largest radial load")),
    ("dynamic_axial_load_N", "F_A,dyn", N_("Largest axial load")),
    ("ambient_temperature_minimum_degC", "t_min", N_("Lowest ambient temperature")),
    ("ambient_temperature_maximum_degC", "t_max", N_("Highest ambient temperature")),
    ("backlash_arcmin", "j", N_("Backlash")),
    ("transmission_accuracy_arcmin", "", N_("Transmission accuracy")),
    ("torsional_stiffness_Nm_per_rad", "K_3", N_("Torsional stiffness")),
    ("weight_kg", "m", N_("Weight")),
    ("length_min_mm", "L_min", N_("Shortest length")),
    ("length_max_mm", "L_max", N_("Longest length")),
)
"""Published figures of a gear: field, symbol, name."""


def _ratings(export: Export, language: Language) -> list[dict[str, Any]]:
    gear = export.gear(export.candidate["designation"])
    return [
        {
            "label": language.text(label),
            "symbol": formula(symbol),
            "text": f"{language.exact(value)}\N{NO-BREAK SPACE}{language.unit(symbol_of(name))}",
            "where": language.filled(gear.sources.get(name, "")),
        }
        for name, symbol, label in RATINGS
        if gear and (value := getattr(gear, name)) is not None
    ]


# --- Checks and alternatives ------------------------------------------------------------------------------------------


def _check(export: Export, check: Mapping[str, Any], language: Language) -> dict[str, Any]:
    code, bound = check["code"], _bound(export, check["code"])
    definition = export.definitions[code]
    equation = definition["equation"]
    where = [language.text(N_("eq. {number}")).format(number=equation)] if equation else []
    return {
        "title": language.text(definition["title"]),
        "relation": formula(standings.STANDINGS[code].relation),
        "demand": _measured(check["demand"], definition["unit"], language),
        "limit": _measured(check["limit"], definition["unit"], language) + _part(bound, definition["kind"], language),
        "utilisation": language.percent(check["utilisation"], bound),
        "share": _share(check),
        "bound": bound,
        "status": check["status"],
        "word": language.text(STATUS[check["status"]]),
        "where": " · ".join([*where, standings.source(export, code, language)]),
        "basis": sentence(language.text(definition["basis"])),
    }


def _bound(export: Export, code: str | None) -> float:
    return allowed(code, export.application.requirements.utilisation)


def _part(bound: float, kind: str, language: Language) -> str:
    """What stands behind a limit that only part of may be used."""
    return f" {'÷' if kind == 'minimum' else '×'} {_exact_percent(bound, language)}" if bound < 1 else ""


def _exact_percent(bound: float, language: Language) -> str:
    return f"{language.exact(100 * bound)}\N{NO-BREAK SPACE}%"


def _used(export: Export, code: str | None, utilisation: float | None, language: Language) -> str:
    """A utilisation inside a sentence, with what is allowed where that is less than the limit."""
    bound = _bound(export, code)
    used = language.percent(utilisation, bound)
    if bound == 1 or utilisation is None:
        return used
    text = language.text(N_("{used} (at most {allowed})"))
    return text.format(used=used, allowed=_exact_percent(bound, language))


def _share(check: Mapping[str, Any]) -> float:
    """Length of a check's bar: none where it is not rated, all of it where it fails without a number."""
    if check["utilisation"] is None:
        return 2.0 if check["status"] == "fail" else 0.0
    return float(check["utilisation"])


def _measured(value: float | None, unit: str, language: Language) -> str:
    shown = language.figure(value)
    return f"{shown}\N{NO-BREAK SPACE}{language.unit(unit)}" if unit and value is not None else shown


def _alternatives(export: Export, language: Language) -> list[list[str]]:
    counts = {status: 0 for status in ("suitable", "unsuitable", "unrated")}
    for candidate in export.candidates:
        counts[candidate["status"]] += 1
    overview = language.text(
        N_("{total} gears considered: {suitable} suitable, {unsuitable} unsuitable, {unrated} not rated.")
    )
    rows = [["", overview.format(total=len(export.candidates), **counts)]]
    if export.runner_up:
        rows.append([language.text(N_("Runner-up")), _standing(export, export.runner_up, language)])
    if export.smaller and export.smaller is not export.candidate:
        rows.append([language.text(N_("Smaller gear")), _standing(export, export.smaller, language)])
    return rows


def _standing(export: Export, candidate: Candidate, language: Language) -> str:
    """A candidate in a sentence: how close it is to its limits, or every check that it fails."""
    gear = export.gear(candidate["designation"])
    name = candidate["designation"]
    if gear and gear.weight_kg:
        name = f"{name} ({language.exact(gear.weight_kg)}\N{NO-BREAK SPACE}kg)"
    failing = [check for check in candidate["checks"] if check["status"] == "fail"]
    if not failing:
        sentence = language.text(N_("{gear} passes too; its closest check is “{check}” at {percent}."))
        check = _title(export, candidate["governing_check"], language)
        return sentence.format(
            gear=name,
            check=check,
            percent=_used(export, candidate["governing_check"], candidate["utilisation"], language),
        )
    sentence = language.text(N_("{gear} fails: {failures}."))
    return sentence.format(gear=name, failures="; ".join(_failure(export, check, language) for check in failing))


def _failure(export: Export, check: Mapping[str, Any], language: Language) -> str:
    unit = export.definitions[check["code"]]["unit"]
    return language.text(N_("{check} {demand} against {limit} ({percent})")).format(
        check=_title(export, check["code"], language),
        demand=_measured(check["demand"], unit, language),
        limit=_measured(check["limit"], unit, language),
        percent=_used(export, check["code"], check["utilisation"], language),
    )
