"""What a co-simulation is set up with: the sleeve, the twin, the rate, the window, and what is refused."""

import numpy as np
import pytest
from cosim_scenes import REFERENCE, SLEEVE, varying, with_sleeves

from identification.decay.sleeve_poles import ratios_of
from models.contact.kelvin_voigt import KelvinVoigt
from models.errors import InputError
from models.linear import linearised, natural_modes
from models.modal import build_modal
from testbed.cosim.plan import FLAT_EDGE, LEAST_PERIODS, MODES, Wish, damping_over, plan_of


@pytest.fixture(scope="module")
def plan():
    return plan_of(varying((0.0, 2.0, 3.0), (100.0, 50.0, 200.0)), Wish(seconds=4.0))


def test_the_twin_has_the_rigs_own_damping_and_the_truth_the_table(plan):
    assert plan.sleeve == SLEEVE
    contact = next(c for c in plan.twin.contacts if c.sleeve == SLEEVE)
    assert isinstance(contact.law, KelvinVoigt)
    assert contact.law.damping == pytest.approx(80.0, rel=1e-9)  # a difference of forces at 1e-6 m/s
    np.testing.assert_allclose(
        plan.true_damping(np.array([0.0, 1.0, 2.5, 9.0])), (100.0, 75.0, 125.0, 200.0), rtol=1e-9
    )


def test_the_poles_are_those_of_the_twin_at_rest(plan):
    modes = natural_modes(linearised(build_modal(plan.twin, 0.43 * plan.fs)), (), 0.43 * plan.fs)
    np.testing.assert_allclose(np.abs(plan.poles) / (2.0 * np.pi), modes.natural_freqs, rtol=1e-7)
    np.testing.assert_allclose(ratios_of(plan.poles), modes.damping_ratios, rtol=1e-6)


def test_rate_window_and_taps_follow_from_the_modes(plan):
    freqs = np.abs(plan.poles) / (2.0 * np.pi)
    assert freqs[MODES - 1] < FLAT_EDGE * plan.fs < 2.0 * freqs[MODES - 1]
    assert plan.window >= LEAST_PERIODS / freqs[0] * (1.0 - 1e-9)
    assert plan.taps.period > plan.window + plan.taps.width
    assert plan.taps.width == pytest.approx(1.5 / freqs[MODES - 1])
    assert plan.n_samples % plan.hop == 0


def test_what_is_asked_for_is_taken():
    plan = plan_of(REFERENCE, Wish(seconds=2.0, channels=("P8", "P2"), window=0.3, start=33.0, snr=20.0))
    assert plan.watched == (1, 7)
    assert plan.window == 0.3
    assert plan.table.own == pytest.approx(33.0, rel=1e-6)  # a tangent by differences
    loud = plan_of(REFERENCE, Wish(seconds=2.0, window=0.3, start=33.0, snr=0.0))
    np.testing.assert_allclose(loud.noise, 10.0 * plan.noise, rtol=1e-9)


def test_the_sleeve_that_varies_is_followed_before_the_one_that_carries_more():
    both = with_sleeves(clearance=0.0)
    assert plan_of(both, Wish(seconds=1.0)).sleeve == SLEEVE
    other = varying((0.0, 1.0), (80.0, 40.0), both, "sleeve 1")
    assert plan_of(other, Wish(seconds=1.0)).sleeve == "sleeve 1"
    named = plan_of(other, Wish(seconds=1.0, sleeve=SLEEVE))
    assert named.sleeve == SLEEVE
    # What varies elsewhere is known to the twin.
    assert damping_over(named.twin.contacts[0], np.array([1.0]))[0] == pytest.approx(40.0)


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        (Wish(sleeve="sleeve 1"), r"--sleeve 'sleeve 1': it is open at rest; sleeve 2 can be followed; name one"),
        (Wish(sleeve="x"), r"--sleeve 'x': the rig has no such sleeve; sleeve 2 can be followed; name one"),
        (Wish(channels=("P99",)), r"--channel 'P99'; the rig has P1, P2, .*; name one of these"),
    ],
)
def test_names_that_the_rig_has_not_are_refused(wish, message):
    with pytest.raises(InputError, match=message):
        plan_of(REFERENCE, wish)


def test_a_rig_that_rests_on_no_sleeve_is_refused():
    with pytest.raises(
        InputError, match=r"a rig with 2 sleeves, of which none touches at rest; small motion .*; place"
    ):
        plan_of(with_sleeves(clearance=5e-3), Wish())


def test_a_damping_that_is_no_number_of_newton_seconds_per_metre_is_refused():
    with pytest.raises(InputError, match=r"sleeve 2: law = 'hunt_crossley'; the damping .* in N s/m; give the sleeve"):
        plan_of(with_sleeves(law="hunt_crossley"), Wish())


def test_a_driven_base_is_refused():
    driven = REFERENCE.excitation.model_copy(update={"quantity": "base_acceleration", "position": None})
    with pytest.raises(InputError, match=r"excitation.quantity = 'base_acceleration'; a live model .*force; simulate"):
        plan_of(REFERENCE.model_copy(update={"excitation": driven}), Wish())
