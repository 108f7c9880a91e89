"""Units of the columns: what is mistaken for them, and by which values one sees it."""

import math

DEGREE = math.pi / 180.0
UNITS = {
    "deg": {"deg": 1.0, "rad": 1.0 / DEGREE},
    "deg/s": {"deg/s": 1.0, "rad/s": 1.0 / DEGREE},
    "kN/m3": {"kN/m3": 1.0, "N/m3": 1e-3},
    "kg/m3": {"kg/m3": 1.0, "g/cm3": 1e3, "g/m3": 1e-3},
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6, "mm/s": 1e-3},
    "kg": {"kg": 1.0, "g": 1e-3},
    "-": {"-": 1.0, "%": 1e-2},
}
"""Unit of a column -> units that are mistaken for it, with their sizes in it."""
USUAL = {
    "mass_kg": (1e-6, 1e8),
    "density_kgm3": (100.0, 2e4),
    "aspect_ratio": (0.02, 50.0),
    "out_of_plane_ratio": (0.02, 50.0),
    "speed_mps": (0.0, 300.0),
    "orientation_deg": (-360.0, 360.0),
    "angular_velocity_degps": (-3e4, 3e4),
    "unit_weight_kNm3": (1.0, 100.0),
    "friction_angle_deg": (2.0, 60.0),
    "k_E": (1.0, 1e6),
    "S_ef": (1e-3, 1e3),
    "eta_N": (0.0, 10.0),
    "eta_T": (0.0, 10.0),
    "eta_R": (0.0, 10.0),
    "c_v": (0.0, 1e3),
    "gamma_v": (0.0, 1e4),
    "alpha_vT": (0.0, 1e3),
    "alpha_vR": (0.0, 1e3),
    "psi": (1e-2, 1e2),
    "alpha_s": (0.0, 10.0),
}
"""Wide: from glass beads to blocks of a landslide, and a decade beyond any ground."""
