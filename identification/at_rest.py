"""What a hypothesis says of small motion about rest: FRFs on the measured lines, modes beside the measured ones."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from identification.hypothesis import Hypothesis
from identification.metrics import mac
from models.arrays import ComplexArray, FloatArray
from models.linear import Linearised, frf, linearised, measurement_chain, natural_modes
from models.modal import build_modal
from models.record import FrfRecord, ModeShapeRecord

MODES_BEYOND = 1.5
"""The model's modes are looked for up to this many times the highest measured natural frequency."""


@dataclass(frozen=True, eq=False)
class PairedModes:
    """The model's modes in the order of the measured ones that they are most like; NaN where the model has none left.

    Attributes:
        natural_freqs: (n,) Hz.
        damping_ratios: (n,).
        shapes: (n, n_sensors) as the sensors read them, the largest displacement 1.
        mac: (n,) modal assurance criterion of each pair.
    """

    natural_freqs: FloatArray
    damping_ratios: FloatArray
    shapes: ComplexArray
    mac: FloatArray


def predicted_frfs(hypothesis: Hypothesis, record: FrfRecord) -> ComplexArray:
    """(n_sensors, n) FRFs of the model linearised at rest.

    Args:
        hypothesis: the model.
        record: whose lines, all above 0 Hz, sensors and excitation point are meant.

    Raises:
        InputError: the rig has no excitation.
    """
    linear = linear_model(hypothesis, float(record.frequency.max()), record.excitation_position)
    return frf(linear, record.frequency, record.sensors)


def paired_modes(hypothesis: Hypothesis, record: ModeShapeRecord) -> PairedModes:
    """The modes of the model linearised at rest, paired so that frequencies and shapes agree best.

    Args:
        hypothesis: the model.
        record: the measured modes.
    """
    highest = MODES_BEYOND * float(record.natural_freqs.max())
    linear = linear_model(hypothesis, highest)
    named = {sensor.name: sensor for sensor in linear.model.plant.sensors}
    modes = natural_modes(linear, [named[name] for name in record.sensors], highest)
    read = modes.shapes * measurement_chain(linear.model.plant, record.sensors, modes.natural_freqs).T
    likeness = mac(read, record.shapes)
    apart = np.abs(np.log(modes.natural_freqs[:, None] / record.natural_freqs[None, :]))
    model, measured = linear_sum_assignment(1.0 - likeness + apart)
    freqs, damping, pair_mac = np.full((3, len(record.natural_freqs)), np.nan)
    shapes = np.full(record.shapes.shape, np.nan, complex)
    freqs[measured], damping[measured] = modes.natural_freqs[model], modes.damping_ratios[model]
    shapes[measured], pair_mac[measured] = read[model], likeness[model, measured]
    return PairedModes(freqs, damping, shapes, pair_mac)


def linear_model(hypothesis: Hypothesis, band: float, position: float | None = None) -> Linearised:
    """The model linearised at rest, for frequencies up to a band.

    Args:
        hypothesis: the model.
        band: Hz.
        position: where the force acts, m from the clamp; by default where the rig says.
    """
    return linearised(build_modal(hypothesis.plant().driven_at(position), band))
