"""The figures of the handbook "Engineering Data Harmonic Planetary Gears HPN", typed by hand as a test reference.

Typed from the text of the handbook alone, without a look at the product's own catalogue, so that a slip in one of the
two transcriptions shows up as a difference. Each block names the printed table it is to be held beside. Sizes leave out
the series ("11A" is HPN-11A). HPN-40A appears only where the handbook's text has a figure for it; its rating table and
its lengths are not in that text.
"""

from __future__ import annotations

from typing import TypedDict

# fmt: off

# Table 9.1 (the ratio cells of HPN-11A are blank there: taken from table 10.1)
RATIOS: dict[str, tuple[int, ...]] = {
    "11A": (   4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50),
    "14A": (3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50),
    "20A": (3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50),
    "32A": (3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50),
    "40A": (3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50),
}

# Tables 10.1, 12.1, 12.2, "Number of stages" (table 10.2 spans only four single-stage columns: 10 is single stage too)
STAGES: dict[int, int] = {
    3: 1, 4: 1, 5: 1, 7: 1, 10: 1,
    15: 2, 20: 2, 25: 2, 30: 2, 35: 2, 40: 2, 45: 2, 50: 2,
}

# Table 9.2
OUTPUT_VERSIONS: dict[str, str] = {
    "J6": "shaft output, keyed",
    "J8": "shaft output, plain (no key)",
}

# Chapter 3.1 (product description: "from 9 to 752 Nm")
LARGEST_REPEATED_PEAK_TORQUE_OF_SERIES_NM: float = 752

