"""Files that must not be read, each with what its owner has to be told."""

import re
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from a_rig_and_its_records import (
    FS,
    SENSORS,
    a_force,
    a_mode,
    a_rig,
    an_frf,
    csv_lines,
    good_sets,
    noise,
    sensors,
    set_58,
    write_sets,
)

from models.errors import InputError
from testbed.records.read import read_record

FREQUENCY = np.arange(1.0, 50.0)


def csv(change):
    """A CSV file whose list of lines was changed."""

    def write(folder):
        lines = csv_lines()
        path = folder / "bad.csv"
        path.write_text("\n".join(change(lines) or lines), encoding="utf-8")
        return path

    return write


def cell(row, column, text):
    """The change of one cell; column 0 is time, 1 the shaker, 2 P1."""

    def change(lines):
        cells = lines[row + 1].split(",")
        cells[column] = text
        lines[row + 1] = ",".join(cells)

    return csv(change)


def header(old, new):
    return csv(lambda lines: [lines[0].replace(old, new), *lines[1:]])


def columns(change):
    """A CSV file whose (N, 6) numbers were changed."""

    def rewrite(lines):
        values = change(np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]]))
        return [lines[0], *(",".join(f"{v:.9g}" for v in row) for row in values)]

    return csv(rewrite)


def content(name, data):
    def write(folder):
        (folder / name).write_bytes(data)
        return folder / name

    return write


def uff(*sets):
    return lambda folder: write_sets(folder / "bad.uff", *sets)


def cut_uff(keep, *, binary=1):
    """A UFF file of which the last bytes are missing."""

    def write(folder):
        path = write_sets(folder / "bad.uff", *(dataset | {"binary": binary} for dataset in good_sets()))
        path.write_bytes(path.read_bytes()[:keep])
        return path

    return write


def variables(**changes):
    held = {"shaker": noise(1), **{name: noise(i) for i, (name, *_) in enumerate(SENSORS, start=2)}, "fs": FS}
    return {name: values for name, values in (held | changes).items() if values is not None}


def mat(**changes):
    def write(folder):
        scipy.io.savemat(folder / "bad.mat", variables(**changes))
        return folder / "bad.mat"

    return write


def npz(**changes):
    def write(folder):
        np.savez(folder / "bad.npz", **variables(**changes))
        return folder / "bad.npz"

    return write


def hdf5(**changes):
    def write(folder):
        with h5py.File(folder / "bad.h5", "w") as file:
            for name, values in variables(**changes).items():
                file[name] = values
        return folder / "bad.h5"

    return write


def with_value(values, index, value):
    changed = np.array(values, float)
    changed[index] = value
    return changed


def jittered(values):
    values[300, 0] += 0.01 / FS
    return values


def without_row(values):
    return np.delete(values, 250, axis=0)


def stuck_clock(values):
    values[:, 0] = 0.0
    return values


def clipped(column, limit):
    def change(values):
        smooth = np.convolve(values[:, column], np.ones(12) / 3, mode="same")
        values[:, column] = np.clip(smooth, -limit, limit)
        return values

    return change


