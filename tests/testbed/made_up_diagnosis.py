"""A diagnosis that nobody computed, for the tests of what is made from one."""

from dataclasses import replace

import numpy as np

from identification.hypothesis import Hypothesis
from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.proposal import Option, Proposal
from identification.noise import Noise
from identification.result import (
    AddedEffect,
    Candidate,
    Diagnosis,
    ErrorMap,
    Estimate,
    MissingForce,
    RecordScore,
    Score,
    Stage,
)
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_mass import PointMass
from models.effects.squeeze_film import SqueezeFilm
from models.record import Record

SLEEVE_2 = Place(sleeve="sleeve 2", position=1.0)
FILM = SqueezeFilm(SLEEVE_2, damping=18.5)
FRICTION = CoulombFriction(Place(position=0.95), friction_force=1.0, slip_velocity=1e-3, against="ground")
FS = 256.0


def made_up_record(rig, name="sweep.csv", n_samples=2048):
    """Noise that repeats nothing: channels of the rig's sensors, a few times the excitation delayed."""
    rng = np.random.default_rng(1)
    excitation = rng.standard_normal(n_samples)
    responses = np.stack([(i + 1.0) * np.roll(excitation, i) for i in range(len(rig.sensors))])
    responses += 0.1 * rng.standard_normal(responses.shape)
    return Record(name, FS, excitation, tuple(s.name for s in rig.sensors), responses)


def made_up_score(record, error):
    n = len(record.sensors)
    noise = Noise(np.full(n, 0.01), 0.0, "assumed", "assumed")
    scored = RecordScore(
        record, (1.0 - error) * record.responses, noise, error, 0.007, np.full(n, error), np.full(n, 0.008)
    )
    return Score((scored,))


def made_up_proposal():
    table = {"kind": "sweep", "low": 5.0, "high": 100.0, "amplitude": 2.0, "duration": 4.0}
    test = PlannedTest("a sweep of 2 N", "sweep", table, FS, 1.0)
    weaker = replace(test, words="a sweep of 1 N")
    return Proposal(
        do=test.words,
        why="to tell them apart",
        test=test,
        options=(Option(test, 0.98, 4.2, 2.1, 4.0, confirmed=True), Option(weaker, 0.7, 1.1, 1.0, 4.0)),
        present_probability=0.5,
        rivals=(FILM, FRICTION),
        noise={"P1": 0.01, "excitation": 0.0},
    )


def made_up_diagnosis(rig, record=None, verdict="missing_effect"):
    record = made_up_record(rig) if record is None else record
    n = len(record.sensors)
    calibrated = Hypothesis(rig, {"youngs_modulus": 211e9})
    stages = (
        Stage("as given", Hypothesis(rig), made_up_score(record, 0.30)),
        Stage("calibrated", calibrated, made_up_score(record, 0.24)),
        Stage("+ squeeze_film at sleeve 2", calibrated.with_effects(FILM), made_up_score(record, 0.0071)),
    )
    by_frequency = np.full((n, 4), 0.1)
    by_frequency[-1, 1] = 0.9
    by_time = np.full((n, 3), 0.1)
    by_time[-1, 2] = 0.8
    error_map = ErrorMap(
        record.name, 1.0, np.array([10.0, 20.0, 30.0, 40.0]), by_frequency, np.array([1.0, 2.0, 3.0]), by_time,
        np.full((n, 4), 0.01),
    )  # fmt: skip
    force = np.zeros(100)
    force[50] = -3.0
    return Diagnosis(
        verdict=verdict,
        added=(AddedEffect(FILM, 0.97, (Estimate("damping", 18.5, 0.4, "N s/m"),)),),
        candidates=(
            Candidate(FILM, 0.97, 0.0071, 0.0, refitted=True),
            Candidate(FRICTION, 0.02, 0.05, -9.0, refitted=True),
        ),
        indistinguishable=((PointMass(Place(position=0.95), 0.1), PointMass(Place(position=1.15), 0.1)),),
        times_noise=1.02,
        stages=stages,
        holdout={"as given": made_up_score(record, 0.28), "updated": made_up_score(record, 0.0074)},
        rig_estimates=(Estimate("youngs_modulus", 211e9, 1e9, "Pa"),),
        where=(error_map,),
        missing_forces=(MissingForce("sleeve 2", record.name, np.zeros(100), np.zeros(100), force, 100.0),),
        updated_maps=(error_map,),
        traces={},
        next_experiment=made_up_proposal(),
        decisions=("added squeeze_film at sleeve 2",),
        seconds=41.0,
        seed=0,
        findings=("P4: dead",),
    )