# Tables 10.1, 10.2, 12.1, 12.2, row T_R
REPEATED_PEAK_TORQUE_NM: dict[str, tuple[float, ...]] = {
    #        3    4    5    7   10   15   20   25   30   35   40   45   50
    "11A": (      14,  16,  11,   9,  24,  24,  24,  26,  26,  26,  26,  26),  # Table 10.1
    "14A": ( 25,  50,  50,  37,  18,  43,  49,  38,  48,  49,  38,  38,  26),  # Table 10.2
    "20A": ( 74, 130, 149, 113,  54, 129, 147, 114, 139, 112, 112, 112,  75),  # Table 12.1
    "32A": (254, 376, 376, 376, 185, 376, 376, 376, 376, 376, 376, 376, 251),  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row T_N
RATED_TORQUE_NM: dict[str, tuple[float, ...]] = {
    #        3    4    5    7   10   15   20   25   30   35   40   45   50
    "11A": (      14,  14,  11,   9,  18,  22,  20,  25,  26,  26,  26,  26),  # Table 10.1
    "14A": ( 22,  28,  29,  30,  18,  30,  30,  30,  40,  40,  30,  30,  26),  # Table 10.2
    "20A": ( 51,  80,  80,  80,  54,  80,  80,  80,  80,  80,  80,  80,  75),  # Table 12.1
    "32A": (153, 198, 200, 200, 185, 200, 200, 200, 250, 250, 300, 300, 251),  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row T_M
MOMENTARY_PEAK_TORQUE_NM: dict[str, tuple[float, ...]] = {
    #        3    4    5    7   10   15   20   25   30   35   40   45   50
    "11A": (      40,  40,  40,  40,  40,  40,  40,  40,  40,  40,  40,  40),  # Table 10.1
    "14A": ( 89, 110, 107, 100,  79,  97, 100, 102,  98,  99, 100, 100,  94),  # Table 10.2
    "20A": (226, 256, 256, 256, 216, 256, 256, 256, 250, 256, 256, 256, 216),  # Table 12.1
    "32A": (625, 625, 625, 625, 625, 625, 625, 625, 625, 625, 625, 625, 625),  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row n_in(max), grease lubrication
MAXIMUM_INPUT_SPEED_RPM: dict[str, float] = {
    "11A": 10000,  # Table 10.1
    "14A":  6000,  # Table 10.2
    "20A":  6000,  # Table 12.1
    "32A":  6000,  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row n_av(max), grease lubrication
AVERAGE_INPUT_SPEED_RPM: dict[str, float] = {
    "11A": 3000,  # Table 10.1
    "14A": 3000,  # Table 10.2
    "20A": 3000,  # Table 12.1
    "32A": 3000,  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row "Weight": (size, stages)
WEIGHT_KG: dict[tuple[str, int], float] = {
    ("11A", 1): 0.44, ("11A", 2): 0.57,  # Table 10.1
    ("14A", 1): 0.95, ("14A", 2): 1.3,   # Table 10.2
    ("20A", 1): 2.6,  ("20A", 2): 3.2,   # Table 12.1
    ("32A", 1): 6.5,  ("32A", 2): 7.2,   # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, row "Ambient operating temperature": (from, to)
AMBIENT_TEMPERATURE_DEGC: dict[str, tuple[float, float]] = {
    "11A": (0, 40),  # Table 10.1
    "14A": (0, 40),  # Table 10.2
    "20A": (0, 40),  # Table 12.1
    "32A": (0, 40),  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, output bearing, row F_R dyn(max)
DYNAMIC_RADIAL_LOAD_N: dict[str, float] = {
    "11A":  480,  # Table 10.1
    "14A":  840,  # Table 10.2
    "20A": 1800,  # Table 12.1
    "32A": 3900,  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, output bearing, row F_A dyn(max)
DYNAMIC_AXIAL_LOAD_N: dict[str, float] = {
    "11A":  640,  # Table 10.1
    "14A":  900,  # Table 10.2
    "20A": 2200,  # Table 12.1
    "32A": 3800,  # Table 12.2
}

# Tables 10.1, 10.2, 12.1, 12.2, footnote 1 (an L50 life, at that output speed); the same two under graphs 16.1 to 16.5
BEARING_REFERENCE_LIFE_H: float = 20000
BEARING_REFERENCE_SPEED_RPM: float = 100

# Tables 11.2, 11.4, 13.2, 13.4: (size, stages) -> (min, max); table 11.2 prints one length, no range
LENGTH_MM: dict[tuple[str, int], tuple[float, float]] = {
    ("11A", 1): ( 60,  60), ("11A", 2): ( 80,  80),  # Table 11.2
    ("14A", 1): ( 70,  75), ("14A", 2): ( 95, 100),  # Table 11.4
    ("20A", 1): (104, 122), ("20A", 2): (126, 144),  # Table 13.2
    ("32A", 1): (130, 169), ("32A", 2): (167, 190),  # Table 13.4
}

# Table 15.1, "Backlash" (upper limits, one cell for all sizes); the rating tables print the same limits per size
BACKLASH_ARCMIN: dict[tuple[str, int], float] = {
    ("11A", 1): 5, ("14A", 1): 5, ("20A", 1): 5, ("32A", 1): 5, ("40A", 1): 5,
    ("11A", 2): 7, ("14A", 2): 7, ("20A", 2): 7, ("32A", 2): 7, ("40A", 2): 7,
}

# Table 15.1, "Transmission accuracy" (upper limits, one cell for all sizes)
TRANSMISSION_ACCURACY_ARCMIN: dict[tuple[str, int], float] = {
    ("11A", 1):  8, ("14A", 1):  8, ("20A", 1):  8, ("32A", 1):  8, ("40A", 1):  8,
    ("11A", 2): 10, ("14A", 2): 10, ("20A", 2): 10, ("32A", 2): 10, ("40A", 2): 10,
}

# Table 15.2, K_3 (printed in 10^3 Nm/rad: 2; 9,3; 26; 94; 143)
TORSIONAL_STIFFNESS_NM_PER_RAD: dict[tuple[str, int], float] = {
    ("11A", 1): 2000, ("14A", 1): 9300, ("20A", 1): 26000, ("32A", 1): 94000, ("40A", 1): 143000,
    ("11A", 2): 2000, ("14A", 2): 9300, ("20A", 2): 26000, ("32A", 2): 94000, ("40A", 2): 143000,
}

# Equation 17.10, the first factor
LIFE_BASIS_H: float = 20000

# Chapter 7.1, "Rated speed n_N, Mechanical", row HPG, HPGP, HPN
RATED_INPUT_SPEED_RPM: float = 3000

# Chapter 4.3
LUBRICANT: str = "PYRONOC UNIVERSAL 00"
LUBRICANT_AMBIENT_DEGC: tuple[float, float] = (-10, 40)
LUBRICANT_MAXIMUM_OPERATING_TEMPERATURE_DEGC: float = 80

# Chapter 5.1
STORAGE_TEMPERATURE_DEGC: tuple[float, float] = (-20, 60)

# Table 26.1 (M6 is printed "M6h")
MOTOR_FLANGE_BOLT_TORQUE_NM: dict[str, float] = {
    "M3":   1.28,
    "M4":   3.0,
    "M5":   5.9,
    "M6":  10.1,
    "M8":  24.6,
    "M10": 48.0,
    "M12": 84.0,
}

# Table 26.2, in the order of its columns: (size, bolt size, tightening torque in Nm)
CLAMP_BOLTS: tuple[tuple[str, str, float], ...] = (
    ("11A", "M3",  1.8),
    ("14A", "M3",  1.8),
    ("14A", "M4",  4.6),
    ("20A", "M4",  4.6),
    ("32A", "M4",  4.6),
    ("32A", "M6", 14.9),
    ("40A", "M6", 14.9),
)

# Table 27.1 (printed "271"): (number of bolts, bolt size, pitch diameter in mm, tightening torque in Nm)
HOUSING_BOLTS: dict[str, tuple[int, str, float, float]] = {
    "11A": (4, "M3",   50,  1.4),
    "14A": (4, "M5",   70,  6.3),
    "20A": (4, "M6",  100, 10.1),
    "32A": (4, "M8",  130, 26.1),
    "40A": (4, "M10", 165, 51.5),
}


class WorkedExample(TypedDict):
    """The example of chapter 4.1: what is given, and what equations 18.1 to 18.9 print."""

    phases: tuple[tuple[float, float, float], ...]  # (T in Nm, n in rpm at the output, t in s)
    pause_s: float
    momentary_peak_torque_nm: float
    ratio: int
    printed_average_output_torque_nm: float
    printed_average_torque_limit_nm: float
    printed_selected_size: str
    printed_average_output_speed_rpm: float
    printed_average_input_speed_rpm: float
    printed_maximum_input_speed_rpm: float
    printed_maximum_input_speed_limit_rpm: float
    printed_maximum_torque_nm: float
    printed_repeated_peak_torque_nm: float
    printed_momentary_peak_torque_limit_nm: float
    printed_exponent: float
    printed_momentary_peak_count: int
    printed_rated_input_speed_rpm: float
    printed_rated_torque_nm: float
    printed_life_h: float


# Chapter 4.1, "Output data" and equations 18.1 to 18.9, as printed (that is: each result rounded before it is used)
WORKED_EXAMPLE: WorkedExample = {
    "phases": (
        (40, 250, 0.3),  # T_1, n_1, t_1
        (32, 500, 3.0),  # T_2, n_2, t_2
        (20, 250, 0.4),  # T_3, n_3, t_3
    ),
    "pause_s": 4.0,                                 # t_p
    "momentary_peak_torque_nm": 200,                # T_k
    "ratio": 5,                                     # i
    "printed_average_output_torque_nm": 32,         # Equation 18.2, T_av
    "printed_average_torque_limit_nm": 80,          # Equation 18.2, T_A
    "printed_selected_size": "HPN-20-5",            # Equation 18.2
    "printed_average_output_speed_rpm": 218,        # Equation 18.3, n_out av
    "printed_average_input_speed_rpm": 1090,        # Equation 18.4, n_in av
    "printed_maximum_input_speed_rpm": 2500,        # Equation 18.5, n_in max
    "printed_maximum_input_speed_limit_rpm": 6000,  # Equation 18.5
    "printed_maximum_torque_nm": 40,                # Equation 18.6, T_max
    "printed_repeated_peak_torque_nm": 149,         # Equation 18.6, T_R
    "printed_momentary_peak_torque_limit_nm": 256,  # Equation 18.7, T_M
    "printed_exponent": 6.49,                       # Equation 18.8, x
    "printed_momentary_peak_count": 3090295,        # Equation 18.8, N_k max
    "printed_rated_input_speed_rpm": 3000,          # Equation 18.9
    "printed_rated_torque_nm": 80,                  # Equation 18.9, T_N
    "printed_life_h": 1167324,                      # Equation 18.9, L_10
}

# fmt: on
