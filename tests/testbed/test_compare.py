"""A comparison of every kind of record, and ``compare.json`` with the keys of its format."""

import json
from dataclasses import replace

import numpy as np
import pytest
from cli_files import FILM, FS, made_record, make_files

from identification.hypothesis import Hypothesis
from models.band_limit import record_channels
from models.effects import Place
from models.effects.sensor_gain import SensorGain
from models.linear import frf, linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from models.record import FrfRecord, ModeShapeRecord
from models.rig_file import read_rig
from models.simulate import simulate
from testbed.compare import RATTLING, compare
from testbed.compare_json import comparison_json
from testbed.outputs import json_text

CHANNEL_KEYS = ["sensor", "nrmse", "noise_nrmse", "mre", "frac", "csac", "csf"]


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    return read_rig(make_files(tmp_path_factory.mktemp("compare")) / "rig.toml")


@pytest.fixture(scope="module")
def record(rig):
    return made_record(rig, "burst.csv", 1)


@pytest.fixture(scope="module")
def missing(rig, record):
    return json.loads(json_text(comparison_json(compare(Hypothesis(rig), [record], jobs=1))))


@pytest.fixture(scope="module")
def complete(rig, record):
    return comparison_json(compare(Hypothesis(rig, effects=(FILM,)), [record], jobs=1))


def linear(rig, *effects):
    return linearised(build_modal(build_plant(rig, effects), 300.0))


def frf_record(rig, frequency, *effects):
    names = tuple(sensor.name for sensor in rig.sensors)
    return FrfRecord("h.uff", frequency, names, frf(linear(rig, *effects), frequency, names))


def test_the_keys_are_those_of_the_format(missing):
    assert list(missing) == ["nrmse", "noise_nrmse", "records", "findings"]
    assert list(missing["records"][0]) == ["record", "nrmse", "noise_nrmse", "channels"]
    assert [list(channel) for channel in missing["records"][0]["channels"]] == [CHANNEL_KEYS] * 3


def test_a_record_all_of_whose_channels_are_in_another_unit_is_a_finding(rig, record, missing):
    in_g = replace(record, responses=record.responses / 9.80665)
    finding, *others = comparison_json(compare(Hypothesis(rig), [in_g], jobs=1))["findings"]
    assert not any("all 3 channels are" in each for each in (*others, *missing["findings"]))
    assert "burst.csv: all 3 channels are" in finding
    assert "near 9.807 or its inverse (g, or kilograms-force)" in finding


@pytest.mark.parametrize("is_damped", [True, False])
def test_a_record_whose_motions_part_is_told_with_the_time_that_can_be_followed(rig, record, is_damped):
    """A twentieth of the force is noise; a rig that damps carries that and no more, one that rattles is torn by it."""
    sleeves = tuple(sleeve.model_copy(update={"damping": 5.0}) for sleeve in rig.sleeves)
    structure = rig.structure.model_copy(update={"rayleigh_damping": (0.5, 1e-6)})
    built = rig if is_damped else rig.model_copy(update={"structure": structure, "sleeves": sleeves})
    heard = simulate(build_plant(built), record).channels
    felt = record.excitation + 0.05 * record.excitation.std() * np.random.default_rng(2).standard_normal(heard.shape[1])

    found = compare(Hypothesis(built), [replace(record, excitation=felt, responses=heard)], jobs=1)

    told = [finding for finding in found.findings if finding.startswith("burst.csv: noise alone is ")]
    assert len(told) == (not is_damped)
    if told:
        seconds = float(told[0].split("for its first ")[1].split(" s")[0])
        assert 0.0 < seconds < record.duration
        assert found.score.noise_nrmse > RATTLING


@pytest.mark.parametrize("is_loud", [True, False])
def test_noise_that_is_told_from_quiet_bands_alone_is_said_to_be_a_bound(rig, record, is_loud):
    """A burst leaves no band of three channels quiet; long after a small blow there is hardly more than the noise."""
    force = record.excitation if is_loud else np.where(np.arange(record.n_samples) == 20, 30.0, 0.0)
    heard = simulate(build_plant(rig), replace(record, excitation=force)).channels
    noise = 1e-3 * heard.std() * np.random.default_rng(3).standard_normal(heard.shape)
    through = record_channels(noise, 1, record.n_samples, record.fs)  # its filter leaves none in its stopped band

    found = compare(Hypothesis(rig), [replace(record, excitation=force, responses=heard + through)], jobs=1)

    assert found.score.records[0].noise.at_most
    assert any("is a bound from above" in finding for finding in found.findings) == is_loud
    assert (found.score.noise_nrmse > 3.0 * found.score.nrmse) == is_loud


