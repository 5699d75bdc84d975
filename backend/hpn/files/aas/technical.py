"""`TechnicalData` by IDTA 02003-2-0-1: published figures of the selected gear, in the sections of the catalogue's page.

Without a saved ordering code, article number and order code are the designation, and their descriptions say so: the
handbook prints no article number, and a full code names output version and motor adapter too. A selection without a
date has no `FurtherInformation`, since that section of the template requires a date.
"""

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime

from basyx.aas import model

from hpn.account.lines import Line
from hpn.account.published import grouped, line_of
from hpn.engine.candidates import Candidate
from hpn.engine.checks import BY_CODE
from hpn.files.aas.concepts import concept_id, published, reference, translations, urn
from hpn.files.aas.elements import group, template, text, words
from hpn.files.export import Export
from hpn.words.units import symbol_of

MANUFACTURER = "Harmonic Drive AG"
TECHNICAL_DATA = "0173-1#01-AHX837#002"
TEMPLATE = "https://admin-shell.io/idta-02003-2-0"
GENERAL, AREAS, AREA = (
    *("0173-1#02-ABK161#002/0173-1#01-AHX838#002", "0173-1#02-ABK163#002"),
    "0173-1#02-ABL358#002/0173-1#01-AHX773#002",
)
FURTHER, STATEMENT, VALID = "0173-1#02-ABK164#002", "0173-1#02-ABK134#002", "0173-1#02-ABL775#001"
NAME, DESIGNATION, ARTICLE, ORDER = (
    *("0173-1#02-AAO677#004", "0173-1#02-AAW338#003", "0173-1#02-AAO676#005"),
    "0173-1#02-AAO227#004",
)
"""Semantic ids of the template's elements."""
ARBITRARY = "https://admin-shell.io/SMT/General/Arbitrary"
"""Meaning of a section; the template leaves it to its user."""

ARTICLE_NUMBER = {
    "en": "Designation of the gear: the manufacturer’s engineering data print no article number.",
    "de": "Bezeichnung des Getriebes: Die Projektierungsunterlagen des Herstellers nennen keine Artikelnummer.",
}
ORDER_CODE = {
    "en": "Ordering code as far as it is known: output version and motor adapter follow (table 9.1).",
    "de": "Bestellschlüssel, soweit bekannt: Abtriebsausführung und Motoradapter folgen (Tab. 9.1).",
}
SAYS = {
    "en": (
        "Figures of the manufacturer’s engineering data, written by an independent tool; not a statement of the "
        "manufacturer."
    ),
    "de": "Angaben aus den Projektierungsunterlagen des Herstellers, von einem unabhängigen Werkzeug geschrieben; "
    "keine Aussage des Herstellers.",
}
KINEMATICS, RATINGS = "Kinematics", "Ratings"
"""Sections that no page has as a group: size and ratio, and the figures of a saved answer without its catalogue."""


def technical_data(export: Export) -> model.Submodel:
    """Submodel of an export whose gear is suitable."""
    return model.Submodel(
        urn("technical-data", export.link),
        [_general(export), _areas(export), *_further(export)],
        id_short="TechnicalData",
        administration=model.AdministrativeInformation(version="2", revision="0", template_id=TEMPLATE),
        semantic_id=template(TECHNICAL_DATA),
    )


def order_code(export: Export) -> str:
    """Saved ordering code, else the designation."""
    return export.heading.ordering_code or export.candidate.designation


def product_names(export: Export) -> Mapping[str, str]:
    """Name of the product in every language."""
    designation = export.candidate.designation
    return {"en": f"{designation} planetary gear", "de": f"{designation} Planetengetriebe"}


def _general(export: Export) -> model.SubmodelElementCollection:
    code, designation = order_code(export), export.candidate.designation
    elements: list[model.SubmodelElement] = [
        text("ManufacturerName", MANUFACTURER, NAME),
        words("ManufacturerProductDesignation", product_names(export), DESIGNATION),
        text("ManufacturerArticleNumber", designation, ARTICLE, ARTICLE_NUMBER),
        text("ManufacturerOrderCode", code, ORDER, ORDER_CODE if code == designation else None),
    ]
    return group("GeneralInformation", elements, GENERAL)


def _areas(export: Export) -> model.SubmodelElementList[model.SubmodelElementCollection]:
    """List of one area, whose sections hold the published figures; unpublished ones are left out."""
    sections = [group(name, properties, ARBITRARY) for name, properties in _sections(export) if properties]
    return model.SubmodelElementList(
        "TechnicalPropertyAreas",
        model.SubmodelElementCollection,
        [group(None, sections, AREA)],
        semantic_id=reference(AREAS),
        semantic_id_list_element=reference(AREA),
        order_relevant=False,
    )


def _sections(export: Export) -> Iterator[tuple[str, list[model.Property]]]:
    """Short ids of sections, each with its figures."""
    candidate, gear = export.candidate, export.account.gear
    known: dict[str, str | float] = {"size": candidate.size, "stages": candidate.stages}
    kinematics = [_property(name, value) for name, value in known.items()]
    ratio = _property("ratio", candidate.ratio, line_of(gear, "ratio") if gear else None)
    yield KINEMATICS, [*kinematics, ratio]
    if gear is None:
        yield RATINGS, [_property(name, value) for name, value in _limits(candidate)]
        return
    for title, lines in grouped(export.account.published, lambda line: line.code):
        yield short_id(title), [_property(line.field, line.value, line) for line in lines if line.value is not None]


def short_id(title: str) -> str:
    """Short id of a title: `Size and weight` is `SizeAndWeight`."""
    letters = "".join(letter if letter.isalnum() else " " for letter in title)
    return "".join(word[0].upper() + word[1:] for word in letters.split())


def _limits(candidate: Candidate) -> Iterator[tuple[str, float]]:
    """Published figures from the limits of load checks: all that a saved answer has without its catalogue."""
    for check in candidate.checks:
        known = BY_CODE.get(check.code)
        own = known and known.group == "load" and known.limited_by and known.unit == symbol_of(known.limited_by)
        if known and known.limited_by and own and check.limit is not None:
            yield known.limited_by, check.limit


def _property(name: str, value: object, line: Line | None = None) -> model.Property:
    """Property of a figure, with its source as the description."""
    name, source = published(name), line.source if line else None
    return model.Property(
        name,
        type(value),
        value,
        semantic_id=reference(concept_id(name)),
        description=model.MultiLanguageTextType(translations(source)) if source else None,
    )


def _further(export: Export) -> Iterator[model.SubmodelElementCollection]:
    if moment := dated(export):
        day = model.datatypes.Date(*moment.timetuple()[:3])
        valid = model.Property("ValidDate", model.datatypes.Date, day, semantic_id=reference(VALID))
        yield group("FurtherInformation", [words("TextStatement", SAYS, STATEMENT), valid], FURTHER)


def dated(export: Export) -> datetime | None:
    """Moment of saving, else the day on which the files are made, in UTC; None without either."""
    if export.created is not None:
        return export.created.astimezone(UTC)
    if export.moment is None:
        return None
    return export.moment.astimezone(UTC).replace(hour=0, minute=0, second=0, microsecond=0)
