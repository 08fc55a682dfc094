"""Damaged files end in an InputError or, where the damage spares all that is read, in a record: in nothing else."""

import numpy as np
import pytest
from a_rig_and_its_records import FS, SENSORS, a_mode, a_record, a_rig, an_frf, noise, write_sets
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import InputError
from testbed.records.read import read_record
from testbed.records.write import write_record

EXAMPLES = {".csv": 150, ".uff": 150, ".npz": 150, ".mat": 5, ".h5": 5}
"""MATLAB and HDF5 files are read in another process, which takes its time."""


def check_read(path, damaged):
    path.write_bytes(damaged)
    for strict in (True, False):
        try:
            message = read_record(path, a_rig(), strict=strict).name
        except InputError as error:
            message = str(error)
        assert message.startswith(path.name)


def damage(good, cut, flips):
    changed = bytearray(good[: max(1, int(cut * len(good)))])
    for place, value in flips:
        changed[int(place * (len(changed) - 1))] = value
    return bytes(changed)


# Headers are short and matter most: half of the places fall into the first twentieth.
places = st.one_of(st.floats(0, 1), st.floats(0, 0.05))
flips = st.lists(st.tuples(places, st.integers(0, 255)), max_size=10)
cuts = st.one_of(st.just(1.0), st.floats(0, 1))


@pytest.mark.parametrize("suffix", EXAMPLES)
def test_bytes_flipped_and_ends_cut_off(tmp_path_factory, suffix):
    folder = tmp_path_factory.mktemp("fuzz")
    path = folder / f"run{suffix}"
    write_record(a_record(400, excitation_position=0.45), a_rig(), path)
    good = path.read_bytes()

    @given(cut=cuts, flips=flips)
    @settings(max_examples=EXAMPLES[suffix])
    def check(cut, flips):
        check_read(path, damage(good, cut, flips))

    check()


@pytest.mark.parametrize(
    "sets",
    [
        [an_frf(i, noise(i, 49) + 1j, np.arange(1.0, 50.0), binary=0) for i in (1, 2, 3, 4)],
        [a_mode([1, 2, 3, 4], noise(freq, 4), freq=float(freq)) for freq in (10, 20)],
    ],
    ids=["frf", "modes"],
)
def test_damaged_frfs_and_modes(tmp_path, sets):
    path = write_sets(tmp_path / "run.uff", *sets)
    good = path.read_bytes()

    @given(cut=cuts, flips=flips)
    @settings(max_examples=150)
    def check(cut, flips):
        check_read(path, damage(good, cut, flips))

    check()


def test_cells_of_a_csv_swapped_for_any_text(tmp_path):
    path = tmp_path / "run.csv"
    write_record(a_record(400), a_rig(), path)
    lines = path.read_text().splitlines()

    @given(row=st.integers(0, len(lines) - 1), column=st.integers(0, 5), text=st.text(max_size=12))
    @settings(max_examples=200)
    def check(row, column, text):
        cells = lines[row].split(",")
        cells[column % len(cells)] = text
        check_read(path, "\n".join([*lines[:row], ",".join(cells), *lines[row + 1 :]]).encode())

    check()


def test_archives_of_any_numeric_type(tmp_path):
    @given(
        dtype=st.sampled_from(["f2", "f4", "f8", "i1", "i8", "u2", "?", "c8", "U3", "S2", "M8[s]", "g", ">f8"]),
        shape=st.sampled_from([(), (0,), (1,), (600,), (600, 1), (2, 300), (0, 5)]),
        name=st.sampled_from(["P1", "fs", "time", "t", "units", "excitation_position", "shaker", ""]),
    )
    @settings(max_examples=150)
    def check(dtype, shape, name):
        held = {"fs": FS, "shaker": noise(1), **{n: noise(i) for i, (n, *_) in enumerate(SENSORS, start=2)}}
        np.savez(tmp_path / "run.npz", **(held | {name: np.ones(shape).astype(dtype)}))
        check_read(tmp_path / "run.npz", (tmp_path / "run.npz").read_bytes())

    check()
