"""Sections of a motion pattern as elements of 02021."""

from collections.abc import Iterable, Iterator

from basyx.aas import model
from basyx.aas.model.concept import ConceptDescription

from hpn.files.aas.concepts import reference
from hpn.files.aas.courses import MotionSection
from hpn.files.aas.elements import group
from hpn.files.aas.sizing_ids import CONCEPTS, meaning

CSV_TYPE = "text/csv"


def number(name: str, value: float) -> model.Property:
    """Quantity of the template, as a double."""
    ref: model.Reference = reference(meaning(name))
    if name in CONCEPTS:
        key = model.Key(model.KeyTypes.CONCEPT_DESCRIPTION, meaning(name))
        ref = model.ModelReference((key,), ConceptDescription)
    return model.Property(name, float, float(value), semantic_id=ref)


def elements_of(sections: Iterable[tuple[MotionSection, str]]) -> Iterator[model.SubmodelElementCollection]:
    """Collections of sections; a section comes with the path of its file in the package."""
    for place, (section, path) in enumerate(sections, 1):
        columns = [number(name, 1.0) for name in section.columns]
        yield group(
            f"{section.kind}_{place}",
            [
                *(number(name, value) for name, value in section.constants.items()),
                group(section.metadata, columns, meaning(section.metadata)),
                model.File("MotionSectionFile", CSV_TYPE, path, semantic_id=reference(meaning("MotionSectionFile"))),
            ],
            meaning(section.kind),
        )
