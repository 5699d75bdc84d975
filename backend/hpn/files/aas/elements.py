"""Elements of a submodel as in the templates of IDTA: short id, meaning, value."""

from collections.abc import Iterable, Mapping

from basyx.aas import model

from hpn.files.aas.concepts import reference

NOT_GIVEN = "not given"
"""Value of a text that a template requires and the user has not typed."""


def text(name: str, value: str, meaning: str, description: Mapping[str, str] | None = None) -> model.Property:
    """Property with a text as its value."""
    translations = model.MultiLanguageTextType(dict(description)) if description else None
    return model.Property(name, str, value, semantic_id=reference(meaning), description=translations)


def words(name: str, values: Mapping[str, str], meaning: str) -> model.MultiLanguageProperty:
    """Property with a text in every language."""
    return model.MultiLanguageProperty(name, model.MultiLanguageTextType(dict(values)), semantic_id=reference(meaning))


def template(value: str) -> model.ModelReference[model.Submodel]:
    """Meaning of a submodel, in the form of its template."""
    return model.ModelReference((model.Key(model.KeyTypes.SUBMODEL, value),), model.Submodel)


def group(name: str | None, elements: Iterable[model.SubmodelElement], meaning: str) -> model.SubmodelElementCollection:
    """Collection of elements."""
    return model.SubmodelElementCollection(name, list(elements), semantic_id=reference(meaning))