ALWAYS = {
    # What is no record at all.
    "missing": (lambda folder: folder / "nowhere.csv", ["nowhere.csv", "there is no such file"]),
    "folder": (
        lambda folder: (folder / "f.csv", (folder / "f.csv").mkdir())[0],
        ["f.csv: is a directory", "files inside it"],
    ),
    "no name": (lambda _: Path(), ["without a name", "variable of the shell"]),
    "suffix": (content("bad.xlsx", b"x"), ["bad.xlsx", '".xlsx"', ".csv", ".uff"]),
    "near suffix": (content("bad.uf", b"x"), ["bad.uf", "rename it to .uff"]),
    "folder without suffix": (lambda folder: folder, ["is a directory"]),
    "no suffix": (content("bad", b"x"), ["bad", "a record is one of"]),
    **{f"empty {s}": (content(f"bad{s}", b""), [f"bad{s}", "empty"]) for s in (".uff", ".csv", ".mat", ".h5", ".npz")},
    **{
        f"garbage {s}": (content(f"bad{s}", bytes(range(256)) * 20), [f"bad{s}", "holds" if s != ".csv" else "binary"])
        for s in (".uff", ".unv", ".csv", ".mat", ".h5", ".npz")
    },
    "text as mat": (content("bad.mat", b"time [s],P1 [g]\n0,1\n"), ["bad.mat", "MATLAB"]),
    "text as uff": (content("bad.uff", b"time [s],P1 [g]\n0,1\n"), ["bad.uff", "has no datasets"]),
    "text as npz": (
        content("bad.npz", b"time [s],P1 [g]\n0,1\n"),
        ["bad.npz: cannot be read (Python objects, or no arrays at all)", "numpy.savez"],
    ),
    "rig": (content("rig.toml", b"[structure]"), ["rig.toml: a rig file or an experiment in the place of a record"]),
    # CSV.
    "no header": (csv(lambda lines: lines[1:]), ["bad.csv", "has no header", "time [s],P1 [m/s^2]"]),
    "header alone": (csv(lambda lines: lines[:1]), ["bad.csv", "has no samples"]),
    "short row": (csv(lambda lines: [*lines[:-1], lines[-1][:20]]), ["bad.csv", "sample 599", "the header 6"]),
    "word": (cell(17, 3, "overload"), ["bad.csv", "channel P2", "sample 17", '"overload"']),
    "empty cell": (cell(17, 3, ""), ["bad.csv", "channel P2", "sample 17", '""']),
    "nan": (cell(57, 2, "nan"), ["bad.csv", "channel P1", "sample 57", "is nan"]),
    "inf": (cell(58, 1, "-inf"), ["bad.csv", "channel shaker", "sample 58", "is -inf"]),
    "absurd": (cell(59, 1, "1e200"), ["bad.csv", "channel shaker", "sample 59", "1e+200"]),
    "unknown unit": (header("P3 [m/s^2]", "P3 [bananas]"), ["bad.csv", "channel P3", '"bananas"', "correct the label"]),
    "wrong unit": (header("P3 [m/s^2]", "P3 [mm]"), ["bad.csv", "channel P3", '"mm"', "acceleration"]),
    "force on a sensor": (header("P3 [m/s^2]", "P3 [N]"), ["bad.csv", "channel P3", '"N"', "acceleration"]),
    "volts": (header("P3 [m/s^2]", "P3 [mV]"), ["bad.csv", "channel P3", "no sensitivity", "add sensitivity"]),
    "time in metres": (header("time [s]", "time [m]"), ["bad.csv", 'time in "m"']),
    "no time": (csv(lambda lines: [line.partition(",")[2] for line in lines]), ["bad.csv", "neither fs nor time"]),
    "no sensor": (
        csv(lambda lines: [re.sub("P(.)", r"S\1", lines[0]), *lines[1:]]),
        ["bad.csv", "no sensor of the rig", "S1", "P1 (node 1)"],
    ),
    "twice": (header("P2", "P1"), ["bad.csv", "2 channels match P1"]),
    "two forces": (
        csv(lambda lines: [lines[0].replace("shaker", "f1").replace("P4 [m/s^2]", "f2 [N]"), *lines[1:]]),
        ["bad.csv", "f1, f2", "one"],
    ),
    "jitter": (columns(jittered), ["bad.csv", "time, sample 30", "uniform"]),
    "lost sample": (columns(without_row), ["bad.csv", "time, sample 250", "uniform"]),
    "stuck clock": (columns(stuck_clock), ["bad.csv", "time does not grow"]),
    "nan in time": (cell(7, 0, "nan"), ["bad.csv", "time, sample 7 is nan"]),
    "clipped sensor": (columns(clipped(2, 1.0)), ["bad.csv", "channel P1", "clipped", "first at sample"]),
    "clipped force": (columns(clipped(1, 1.0)), ["bad.csv", "channel shaker", "clipped", "lower gain"]),
    "short": (csv(lambda lines: lines[:200]), ["bad.csv", "199 samples", "one period of the first mode, 0.149"]),
    "time in ms": (
        columns(lambda v: v * [1e3, 1, 1, 1, 1, 1]),
        ["bad.csv", "at 2.048 Hz", "half its rate, and the first mode of the rig is at", "call it time [ms]"],
    ),
    "fs of comment": (csv(lambda lines: ["# fs = fast", *lines]), ["bad.csv", "fs = fast", "number"]),
    "two rates": (csv(lambda lines: ["# fs = 1000", *lines]), ["bad.csv", "1000 Hz", "2048 Hz"]),
    "negative rate": (csv(lambda lines: ["# fs = -2048", *lines]), ["bad.csv", "fs = -2048.0 Hz", "above 0"]),
    "beyond the tip": (csv(lambda lines: ["# excitation_position = 2", *lines]), ["bad.csv", "2.0 m", "0 to 1.469"]),
    "excitation in another quantity": (
        header("shaker [N]", "shaker [m/s^2]"),
        ["bad.csv", 'channel shaker is in "m/s^2"', "shaker is a force, in N", "correct the unit"],
    ),
    "round brackets": (
        header("P3 [m/s^2]", "P3 (m/s^2)"),
        ["bad.csv", '"P3 (m/s^2)"', "square brackets", "write P3 [m/s^2]"],
    ),
    "time in round brackets": (header("time [s]", "time (s)"), ["bad.csv", "square brackets", "write time [s]"]),
    "npz in round brackets": (npz(**{"P3": None, "P3 (m/(s^2))": noise(4)}), ["bad.npz", "write P3 [m/(s^2)]"]),
    "decimal commas": (
        csv(lambda lines: [lines[0], *(line.replace(".", ",") for line in lines[1:])]),
        ["bad.csv", "sample 0 has", "the header 6", "decimal commas", "semicolons"],
    ),
    "decimal commas between tabs": (
        csv(lambda lines: [line.replace(",", "\t").replace(".", ",") for line in lines]),
        ["bad.csv", "channel shaker, sample 0", "decimal commas"],
    ),
    "units below the header": (
        csv(lambda lines: ["time,shaker,P1,P2,P3,P4", "[s],(N),m/s^2,m/s^2,m/s^2,m/s^2", *lines[1:]]),
        ["bad.csv", "the line below the header is '[s],(N),m", "make one line of the two: time [s],shaker [N],P1 [m/"],
    ),
    "what the recorder's maker writes above": (
        csv(lambda lines: ["Recorder: R7, 8 channels", "Rate: 2048", *lines]),
        ["bad.csv", "2 lines stand above the header, as 'Recorder: R7, 8", "remove them, or begin each with #"],
    ),
    "one line above, semicolons and decimal commas": (
        csv(lambda lines: ["Recorder: R7", *(line.replace(",", ";").replace(".", ",") for line in lines)]),
        ["bad.csv", "1 line stands above the header, as 'Recorder: R7'", "remove them, or begin each with #"],
    ),
    "a comma behind each line": (
        csv(lambda lines: [f"{line}," for line in lines]),
        ["bad.csv", "a ',' stands at the end of each line", "remove it there"],
    ),
    "a tab behind each row": (
        csv(lambda lines: [lines[0].replace(",", "\t"), *(line.replace(",", "\t") + "\t" for line in lines[1:])]),
        ["bad.csv", r"a '\t' stands at the end of each line", "remove it there"],
    ),
    "blanks between values": (
        csv(lambda lines: [line.replace(",", " ") for line in lines]),
        ["bad.csv", "blanks stand between the values", "commas, semicolons or tabs"],
    ),
    "half a character of UTF-16": (
        content("bad.csv", "\n".join(csv_lines()).encode("utf-16")[:-1]),
        ["bad.csv", "UTF-16", "export it again"],
    ),
    # UFF.
    "uff cut in data": (cut_uff(20000), ["bad.uff", "does not end", "-1"]),
    "uff cut in ascii": (cut_uff(20000, binary=0), ["bad.uff", "does not end"]),
    "uff cut in header": (cut_uff(500), ["bad.uff", "does not end"]),
    "uff of nodes": (
        uff(
            {
                "type": 15,
                "node_nums": [1],
                "def_cs": [0],
                "disp_cs": [0],
                "color": [1],
                "x": [0.0],
                "y": [0.0],
                "z": [0.0],
            }
        ),
        ["bad.uff", "only datasets 15"],
    ),
    "uff nan": (uff(*good_sets()[:4], set_58(4, noise(9) * 1e300)), ["bad.uff", "channel node 4", "sample 0"]),
    "uff lengths": (uff(*good_sets()[:4], set_58(4, noise(9, 500))), ["bad.uff", "node 4", "another time base"]),
    "uff rates": (uff(*good_sets()[:4], set_58(4, noise(9), fs=1024)), ["bad.uff", "node 4", "another time base"]),
    "uff node twice": (uff(*good_sets(), set_58(4, noise(9), direction=1)), ["bad.uff", "2 channels match P4"]),
    "uff unknown unit": (uff(*good_sets()[:4], set_58(4, noise(9), unit="zz")), ["bad.uff", "node 4", '"zz"']),
    "uff hammer nowhere": (
        uff(a_force(77, noise(9)), *good_sets()[1:]),
        ["bad.uff", "excitation is at node 77", "100", "4 (P4)", "write node = 77"],
    ),
    "uff other nodes": (uff(set_58(50, noise(9))), ["bad.uff", "no sensor of the rig", "node 50"]),
    "frf over rad/s": (
        uff(an_frf(1, noise(1, 49) + 1j, FREQUENCY, abscissa_axis_units_lab="rad/s")),
        ["bad.uff", '"rad/s"', "Hz"],
    ),
    "frf falling axis": (uff(an_frf(1, noise(1, 49) + 1j, FREQUENCY[::-1])), ["bad.uff", "does not grow"]),
    "frf two references": (
        uff(an_frf(1, noise(1, 49) + 1j, FREQUENCY), an_frf(2, noise(2, 49) + 1j, FREQUENCY, ref_node=3)),
        ["bad.uff", "several references", "node 100, node 3"],
    ),
    "frf twice": (uff(*[an_frf(1, noise(1, 49) + 1j, FREQUENCY)] * 2), ["bad.uff", "several FRFs match P1"]),
    "frf of zeros": (uff(an_frf(1, np.zeros(49, complex), FREQUENCY)), ["bad.uff", "FRF of P1 is 0 throughout"]),
    "frf wrong unit": (
        uff(an_frf(1, noise(1, 49) + 1j, FREQUENCY, ordinate_axis_units_lab="m/s")),
        ["bad.uff", "node 1", '"m/s"'],
    ),
    "modes elsewhere": (uff(a_mode([50, 51], [1.0, 2.0])), ["bad.uff", "no sensor of the rig", "node 50"]),
    "mode node twice": (uff(a_mode([1, 1], [1.0, 2.0])), ["bad.uff", "node 1 stands twice"]),
    "mode at 0 Hz": (uff(a_mode([1, 2], [1.0, 2.0], freq=0.0)), ["bad.uff", "mode 1 at 0 Hz"]),
    "modes at different nodes": (
        uff(a_mode([1, 2], [1.0, 2.0]), a_mode([1, 3], [1.0, 2.0])),
        ["bad.uff", "mode 2", "other nodes"],
    ),
    "nothing measured": (
        csv(lambda lines: [lines[0], *(",".join([*line.split(",")[:2], *"0000"]) for line in lines[1:])]),
        ["bad.csv: nothing was measured: P1, P2, P3, P4 are constant", "check sensors"],
    ),
    # Named arrays.
    "no rate": (mat(fs=None), ["bad.mat", "neither fs nor time", "add fs"]),
    "rate of zero": (npz(fs=0.0), ["bad.npz", "fs = 0.0 Hz"]),
    "rates": (npz(fs=np.array([1.0, 2.0])), ["bad.npz", "fs is 2", "one number"]),
    "rate as text": (npz(fs=np.array("fast")), ["bad.npz", "fs is"]),
    "mat nan": (mat(P2=with_value(noise(1), 31, np.nan)), ["bad.mat", "channel P2", "sample 31", "nan"]),
    "h5 inf": (hdf5(P2=with_value(noise(1), 31, np.inf)), ["bad.h5", "channel P2", "sample 31", "inf"]),
    "npz length": (npz(P2=noise(1, 599)), ["bad.npz", "channel P2 has 599 samples", "has 600"]),
    "npz matrix": (npz(P2=noise(1, 600, 3)), ["bad.npz", "channel P2", "3 x 600", "one vector"]),
    "npz scalar": (npz(P2=np.array(3.0)), ["bad.npz", "channel P2", "one value"]),
    "npz complex": (npz(P2=noise(1) + 1j), ["bad.npz", "channel P2", "complex"]),
    "npz objects": (npz(P2=np.array([None, 1], dtype=object)), ["bad.npz", "cannot be read"]),
    "npz short time": (npz(fs=None, time=np.arange(599) / FS), ["bad.npz", "time of size 599", "600 samples"]),
    "npz unknown unit": (npz(units=np.array(["P2=furlong-ish"])), ["bad.npz", "channel P2", "furlong-ish"]),
    "mat of others": (
        lambda folder: (scipy.io.savemat(folder / "bad.mat", {"t": noise(1), "x": noise(2)}), folder / "bad.mat")[1],
        ["bad.mat", "no sensor of the rig", "(x)"],
    ),
}


