"""What is odd about a rig file, though it can be read."""

from collections.abc import Iterator
from math import pi

from models.rig import Beam, Rig
from models.structure import Structure
from testbed.records.read import first_natural_freq

SLENDER = (5.0, 1000.0)
"""Length over diameter of a beam that is neither a block nor a wire."""

WIDEST = 0.5
"""Clearance over diameter of a sleeve that still is one."""

MOST_DAMPED = 0.5
"""Share of critical damping that a beam's first mode may have; steel has a thousandth."""

LARGEST_SAG = 0.1
"""Sag under the beam's own weight without sleeves, as a share of its length, up to which it bends by small angles."""


def rig_doubts(rig: Rig) -> Iterator[str]:
    """Numbers of a rig that hint at another unit, a sentence each.

    Args:
        rig: as its file describes it.
    """
    beam = rig.structure
    if not isinstance(beam, Beam):
        return
    slenderness = beam.length / beam.diameter
    if not SLENDER[0] <= slenderness <= SLENDER[1]:
        yield (
            f"a length of {beam.length:g} m with a diameter of {beam.diameter:g} m; beams are {SLENDER[0]:g} to "
            f"{SLENDER[1]:g} times as long as thick; are both in m?"
        )
        return
    bare = Structure.of(beam)
    sag = bare.line_mass * abs(bare.gravity) * bare.length**4 / (8.0 * bare.bending_stiffness)
    freq = first_natural_freq(rig)
    eta1, eta2 = beam.rayleigh_damping
    ratio = 0.5 * (eta1 / (2.0 * pi * freq) + eta2 * 2.0 * pi * freq)
    if sag > LARGEST_SAG * beam.length:
        yield (
            f"the beam would sag by {sag:.3g} m without its sleeves; the models are for small angles; are length, "
            "youngs_modulus (Pa) and density (kg/m^3) in SI units?"
        )
    elif ratio > MOST_DAMPED:
        yield (
            f"rayleigh_damping = [{eta1:g}, {eta2:g}] damps the first mode, {freq:.3g} Hz, by "
            f"{ratio:.0%} of critical; is eta1 the first, in 1/s, and eta2 the second, in s?"
        )
    for sleeve in rig.sleeves:
        if sleeve.clearance > WIDEST * beam.diameter:
            yield (
                f"{sleeve.name}: a clearance of {sleeve.clearance:g} m about a beam {beam.diameter:g} m thick; "
                f"it is rarely more than {WIDEST:g} of that; is it in m?"
            )
