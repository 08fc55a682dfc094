"""A random place for an effect, and the motion there that its trial values are chosen from."""

from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator, TimeTarget
from identification.hypothesis import Hypothesis
from identification.noise import Noise
from identification.scene import scenes
from models.effects import Effect, Place
from models.effects.protocol import Scene
from models.rig import Beam, Rig
from testbed.hidden_effects.judge import NEAR
from testbed.hidden_effects.motion import blank_record, channels_of
from testbed.hidden_effects.trials import Trial

ENDS = (0.2, 0.98)
"""Shares of the length between which a position is drawn: nearer to the clamp hardly anything moves."""


WITH_NOISE = 0.01
"""Of each channel in the record by which a scene is made, as a share of its rms: no effect shows in it."""


def draw_place(kind: type[Effect], rig: Rig, rng: np.random.Generator) -> Place:
    """A sleeve, a sensor, a position or nowhere in particular, as the kind may have it.

    Args:
        kind: class of the effect.
        rig: a beam.
        rng: draws the place.
    """
    if not kind.places:
        return Place()
    chosen = str(rng.choice(kind.places))
    if chosen == "sleeve":
        sleeve = rig.sleeves[int(rng.integers(len(rig.sleeves)))]
        return Place(sleeve=sleeve.name, position=sleeve.position)
    if chosen == "sensor":
        return Place(sensor=rig.sensors[int(rng.integers(len(rig.sensors)))].name)
    assert chosen == "position"
    assert isinstance(rig.structure, Beam)
    return Place(position=round(float(rng.uniform(*ENDS)) * rig.structure.length, 3))


def scene_at(place: Place, trial: Trial) -> Scene:
    """The motion at a place in the record of the higher level, as the diagnosis would see it.

    Args:
        place: of an effect.
        trial: the rig as built and the force.
    """
    built, force, rng = trial.built, trial.forces["high"], np.random.default_rng(0)
    channels = channels_of(built, force, trial.fs)
    noise = WITH_NOISE * channels.std(axis=1)
    record = replace(
        blank_record(built, force, trial.fs), responses=channels + noise[:, None] * rng.standard_normal(channels.shape)
    )
    evaluator = Evaluator([TimeTarget.of(record, Noise(noise, 0.0, "as added", "none"))], jobs=1)
    return scenes(evaluator, Hypothesis(built), [place])[place]


def is_apart(here: Place, there: Place, length: float) -> bool:
    """Whether two effects sit far enough from each other to be called two places; without a place they always do.

    Args:
        here: a place.
        there: another.
        length: of the beam, m.
    """
    if here.sensor is not None or there.sensor is not None:
        return here.sensor != there.sensor
    if here.position is None or there.position is None:
        return True
    return abs(here.position - there.position) > 2.0 * NEAR * length
