"""Several records together: realisations, levels, records that do not repeat, a model's gain, and the words."""

import time
from dataclasses import replace

import numpy as np
import pytest
from budget_scenes import FS, PERIOD, line_powers, multisine, record, resonator, steady

from identification.budget import budget_of
from identification.budget.gain import gain_of
from identification.budget.modes import resonances
from models.errors import InputError
from models.record import FrfRecord, Record

PERIODS = 6
RAGGED_BY = 0.6
"""Of a best linear approximation's own size, scattered from line to line as impacts do."""


def duffing(drive, hardening, freq=30.0, damping_ratio=0.03, finer=8):
    """x'' + 2 zeta w x' + w^2 (x + hardening x^3) = w^2 u by the central difference, u band-limited between samples."""
    n = len(drive)
    spectrum = np.zeros(finer * n // 2 + 1, complex)
    spectrum[: n // 2 + 1] = np.fft.rfft(drive)
    u, h, w = finer * np.fft.irfft(spectrum, finer * n), 1.0 / (finer * FS), 2.0 * np.pi * freq
    x = np.zeros(finer * n)
    left, right = 1.0 + damping_ratio * w * h, 1.0 - damping_ratio * w * h
    for i in range(1, finer * n - 1):
        pull = w * w * (u[i] - x[i] - hardening * x[i] ** 3)
        x[i + 1] = (2.0 * x[i] - right * x[i - 1] + h * h * pull) / left
    return x[::finer]


def duffing_record(seed, rms, hardening=0.02, periods=5, name="made"):
    drive = multisine(seed, periods, high=60.0, rms=rms)
    return record(drive, duffing(drive, hardening), noise=1e-4, seed=seed, name=name)


@pytest.fixture(scope="module")
def hardening():
    runs = [(1, 0.05), (2, 0.05), (1, 0.2), (2, 0.2)]
    return budget_of([duffing_record(seed, rms, name=f"{rms}-{seed}") for seed, rms in runs], "N")


def test_what_impacts_make_of_an_approximation_is_no_mode(hardening):
    level = hardening.levels[0]
    rng = np.random.default_rng(5)
    scatter = RAGGED_BY * np.abs(level.bla) * np.exp(2j * np.pi * rng.uniform(size=level.bla.shape))

    spike = np.where(np.arange(level.bla.shape[1]) == np.argmax(np.abs(level.bla[0])), 30.0, 1.0)

    assert len(resonances(level)) == 1
    assert resonances(replace(level, bla=level.bla + scatter)) == ()
    assert resonances(replace(level, bla=np.abs(level.bla).mean() * spike[None] + 0j)) == ()


def test_levels_and_realisations_are_sorted(hardening):
    assert [(round(level.rms, 2), level.realisations) for level in hardening.levels] == [(0.05, 2), (0.2, 2)]
    assert len(hardening.changes) == 1


def test_a_hardening_spring_stiffens_with_level(hardening):
    ((low, high),) = hardening.changes[0].modes
    assert low.natural_freq == pytest.approx(30.0, rel=0.01)  # at 0.2 the spring adds 3 hardening <x^2> / 2, below 1 %
    # The equivalent linear spring of a Gaussian motion: 1 + 3 hardening <x^2> (Caughey 1963).
    motion = np.mean(hardening.splits[2].record.responses[0] ** 2)
    stiffer = 30.0 * np.sqrt(1.0 + 3.0 * 0.02 * motion)
    # The motion of a light resonance is not quite Gaussian: a fifth of the shift.
    assert high.natural_freq - 30.0 == pytest.approx(stiffer - 30.0, rel=0.2)
    text = " ".join(hardening.findings())
    assert "stiffens" in text
    assert "odd distortion: a symmetric law" in text
    assert "even distortion: an" not in text


def test_realisations_tell_the_distortion_that_detection_lines_tell():
    records = []
    for seed in range(6):
        drive = multisine(seed, 4)
        records.append(record(drive, drive + 0.05 * drive**3, noise=1e-3, seed=seed, name=f"r{seed}"))
    (level,) = budget_of(records).levels
    inside = ~np.isnan(level.distortion.power[0])
    by_lines = np.mean([split.shares["odd"].power[0, inside] for split in level.splits], axis=0)
    assert level.realisations == 6
    assert level.distortion.found[0, inside].all()
    # Lines that all six excite, a sixth of the odd ones, stand for the rest; both scatter by some 15 %.
    shared = len(level.frequency) / np.mean([s.periods.excited.sum() * 4.0 / 3.0 for s in level.splits])
    assert level.distortion.total[0] / shared == pytest.approx(np.nansum(by_lines), rel=0.4)


def test_a_linear_rig_stays_the_same_at_all_levels_and_phases():
    records = []
    for seed, rms in ((1, 1.0), (2, 1.0), (3, 3.0), (4, 3.0)):
        drive = multisine(seed, PERIODS, "full", rms=rms)
        motion = steady(lambda u: resonator(u, 40.0), drive)
        records.append(record(drive, motion, noise=0.01, seed=seed, name=f"{rms}-{seed}"))
    budget = budget_of(records, "N")
    text = " ".join(budget.findings())
    assert not any(level.distortion.found.any() for level in budget.levels)
    assert "stays the same" in text
    assert "stiffens" not in text
    assert "softens" not in text
    assert "cannot be told apart" in text
    (mode,) = resonances(budget.levels[0])
    assert mode.natural_freq == pytest.approx(40.0, abs=5.0 * mode.natural_freq_std + 0.02)  # a digital resonator
    assert mode.damping_ratio == pytest.approx(0.02, rel=0.05)


def test_one_realisation_that_is_repeated_is_one():
    drive = multisine(1, PERIODS)
    motion = steady(resonator, drive)
    pair = [record(drive, motion, noise=0.01, seed=seed, name=f"r{seed}") for seed in (1, 2)]
    (level,) = budget_of(pair).levels
    assert (len(level.splits), level.realisations, level.distortion) == (2, 1, None)


def test_noise_that_grows_faster_than_the_response_is_told():
    records = []
    for rms, size in ((1.0, 0.001), (3.0, 0.02)):
        drive = multisine(1, PERIODS, rms=rms)
        records.append(record(drive, steady(resonator, drive), noise=size, name=f"{rms}"))
    assert any("has no period" in text for text in budget_of(records, "N").findings())


def others():
    rng = np.random.default_rng(1)
    n = 4096
    time_s = np.arange(n) / FS
    blow = np.where(np.arange(n) < 4, 100.0, 0.0)
    sweep = np.sin(2.0 * np.pi * (5.0 + 8.0 * time_s) * time_s)
    decay = np.exp(-time_s) * np.sin(2.0 * np.pi * 30.0 * time_s)
    dead = Record("dead", FS, multisine(1, 4), ("P1",), np.zeros((1, 4 * PERIOD)))
    flat = Record("flat", FS, np.zeros(n), ("P1",), rng.standard_normal((1, n)))
    frf = FrfRecord("frf", np.arange(1.0, 50.0), ("P1",), np.ones((1, 49), complex))
    return [
        record(blow, resonator(blow), noise=1e-3, name="hammer"),
        record(sweep, resonator(sweep), noise=1e-3, name="sweep"),
        Record("decay", FS, None, ("P1",), (decay + 1e-3 * rng.standard_normal(n))[None], moving_start=True),
        Record("short", FS, np.ones(40), ("P1",), rng.standard_normal((1, 40))),
        dead,
        flat,
        frf,
    ]


@pytest.mark.parametrize("number", range(7))
def test_a_record_that_does_not_repeat_is_said_to_tell_little(number):
    one = others()[number]
    budget = budget_of([one])
    assert not budget.splits
    assert one.name in budget.findings()[0]
    assert "one left out at random in each group of four" in budget.findings()[-1]


def test_what_a_perfect_model_could_still_gain():
    drive = multisine(1, PERIODS)
    linear, bent = steady(resonator, drive), 0.05 * drive**2
    held = record(drive, 1.1 * linear + bent, noise=0.005)
    (split,) = budget_of([held]).splits
    gain = gain_of(split, linear[None])
    wrong, missing = (line_powers(part)[: len(split.periods.frequency)].sum() for part in (0.1 * linear, bent))
    assert gain.possible.sum() == pytest.approx(wrong + missing, rel=0.02)
    assert gain.nonlinear.sum() == pytest.approx(missing, rel=0.02)
    assert gain.noise.sum() == pytest.approx(0.005**2 * 0.7, rel=0.1)
    perfect = gain_of(split, (1.1 * linear + bent)[None])
    assert perfect.possible.sum() < 0.05 * perfect.noise.sum()


def test_it_costs_no_more_than_some_transforms_of_the_records():
    """65 times one transform of every channel on a quiet machine; the rest is room for a busy one."""
    rng = np.random.default_rng(1)
    drive = np.tile(multisine(1, 1), 32)
    rows = np.stack([drive] * 8) + 0.01 * rng.standard_normal((8, len(drive)))
    records = [Record(f"r{i}", 2048.0, drive, tuple("abcdefgh"), rows) for i in range(3)]
    costs: dict[str, list[float]] = {"budget": [], "transforms": []}
    for _ in range(3):
        start = time.process_time()
        budget_of(records)
        costs["budget"].append(time.process_time() - start)
        start = time.process_time()
        for _ in records:
            np.fft.rfft(np.vstack((drive, rows)))
        costs["transforms"].append(time.process_time() - start)
    assert min(costs["budget"]) < 200.0 * min(costs["transforms"])


def test_no_record_is_an_error():
    with pytest.raises(InputError, match="no record; a budget is of one record at least; name a record"):
        budget_of([])
