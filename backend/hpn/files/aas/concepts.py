"""Concepts of the submodels' properties: names in both languages, units, and ids of our own.

The ids are UUIDs made from names: they claim no number of ECLASS, IEC or the manufacturer that we could not check.
"""

from collections.abc import Mapping
from uuid import NAMESPACE_URL, uuid5

from basyx.aas import model
from basyx.aas.model.concept import ConceptDescription

from hpn.files.export import DIGITS
from hpn.words.quantities import CANDIDATE, CHECK, DUTY, GEAR, INPUTS
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.units import symbol_of
from hpn.words.wording import Named, Sentence

IEC61360 = "https://admin-shell.io/DataSpecificationTemplates/DataSpecificationIec61360/3"

_TEXTS_AND_PARTS = (
    *("designation", "rank", "governing_check", "reason", "reserve", "checks", "code"),
    *("clamp_bolts", "housing_bolts", "note", "sources"),
)
"""Fields without a property of their own."""


def published(field: str) -> str:
    """Concept of a published figure, with the prefix `published_` where a calculated figure has the same field."""
    same = CANDIDATE.get(field, GEAR[field]).name == GEAR[field].name
    return field if same else f"published_{field}"


CONCEPTS: Mapping[str, Named] = {
    name: named
    for table in (
        {"load_inertia_kgm2": INPUTS["requirements.load_inertia_kgm2"]},
        {published(field): named for field, named in GEAR.items()},
        DUTY,
        CANDIDATE,
        CHECK,
    )
    for name, named in table.items()
    if name not in _TEXTS_AND_PARTS
}
"""Concepts by the name of the property."""


def urn(*parts: str) -> str:
    """Id made from the parts; the same parts make the same id."""
    return uuid5(NAMESPACE_URL, "/".join(("hpn-select", *parts))).urn


def reference(value: str) -> model.ExternalReference:
    """Reference to a meaning outside this package, or to one of its concept descriptions."""
    return model.ExternalReference((model.Key(model.KeyTypes.GLOBAL_REFERENCE, value),))


def concept_id(name: str) -> str:
    """Id of a concept; `CONCEPTS` has its name."""
    return urn("concept", name)


def texts(english: str) -> dict[str, str]:
    """Text in every language."""
    return {code: Reader(code).text(english) for code in LANGUAGES}


def translations(sentence: Sentence) -> dict[str, str]:
    """Sentence in every language."""
    return {code: Reader(code, digits=DIGITS).sentence(sentence) for code in LANGUAGES}


def concept(name: str) -> ConceptDescription:
    """Description of a concept by IEC 61360."""
    unit, names = symbol_of(name), texts(CONCEPTS[name].name)
    content = model.DataSpecificationIEC61360(
        preferred_name=model.PreferredNameTypeIEC61360(names),
        definition=model.DefinitionTypeIEC61360(names),
        unit=unit or None,
        data_type=model.DataTypeIEC61360.REAL_MEASURE if unit else None,
    )
    return ConceptDescription(
        concept_id(name),
        id_short=name,
        embedded_data_specifications=[model.EmbeddedDataSpecification(reference(IEC61360), content)],
    )
