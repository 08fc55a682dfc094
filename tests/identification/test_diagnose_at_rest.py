"""Once round the loop on FRFs and mode shapes: kind and place, and no nonlinearity that nobody can have seen."""

import numpy as np
import pytest
from rest_records import frfs_of, modes_of
from test_diagnose import BUILT, few
from trial_records import REFERENCE, measured, moved, multisine, oscillator

from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from identification.outcome import AT_REST_ONLY, UNTRIED
from models.effects import EFFECTS, Place
from models.effects.clamp_compliance import ClampCompliance
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.effects.youngs_modulus import YoungsModulus

LINEAR = few("point_mass", "sensor_gain", "clamp_compliance", "youngs_modulus", "force_gain", "modal_damping")
DAMPING = few("squeeze_film", "coulomb_friction", "point_damping", "modal_damping", "time_varying_damping")
MASS = PointMass(Place(position=0.8), mass=0.2)


def built(*effects):
    return Hypothesis(REFERENCE, BUILT.values, effects=effects)


def test_where_nothing_is_hidden_in_frfs_the_model_is_complete_for_small_motion():
    kept = frfs_of(built(), seed=2, name="kept.uff")

    found = diagnose(REFERENCE, [frfs_of(built())], [kept], jobs=1)

    assert (found.verdict, found.added, found.candidates) == ("complete", (), ())
    assert found.final.score.nrmse == pytest.approx(found.final.score.noise_nrmse, rel=0.15)
    assert found.holdout["updated"].nrmse < 0.3 * found.holdout["as given"].nrmse
    assert (found.where, found.missing_forces, found.traces) == ((), (), {})
    assert found.next_experiment.why == AT_REST_ONLY
    assert any("small motion" in decision for decision in found.decisions)
    assert f"h.uff: {AT_REST_ONLY}" in found.findings


def test_an_oscillators_frfs_calibrate_it():
    rig = oscillator()

    found = diagnose(rig, [frfs_of(moved(rig, 0.5, -0.8, 1.0))], jobs=1)

    assert found.verdict == "complete"
    assert found.stages[0].score.nrmse > 3.0 * found.final.score.nrmse


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "size"),
    [
        (MASS, 0.2),
        (ClampCompliance(Place(), rotational_stiffness=2e4), 2e4),
        (SensorGain(Place(sensor="P4"), 0.8), 0.8),
    ],
    ids=["mass", "clamp", "sensor"],
)
def test_what_is_hidden_in_frfs_is_found_with_its_place(hidden, size):
    found = diagnose(REFERENCE, [frfs_of(built(hidden))], jobs=1, registry=LINEAR)

    assert found.verdict == "missing_effect"
    (added,) = found.added
    effect = added.effect
    assert (effect.kind, effect.place.sensor) == (hidden.kind, hidden.place.sensor)
    if hidden.place.position is not None:
        assert effect.place.position == pytest.approx(hidden.place.position, abs=0.005)
    # 1 % of noise on some 4000 numbers.
    assert effect.fitted_values()[0] == pytest.approx(size, rel=0.01)
    assert added.probability > 0.99 * (1.0 - UNTRIED)
    assert found.next_experiment.why == AT_REST_ONLY


@pytest.mark.slow
def test_grease_is_seen_in_frfs_as_the_dashpot_that_it_is_at_rest():
    film = SqueezeFilm(Place(sleeve="sleeve 2", position=1.0), damping=20.0)

    found = diagnose(REFERENCE, [frfs_of(built(film))], jobs=1, registry=DAMPING)

    assert found.verdict == "missing_effect"
    (added,) = found.added
    assert added.effect.kind == "point_damping"
    assert added.effect.place.position == pytest.approx(1.0, abs=0.005)
    assert added.probability < 0.6
    (group,) = found.indistinguishable
    assert {"point_damping", "squeeze_film"} <= {effect.kind for effect in group}
    assert any(AT_REST_ONLY in decision for decision in found.decisions)
    assert not any(candidate.effect.kind == "time_varying_damping" for candidate in found.candidates)


@pytest.mark.slow
@pytest.mark.parametrize("hidden", [MASS, YoungsModulus(Place(), ratio=1.1)], ids=["mass", "modulus"])
def test_what_is_hidden_in_mode_shapes_is_found(hidden):
    found = diagnose(REFERENCE, [modes_of(built(hidden))], jobs=1, registry=LINEAR)

    assert found.verdict == "missing_effect"
    (added,) = found.added
    assert added.effect.kind == hidden.kind
    if hidden.place.position is not None:
        assert added.effect.place.position == pytest.approx(hidden.place.position, abs=0.03)
    # A frequency is known to 0.2 %, and the rig's numbers move it too.
    assert added.effect.fitted_values()[0] == pytest.approx(hidden.fitted_values()[0], rel=0.1)


def test_mode_shapes_of_the_rig_as_built_are_complete():
    assert diagnose(REFERENCE, [modes_of(built())], jobs=1).verdict == "complete"


def test_frfs_help_time_records_whose_nonlinearity_can_be_seen():
    rig = oscillator()
    truth = moved(rig, 0.5, -0.8, 1.0)
    record, _ = measured(truth, multisine(4096), name="multisine")

    found = diagnose(rig, [frfs_of(truth), record], jobs=1, registry=EFFECTS)

    assert found.verdict == "complete"
    assert [row.record.name for row in found.final.score.records] == ["multisine"]
    assert [row.record.name for row in found.final.score.at_rest] == ["h.uff"]
    assert "higher level" in found.next_experiment.do
    assert found.next_experiment.why != AT_REST_ONLY
    assert [error_map.record for error_map in found.where] == ["multisine"]
    errors = np.array([stage.score.nrmse for stage in found.stages])
    assert errors[-1] < 0.5 * errors[0]