def test_the_model_that_made_the_record_leaves_its_noise_alone_and_the_other_does_not(missing, complete):
    """White noise of 0.5 % over fs/2, judged below 0.35 fs; 1000 samples hold 3 % of chance."""
    assert complete["nrmse"] == pytest.approx(0.005 * np.sqrt(0.7), rel=0.1)
    assert missing["nrmse"] > 10.0 * missing["noise_nrmse"]
    for channel in complete["records"][0]["channels"]:
        assert min(channel["frac"], channel["csac"], channel["csf"]) > 0.95
        assert channel["mre"] < 0.1


def test_without_excitation_there_are_no_frfs_and_their_figures_are_null(rig, record):
    decay = replace(record, excitation=None)
    row = comparison_json(compare(Hypothesis(rig), [decay], jobs=1))["records"][0]
    assert all(channel[key] is None for channel in row["channels"] for key in ("mre", "frac", "csac", "csf"))


def test_frfs_of_the_model_itself_are_met_and_their_line_at_0_hz_is_left_out(rig):
    content = comparison_json(compare(Hypothesis(rig), [frf_record(rig, np.linspace(0.0, 150.0, 76))]))
    assert content["nrmse"] < 1e-9
    assert content["noise_nrmse"] is None
    assert [channel["sensor"] for channel in content["records"][0]["channels"]] == ["P1", "P2", "P3"]


def test_frfs_see_a_softer_beam(rig):
    softer = rig.with_values({"youngs_modulus": 150e9})
    assert comparison_json(compare(Hypothesis(rig), [frf_record(softer, np.linspace(1.0, 150.0, 75))]))["nrmse"] > 0.2


def test_frfs_of_other_quantities_count_alike(rig):
    """Only the displacement is wrong, whose numbers are a thousandth of the accelerations'."""
    names = [sensor.name for sensor in rig.sensors]
    mixed = rig.model_copy(
        update={"sensors": (*rig.sensors[:-1], rig.sensors[-1].model_copy(update={"quantity": "displacement"}))}
    )
    exact = frf_record(mixed, np.linspace(1.0, 150.0, 75))
    wrong = replace(exact, values=np.array([[1.0]] * (len(names) - 1) + [[1.25]]) * exact.values)
    content = comparison_json(compare(Hypothesis(mixed), [wrong]))
    assert content["nrmse"] == pytest.approx(0.2 / np.sqrt(len(names)), rel=1e-6)


def test_modes_are_paired_by_frequency_and_shape_whatever_their_order_and_scale(rig):
    modes = natural_modes(linear(rig), rig.sensors, 250.0)
    order, names = [2, 0, 1], tuple(sensor.name for sensor in rig.sensors)
    measured = ModeShapeRecord("m.uff", names, 1.01 * modes.natural_freqs[order], None, -3j * modes.shapes[order])
    row = comparison_json(compare(Hypothesis(rig), [measured]))["records"][0]
    found = [(mode["model_freq"] / mode["measured_freq"], mode["mac"]) for mode in row["modes"]]
    assert np.array(found) == pytest.approx(np.array([[1 / 1.01, 1.0]] * 3), rel=1e-6)
    assert row["modes"][0]["measured_damping_ratio"] is None


def test_shapes_are_compared_as_the_sensors_read_them(rig):
    modes, names = natural_modes(linear(rig), rig.sensors, 250.0), tuple(sensor.name for sensor in rig.sensors)
    inverted = SensorGain(Place(sensor="P2"), gain=-1.0)
    read = modes.shapes * np.array([1.0, -1.0, 1.0])
    measured = ModeShapeRecord("m.uff", names, modes.natural_freqs, modes.damping_ratios, read)
    macs = [
        [mode["mac"] for mode in comparison_json(compare(hypothesis, [measured]))["records"][0]["modes"]]
        for hypothesis in (Hypothesis(rig), Hypothesis(rig, effects=(inverted,)))
    ]
    assert min(macs[1]) > 1.0 - 1e-9
    assert min(macs[0]) < 0.9


def test_lines_that_were_not_excited_carry_no_frf(rig, record):
    pair = compare(Hypothesis(rig), [record], jobs=1).frfs[0]
    assert pair.frequency.max() < 0.35 * FS
    assert pair.coherence.max(axis=0).min() >= 0.5
