"""The Asset Administration Shell: technical data of the selected gear, and the selection with every check.

`TechnicalData` follows IDTA 02003-1-2 (Generic Frame for Technical Data for Industrial Equipment in Manufacturing, 1.2)
with its semantic ids. Article number and order code are the designation: the handbook prints no article number, and a
full order code names output version and motor adapter too; their descriptions say so. An unsaved selection has no date,
hence no `ValidDate`. `SelectionResult` is ours; no registered template exists for it.

The library writes metamodel 3.1, whose elements are those of 3.0 as far as they are used here: the namespace tells
which one a package claims. Most other tools read 3.0 alone.
"""

from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from basyx.aas import model
from basyx.aas.adapter import aasx
from pyecma376_2.core_properties import OPCCoreProperties

from hpn.account.motion import mechanism_of, moves_of
from hpn.account.readings import AT_MOTOR
from hpn.engine.candidates import FIGURES, Candidate, CheckResult
from hpn.engine.checks import BY_CODE
from hpn.engine.selection import DutyFigures, encode
from hpn.files.aas import Metamodel
from hpn.files.aas.concepts import CONCEPTS, concept, concept_id, published, reference, texts, told, urn
from hpn.files.export import LOSS_FREE, Export
from hpn.words.motion import MOTION
from hpn.words.quantities import DUTY, GEAR, INPUTS
from hpn.words.source import source_sentence
from hpn.words.units import symbol_of
from hpn.words.wording import Sentence

Value = str | int | float | None

CALCULATED = ("ratio", "stages", "utilisation", *FIGURES)
"""Fields of a candidate that are figures."""

OPTIONAL = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "name")
"""Fields of a phase that only some cycles have."""

MANUFACTURER = "Harmonic Drive AG"
TECHNICAL_DATA = "https://admin-shell.io/ZVEI/TechnicalData/"
GENERAL_INFORMATION = {
    "ManufacturerName": "0173-1#02-AAO677#002",
    "ManufacturerProductDesignation": "0173-1#02-AAW338#001",
    "ManufacturerArticleNumber": "0173-1#02-AAO676#003",
    "ManufacturerOrderCode": "0173-1#02-AAO227#002",
}
"""Elements of the template and their semantic ids, as the template of IDTA gives them."""

ARTICLE_NUMBER = {
    "en": "Designation of the gear: the manufacturer’s engineering data print no article number.",
    "de": "Bezeichnung des Getriebes: Die Projektierungsunterlagen des Herstellers nennen keine Artikelnummer.",
}
ORDER_CODE = {
    "en": "Ordering code as far as it is known: output version and motor adapter follow (table 9.1).",
    "de": "Bestellschlüssel, soweit bekannt: Abtriebsausführung und Motoradapter folgen (Tab. 9.1).",
}

WRITTEN: Metamodel = "3.1"
NAMESPACES: Mapping[Metamodel, bytes] = {
    "3.0": b"https://admin-shell.io/aas/3/0",
    "3.1": b"https://admin-shell.io/aas/3/1",
}

