"""What the properties of the submodels mean: names in both languages, units, and ids of our own.

The ids are UUIDs made from names: they claim no number of ECLASS, IEC or the maker that we could not check.
"""

from uuid import NAMESPACE_URL, uuid5

from basyx.aas import model
from basyx.aas.model.concept import ConceptDescription

from hpn.report.language import LANGUAGES, language
from hpn.units import symbol_of
from hpn.wording import N_

IEC61360 = "https://admin-shell.io/DataSpecificationTemplates/DataSpecificationIec61360/3"

CONCEPTS = {
    "size": N_("Size"),
    "ratio": N_("Ratio"),
    "stages": N_("Number of stages"),
    "rated_torque_Nm": N_("Rated torque"),
    "repeated_peak_torque_Nm": N_("Repeated peak torque"),
    "momentary_peak_torque_Nm": N_("Momentary peak torque"),
    "average_input_speed_rpm": N_("Average input speed"),
    "maximum_input_speed_rpm": N_("Maximum input speed"),
    "ambient_temperature_minimum_degC": N_("Lowest ambient temperature"),
    "ambient_temperature_maximum_degC": N_("Highest ambient temperature"),
    "weight_kg": N_("Weight"),
    "backlash_arcmin": N_("Backlash"),
    "transmission_accuracy_arcmin": N_("Transmission accuracy"),
    "torsional_stiffness_Nm_per_rad": N_("Torsional stiffness"),
    "length_min_mm": N_("Shortest length"),
    "length_max_mm": N_("Longest length"),
    "dynamic_radial_load_N": N_("Largest radial load"),
    "dynamic_axial_load_N": N_("Largest axial load"),
    "average_torque_Nm": N_("Average torque"),
    "maximum_torque_Nm": N_("Largest torque"),
    "average_output_speed_rpm": N_("Average output speed"),
    "maximum_output_speed_rpm": N_("Largest output speed"),
    "life_L10_h": N_("Gear life"),
    "momentary_peak_count": N_("Allowed emergency stops"),
    "bearing_life_L50_h": N_("Bearing life L50"),
    "bearing_life_L10_h": N_("Bearing life L10"),
    "motor_peak_torque_Nm": N_("Peak motor torque needed"),
    "motor_rated_torque_Nm": N_("RMS motor torque needed"),
    "demand": N_("Value"),
    "limit": N_("Limit"),
    "utilisation": N_("Utilisation"),
    "status": N_("Verdict"),
}
"""Properties by name, with the name for people."""


def urn(*parts: str) -> str:
    """An id that is the same for the same parts."""
    return uuid5(NAMESPACE_URL, "/".join(("hpn-select", *parts))).urn


def reference(value: str) -> model.ExternalReference:
    """Reference to a meaning outside of this package, or to one of its concept descriptions."""
    return model.ExternalReference((model.Key(model.KeyTypes.GLOBAL_REFERENCE, value),))


def concept_id(name: str) -> str:
    """Id of a concept; `CONCEPTS` has its name."""
    return urn("concept", name)


def texts(english: str) -> dict[str, str]:
    """A text in every language."""
    return {code: language(code).filled(english) for code in LANGUAGES}


def concept(name: str) -> ConceptDescription:
    """Description of a concept by IEC 61360."""
    unit = symbol_of(name)
    content = model.DataSpecificationIEC61360(
        preferred_name=model.PreferredNameTypeIEC61360(texts(CONCEPTS[name])),
        definition=model.DefinitionTypeIEC61360(texts(CONCEPTS[name])),
        unit=unit or None,
        data_type=model.DataTypeIEC61360.REAL_MEASURE if unit else None,
    )
    return ConceptDescription(
        concept_id(name),
        id_short=name,
        embedded_data_specifications=[model.EmbeddedDataSpecification(reference(IEC61360), content)],
    )
