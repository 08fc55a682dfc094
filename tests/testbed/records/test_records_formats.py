import pkgutil
import subprocess
import sys
from importlib import import_module

import h5py
import numpy as np
import pytest
import scipy.io
from a_rig_and_its_records import FS, SENSORS, a_record, a_rig, csv_lines, noise, sensors
from hypothesis import given, settings
from hypothesis import strategies as st

import testbed.records
from models.errors import InputError
from models.rig_file import RECORDS
from testbed.records.formats import FORMATS
from testbed.records.read import read_record
from testbed.records.write import write_record

SUFFIXES = sorted(FORMATS)
# Where a format prints the step or the times, the rate comes back to rounding alone.
RATE_ROUNDING = 1e-12


def as_bytes(record):
    return record.responses.tobytes(), None if record.excitation is None else record.excitation.tobytes()


def check_round_trip(record, rig, path):
    write_record(record, rig, path)
    back = read_record(path, rig)
    assert as_bytes(back) == as_bytes(record)
    assert back.fs == pytest.approx(record.fs, rel=RATE_ROUNDING)
    assert back.sensors == record.sensors
    assert back.name == path.name


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
@given(fs=st.floats(300, 1e5), seed=st.integers(0, 2**32 - 1), size=st.tuples(st.integers(1, 4), st.floats(-9, 9)))
@settings(max_examples=30)
def test_every_bit_comes_back(tmp_path_factory, suffix, fs, seed, size):
    n_sensors, level = size
    n = int(fs * 0.16)
    rig = a_rig(sensors=sensors()[:n_sensors])
    record = a_record(
        n, fs, responses=10**level * noise(seed, n, n_sensors), sensors=("P1", "P2", "P3", "P4")[:n_sensors]
    )
    check_round_trip(record, rig, tmp_path_factory.mktemp("round") / f"run{suffix}")


@pytest.mark.parametrize("suffix", [".mat", ".h5", ".hdf5"])
@given(fs=st.floats(300, 5000), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=4)
def test_every_bit_comes_back_through_another_process(tmp_path_factory, suffix, fs, seed):
    n = int(fs * 0.16)
    record = a_record(n, fs, responses=noise(seed, n, 4))
    check_round_trip(record, a_rig(), tmp_path_factory.mktemp("round") / f"run{suffix}")


@pytest.mark.parametrize("suffix", [".csv", ".mat", ".h5", ".npz"])
def test_names_that_are_no_variables_come_back(tmp_path, suffix):
    names = ["P 1, left", "1/2", "_tip", "file"]
    rig = a_rig(sensors=[{"name": n, "position": p} for n, (_, _, p) in zip(names, SENSORS, strict=True)])
    check_round_trip(a_record(sensors=tuple(names)), rig, tmp_path / f"run{suffix}")


@pytest.mark.parametrize("suffix", [".csv", ".mat", ".h5", ".npz"])
def test_a_place_of_the_hammer_comes_back(tmp_path, suffix):
    write_record(a_record(excitation_position=0.7), a_rig(), tmp_path / f"run{suffix}")
    assert read_record(tmp_path / f"run{suffix}", a_rig()).excitation_position == 0.7


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_free_decay_has_no_excitation_and_moves(tmp_path, suffix):
    write_record(a_record(excitation=None), a_rig(), tmp_path / f"run{suffix}")
    back = read_record(tmp_path / f"run{suffix}", a_rig())
    assert back.excitation is None
    assert back.moving_start
    assert any("no channel for the excitation shaker; read as a free decay" in finding for finding in back.findings)


def test_an_excitation_by_another_name_is_asked_for(tmp_path):
    write_record(a_record(), a_rig(), tmp_path / "run.csv")
    text = (tmp_path / "run.csv").read_text()
    (tmp_path / "run.csv").write_text(text.replace("shaker [N]", "foo [V]"))

    with pytest.raises(InputError, match=r"no channel for the excitation shaker, but foo.*--without shaker"):
        read_record(tmp_path / "run.csv", a_rig())

    assert read_record(tmp_path / "run.csv", a_rig(), without=["shaker"]).excitation is None


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_arrays_of_a_record_are_read_only(tmp_path, suffix):
    write_record(a_record(), a_rig(), tmp_path / f"run{suffix}")
    assert not read_record(tmp_path / f"run{suffix}", a_rig()).responses.flags.writeable


def test_the_suffix_counts_in_any_case(tmp_path):
    write_record(a_record(), a_rig(), tmp_path / "RUN.CSV")
    assert read_record(tmp_path / "RUN.CSV", a_rig()).n_samples == 600


def test_every_format_is_registered_and_every_registered_module_is_a_format():
    names = [info.name for info in pkgutil.iter_modules(testbed.records.__path__)]
    modules = {name: import_module(f"testbed.records.{name}") for name in names}
    formats = {name for name, module in modules.items() if hasattr(module, "HOLDS")}
    assert formats == {form.__name__.rpartition(".")[2] for form in FORMATS.values()}


