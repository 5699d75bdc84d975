"""Inputs of a motion and of a turning body: their names and symbols, by their path in each.

`quantities.py` has them all under one name.
"""

from collections.abc import Mapping

from hpn.words.wording import N_, Named

MOTION: Mapping[str, Named] = {
    "mechanism.type": Named(N_("Mechanism")),
    "mechanism.inertia_kgm2": Named(N_("Moment of inertia"), "J"),
    "mechanism.gravity_mass_kg": Named(N_("Mass off the shaft"), "m"),
    "mechanism.gravity_radius_mm": Named(N_("Its distance from the shaft"), "r"),
    "mechanism.friction_torque_Nm": Named(N_("Friction torque"), "T_f"),
    "mechanism.friction_force_N": Named(N_("Friction force"), "F_f"),
    "mechanism.counterweight_kg": Named(N_("Counterweight"), "m_c"),
    "mechanism.viscous_friction_Nm_per_rpm": Named(N_("Viscous friction"), "b"),
    "mechanism.efficiency": Named(N_("Efficiency of the mechanism"), "η_m"),
    "mechanism.ratio": Named(N_("Ratio of a stage between"), "i_m"),
    "start_deg": Named(N_("Angle at the start"), "θ_0"),
    "mechanism.diameter_mm": Named(N_("Pitch diameter"), "d"),
    "mechanism.lead_mm": Named(N_("Lead"), "h"),
    "mechanism.mass_kg": Named(N_("Moved mass"), "m"),
    "mechanism.incline_deg": Named(N_("Incline"), "β"),
    "mechanism.friction_coefficient": Named(N_("Coefficient of friction"), "μ"),
    "move.profile": Named(N_("Profile")),
    "move.angle_deg": Named(N_("Angle"), "φ"),
    "move.distance_mm": Named(N_("Distance"), "s"),
    "move.time_s": Named(N_("Time"), "t"),
    "move.speed_rpm": Named(N_("Peak speed"), "n"),
    "move.speed_mm_per_s": Named(N_("Largest speed"), "v"),
    "move.acceleration_deg_per_s2": Named(N_("Acceleration"), "α"),
    "move.acceleration_mm_per_s2": Named(N_("Acceleration"), "a"),
    "move.acceleration_time_s": Named(N_("Acceleration time"), "t_1"),
    "move.deceleration_time_s": Named(N_("Deceleration time"), "t_2"),
    "move.deceleration_deg_per_s2": Named(N_("Deceleration"), "α_2"),
    "move.deceleration_mm_per_s2": Named(N_("Deceleration"), "a_2"),
    "move.jerk_share": Named(N_("Jerk share")),
    "move.jerk_deg_per_s3": Named(N_("Jerk"), "j"),
    "move.jerk_mm_per_s3": Named(N_("Jerk"), "j"),
    "move.external_torque_Nm": Named(N_("External torque"), "T_ext"),
    "move.external_force_N": Named(N_("External force"), "F_ext"),
    "move.name": Named(N_("Name")),
}
"""Inputs of a motion: of its mechanism, and of each move."""

BODY: Mapping[str, Named] = {
    "shape": Named(N_("Shape")),
    "count": Named(N_("Number")),
    "mass_kg": Named(N_("Mass")),
    "density_g_per_cm3": Named(N_("or density")),
    "diameter_mm": Named(N_("Diameter")),
    "inner_diameter_mm": Named(N_("Inner diameter")),
    "length_mm": Named(N_("Length")),
    "width_mm": Named(N_("Width")),
    "height_mm": Named(N_("Height")),
    "distance_mm": Named(N_("Off the axis")),
}
"""Inputs of a body for calculating a moment of inertia; they are not part of an application."""
