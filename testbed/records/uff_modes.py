"""Mode shapes from UFF dataset 55: normal modes and complex modes at nodes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from models.arrays import ComplexArray
from models.errors import InputError
from testbed.records.recording import ModeRecording

NORMAL_MODE, COMPLEX_FIRST_ORDER, COMPLEX_SECOND_ORDER = 2, 3, 7
"""Analysis types of dataset 55 that hold mode shapes."""

TRANSLATIONS = ("r3", "r2", "r1")
"""Data of a node in z, y and x, in the order of preference."""

Dataset = Mapping[str, Any]


def mode_recording(datasets: Sequence[Dataset], file: str, holds: str) -> ModeRecording:
    """The mode shapes of a file, ordered by frequency, in the direction that moves most.

    Args:
        datasets: all of the file.
        file: its name.
        holds: what a UFF file should hold, for the error.

    Raises:
        InputError: no mode shapes, or modes at different nodes, or with a frequency that is none.
    """
    kinds = (NORMAL_MODE, COMPLEX_FIRST_ORDER, COMPLEX_SECOND_ORDER)
    modes = [d for d in datasets if d["type"] == 55 and d.get("analysis_type") in kinds]
    if not modes:
        found = ", ".join(sorted({str(d["type"]) for d in datasets}))
        raise InputError(f"{file}: only datasets {found}", f"a UFF record holds {holds}", "export one of these")
    nodes = tuple(int(node) for node in modes[0]["node_nums"])
    for i, mode in enumerate(modes, start=1):
        if tuple(mode["node_nums"]) != nodes or any(len(mode[r]) != len(nodes) for r in TRANSLATIONS):
            raise InputError(
                f"{file}: mode {i} is given at other nodes than mode 1, or without three values for each",
                "all mode shapes of a record are given at the same nodes",
                "export them together",
            )
    pairs = [_freq_and_damping(mode) for mode in modes]
    for i, (freq, damping) in enumerate(pairs, start=1):
        if not (np.isfinite(damping) and 0 < freq < np.inf):
            raise InputError(
                f"{file}: mode {i} at {freq:g} Hz with damping ratio {damping:g}",
                "a natural frequency is above 0 and a damping ratio finite",
                "correct or remove the mode",
            )
    order = np.argsort([freq for freq, _ in pairs], kind="stable")
    freqs, dampings = (np.array(column)[order] for column in zip(*pairs, strict=True))
    return ModeRecording(file, nodes, freqs, dampings, _main_direction(modes)[order])


def _freq_and_damping(mode: Dataset) -> tuple[float, float]:
    """Hz and damping ratio; an eigenvalue is in rad/s, a hysteretic loss factor counts half."""
    if mode["analysis_type"] == NORMAL_MODE:
        return float(mode["freq"]), float(mode["modal_damp_vis"]) or float(mode["modal_damp_his"]) / 2
    size = abs(mode["eig"])
    return size / (2 * np.pi), -mode["eig"].real / size if size else 0.0


def _main_direction(modes: Sequence[Dataset]) -> ComplexArray:
    """(n, n_nodes) shapes in the direction with the largest motion: a beam's sensors look along one axis."""
    stacks = [np.array([mode[r] for mode in modes], complex) for r in TRANSLATIONS]
    return stacks[int(np.argmax([np.sum(np.abs(stack) ** 2) for stack in stacks]))]
