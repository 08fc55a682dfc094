import numpy as np
import pytest
from a_rig_and_its_records import (
    FS,
    a_force,
    a_mode,
    a_record,
    a_rig,
    an_frf,
    good_sets,
    noise,
    sensors,
    set_58,
    write_sets,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.record import FrfRecord, ModeShapeRecord, Record
from testbed.records import uff
from testbed.records.read import read_record
from testbed.records.write import write_record

SHAPES = [
    ("acceleration", 12, "m/s^2"),
    ("velocity", 11, "m/s"),
    ("displacement", 8, "m"),
]


@given(
    fs=st.one_of(st.integers(300, 204800).map(float), st.floats(300, 5000)),
    seed=st.integers(0, 2**32 - 1),
    level=st.floats(-8, 8),
    moving=st.booleans(),
)
@settings(max_examples=40)
def test_binary_files_give_back_every_bit(tmp_path_factory, fs, seed, level, moving):
    n = int(fs * 0.2)
    record = a_record(n, fs, responses=10**level * noise(seed, n, 4), excitation=None if moving else noise(seed + 1, n))
    path = tmp_path_factory.mktemp("uff") / "run.uff"
    write_record(record, a_rig(), path)
    back = read_record(path, a_rig())
    assert isinstance(back, Record)
    assert np.array_equal(back.responses, record.responses)
    assert back.fs == record.fs
    assert back.sensors == record.sensors
    if moving:
        assert back.excitation is None
        assert back.moving_start
    else:
        assert np.array_equal(back.excitation, record.excitation)
        assert back.findings == ()


def test_ascii_files_keep_twelve_digits(tmp_path):
    sets = good_sets()
    write_sets(tmp_path / "a.unv", *(dataset | {"binary": 0} for dataset in sets))
    back = read_record(tmp_path / "a.unv", a_rig())
    assert np.allclose(back.responses[2], sets[3]["data"], rtol=1e-11, atol=0)


def test_single_precision_ascii_keeps_six_digits(tmp_path):
    sets = [dataset | {"binary": 0, "ord_data_type": 2} for dataset in good_sets()]
    write_sets(tmp_path / "a.unv", *sets, force_double=False)
    back = read_record(tmp_path / "a.unv", a_rig())
    assert np.allclose(back.responses[0], sets[1]["data"], rtol=1e-5, atol=0)


@pytest.mark.parametrize("fs", [2048.0, 51200.0, 4096.0, 333.0, 44100.0])
def test_a_whole_rate_survives_the_six_digits_of_the_step(tmp_path, fs):
    write_sets(tmp_path / "a.uff", *(set_58(i, noise(i, 60000, None), fs=fs) for i in (1, 2, 3, 4)))
    assert read_record(tmp_path / "a.uff", a_rig()).fs == fs


def test_a_rate_that_is_no_whole_number_stays_what_the_step_says(tmp_path):
    fs = 1e7 / 2**14
    write_sets(tmp_path / "a.uff", *(set_58(i, noise(i), fs=fs) for i in (1, 2, 3, 4)))
    assert read_record(tmp_path / "a.uff", a_rig()).fs == pytest.approx(fs, rel=1e-12)


def test_times_written_out_one_by_one_with_six_digits_are_uniform(tmp_path):
    sets = [dataset | {"binary": 0, "abscissa_spacing": 0} for dataset in good_sets(3000)]
    write_sets(tmp_path / "a.uff", *sets)
    assert read_record(tmp_path / "a.uff", a_rig()).fs == FS


@pytest.mark.parametrize("direction", [-1, -2, -3])
def test_a_negative_direction_flips_the_sign_of_its_channel_alone(tmp_path, direction):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", *sets[:2], sets[2] | {"rsp_dir": direction}, *sets[3:])
    back = read_record(tmp_path / "a.uff", a_rig())
    assert np.array_equal(back.responses[1], -sets[2]["data"])
    assert np.array_equal(back.responses[0], sets[1]["data"])


def test_a_negative_direction_flips_the_force(tmp_path):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", sets[0] | {"rsp_dir": -3}, *sets[1:])
    assert np.array_equal(read_record(tmp_path / "a.uff", a_rig()).excitation, -sets[0]["data"])


def test_nodes_find_sensors_whatever_the_order_and_the_names(tmp_path):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", *(dataset | {"id1": "P1"} for dataset in reversed(sets)))
    back = read_record(tmp_path / "a.uff", a_rig())
    assert back.sensors == ("P1", "P2", "P3", "P4")
    assert np.array_equal(back.responses, np.array([dataset["data"] for dataset in sets[1:]]))


def test_a_sensor_without_node_is_found_by_name(tmp_path):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", *sets[:4], sets[4] | {"rsp_node": 0, "id1": "P4"})
    rig = a_rig(sensors=[*sensors()[:3], {"name": "P4", "position": 1.44}])
    assert np.array_equal(read_record(tmp_path / "a.uff", rig).responses[3], sets[4]["data"])


def test_force_and_accelerometer_may_share_the_drive_points_node(tmp_path):
    sets = good_sets()
    rig = a_rig(excitation={"name": "shaker", "node": 4, "position": 1.44})
    write_sets(tmp_path / "a.uff", sets[0] | {"rsp_node": 4}, *sets[1:])
    back = read_record(tmp_path / "a.uff", rig)
    assert np.array_equal(back.excitation, sets[0]["data"])
    assert np.array_equal(back.responses[3], sets[4]["data"])
    assert back.excitation_position is None


@pytest.mark.parametrize("name", ["NONE", "shaker", "hammer"])
def test_a_roving_hammer_is_located_by_the_sensor_at_its_node(tmp_path, name):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", sets[0] | {"rsp_node": 2, "id1": name}, *sets[1:])
    back = read_record(tmp_path / "a.uff", a_rig())
    assert back.excitation_position == 0.45
    assert np.array_equal(back.excitation, sets[0]["data"])
    assert back.sensors == ("P1", "P2", "P3", "P4")


def test_a_roving_hammer_survives_the_round_trip(tmp_path):
    write_record(a_record(excitation_position=0.83), a_rig(), tmp_path / "a.uff")
    assert read_record(tmp_path / "a.uff", a_rig()).excitation_position == 0.83


def test_a_hammer_between_nodes_cannot_be_written(tmp_path):
    with pytest.raises(InputError, match=r"0\.5 m, where no sensor has a node.*write another format"):
        write_record(a_record(excitation_position=0.5), a_rig(), tmp_path / "a.uff")


def test_the_files_own_unit_system_speaks_for_channels_without_label(tmp_path):
    sets = [dataset | {"ordinate_axis_units_lab": "NONE"} for dataset in good_sets()]
    system = {"type": 164, "units_code": 5, "length": 1000.0, "force": 1000.0, "temp": 1.0, "temp_offset": 0.0}
    write_sets(tmp_path / "a.uff", system, *sets)
    back = read_record(tmp_path / "a.uff", a_rig())
    assert np.allclose(back.responses[0], 1e-3 * sets[1]["data"], rtol=1e-14)
    assert np.allclose(back.excitation, 1e-3 * sets[0]["data"], rtol=1e-14)
    assert back.findings == ()


def test_without_label_si_is_assumed_and_said(tmp_path):
    write_sets(tmp_path / "a.uff", *(dataset | {"ordinate_axis_units_lab": "NONE"} for dataset in good_sets()))
    back = read_record(tmp_path / "a.uff", a_rig())
    assert "a.uff: channel node 1 has no unit; read as m/s^2" in back.findings


@pytest.mark.parametrize(("quantity", "code", "unit"), SHAPES)
def test_the_quantity_of_the_dataset_must_be_the_sensors(tmp_path, quantity, code, unit):
    sets = [set_58(i, noise(i), quantity=code, unit="NONE") for i in (1, 2, 3, 4)]
    write_sets(tmp_path / "a.uff", *sets)
    assert read_record(tmp_path / "a.uff", a_rig(sensors=sensors(quantity=quantity))).n_samples == 600
    other = "velocity" if quantity != "velocity" else "displacement"
    with pytest.raises(InputError, match=rf"a {quantity}|an {quantity}"):
        read_record(tmp_path / "a.uff", a_rig(sensors=sensors(quantity=other)))


def test_an_angular_velocity_is_a_velocity_in_a_rotation(tmp_path):
    rig = a_rig(sensors=sensors(quantity="angular_velocity"))
    write_record(a_record(), rig, tmp_path / "a.uff")
    assert np.array_equal(read_record(tmp_path / "a.uff", rig).responses, a_record().responses)


def test_frfs_are_read_in_si_with_signs(tmp_path):
    frequency = np.arange(1.0, 200.0)
    values = noise(1, 199, 4) + 1j * noise(2, 199, 4)
    sets = [an_frf(i + 1, values[i], frequency) for i in range(4)]
    sets[0] |= {"ordinate_axis_units_lab": "g", "orddenom_axis_units_lab": "kN"}
    sets[1] |= {"rsp_dir": -3}
    sets[2] |= {"ordinate_axis_units_lab": "g/N", "orddenom_axis_units_lab": "NONE"}
    write_sets(tmp_path / "a.uff", *sets)
    back = read_record(tmp_path / "a.uff", a_rig())
    assert isinstance(back, FrfRecord)
    assert np.allclose(back.frequency, frequency)
    assert back.excitation_position is None
    factors = np.array([9.80665e-3, -1.0, 9.80665, 1.0])
    assert np.allclose(back.values, factors[:, None] * values, rtol=1e-12)


def test_a_coherence_stands_beside_its_frf_whatever_their_order(tmp_path):
    frequency = np.arange(1.0, 50.0)
    coherence = 1.0 / (1.0 + noise(5, 49, 4) ** 2)
    frfs = [an_frf(i + 1, noise(i, 49) + 1j, frequency) for i in range(4)]
    told = [an_frf(i + 1, coherence[i], frequency, func_type=6) for i in range(4)]
    write_sets(tmp_path / "a.uff", *told[::-1], *frfs)
    assert np.allclose(read_record(tmp_path / "a.uff", a_rig()).coherence, coherence, rtol=1e-12)
    write_sets(tmp_path / "b.uff", *frfs, *told[:3])
    assert read_record(tmp_path / "b.uff", a_rig()).coherence is None


def test_a_coherence_that_is_none_is_refused(tmp_path):
    frequency = np.arange(1.0, 50.0)
    write_sets(
        tmp_path / "a.uff",
        *(an_frf(i, noise(i, 49) + 1j, frequency) for i in (1, 2, 3, 4)),
        an_frf(3, np.full(49, 1.2), frequency, func_type=6),
    )
    with pytest.raises(InputError, match=r"a\.uff: coherence of P3, sample 0 is 1\.2; a coherence is from 0 to 1"):
        read_record(tmp_path / "a.uff", a_rig())


def test_frfs_of_a_roving_hammer_know_where_it_struck(tmp_path):
    frequency = np.arange(1.0, 50.0)
    write_sets(tmp_path / "a.uff", *(an_frf(i, noise(i, 49) + 1j, frequency, ref_node=3) for i in (1, 2, 3, 4)))
    assert read_record(tmp_path / "a.uff", a_rig()).excitation_position == 0.83


def test_a_missing_frf_is_an_error_for_compare_alone(tmp_path):
    frequency = np.arange(1.0, 50.0)
    write_sets(tmp_path / "a.uff", *(an_frf(i, noise(i, 49) + 1j, frequency) for i in (1, 2, 3)))
    with pytest.raises(InputError, match=r"a\.uff: no channel for P4.*--without P4"):
        read_record(tmp_path / "a.uff", a_rig())
    assert read_record(tmp_path / "a.uff", a_rig(), strict=False).sensors == ("P1", "P2", "P3")
    assert read_record(tmp_path / "a.uff", a_rig(), without=["P4"]).sensors == ("P1", "P2", "P3")


@pytest.mark.parametrize("axis", ["r1", "r2", "r3"])
def test_mode_shapes_are_read_in_the_direction_that_moves(tmp_path, axis):
    shapes = noise(1, 5, 2)
    nodes = [4, 9, 1, 2, 3]
    modes = [
        a_mode(nodes, np.zeros(5), freq=freq, **{axis: shape}) for freq, shape in zip([25, 10], shapes, strict=True)
    ]
    write_sets(tmp_path / "a.unv", *modes)
    back = read_record(tmp_path / "a.unv", a_rig())
    assert isinstance(back, ModeShapeRecord)
    assert back.sensors == ("P1", "P2", "P3", "P4")
    assert np.allclose(back.natural_freqs, [10, 25])
    assert np.allclose(back.damping_ratios, 0.01)
    assert np.allclose(back.shapes, shapes[::-1][:, [2, 3, 4, 0]], rtol=1e-5)


def test_complex_modes_give_frequency_and_damping_by_their_eigenvalue(tmp_path):
    pole = 2 * np.pi * 12.0 * (-0.02 + 1j * np.sqrt(1 - 0.02**2))
    shape = noise(1, 4) + 1j * noise(2, 4)
    still = np.zeros(4, complex)
    write_sets(tmp_path / "a.uff", a_mode([1, 2, 3, 4], shape, analysis_type=3, eig=pole, r1=still, r2=still))
    back = read_record(tmp_path / "a.uff", a_rig())
    assert back.natural_freqs[0] == pytest.approx(12.0, rel=1e-5)
    assert back.damping_ratios[0] == pytest.approx(0.02, rel=1e-4)
    assert np.allclose(back.shapes[0], shape, rtol=1e-5)


def test_modes_without_damping_have_none(tmp_path):
    write_sets(tmp_path / "a.uff", a_mode([1, 2, 3, 4], noise(1, 4), modal_damp_vis=0.0))
    assert read_record(tmp_path / "a.uff", a_rig()).damping_ratios is None


def test_a_loss_factor_counts_half(tmp_path):
    write_sets(tmp_path / "a.uff", a_mode([1, 2, 3, 4], noise(1, 4), modal_damp_vis=0.0, modal_damp_his=0.04))
    assert read_record(tmp_path / "a.uff", a_rig()).damping_ratios[0] == pytest.approx(0.02)


def test_binary_and_ascii_of_our_own_agree(tmp_path):
    write_record(a_record(), a_rig(), tmp_path / "b.uff")
    recording = uff.read(tmp_path / "b.uff")
    uff.write(recording, tmp_path / "a.uff", binary=False)
    binary, text = (read_record(tmp_path / name, a_rig()) for name in ("b.uff", "a.uff"))
    assert np.allclose(binary.responses, text.responses, rtol=1e-11, atol=0)
    assert binary.fs == text.fs


def test_the_only_force_is_the_excitation_where_the_rig_gives_no_node(tmp_path):
    sets = good_sets()
    write_sets(tmp_path / "a.uff", a_force(0, sets[0]["data"]), *sets[1:])
    back = read_record(tmp_path / "a.uff", a_rig(excitation={"name": "shaker", "position": 1.3}))
    assert np.array_equal(back.excitation, sets[0]["data"])
    assert any("the only force, is taken as the excitation shaker" in finding for finding in back.findings)
