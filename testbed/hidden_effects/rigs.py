"""Random rigs: all numbers differ, yet a laboratory could build each."""

from math import pi, sqrt

import numpy as np

from models.contact.hertz import Hertz
from models.contact.hunt_crossley import HuntCrossley
from models.rig import Beam, Excitation, Rig, Sensor, Sleeve
from testbed.hidden_effects.sets import DAMPED_TO, DISSIPATION, MATERIALS, PRESSED, TOLERANCES, CaseSet, Span, one_of

FIRST_ROOT = 1.8751
"""k L of a cantilever's first mode."""


def draw_rig(case_set: CaseSet, rng: np.random.Generator) -> Rig:
    """A cantilever in one or two sleeves with a force and sensors.

    Args:
        case_set: what it may be like.
        rng: draws it.
    """
    beam, shape = draw_beam(case_set, rng), case_set.shape
    alone = rng.random() < case_set.one_sleeve_share
    spans = (case_set.one_place,) if alone else case_set.two_places
    law = one_of(case_set.laws, rng)
    sleeves = [
        draw_sleeve(case_set, f"sleeve {number}", law, span, beam, rng) for number, span in enumerate(spans, start=1)
    ]
    edges = np.linspace(*case_set.sensor_ends, one_of(case_set.n_sensors, rng) + 1)
    places = rng.uniform(edges[:-1] + 0.1 * np.diff(edges), edges[1:] - 0.1 * np.diff(edges)) * beam.length
    force_at = min(case_set.force_place.draw(rng, shape), 1.0) * beam.length
    return Rig(
        structure=beam,
        tolerances=dict(TOLERANCES),
        sleeves=tuple(sleeves),
        excitation=Excitation(name="shaker", node=100, position=round(force_at, 3), quantity="force"),
        sensors=tuple(
            Sensor(name=f"P{i}", node=i, position=round(float(x), 3), quantity=one_of(case_set.quantities, rng))
            for i, x in enumerate(places, start=1)
        ),
    )


def draw_sleeve(case_set: CaseSet, name: str, law: str, span: Span, beam: Beam, rng: np.random.Generator) -> Sleeve:
    """A sleeve with a contact.

    Args:
        case_set: what it may be like.
        name: of it.
        law: of its contact.
        span: of its position, as a share of the length.
        beam: that it holds.
        rng: draws it.
    """
    stiffness = case_set.stiffness.draw(rng, case_set.shape)
    ratio = case_set.contact_damping.draw(rng, case_set.shape)
    mass = beam.density * pi * beam.diameter**2 / 4 * beam.length
    damping = DISSIPATION.draw(rng) if law == HuntCrossley.name else 2.0 * ratio * sqrt(stiffness * mass / 4.0)
    return Sleeve(
        name=name,
        position=round(span.draw(rng, case_set.shape) * beam.length, 3),
        clearance=round(case_set.clearance.draw(rng, case_set.shape), 7),
        law=law,
        stiffness=round(stiffness / sqrt(PRESSED) if law == Hertz.name else stiffness, -2),
        damping=round(damping, 1),
    )


def draw_beam(case_set: CaseSet, rng: np.random.Generator) -> Beam:
    """A rod whose first frequency without sleeves lies in the set's span.

    Args:
        case_set: what it may be like.
        rng: draws it.
    """
    first = 0.0
    while not case_set.first_freq.low <= first / (2.0 * pi) <= case_set.first_freq.high:
        modulus, density = MATERIALS[str(rng.choice(case_set.materials))]
        length, diameter = (span.draw(rng, case_set.shape) for span in (case_set.length, case_set.diameter))
        first = FIRST_ROOT**2 / length**2 * diameter / 4 * sqrt(modulus / density)
    at_first, at_top = (case_set.damping_ratio.draw(rng, case_set.shape) for _ in range(2))
    return Beam(
        kind="beam",
        length=round(length, 3),
        diameter=round(diameter, 4),
        youngs_modulus=modulus,
        density=density,
        rayleigh_damping=(round(2.0 * at_first * first, 3), float(f"{2.0 * at_top / (2.0 * pi * DAMPED_TO):.3g}")),
        gravity=9.81 if rng.random() < case_set.gravity_share else 0.0,
    )