def test_importing_the_package_imports_nothing_heavy():
    code = "import sys, testbed.records.read, testbed.records.write; print(*sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in result.stdout.split()}
    assert loaded & {"pint", "h5py", "pyuff", "pandas", "matplotlib"} == set()
    assert "scipy.io" not in result.stdout.split()


# CSV as other programs write it.


def read_csv(tmp_path, lines, rig=None, encoding="utf-8"):
    (tmp_path / "run.csv").write_text("\n".join(lines), encoding=encoding)
    return read_record(tmp_path / "run.csv", rig or a_rig())


def test_semicolons_with_decimal_commas(tmp_path):
    plain = read_csv(tmp_path, csv_lines())
    german = [line.replace(",", ";").replace(".", ",") for line in csv_lines()]
    assert as_bytes(read_csv(tmp_path, german)) == as_bytes(plain)


def test_tabs_and_blank_lines_and_a_byte_order_mark(tmp_path):
    tabs = ["\ufeff" + csv_lines()[0].replace(",", "\t"), "", *(line.replace(",", "\t") for line in csv_lines()[1:])]
    assert as_bytes(read_csv(tmp_path, tabs)) == as_bytes(read_csv(tmp_path, csv_lines()))


def test_a_header_as_numpy_writes_it(tmp_path):
    lines = csv_lines()
    assert read_csv(tmp_path, ["# " + lines[0], *lines[1:]]).sensors == ("P1", "P2", "P3", "P4")


def test_fs_above_the_header_in_place_of_a_time_column(tmp_path):
    lines = [line.partition(",")[2] for line in csv_lines()]
    assert read_csv(tmp_path, ["# fs = 1000 Hz", *lines]).fs == 1000


def test_time_in_milliseconds(tmp_path):
    lines = csv_lines(fs=2.0)
    assert read_csv(tmp_path, [lines[0].replace("[s]", "[ms]"), *lines[1:]]).fs == pytest.approx(2000)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be"])
def test_text_with_a_byte_order_mark_is_read(tmp_path, encoding):
    lines = csv_lines()
    if encoding == "utf-16-be":
        lines[0] = "\ufeff" + lines[0]
    assert read_csv(tmp_path, lines, encoding=encoding).sensors == ("P1", "P2", "P3", "P4")


def test_micro_and_square_in_an_old_encoding(tmp_path):
    rig = a_rig(sensors=sensors(quantity="displacement"))
    lines = csv_lines(units=("N", *["µm"] * 4))
    back = read_csv(tmp_path, lines, rig, encoding="cp1252")
    assert back.responses[0, 0] == pytest.approx(1e-6 * float(lines[1].split(",")[2]))


def test_a_column_that_is_no_sensor_is_passed_over_and_said(tmp_path):
    back = read_csv(
        tmp_path, csv_lines(names=("shaker", "P1", "P2", "P3", "P4", "temp"), units=("N", *["g"] * 4, "degC"))
    )
    assert "run.csv: channel temp is no sensor of the rig and was passed over" in back.findings


# MATLAB, HDF5 and NPZ as other programs write them.


def variables(n=600):
    return {"shaker": noise(1, n), **{name: noise(i, n) for i, (name, *_) in enumerate(SENSORS, start=2)}, "fs": FS}


UNITS = [
    {"P1": "g", "shaker": "kN", "P2": "m/s^2", "P3": "m/s^2", "P4": "m/s^2"},
    np.array(["P1=g", "shaker = kN", "P2=m/s^2"], dtype=object),
    np.array(["P1=g     ", "shaker=kN"]),
]


@pytest.mark.parametrize("units", UNITS, ids=["struct", "cell", "char"])
def test_units_of_a_matlab_file(tmp_path, units):
    scipy.io.savemat(tmp_path / "a.mat", variables() | {"units": units})
    back = read_record(tmp_path / "a.mat", a_rig())
    assert back.responses[0] == pytest.approx(9.80665 * noise(2))
    assert back.excitation == pytest.approx(1000 * noise(1))
    assert np.array_equal(back.responses[1], noise(3))


