"""A rig, records of it, and files that say what a test wants them to say."""

import numpy as np
import pyuff

from models.record import Record
from models.rig import Rig

FS = 2048.0
SENSORS = [("P1", 1, 0.15), ("P2", 2, 0.45), ("P3", 3, 0.83), ("P4", 4, 1.44)]


def a_rig(**changes):
    """The reference beam with four accelerometers; changes replace top-level tables."""
    tables = {
        "structure": {
            "kind": "beam",
            "length": 1.469,
            "diameter": 0.02,
            "youngs_modulus": 210e9,
            "density": 7850.0,
            "rayleigh_damping": [1.2, 6e-6],
        },
        "excitation": {"name": "shaker", "node": 100, "position": 1.3},
        "sensors": [{"name": name, "node": node, "position": position} for name, node, position in SENSORS],
    }
    return Rig.model_validate(tables | changes)


def sensors(**changes):
    """The rig's sensors, each with the same changes."""
    return [{"name": name, "node": node, "position": position} | changes for name, node, position in SENSORS]


def noise(seed=0, n=600, channels=None):
    """Reproducible noise: none of the checks has anything to say about it."""
    return np.random.default_rng(seed).standard_normal(n if channels is None else (channels, n))


def a_record(n=600, fs=FS, **changes):
    """A record of all four sensors and the shaker."""
    fields = {
        "name": "run",
        "fs": fs,
        "excitation": noise(1, n),
        "sensors": tuple(name for name, *_ in SENSORS),
        "responses": noise(2, n, 4),
    }
    return Record(**(fields | changes))


def csv_lines(n=600, fs=FS, units=("N", *["m/s^2"] * 4), names=("shaker", "P1", "P2", "P3", "P4"), seed=3):
    """A good CSV record as a list of lines: the header and n rows."""
    values = noise(seed, n, len(names))
    header = ",".join(["time [s]", *(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True))])
    rows = [",".join(f"{v:.9g}" for v in (i / fs, *values[:, i])) for i in range(n)]
    return [header, *rows]


def set_58(node, data, *, quantity=12, unit="m/s^2", direction=3, fs=FS, **changes):
    """One dataset 58 with a time response, as other programs write it."""
    return {
        "type": 58,
        "binary": 1,
        "func_type": 1,
        "rsp_node": node,
        "rsp_dir": direction,
        "ref_node": 0,
        "ref_dir": 0,
        "abscissa_spacing": 1,
        "x": np.arange(len(data)) / fs,
        "data": np.asarray(data),
        "abscissa_spec_data_type": 17,
        "ordinate_spec_data_type": quantity,
        "ordinate_axis_units_lab": unit,
        "orddenom_spec_data_type": 0,
    } | changes


def a_force(node, data, **changes):
    """A dataset 58 that is a force in N."""
    return set_58(node, data, **({"quantity": 13, "unit": "N"} | changes))


def an_frf(node, values, frequency, **changes):
    """A dataset 58 with an FRF, per N at node 100."""
    fields = {
        "func_type": 4,
        "x": frequency,
        "ref_node": 100,
        "ref_dir": 3,
        "abscissa_spec_data_type": 18,
        "orddenom_spec_data_type": 13,
        "orddenom_axis_units_lab": "N",
        "abscissa_spacing": 0,
    }
    return set_58(node, values, **(fields | changes))


def a_mode(nodes, shape, freq=10.0, **changes):
    """A dataset 55 with a normal mode that moves in z."""
    still = np.zeros(len(nodes))
    return {
        "type": 55,
        "analysis_type": 2,
        "data_ch": 2,
        "spec_data_type": 8,
        "load_case": 1,
        "mode_n": 1,
        "freq": freq,
        "modal_damp_vis": 0.01,
        "node_nums": np.asarray(nodes),
        "r1": still,
        "r2": still,
        "r3": np.asarray(shape),
    } | changes


def write_sets(path, *sets, force_double=True):
    """A UFF file of these datasets."""
    file = pyuff.UFF(str(path))
    for dataset in sets:
        file.write_sets([dict(dataset)], mode="add", force_double=force_double)
    return path


def good_sets(n=600):
    """The shaker and all four sensors."""
    responses = noise(5, n, 4)
    return [a_force(100, noise(4, n)), *(set_58(node, responses[i]) for i, (_, node, _) in enumerate(SENSORS))]
