"""What is odd about a rig file, though it can be read."""

from collections.abc import Iterator
from itertools import combinations
from math import pi

from models.rig import Beam, Rig
from models.structure import Structure
from testbed.records.read import first_natural_freq

SLENDER = (5.0, 1000.0)
"""Length over diameter of a beam that is neither a block nor a wire."""

LONGEST = 50.0
"""Length, m, that a laboratory holds no beam beyond."""

LEAST_REACH = 0.02
"""Share of the length within which not all sleeves, sensors and the excitation of a rig lie."""

WIDEST = 0.5
"""Clearance over diameter of a sleeve that still is one."""

MOST_DAMPED = 0.5
"""Share of critical damping that a beam's first mode may have; steel has a thousandth."""

LARGEST_SAG = 0.1
"""Sag under the beam's own weight without sleeves, as a share of its length, up to which it bends by small angles."""

SOLID = (1e9, 1e12)
"""Young's moduli, Pa, from plastics to the stiffest fibres."""


UNITS = {"mm": 1e3, "cm": 1e2}
"""Of which so many are a metre; in the order in which they are suspected."""

PRESSURES = {"MPa": 1e6, "GPa": 1e9}
"""Pascals."""


def rig_doubts(rig: Rig) -> Iterator[str]:
    """Numbers of a rig that hint at another unit, a sentence each: what was read, what is usual, how to mend it.

    Args:
        rig: as its file describes it.
    """
    yield from _nothing_measured(rig)
    beam = rig.structure
    if not isinstance(beam, Beam):
        return
    yield from _at_one_place(rig)
    size = _size(rig, beam)
    if size is not None:
        # All else that looks odd may follow from it.
        yield size
        return
    odd = _sag(beam) or _damping(rig, beam)
    if odd is not None:
        yield odd
    for sleeve in rig.sleeves:
        if sleeve.clearance > WIDEST * beam.diameter:
            yield (
                f"{sleeve.name}: a clearance of {sleeve.clearance:g} m about a beam {beam.diameter:g} m thick; "
                f"it is rarely more than {WIDEST:g} of that, and in m; if it is in mm, write clearance = "
                f"{sleeve.clearance / UNITS['mm']:g}"
            )


def _nothing_measured(rig: Rig) -> Iterator[str]:
    if not rig.sensors:
        yield (
            "no sensors; compare, diagnose and simulate need the places and quantities of what is measured; write a "
            "[[sensors]] table for each channel of the records"
        )


def _at_one_place(rig: Rig) -> Iterator[str]:
    """Two sleeves that no measurement can tell apart."""
    for one, other in combinations(rig.sleeves, 2):
        if one.position is not None and one.position == other.position:
            yield (
                f"{one.name} and {other.name} are both at {one.position:g} m; sleeves at one place act as one, whose "
                "numbers hardly a measurement tells apart; write their positions, m from the clamp, or one sleeve alone"
            )


def _size(rig: Rig, beam: Beam) -> str | None:
    """Of length and diameter: by each other, by what a laboratory holds, and by where the rig's parts are."""
    driven = None if rig.excitation is None else rig.excitation.position
    positions = [driven, *(sleeve.position for sleeve in rig.sleeves), *(sensor.position for sensor in rig.sensors)]
    furthest = max((position for position in positions if position is not None), default=None)
    usual = []
    if not _is_slender(beam.length, beam.diameter):
        usual.append(f"a beam is {SLENDER[0]:g} to {SLENDER[1]:g} times as long as thick")
    if beam.length > LONGEST:
        usual.append(f"a beam on a bench is no longer than {LONGEST:g} m")
    if furthest is not None and furthest < LEAST_REACH * beam.length:
        usual.append(
            f"all sleeves, sensors and forces of this one lie within {furthest:g} m from the clamp, "
            f"{furthest / beam.length:.2%} of its length"
        )
    if not usual:
        return None
    read = f"length = {beam.length:g} m and diameter = {beam.diameter:g} m"
    return f"{read}; {', and '.join(usual)}; all lengths are in m: {_in_metres(beam, furthest)}"


def _is_slender(length: float, diameter: float) -> bool:
    return SLENDER[0] <= length / diameter <= SLENDER[1]


def _in_metres(beam: Beam, furthest: float | None) -> str:
    """What to write where the rig makes sense with length, diameter or both taken in another unit."""
    for unit, number in UNITS.items():
        for keys in (("length", "diameter"), ("length",), ("diameter",)):
            scaled = {key: getattr(beam, key) / number for key in keys}
            length, diameter = (scaled.get(key, getattr(beam, key)) for key in ("length", "diameter"))
            beyond = furthest is not None and furthest > length
            reach = length if furthest is None else furthest / (number if beyond else 1.0)
            if _is_slender(length, diameter) and LEAST_REACH * length <= reach <= length <= LONGEST:
                written = " and ".join(f"{key} = {value:g}" for key, value in scaled.items())
                verb = "are" if len(keys) > 1 else "is"
                also = ", and each position in m too" if beyond else ""
                return f"if {' and '.join(keys)} {verb} in {unit}, write {written}{also}"
    return "correct what is in another unit"


def _sag(beam: Beam) -> str | None:
    bare = Structure.of(beam)
    sag = bare.line_mass * abs(bare.gravity) * bare.length**4 / (8.0 * bare.bending_stiffness)
    if sag <= LARGEST_SAG * beam.length:
        return None
    modulus = beam.youngs_modulus
    stiffer = {unit: modulus * pascals for unit, pascals in PRESSURES.items() if modulus < SOLID[0]}
    mends = [f"if youngs_modulus is in {u}, write {m:g}" for u, m in stiffer.items() if SOLID[0] <= m <= SOLID[1]]
    return (
        f"length = {beam.length:g} m, diameter = {beam.diameter:g} m, youngs_modulus = {modulus:g} Pa and density = "
        f"{beam.density:g} kg/m^3 let the beam sag by {sag:.3g} m without sleeves; the models are for small angles, "
        f"up to {LARGEST_SAG:g} of the length; {next(iter(mends), 'correct the one that is not in this unit')}"
    )


def _damping(rig: Rig, beam: Beam) -> str | None:
    freq = first_natural_freq(rig)
    eta1, eta2 = beam.rayleigh_damping
    ratio = 0.5 * (eta1 / (2.0 * pi * freq) + eta2 * 2.0 * pi * freq)
    if ratio <= MOST_DAMPED:
        return None
    return (
        f"rayleigh_damping = [{eta1:g}, {eta2:g}] damps the first mode, {freq:.3g} Hz, by "
        f"{ratio:.0%} of critical; is eta1 the first, in 1/s, and eta2 the second, in s?"
    )
