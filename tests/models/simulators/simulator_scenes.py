"""The reference rig and the tests that all simulators are asked to carry out."""

from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.effects import EFFECTS, build_effect
from models.plant import Plant, build_plant
from models.rig import EffectEntry, Excitation, Rig
from models.rig_file import read_rig
from models.simulators import simulator
from models.simulators.protocol import Motion, Resolution, Trial

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
SHAKEN = REFERENCE.model_copy(update={"excitation": Excitation(quantity="base_acceleration")})
FS = 2048.0
FINE_MODAL = Resolution(30, 16)
"""Within 0.05 % of the converged modal model over a second of impacts."""


def noise(n: int, rms: float, low: float = 3.0, high: float = 250.0, seed: int = 1) -> FloatArray:
    """(n,) random phases between two frequencies, Hz, faded in and out over a tenth."""
    freq = np.fft.rfftfreq(n, 1.0 / FS)
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(freq))
    wave = np.fft.irfft(np.where((freq >= low) & (freq <= high), np.exp(1j * phase), 0.0), n)
    ramp = np.clip(10.0 * np.minimum(np.arange(n), np.arange(n)[::-1]) / n, 0.0, 1.0)
    return wave * (rms / wave.std()) * np.sin(0.5 * np.pi * ramp) ** 2


def with_effects(*entries: dict, rig: Rig = REFERENCE) -> Plant:
    """The rig with effects, each as a table of a rig file."""
    return build_plant(rig, [build_effect(EffectEntry(**entry), rig, EFFECTS) for entry in entries])


def moved(name: str, plant: Plant, trial: Trial, resolution: Resolution | None = None) -> Motion:
    """What a simulator answers; the modal model finely."""
    return simulator(name).run(plant, trial, resolution or (FINE_MODAL if name == "modal" else Resolution()))


def nrmse(found: FloatArray, expected: FloatArray) -> float:
    """rms(found - expected) / rms(expected)."""
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def impulses(motion: Motion) -> FloatArray:
    """(n_contacts,) N s over the whole record."""
    return motion.contact_forces.sum(axis=1) / motion.fs