DATA_PART, APPLICATION_PART, RESULT_PART = "/aasx/data.xml", "/aasx/application.json", "/aasx/result.json"
FIRST_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest time that a zip entry can have; the content says when the selection was saved."""


def package(export: Export, metamodel: Metamodel = "3.0") -> bytes:
    """The .aasx package on an export in a version of the metamodel; the same bytes for the same selection."""
    files = aasx.DictSupplementaryFileContainer()  # type: ignore[no-untyped-call]
    application = export.application.model_dump_json(exclude_none=True).encode()
    files.add_file(APPLICATION_PART, BytesIO(application), "application/json")
    files.add_file(RESULT_PART, BytesIO(export.reply or encode(export.selection)), "application/json")
    packed = BytesIO()
    with aasx.AASXWriter(packed, failsafe=False) as writer:
        writer.write_core_properties(_properties(export))
        writer.write_all_aas_objects(DATA_PART, environment(export), files)
    return _finished(packed.getvalue(), metamodel)


def environment(export: Export) -> model.DictIdentifiableStore[model.Identifiable]:
    """Shell, submodels and concept descriptions of an export."""
    submodels = [_selection_result(export)]
    suitable = export.candidate.status == "suitable"
    if suitable:
        submodels.insert(0, _technical_data(export))
    kind = model.AssetKind.TYPE if suitable else model.AssetKind.NOT_APPLICABLE
    shell = model.AssetAdministrationShell(
        model.AssetInformation(kind, global_asset_id=urn("asset", export.link)),
        urn("shell", export.link),
        id_short="GearSelection",
        submodel=_InOrder(map(model.ModelReference.from_referable, submodels)),
    )
    store: model.DictIdentifiableStore[model.Identifiable] = model.DictIdentifiableStore()
    for item in (shell, *submodels, *map(concept, CONCEPTS)):
        store.add(item)
    return store


class _InOrder(set[model.ModelReference[model.Submodel]]):
    """A set that is always written in the same order, so that equal packages have equal bytes."""

    def __iter__(self) -> Iterator[model.ModelReference[model.Submodel]]:
        return iter(sorted(super().__iter__(), key=str))


# --- Technical data ---------------------------------------------------------------------------------------------------


def _technical_data(export: Export) -> model.Submodel:
    return model.Submodel(
        urn("technical-data", export.link),
        [_general_information(export), _technical_properties(export), _further_information(export)],
        id_short="TechnicalData",
        administration=model.AdministrativeInformation(version="1", revision="2"),
        semantic_id=reference(TECHNICAL_DATA + "Submodel/1/2"),
    )


def _general_information(export: Export) -> model.SubmodelElementCollection:
    designation = export.candidate.designation
    names = {"en": f"{designation} planetary gear", "de": f"{designation} Planetengetriebe"}
    ids = {name: reference(value) for name, value in GENERAL_INFORMATION.items()}

    def element(name: str, value: str, description: Mapping[str, str] | None = None) -> model.Property:
        text = model.MultiLanguageTextType(dict(description)) if description else None
        return model.Property(name, str, value, semantic_id=ids[name], description=text)

    return model.SubmodelElementCollection(
        "GeneralInformation",
        [
            element("ManufacturerName", MANUFACTURER),
            model.MultiLanguageProperty(
                "ManufacturerProductDesignation",
                model.MultiLanguageTextType(names),
                semantic_id=ids["ManufacturerProductDesignation"],
            ),
            element("ManufacturerArticleNumber", designation, ARTICLE_NUMBER),
            element("ManufacturerOrderCode", designation, ORDER_CODE),
        ],
        semantic_id=reference(TECHNICAL_DATA + "GeneralInformation/1/1"),
    )


def _technical_properties(export: Export) -> model.SubmodelElementCollection:
    """Published figures; what is not published is left out."""
    gear, candidate = export.gear(export.candidate), export.candidate
    figures: dict[str, Value] = {"size": candidate.size, "ratio": candidate.ratio, "stages": candidate.stages}
    sources: dict[str, Sentence] = {}
    if gear:
        figures |= {published(name): getattr(gear, name) for name in GEAR if published(name) in CONCEPTS}
        sources = {published(name): source_sentence(source) for name, source in gear.sources.items() if name in GEAR}
    else:
        figures |= {published(name): value for name, value in _limits(candidate)}
    return model.SubmodelElementCollection(
        "TechnicalProperties",
        _properties_of(figures, sources),
        semantic_id=reference(TECHNICAL_DATA + "TechnicalProperties/1/1"),
    )


def _limits(candidate: Candidate) -> Iterator[tuple[str, Value]]:
    """Published figures that are the limit of a load check: what a kept answer says without its catalogue."""
    for check in candidate.checks:
        known = BY_CODE.get(check.code)
        if known and known.group == "load" and known.limited_by and known.unit == symbol_of(known.limited_by):
            yield known.limited_by, check.limit


def _further_information(export: Export) -> model.SubmodelElementCollection:
    statement = {
        "en": (
            "Figures of the manufacturer’s engineering data, written by an independent tool; not a statement of the "
            "manufacturer."
        ),
        "de": "Angaben aus den Projektierungsunterlagen des Herstellers, von einem unabhängigen Werkzeug geschrieben; "
        "keine Aussage des Herstellers.",
    }
    elements: list[model.SubmodelElement] = [
        model.MultiLanguageProperty(
            "TextStatement01",
            model.MultiLanguageTextType(statement),
            semantic_id=reference(TECHNICAL_DATA + "TextStatement/1/1"),
        )
    ]
    if export.created:
        day = model.datatypes.Date(*export.created.astimezone(UTC).timetuple()[:3])
        valid = reference(TECHNICAL_DATA + "ValidDate/1/1")
        elements.append(model.Property("ValidDate", model.datatypes.Date, day, semantic_id=valid))
    return model.SubmodelElementCollection(
        "FurtherInformation",
        elements,
        semantic_id=reference(TECHNICAL_DATA + "FurtherInformation/1/1"),
    )


# --- Selection --------------------------------------------------------------------------------------------------------


def _selection_result(export: Export) -> model.Submodel:
    elements: list[model.SubmodelElement] = [
        *_texts(export),
        model.File("Application", "application/json", APPLICATION_PART),
        model.File("Result", "application/json", RESULT_PART),
        model.SubmodelElementCollection("Duty", _duty(export)),
        *_cycle(export),
        model.SubmodelElementCollection("Figures", _calculated(export)),
        model.SubmodelElementCollection("Checks", [_check(export, check) for check in export.candidate.checks]),
        model.SubmodelElementCollection("Notices", _notices(export)),
    ]
    return model.Submodel(
        urn("selection-result", export.link),
        elements,
        id_short="SelectionResult",
        description=model.MultiLanguageTextType(
            {"en": "Selection of a planetary gear for a duty cycle", "de": "Auswahl eines Planetengetriebes"}
        ),
        semantic_id=reference(urn("submodel", "selection-result", "1")),
    )


def _texts(export: Export) -> Iterable[model.Property]:
    selection, candidate = export.selection, export.candidate
    values = {
        "Selected": selection.selected,
        "Candidate": candidate.designation,
        "Status": candidate.status,
        "GoverningCheck": candidate.governing_check,
        "Title": export.heading.title or None,
        "Reference": export.heading.reference or None,
        "Author": export.heading.author or None,
        "Revision": export.heading.revision or None,
        "OrderingCode": export.heading.ordering_code or None,
        "Created": export.created.astimezone(UTC).isoformat() if export.created else None,
        "Link": export.link,
        "EngineVersion": selection.engine_version,
        "CatalogueVersion": selection.catalogue_version,
    }
    return [model.Property(name, str, value) for name, value in values.items() if value is not None]


MOST_ITEMS = 100
"""Moves or phases of which each stands in the submodel; of more the files have them all."""


def _duty(export: Export) -> list[model.Property]:
    """Figures of the cycle; of a motion also the inertia of its load."""
    return _properties_of(_fields(export.selection.duty, (*DUTY, "load_inertia_kgm2")))


def _cycle(export: Export) -> Iterable[model.SubmodelElementCollection]:
    """A motion as it was given, and the phases where torque or speed vary in them, or where they have names."""
    cycle = export.application.duty_cycle
    if cycle.motion is not None:
        mechanism = {name: value for name, _, value in mechanism_of(cycle.motion)}
        columns = moves_of(cycle.motion)
        names = {"name": [move.name for move in cycle.motion.moves]}
        moves = ({n: values[k] for n, values in (columns | names).items()} for k in range(len(cycle.motion.moves)))
        parts: list[model.SubmodelElement] = [
            model.SubmodelElementCollection("Mechanism", _said(mechanism)),
            *_numbered("Move", moves, len(cycle.motion.moves)),
        ]
        yield model.SubmodelElementCollection("Motion", parts)
    elif not any(getattr(phase, name) is not None for phase in cycle.load_phases for name in OPTIONAL):
        return
    phases = (phase.model_dump(exclude_none=True) for phase in cycle.load_phases)
    yield model.SubmodelElementCollection("Phases", [*_numbered("Phase", phases, len(cycle.load_phases))])


def _numbered(name: str, items: Iterable[Mapping[str, Value]], count: int) -> Iterable[model.SubmodelElement]:
    """How many there are, and each of them unless they are very many."""
    yield model.Property("Count", int, count)
    if count <= MOST_ITEMS:
        for number, item in enumerate(items, 1):
            yield model.SubmodelElementCollection(f"{name}_{number}", _said(item))


def _said(values: Mapping[str, Value]) -> list[model.Property]:
    """Properties of a mechanism, a move or a phase, each with its name and unit in words."""
    return [
        model.Property(name, type(value), value, display_name=model.MultiLanguageNameType(_name_of(name)))
        for name, value in values.items()
        if value is not None
    ]


def _name_of(name: str) -> dict[str, str]:
    """Name of an input of a motion or a phase in every language, with its unit."""
    named = next(table[f"{part}{name}"] for part, table in _TABLES if f"{part}{name}" in table)
    unit = symbol_of(name)
    return {code: f"{text} [{unit}]" if unit else text for code, text in texts(named.name).items()}


_TABLES = (("mechanism.", MOTION), ("move.", MOTION), ("", MOTION), ("phase.", INPUTS))


def _calculated(export: Export) -> list[model.Property]:
    """Figures of the candidate; motor torques without an efficiency are described as a lower bound."""
    loss_free = AT_MOTOR if export.is_lower_bound(export.candidate) else ()
    return _properties_of(_fields(export.candidate, CALCULATED), dict.fromkeys(loss_free, Sentence(LOSS_FREE)))


def _fields(part: DutyFigures | Candidate | CheckResult, names: Iterable[str]) -> dict[str, Value]:
    """Fields of a part of the selection."""
    return {name: getattr(part, name) for name in names}


def _check(export: Export, check: CheckResult) -> model.SubmodelElementCollection:
    definition = export.selection.check_definitions[check.code]
    figures = _fields(check, ("demand", "limit", "utilisation", "status"))
    return model.SubmodelElementCollection(
        check.code,
        [*_properties_of(figures), *([model.Property("unit", str, definition.unit)] if definition.unit else [])],
        display_name=model.MultiLanguageNameType(texts(definition.title)),
        description=model.MultiLanguageTextType(texts(definition.basis)) if definition.basis else None,
    )


def _notices(export: Export) -> Iterable[model.MultiLanguageProperty]:
    return [
        model.MultiLanguageProperty(f"{notice.code}_{number}", model.MultiLanguageTextType(told(notice.sentence)))
        for number, notice in enumerate(export.selection.notices, 1)
    ]


def _properties_of(
    figures: Mapping[str, Value], described: Mapping[str, Sentence] | None = None
) -> list[model.Property]:
    """Properties of the figures that have a value, described by their source or by what is to be known of them."""
    described = described or {}
    return [
        model.Property(
            name,
            type(value),
            value,
            semantic_id=reference(concept_id(name)),
            description=model.MultiLanguageTextType(told(described[name])) if name in described else None,
        )
        for name, value in figures.items()
        if value is not None
    ]


# --- Package ----------------------------------------------------------------------------------------------------------


def _properties(export: Export) -> OPCCoreProperties:
    """Author and title of the package; its time stands in the content, where no library chooses the prefix."""
    properties = OPCCoreProperties()  # type: ignore[no-untyped-call]
    properties.creator = "HPN Select"
    properties.title = export.heading.title or None
    return properties


def _finished(packed: bytes, metamodel: Metamodel) -> bytes:
    """The same package in the namespace of a metamodel, and without the time of its making."""
    result = BytesIO()
    with ZipFile(BytesIO(packed)) as source, ZipFile(result, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            entry = ZipInfo(name, FIRST_DATE)
            entry.compress_type = ZIP_DEFLATED
            content = source.read(name)
            if f"/{name}" == DATA_PART:
                content = content.replace(NAMESPACES[WRITTEN], NAMESPACES[metamodel], 1)
            target.writestr(entry, content)
    return result.getvalue()
