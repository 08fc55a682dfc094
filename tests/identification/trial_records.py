"""Rigs and records whose truth is known, for the tests of the identification."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from identification.evaluate import Evaluator, TimeTarget
from identification.fit import Fit, fit
from identification.heard_before import unjudged_of
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.noise import Noise
from identification.prepare import Horizon, cut_to
from identification.session import Session
from models.effects import EFFECTS
from models.excitations import logarithmic_sweep, random_phase_multisine
from models.plant import build_plant
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.rig_file import read_rig
from models.simulate import Settings
from models.simulators import simulator
from models.simulators.protocol import Hold, Resolution, Trial

REFERENCE = read_rig(Path(__file__).parents[1] / "data" / "reference_rig.toml")
FS = 2048.0
NOISE = 0.005
"""Of each channel, as a share of its rms."""


def oscillator(quantity="acceleration", *, freq=60.0, damping_ratio=0.03, **tolerances):
    """A mass of 2 kg on a spring, driven by a force."""
    mass, omega = 2.0, 2.0 * np.pi * freq
    return Rig(
        structure=Oscillator(
            kind="oscillator", mass=mass, stiffness=mass * omega**2, damping=2.0 * damping_ratio * omega * mass
        ),
        tolerances=tolerances or {"mass": 0.01, "stiffness": 0.03, "damping": 0.1},
        excitation=Excitation(quantity="force"),
        sensors=(Sensor(name="top", quantity=quantity),),
    )


def multisine(n=2048, periods=1, rms=20.0, low=5.0, high=250.0, seed=1):
    return random_phase_multisine(np.random.default_rng(seed), FS, n, periods, low, high, rms)


def sweep(n=2048, amplitude=20.0, low=10.0, high=250.0):
    return logarithmic_sweep(FS, n, low, high, amplitude)


def measured(truth, force, *, noise=NOISE, force_noise=0.0, seed=3, name="test", settings=Settings(), **changes):  # noqa: B008
    """What a test of the true hypothesis records under this force: white noise on every channel; and the noise."""
    rng = np.random.default_rng(seed)
    names = tuple(sensor.name for sensor in truth.rig.sensors)
    silent = Record(name, FS, force.copy(), names, np.zeros((len(names), len(force))), **changes)
    clean = truth.simulated(silent, settings).channels
    sensors = noise * clean.std(axis=1)
    heard = clean + sensors[:, None] * rng.standard_normal(clean.shape)
    felt = force + force_noise * force.std() * rng.standard_normal(len(force))
    return replace(silent, excitation=felt, responses=heard), Noise(sensors, force_noise * float(force.std()), "", "")


def let_go(rig, force, *effects, n=4096, before=60, noise=1e-3, seed=4, name="decay"):
    """A free decay whose recorder was started a little after the beam's end had been let go; and the noise."""
    hold = Hold(rig.structure.length, force)
    trial = Trial(FS, np.zeros(n + before), hold=hold)
    clean = (
        simulator("modal").run(build_plant(rig, effects), trial, Resolution(steps_per_sample=4)).channels[:, before:]
    )
    sensors = noise * clean.std(axis=1)
    heard = clean + sensors[:, None] * np.random.default_rng(seed).standard_normal(clean.shape)
    names = tuple(sensor.name for sensor in rig.sensors)
    return Record(name, FS, None, names, heard, moving_start=True), Noise(sensors, 0.0, "", "")


def evaluator_of(*pairs, rig=REFERENCE, jobs=1, settings=Settings()):  # noqa: B008
    """An evaluator that knows the noise of its (record, noise) pairs."""
    plant = Hypothesis(rig).plant()
    targets = [TimeTarget.of(record, noise, unjudged_of(record, noise, plant)) for record, noise in pairs]
    return Evaluator(targets, jobs, settings)


def moved(rig, *sigmas):
    """The rig's toleranced numbers, moved by so many of their standard deviations."""
    parameters = rig.parameters()
    return Hypothesis(
        rig, values={p.path: p.value * np.exp(s * p.tolerance) for p, s in zip(parameters, sigmas, strict=True)}
    )


OSCILLATOR = oscillator()


def rising_session(truth, seconds, **noise):
    """A session that fits so many seconds of 4 s in which the force grows, and the oscillator's fit on them.

    What is nonlinear shows in the later part only.
    """
    force = np.linspace(0.05, 1.0, 8192) ** 3 * multisine(8192, rms=200.0)
    everything = evaluator_of(measured(truth, force, name="rising", **noise))
    limits = [Horizon("rising", 1.0, 4.0)]
    session = Session(everything, cut_to(everything, seconds, limits), limits, EFFECTS, lambda _: None, 0)
    return session, fit(session.fitting, Hypothesis(OSCILLATOR), rig_unknowns(OSCILLATOR), precise=True)


def beam_session(*effects, n=2048, rms=2.0):
    """A session on one short record of the reference rig with these effects."""
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=effects), multisine(n, rms=rms)))
    return Session(evaluator, evaluator, [Horizon("test", 1.0, n / FS)], EFFECTS, lambda _: None, 0)


def found_with(session, *effects, iterations=12):
    """The fit of the reference rig with these effects."""
    hypothesis = Hypothesis(REFERENCE, effects=effects)
    unknowns = (*rig_unknowns(REFERENCE), *effect_unknowns(hypothesis))
    return fit(session.fitting, hypothesis, unknowns, max_iterations=iterations, precise=True)


def fit_of(effect, chi2, *, std=0.01, n_data=1000, places=False):
    """A finished fit of an effect on the reference rig, with this chi-square and standard deviation of its numbers."""
    hypothesis = Hypothesis(REFERENCE, effects=(effect,))
    unknowns = effect_unknowns(hypothesis, places=places)
    n = len(unknowns)
    return Fit(hypothesis, unknowns, chi2, 0.0, n_data, np.zeros(n_data), np.zeros((n, n_data)), std**2 * np.eye(n))