@pytest.mark.parametrize("strict", [True, False], ids=["compare", "diagnose"])
@pytest.mark.parametrize("case", ALWAYS)
def test_what_no_one_may_use_is_refused_with_its_place(tmp_path, case, strict):
    write, words = ALWAYS[case]
    with pytest.raises(InputError) as caught:
        read_record(write(tmp_path), a_rig(), strict=strict)
    message = str(caught.value)
    assert [word for word in words if word not in message] == []
    assert all(part.strip() for part in (caught.value.given, caught.value.expected, caught.value.mend))


COMPARE_ONLY = {
    "missing": (npz(P3=None), ["no channel for P3", "--without P3"], ("P3",)),
    "two missing": (npz(P3=None, P1=None), ["no channel for P1, P3", "--without P1 --without P3"], ("P1", "P3")),
    "renamed": (npz(P3=None, Q3=noise(3)), ["no channel for P3", "if Q3 is a sensor of the rig, give it"], ("P3",)),
    "dead": (npz(P3=np.full(600, 0.25)), ["channel P3 is dead: 0.25 throughout", "--without P3"], ("P3",)),
    "copy": (npz(P3=noise(2)), ["channels P1, P3 are exact copies", "--without P1"], ("P1", "P3")),
    "too large": (npz(P3=1e3 * noise(9)), ["channel P3 is implausible", "times the others'"], ("P3",)),
    "too small": (npz(P3=1e-4 * noise(9)), ["channel P3 is implausible", "times below the others'"], ("P3",)),
    "mere noise": (npz(P3=noise(9) / 60), ["channel P3 is implausible", "times below the others'"], ("P3",)),
}


