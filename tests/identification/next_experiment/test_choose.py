"""Which test is chosen, and that carrying it out settles what a quiet record leaves open."""

from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import SIGMA, bench_of, built, certain, group, quiet_record, resolved

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.next_experiment import choose
from identification.next_experiment.choose import AMPLE, DECISIVE, Question, options_of
from identification.next_experiment.costs import Costs, Limits
from models.effects import Place
from models.effects.clearance import Clearance
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.gap_offset import GapOffset
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain
from tests.identification.trial_records import oscillator


def hardening_or_not(share, **about):
    """An oscillator with a spring that hardens by a share at 1 mm, or one whose sensor reads right."""
    rig = oscillator("displacement")
    cubic = CubicStiffness(Place(), stiffness=share * rig.structure.stiffness / 1e-3**2)
    rivals = (
        certain(Hypothesis(rig, effects=(cubic,))),
        certain(Hypothesis(rig, effects=(SensorGain(Place(sensor="top"), 1.0),))),
    )
    bench = replace(bench_of(rig, 1e-5, rms=5.0), largest=np.array([1e-3]))
    return Question(bench, rivals, **about)


def test_what_grows_with_the_level_is_looked_for_at_a_higher_one():
    best = options_of(hardening_or_not(0.003))[0]
    assert best.expected_probability > DECISIVE
    assert best.test.excitation["kind"] == "multisine"
    assert best.test.excitation["rms"] > 5.0


def test_the_options_stand_in_order_of_what_they_bring():
    options = options_of(hardening_or_not(0.003))
    assert len(options) == 5
    gains = [float(f"{(o.expected_probability - 0.5) / o.test.minutes:.2g}") for o in options]
    decisive = [o.expected_probability >= DECISIVE for o in options]
    keys = list(zip(decisive, gains, strict=True))
    assert keys == sorted(keys, reverse=True)
    alike = [o for o in options if o.separation >= AMPLE and o.test.minutes == options[0].test.minutes]
    assert [o.reach for o in alike] == sorted(o.reach for o in alike)


def test_a_promise_that_no_fit_confirms_falls_behind(monkeypatch):
    question = replace(hardening_or_not(0.003), old=Evaluator([], 1))
    promised = options_of(hardening_or_not(0.003))
    broken = {option.test.words for option in promised[:3]}

    def fits(seen, _rivals, _old, scatter):
        return (0.0 if seen.test.words in broken else 1.0) * scatter

    monkeypatch.setattr(choose, "confirmed", fits)
    best = options_of(question)[0]

    assert best.confirmed
    assert best.test.words == promised[3].test.words


def test_where_no_fit_confirms_anything_the_best_that_was_tried_is_told(monkeypatch):
    monkeypatch.setattr(choose, "confirmed", lambda _seen, _rivals, _old, scatter: 0.0 * scatter)
    options = options_of(replace(hardening_or_not(0.003), old=Evaluator([], 1)))
    assert all(option.confirmed for option in options[:1])
    assert options[0].expected_probability == pytest.approx(0.5)


def test_a_test_through_which_no_fit_finds_its_way_is_not_proposed(monkeypatch):
    def lost(*_):
        raise ArithmeticError

    monkeypatch.setattr(choose, "confirmed", lost)
    assert options_of(replace(hardening_or_not(0.003), old=Evaluator([], 1))) == ()


def test_no_test_goes_beyond_the_limits():
    tight = hardening_or_not(0.003, limits=Limits(force=1.5, reading=1.2))
    options = options_of(tight)
    assert options
    for option in options:
        assert option.reach <= 1.2
        if option.test.excitation["kind"] == "multisine":
            assert option.test.excitation["rms"] <= 1.5 * 1.1 * tight.bench.peak


def test_where_turning_a_knob_is_dear_the_hammer_is_taken():
    cheap = options_of(hardening_or_not(0.003))[0]
    dear = options_of(hardening_or_not(0.003, costs=Costs(setting=60.0)))[0]
    assert cheap.test.family != "hammer"
    assert dear.test.family == "hammer"


def test_what_nothing_parts_is_not_said_to_be_parted():
    rig = oscillator()
    rivals = tuple(certain(Hypothesis(rig, effects=(SensorGain(Place(sensor="top"), g),))) for g in (1.0, 1.0))
    best = options_of(Question(bench_of(rig, SIGMA), rivals))[0]
    assert best.expected_probability == pytest.approx(0.5)
    assert best.separation == 0.0


SLEEVE_1, MIDDLE = Place(sleeve="sleeve 1", position=0.45), Place(position=0.7)
OFF_CENTRE, NARROW = GapOffset(SLEEVE_1, offset=2e-5), Clearance(SLEEVE_1, clearance=1.3e-4)
SPRING, HARDENING = PointStiffness(MIDDLE, stiffness=3e3), CubicStiffness(MIDDLE, stiffness=2e10)
FRICTION, DASHPOT = CoulombFriction(MIDDLE, friction_force=0.3, slip_velocity=1e-2), PointDamping(MIDDLE, damping=26.0)
HERE, THERE = PointMass(Place(position=0.83), mass=0.05), PointMass(Place(position=1.2), mass=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "other", "record", "sigma"),
    [
        pytest.param(OFF_CENTRE, NARROW, {"rms": 4.0, "low": 10.0}, 0.04, marks=pytest.mark.study),
        (NARROW, OFF_CENTRE, {"rms": 4.0, "low": 10.0}, 0.04),
        pytest.param(SPRING, HARDENING, {"rms": 1.0, "low": 10.0}, 0.12, marks=pytest.mark.study),
        pytest.param(HARDENING, SPRING, {"rms": 1.0, "low": 10.0}, 0.12, marks=pytest.mark.study),
        (FRICTION, DASHPOT, {"rms": 1.0, "low": 10.0}, 0.10),
        # At more noise the sizes are so little known that no affordable test promises DECISIVE.
        (HERE, THERE, {"rms": 0.5, "low": 5.0, "high": 15.0}, 0.006),
    ],
    ids=["offset", "clearance", "spring", "hardening", "friction", "mass"],
)
def test_the_proposed_test_settles_what_a_quiet_record_left_open(hidden, other, record, sigma):
    """The truth moves as finite elements do, so that its model is nobody's."""
    truth = replace(built()[0], effects=(hidden,))
    places = hidden.kind != other.kind  # two places of one kind are one valley for a place that is fitted
    evaluator, ranked, chances, question = group(truth, (hidden, other), quiet_record(**record), sigma, places=places)
    assert len(question.rivals) == 2, chances

    best = options_of(question)[0]
    again, after = resolved(evaluator, ranked, question, best.test, truth, sigma, places=places)

    assert best.expected_probability > DECISIVE
    assert again[0].effect.kind == hidden.kind
    assert again[0].effect.place.position == pytest.approx(hidden.place.position, abs=0.02)
    assert after[0] > DECISIVE
    # The test was chosen to tell kinds and places, not sizes.
    assert again[0].effect.fitted_values()[0] == pytest.approx(hidden.fitted_values()[0], rel=0.12)
