"""A small rig with two short records, as files, for the tests of the commands."""

from pathlib import Path

import numpy as np

from identification.at_rest import predicted_frfs
from identification.hypothesis import Hypothesis
from models.effects import Place
from models.effects.squeeze_film import SqueezeFilm
from models.plant import build_plant
from models.record import FrfRecord, Record
from models.rig_file import read_rig
from models.simulate import simulate
from testbed.records.write import write_record

RIG_TOML = """# The owner's comment.
[structure]
kind = "beam"
length = 1.2
diameter = 0.02
youngs_modulus = 210e9
density = 7850.0
rayleigh_damping = [4.0, 2e-5]

[tolerances]
youngs_modulus = 0.01

[[sleeves]]
name = "sleeve 1"
position = 0.5
clearance = 3e-4
stiffness = 1e5
damping = 80.0

[[sleeves]]
name = "sleeve 2"
position = 1.0
clearance = 1.5e-4
stiffness = 1e5
damping = 80.0

[excitation]
name = "shaker"
node = 100
position = 0.8

[[sensors]]
name = "P1"
node = 1
position = 0.3

[[sensors]]
name = "P2"
node = 2
position = 0.7

[[sensors]]
name = "P3"
node = 3
position = 1.2
"""
FS, N_SAMPLES = 512.0, 512
FILM = SqueezeFilm(Place(sleeve="sleeve 2", position=1.0), damping=40.0)


def make_files(folder: Path) -> Path:
    """``rig.toml`` without the grease, ``sweep.csv`` and ``burst.csv`` with it, ``decay.csv``, and an experiment."""
    (folder / "rig.toml").write_text(RIG_TOML)
    rig = read_rig(folder / "rig.toml")
    for seed, name in enumerate(("sweep.csv", "burst.csv")):
        write_record(made_record(rig, name, seed), rig, folder / name)
    write_record(made_decay(rig), rig, folder / "decay.csv")
    (folder / "experiment.toml").write_text('fs = 512.0\n[excitation]\nkind = "sweep"\nhigh = 150.0\nduration = 0.5\n')
    return folder


def made_record(rig, name, seed, effects=(FILM,)):
    """One record with the grease in it."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(rng.standard_normal(N_SAMPLES))
    frequency = np.fft.rfftfreq(N_SAMPLES, 1.0 / FS)
    spectrum[(frequency < 5.0) | (frequency > 150.0)] = 0.0
    excitation = 30.0 * np.fft.irfft(spectrum, N_SAMPLES) * np.minimum(1.0, np.arange(N_SAMPLES) / 50.0)
    record = Record(name, FS, excitation, tuple(s.name for s in rig.sensors), np.zeros((len(rig.sensors), N_SAMPLES)))
    channels = simulate(build_plant(rig, effects), record).channels
    noisy = channels + 0.005 * channels.std() * rng.standard_normal(channels.shape)
    return Record(name, FS, excitation, record.sensors, noisy)


def made_decay(rig):
    """A light blow and two seconds of what follows it, the sleeve below staying closed."""
    excitation = np.zeros(2 * N_SAMPLES)
    excitation[20:28] = 2.0 * np.sin(np.pi * (np.arange(8) + 0.5) / 8)
    names = tuple(sensor.name for sensor in rig.sensors)
    still = Record("decay.csv", FS, excitation, names, np.zeros((len(names), len(excitation))))
    channels = simulate(build_plant(rig), still).channels
    noise = 0.002 * channels.std() * np.random.default_rng(5).standard_normal(channels.shape)
    return Record("decay.csv", FS, excitation, names, channels + noise)


def write_frfs(rig, path, effects=(), frequency=None):
    """FRFs of the rig with 1 % of noise, as an analyser writes them."""
    import pyuff

    rng, frequency = np.random.default_rng(4), np.arange(6.0, 100.5, 1.0) if frequency is None else frequency
    names, shape = tuple(sensor.name for sensor in rig.sensors), (len(rig.sensors), len(frequency))
    clean = predicted_frfs(Hypothesis(rig, effects=effects), FrfRecord("", frequency, names, np.zeros(shape, complex)))
    noise = (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)
    sets = [
        {
            "type": 58, "binary": 1, "func_type": 4, "rsp_node": sensor.node, "rsp_dir": 3, "ref_node": 100,
            "ref_dir": 3, "abscissa_spacing": 0, "x": frequency, "data": values, "abscissa_spec_data_type": 18,
            "ordinate_spec_data_type": 12, "ordinate_axis_units_lab": "m/s^2", "orddenom_spec_data_type": 13,
            "orddenom_axis_units_lab": "N",
        }
        for sensor, values in zip(rig.sensors, clean * (1.0 + 0.01 * noise), strict=True)
    ]  # fmt: skip
    path.write_bytes(b"")
    pyuff.UFF(str(path)).write_sets(sets, mode="add", force_double=True)
