"""The reference rig and what the tests of the modal model do to it."""

from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.plant import Plant
from models.record import Record
from models.rig import Excitation, Rig, Sensor, Sleeve
from models.rig_file import read_rig
from models.structure import Structure

REFERENCE = read_rig(Path(__file__).parents[1] / "data" / "reference_rig.toml")
STRUCTURE = Structure.of(REFERENCE.structure)
LENGTH = STRUCTURE.length
EI = STRUCTURE.bending_stiffness
MASS = STRUCTURE.line_mass * LENGTH
GRAVITY = STRUCTURE.gravity
RADIUS = float(np.sqrt(EI / (STRUCTURE.line_mass * LENGTH**4)))
"""omega = (beta L)^2 times this."""


def rig_with(*sleeves: Sleeve, **changes) -> Rig:
    """The reference beam with other sleeves, and other numbers of the structure."""
    structure = REFERENCE.structure.model_copy(update=changes)
    return REFERENCE.model_copy(update={"structure": structure, "sleeves": sleeves})


def sleeve(position: float, clearance: float = 1.5e-4, **changes) -> Sleeve:
    about = {"stiffness": 1e5, "damping": 80.0, "law": "kelvin_voigt", **changes}
    return Sleeve(name=f"at {position}", position=position, clearance=clearance, **about)


def sensed(rig: Rig, *sensors: tuple[float | None, str]) -> Rig:
    """The rig with these (position, quantity) for sensors."""
    named = tuple(Sensor(name=f"{q} {x}", position=x, quantity=q) for x, q in sensors)
    return rig.model_copy(update={"sensors": named})


def driven(rig: Rig, quantity: str) -> Rig:
    """The rig with its base driven."""
    return rig.model_copy(update={"excitation": Excitation(quantity=quantity)})


def record_of(plant: Plant, excitation: FloatArray | None, fs: float, n_samples: int = 0, **changes) -> Record:
    """A record to be simulated: all sensors, responses of no account."""
    n = n_samples if excitation is None else len(excitation)
    names = tuple(sensor.name for sensor in plant.sensors)
    return Record("test", fs, excitation, names, np.zeros((len(names), n)), **changes)


def multisine(fs: float, n: int, low: float, high: float, rms: float, *, seed: int = 1) -> FloatArray:
    """Sines of equal amplitude and random phase at every line of the band."""
    freq = np.fft.rfftfreq(n, 1.0 / fs)
    lines = (freq >= low) & (freq <= high)
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, lines.sum())
    spectrum = np.zeros(len(freq), complex)
    spectrum[lines] = np.exp(1j * phase)
    wave = np.fft.irfft(spectrum, n)
    return wave * (rms / np.sqrt(np.mean(wave**2)))


def burst(fs: float, n: int, freq: float, peak: float) -> FloatArray:
    """A sine under a bell, so that nothing touches the record's ends."""
    time = (np.arange(n) - n / 2) / fs
    return peak * np.cos(2.0 * np.pi * freq * time) * np.exp(-((4.5 * 2.0 * time * fs / n) ** 2))


def nrmse(found: FloatArray, expected: FloatArray) -> float:
    """rms(found - expected) / rms(expected)."""
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))