@pytest.mark.parametrize("case", COMPARE_ONLY)
def test_what_compare_refuses_diagnose_leaves_out_and_says(tmp_path, case):
    write, words, out = COMPARE_ONLY[case]
    path = write(tmp_path)
    with pytest.raises(InputError) as caught:
        read_record(path, a_rig())
    assert [word for word in ["bad.npz", *words] if word not in str(caught.value)] == []
    rest = tuple(name for name, *_ in SENSORS if name not in out)
    lenient = read_record(path, a_rig(), strict=False)
    assert lenient.sensors == rest
    assert any(words[0] in finding for finding in lenient.findings)
    assert read_record(path, a_rig(), without=out).sensors == rest


def test_what_is_left_out_already_is_named_again(tmp_path):
    with pytest.raises(InputError, match=r"no channel for P1; .*leave out with --without P3 --without P1$"):
        read_record(npz(P1=None)(tmp_path), a_rig(), without=["P3"])


def test_a_dead_excitation_is_an_error_for_compare_and_a_finding_for_diagnose(tmp_path):
    path = npz(shaker=np.zeros(600))(tmp_path)
    with pytest.raises(InputError, match=r"the excitation shaker is dead: 0 throughout.*--without shaker"):
        read_record(path, a_rig())
    lenient = read_record(path, a_rig(), strict=False)
    assert lenient.excitation is None
    assert lenient.moving_start
    assert read_record(path, a_rig(), without=["shaker"]).excitation is None