def test_si_is_assumed_and_said_where_a_matlab_file_has_no_units(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", variables())
    back = read_record(tmp_path / "a.mat", a_rig())
    assert "a.mat: channel P1 has no unit; read as m/s^2" in back.findings
    assert "a.mat: channel shaker has no unit; read as N" in back.findings


def test_a_matlab_file_without_units_is_in_the_sensitivitys_volts(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", variables())
    back = read_record(tmp_path / "a.mat", a_rig(sensors=sensors(sensitivity="100 mV/g")))
    assert back.responses[0] == pytest.approx(9.80665 / 100 * noise(2))
    assert any("read as mV through the sensitivity 100 mV/g" in finding for finding in back.findings)


def test_a_struct_in_a_matlab_file_is_passed_over_and_said(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", variables() | {"info": {"by": "me"}})
    assert any("variable info holds no numbers" in f for f in read_record(tmp_path / "a.mat", a_rig()).findings)


def test_a_time_vector_in_place_of_fs(tmp_path):
    held = variables()
    del held["fs"]
    scipy.io.savemat(tmp_path / "a.mat", held | {"t": np.arange(600)[:, None] / FS})
    assert read_record(tmp_path / "a.mat", a_rig()).fs == pytest.approx(FS, rel=RATE_ROUNDING)


def test_matlab_7_3(tmp_path):
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        for name, values in variables().items():
            file[name] = np.atleast_2d(values)
        units = file.create_group("units")
        units["P1"] = np.array([[ord("g")]], dtype=np.uint16)
        file["comment"] = np.array([[ord(letter)] for letter in "a note"], dtype=np.uint16)
        file["comment"].attrs["MATLAB_class"] = np.bytes_(b"char")
    back = read_record(tmp_path / "a.mat", a_rig())
    assert back.fs == FS
    assert back.responses[0] == pytest.approx(9.80665 * noise(2))
    assert np.array_equal(back.responses[3], noise(5))
    assert any("variable comment holds no numbers" in finding for finding in back.findings)


@pytest.mark.parametrize("options", [{}, {"compression": "gzip", "shuffle": True}, {"dtype": "f4"}, {"dtype": "i2"}])
def test_hdf5_of_other_programs(tmp_path, options):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values in variables().items():
            if name != "fs":
                file.create_dataset(name, data=1000 * values, **options).attrs["unit"] = (
                    "mN" if name == "shaker" else "mm/s^2"
                )
        file["time"] = np.arange(600) / FS
    back = read_record(tmp_path / "a.h5", a_rig())
    assert back.fs == pytest.approx(FS, rel=RATE_ROUNDING)
    # An integer rounds by half a unit of a thousandth, a single by 6e-8 of its value.
    assert np.abs(back.responses[0] - noise(2)).max() < (1e-3 if "dtype" in options else 1e-12)


def test_npz_of_other_programs(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", **variables(), units=np.array(["P2=g", "shaker=lbf"]))
    back = read_record(tmp_path / "a.npz", a_rig())
    assert back.responses[1] == pytest.approx(9.80665 * noise(3))
    assert back.excitation == pytest.approx(4.4482216152605 * noise(1))


# Writing.


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, suffix, monkeypatch):
    path = tmp_path / f"run{suffix}"
    path.write_text("old")

    def broken(recording, to):
        to.write_text("half")
        raise InputError("given", "expected", "mend")

    monkeypatch.setattr(FORMATS[suffix], "write", broken)
    with pytest.raises(InputError):
        write_record(a_record(), a_rig(), path)
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_an_existing_file_is_replaced_whole(tmp_path):
    for n in (900, 600):
        write_record(a_record(n), a_rig(), tmp_path / "run.uff")
    assert read_record(tmp_path / "run.uff", a_rig()).n_samples == 600


@pytest.mark.parametrize(
    ("record", "rig", "name", "words"),
    [
        (a_record(), a_rig(), "run.xlsx", '"\\.xlsx".*a record is one of'),
        (a_record(), a_rig(sensors=sensors()[:2]), "run.csv", "channel P3; the rig's sensors are P1, P2"),
        (a_record(), a_rig(excitation=None), "run.csv", "the rig has no excitation"),
        (a_record(1), a_rig(), "run.csv", "1 samples; a record has two or more"),
        (a_record(), a_rig(), "no/such/folder/run.csv", "No such file or directory"),
    ],
)
def test_what_cannot_be_written_is_said(tmp_path, record, rig, name, words):
    with pytest.raises(InputError, match=words):
        write_record(record, rig, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".mat", ".npz", ".h5"])
def test_a_sensor_called_like_the_time_base_cannot_be_written(tmp_path, suffix):
    rig = a_rig(sensors=[{"name": name, "position": p} for name, (_, _, p) in zip("tabc", SENSORS, strict=True)])
    with pytest.raises(InputError, match=r'channel "t" as variable t.*rename the sensor'):
        write_record(a_record(sensors=("t", "a", "b", "c")), rig, tmp_path / f"run{suffix}")


def test_whatever_is_read_as_a_record_is_not_taken_for_a_rig():
    assert set(FORMATS) == RECORDS


@pytest.mark.parametrize("suffix", [".npz", ".h5"])
def test_names_may_be_headings_with_units(tmp_path, suffix):
    record = a_record(n := 512, 2048.0, responses=noise(1, n, 2), sensors=("P1", "P2"))
    columns = {
        "time [s]": np.arange(n) / 2048.0,
        "shaker [kN]": record.excitation / 1e3,
        "P1 [mm/s^2]": record.responses[0] * 1e3,
        "P2 [m/s^2]": record.responses[1],
    }
    path = tmp_path / f"table{suffix}"
    if suffix == ".npz":
        np.savez(path, **columns)
    else:
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                # A slash would be a group.
                file[name.replace("/s^2", " s^-2")] = values
    back = read_record(path, a_rig(sensors=sensors()[:2]))
    assert back.fs == pytest.approx(2048.0, rel=RATE_ROUNDING)
    np.testing.assert_allclose(back.responses, record.responses, rtol=1e-12)
    np.testing.assert_allclose(back.excitation, record.excitation, rtol=1e-12)
