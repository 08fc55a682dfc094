"""What two simulators are compared by, on one rig: frequencies, rest, FRFs, motion with impacts, impulses, energy."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import fft

from identification.metrics import frac
from models.arrays import ComplexArray, FloatArray
from models.excitations import random_phase_multisine
from models.plant import Plant, build_plant
from models.rig import Beam, Rig
from models.simulators.protocol import Motion, Resolution, Simulator, Trial

FS = 2048.0
BAND = (3.0, 250.0)
"""Hz, of the excitation and of what is compared."""

LEVEL = 30.0
"""N rms, at which the beam strikes both sleeves."""

FRF_SECONDS, FRF_SHIFT = 8.0, 0.5
"""Length of the linear test, s, and how far from the imaginary axis the FRF is read, 1/s: what has not died out at the
end is weighed down by exp(-FRF_SHIFT t), in input and output alike."""

SEED = 7
"""Of the excitation's phases, unless another is asked for."""

FAR_AWAY = 0.5
"""Clearance, m, at which no sleeve is touched."""

REAL = {"modal": Resolution(24, 16), "mujoco": Resolution(None, 24), "exudyn": Resolution(20, 32)}
"""Finer than by default: the models are compared, not their steps."""


@dataclass(frozen=True)
class Measure:
    """One comparison.

    Attributes:
        rig: which rig, in words.
        quantity: what was compared.
        simulator: with the modal model.
        value: the difference, in ``unit``.
        bound: largest difference allowed; for FRAC the least value.
        unit: of both.
    """

    rig: str
    quantity: str
    simulator: str
    value: float
    bound: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether the bound is kept."""
        return self.value >= self.bound if self.quantity.startswith("FRAC") else self.value <= self.bound


@dataclass(frozen=True)
class Bounds:
    """What is allowed between the modal model and one simulator."""

    freq: float
    rest: float
    frac: float
    peak: float
    motion: float
    impulse: float
    energy: float


BOUNDS = {
    "exudyn": Bounds(freq=0.02, rest=0.01, frac=0.9998, peak=0.05, motion=2.0, impulse=0.5, energy=0.02),
    "mujoco": Bounds(freq=0.1, rest=0.02, frac=0.9996, peak=0.05, motion=3.0, impulse=1.0, energy=0.05),
}
"""In percent, peaks in dB."""


def variant(rig: Rig, clearance: float | None) -> Rig:
    """The rig with another clearance in all sleeves, m, and otherwise as its file says; None leaves it."""
    if clearance is None:
        return rig
    return rig.model_copy(update={"sleeves": tuple(s.model_copy(update={"clearance": clearance}) for s in rig.sleeves)})


def multisine(level: float, seconds: float = 1.0, seed: int = SEED) -> FloatArray:
    """(N,) the excitation of all tests, N."""
    n = round(seconds * FS)
    return random_phase_multisine(np.random.default_rng(seed), FS, n, 1, *BAND, level)


def shaken(simulator: Simulator, plant: Plant, force: FloatArray) -> Motion:
    """The rig under an excitation, (N,) N."""
    return simulator.run(plant, Trial(FS, force), REAL[simulator.name])


def freq_differences(rig: Rig, name: str, modal: Simulator, other: Simulator) -> Iterator[Measure]:
    """Of f1 to f4, free and at rest on the sleeves."""
    bound = BOUNDS[other.name].freq
    plants = {"free": build_plant(rig.model_copy(update={"sleeves": ()})), "on its sleeves": build_plant(rig)}
    for words, plant in plants.items():
        ours, theirs = (each.natural_freqs(plant, 4, Resolution(REAL[each.name].n_parts)) for each in (modal, other))
        difference = 100.0 * float(np.abs(theirs / ours - 1.0).max())
        yield Measure(name, f"f1 to f4 {words}", other.name, difference, bound, "%")


def rest_differences(rig: Rig, name: str, modal: Simulator, other: Simulator) -> Iterator[Measure]:
    """Of the sag without sleeves, of the forces at rest, and of a contact's force over its depth from its stiffness.

    The forces are compared as shares of what all sleeves carry: one that hardly touches carries the difference of two
    large deflections, and a share of that says nothing.
    """
    bound = BOUNDS[other.name].rest
    still = Trial(FS, np.zeros(16))
    sag = [
        simulator.run(build_plant(variant(rig, FAR_AWAY)), still, REAL[simulator.name]).places[:, 0]
        for simulator in (modal, other)
    ]
    yield Measure(name, "static sag", other.name, 100.0 * float(np.abs(sag[1] / sag[0] - 1.0).max()), bound, "%")
    plant = build_plant(rig)
    ours, found = (each.run(plant, still, REAL[each.name]) for each in (modal, other))
    closed = [i for i, gap in enumerate(found.gaps[:, 0]) if gap < 0.0]
    borne = np.abs(ours.contact_forces[:, 0])
    if closed:
        apart = np.abs(found.contact_forces[:, 0] - ours.contact_forces[:, 0]).max() / borne.sum()
        yield Measure(name, "forces at rest", other.name, 100.0 * float(apart), bound, "%")
    for i in closed:
        stiffness = abs(found.contact_forces[i, 0] / found.gaps[i, 0])
        wanted = plant.contacts[i].law.elastic(-float(found.gaps[i, 0])) / -float(found.gaps[i, 0])
        difference = 100.0 * abs(float(stiffness / wanted) - 1.0)
        yield Measure(name, f"contact stiffness of {plant.contacts[i].sleeve}", other.name, difference, bound, "%")


def frf_of(simulator: Simulator, plant: Plant, seed: int) -> tuple[FloatArray, ComplexArray]:
    """(lines,) Hz and (n_sensors, lines) FRFs, read ``FRF_SHIFT`` beside the imaginary axis, where nothing leaks."""
    n, burst = round(FRF_SECONDS * FS), round(FS)
    force = np.zeros(n)
    force[:burst] = multisine(1.0, seed=seed) * np.sin(np.pi * np.arange(burst) / burst) ** 2
    motion = simulator.run(plant, Trial(FS, force), REAL[simulator.name])
    weight = np.exp(-FRF_SHIFT * np.arange(n) / FS)
    freq = fft.rfftfreq(n, 1.0 / FS)
    lines = (freq >= BAND[0]) & (freq <= BAND[1])
    ratio: ComplexArray = np.asarray(fft.rfft(motion.channels * weight, axis=1) / fft.rfft(force * weight), complex)
    return freq[lines], ratio[:, lines]


def frf_differences(rig: Rig, name: str, modal: Simulator, other: Simulator, seed: int) -> Iterator[Measure]:
    """Of linear FRFs, the sleeves without clearance and so closed for good."""
    plant, bounds = build_plant(variant(rig, 0.0)), BOUNDS[other.name]
    (_, ours), (_, theirs) = frf_of(modal, plant, seed), frf_of(other, plant, seed)
    worst = float(frac(theirs, ours).min())
    yield Measure(name, "FRAC of linear FRFs, worst point", other.name, worst, bounds.frac, "")
    size = np.abs(ours).max(axis=0)
    peaks = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] > size[2:])) + 1
    high = peaks[size[peaks] > PEAK_SHARE * size.max()]
    near = [slice(max(0, k - 8), k + 9) for k in high]
    level = [abs(20.0 * np.log10(np.abs(theirs[:, s]).max() / np.abs(ours[:, s]).max())) for s in near]
    yield Measure(name, "peaks of linear FRFs", other.name, float(max(level, default=0.0)), bounds.peak, "dB")


PEAK_SHARE = 0.01
"""Of the highest peak, above which a peak is compared."""


def low_passed(channels: FloatArray) -> FloatArray:
    """(n, N) what is below 250 Hz, sharply."""
    spectrum = fft.rfft(channels, axis=1)
    spectrum[:, fft.rfftfreq(channels.shape[1], 1.0 / FS) > BAND[1]] = 0.0
    return np.asarray(fft.irfft(spectrum, channels.shape[1], axis=1))


def motion_difference(one: Motion, other: Motion, seconds: float) -> float:
    """NRMSE of the channels below 250 Hz over the predictable time, in percent."""
    n = round(seconds * FS)
    ours, theirs = low_passed(one.channels)[:, :n], low_passed(other.channels)[:, :n]
    return 100.0 * float(np.sqrt(np.mean((theirs - ours) ** 2) / np.mean(ours**2)))


def impulses(motion: Motion, sleeve: int) -> tuple[FloatArray, FloatArray]:
    """Middle, s, and impulse, N s, of each time a sleeve was closed and open again."""
    closed = np.concatenate([[False], motion.gaps[sleeve] < 0.0, [False]]).astype(int)
    starts, ends = np.flatnonzero(np.diff(closed) == 1), np.flatnonzero(np.diff(closed) == -1)
    sums = np.concatenate([[0.0], np.cumsum(np.abs(motion.contact_forces[sleeve]))]) / motion.fs
    return np.asarray(0.5 * (starts + ends) / motion.fs, np.float64), np.asarray(sums[ends] - sums[starts])


def impulse_difference(one: Motion, other: Motion, seconds: float) -> float:
    """Of the impulses of impacts that both saw, the squares weighed by size, in percent; 0 where none was."""
    wrong, whole = 0.0, 0.0
    for sleeve in range(len(one.gaps)):
        time, ours = impulses(one, sleeve)
        when, theirs = impulses(other, sleeve)
        for t, impulse in zip(time, ours, strict=True):
            if t < seconds and len(when):
                nearest = int(np.argmin(np.abs(when - t)))
                if abs(when[nearest] - t) < SAME_IMPACT:
                    wrong, whole = wrong + (theirs[nearest] - impulse) ** 2, whole + impulse**2
    return 100.0 * float(np.sqrt(wrong / whole)) if whole else 0.0


SAME_IMPACT = 1e-3
"""s between the middles of what counts as one impact."""


def predictable(modal: Simulator, plant: Plant, force: FloatArray) -> float:
    """Seconds until a disturbance of 1e-9 of the force, (N,) N, has grown to where half a percent would be lost."""
    one, other = (modal.run(plant, Trial(FS, f), REAL["modal"]).channels for f in (force, force * (1.0 + 1e-9)))
    apart = np.abs(other - one).max(axis=0) / (1e-9 * np.abs(one).max())
    beyond = np.flatnonzero(np.maximum.accumulate(apart) > MOST_GROWTH)
    return float(beyond[0] / FS) if len(beyond) else len(force) / FS


MOST_GROWTH = 1e3
"""Growth of a disturbance up to which models that differ by a few parts in a hundred thousand are held together."""


def is_beam(rig: Rig) -> bool:
    """Whether there is anything to cross-check."""
    return isinstance(rig.structure, Beam)
