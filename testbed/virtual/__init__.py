"""Virtual tests: excitations, rigs that are a little off their drawings, and records of what a fine model did."""

from models.excitations import half_sine_hammer, logarithmic_sweep, random_phase_multisine
from testbed.virtual.as_built import perturbed
from testbed.virtual.noise import Noise
from testbed.virtual.virtual_record import virtual_record

__all__ = [
    "Noise",
    "half_sine_hammer",
    "logarithmic_sweep",
    "perturbed",
    "random_phase_multisine",
    "virtual_record",
]
