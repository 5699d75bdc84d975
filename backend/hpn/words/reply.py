"""Base of a typed reply: encoded by msgspec, described by pydantic, and thus part of FastAPI's OpenAPI document."""

from collections.abc import Mapping
from math import isfinite
from typing import Annotated, Any, get_args, get_type_hints

from msgspec import UNSET, Struct, UnsetType, structs
from pydantic import ConfigDict, GetCoreSchemaHandler, WithJsonSchema
from pydantic_core import CoreSchema, core_schema

from hpn.words.fields import name_units
from hpn.words.wording import Named

Mixed = Annotated[float | str, WithJsonSchema({"description": "A number or a text."})]
"""A number or a text, without a type in the document: Kotlin’s and Rust’s clients can’t read a union of both."""


def described(named: Mapping[str, Named]) -> ConfigDict:
    """Settings of a class with quantities as fields: their sentences and units go into its JSON Schema."""

    def describe(schema: dict[str, Any]) -> None:
        for field, entry in schema["properties"].items():
            for superfluous in ("title", "default"):
                entry.pop(superfluous, None)
            if field in named:
                equation = f" Equation {named[field].equation}." if named[field].equation else ""
                entry["description"] = named[field].sentence + equation
        name_units(schema)

    return ConfigDict(json_schema_extra=describe)


class Reply(Struct, frozen=True):
    """A reply or part of one. Its class describes fields by `Field` in their types, or by `described` quantities.

    A default stands for a field that an old saved reply lacks; a new reply has every field, unless its class omits
    defaults.
    """

    __pydantic_config__ = described({})

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Schema of an object: fields that are always sent, and optional ones."""
        kinds, sparse = get_type_hints(cls, include_extras=True), cls.__struct_config__.omit_defaults
        fields = {
            field.encode_name: core_schema.typed_dict_field(
                handler.generate_schema(_on_wire(kinds[field.name])),
                required=field.required or not (sparse or field.default is UNSET),
            )
            for field in structs.fields(cls)
        }
        ref = f"{cls.__module__}.{cls.__qualname__}:{id(cls)}"
        return core_schema.typed_dict_schema(fields, cls=cls, ref=ref)


def finite(value: float) -> float | None:
    """A figure of a reply; None for NaN and infinity."""
    return value if isfinite(value) else None


def _on_wire(kind: Any) -> Any:
    """Type of a field in a reply: without the unset option."""
    options = get_args(kind)
    return options[0] if UnsetType in options else kind