@pytest.mark.parametrize("bad", [np.full(600, np.nan), noise(1, 500), noise(1) + 1j], ids=["nan", "length", "complex"])
def test_a_channel_left_out_is_not_looked_at(tmp_path, bad):
    back = read_record(npz(P2=bad)(tmp_path), a_rig(), without=["P2"])
    assert back.sensors == ("P1", "P3", "P4")
    assert not any("P2" in finding for finding in back.findings)


def test_a_name_that_is_no_channel_gets_the_nearest(tmp_path):
    with pytest.raises(InputError, match=r"--without P33; the rig's channels are P1.*; the nearest one is P3"):
        read_record(npz()(tmp_path), a_rig(), without=["P33"])


def test_not_all_sensors_can_be_left_out(tmp_path):
    with pytest.raises(InputError, match="a record keeps at least one sensor"):
        read_record(npz()(tmp_path), a_rig(), without=["P1", "P2", "P3", "P4"])


def test_a_record_of_dead_channels_alone_is_refused_by_diagnose_too(tmp_path):
    with pytest.raises(InputError, match="nothing was measured: P1, P2"):
        read_record(npz(**{name: np.zeros(600) for name, *_ in SENSORS})(tmp_path), a_rig(), strict=False)


def test_a_mass_that_nothing_holds_has_no_shortest_record(tmp_path):
    rig = a_rig(
        structure={"kind": "oscillator", "mass": 1.0, "stiffness": 0.0, "damping": 0.0},
        excitation={"name": "shaker"},
        sensors=[{"name": "P1"}],
    )
    path = npz(shaker=noise(1, 20), P1=noise(2, 20), P2=None, P3=None, P4=None)(tmp_path)
    assert read_record(path, rig).n_samples == 20


def test_an_oscillators_record_lasts_a_period(tmp_path):
    rig = a_rig(
        structure={"kind": "oscillator", "mass": 1.0, "stiffness": 1.0, "damping": 0.0},
        excitation={"name": "shaker"},
        sensors=[{"name": "P1"}],
    )
    with pytest.raises(InputError, match=r"one period of the first mode, 6\.283 s"):
        read_record(npz(P2=None, P3=None, P4=None)(tmp_path), rig)


def test_the_good_file_behind_the_bad_ones_is_good(tmp_path):
    for write in (csv(lambda _: None), uff(*good_sets()), mat(), npz(), hdf5()):
        record = read_record(write(tmp_path), a_rig(sensors=sensors()))
        assert record.sensors == ("P1", "P2", "P3", "P4")
        assert record.fs == pytest.approx(FS)
