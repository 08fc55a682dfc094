import numpy as np
import pytest
from chain_scenes import EI, LENGTH, LINE_MASS, REFERENCE, bare, chain_of

from models.beam.clamped_free import wave_numbers
from models.cable.port_law import RoundLaw
from models.chain.engine_call import engine_address, without_warnings
from models.chain.march import contact_force, round_force
from models.chain.mjcf import ChainSettings
from models.chain.moving import move_chain
from models.contact.kelvin_voigt import KelvinVoigt
from models.errors import DivergenceError
from models.plant import build_plant
from models.point_forces import PointForce, closed_part, compile_items, round_contacts
from models.ports import Port
from models.rig import Excitation, Sensor, Sleeve

STILL = np.zeros((3, 0))
TIP = Sensor(name="tip", position=LENGTH, quantity="displacement")


def sensed(rig):
    return build_plant(rig.model_copy(update={"sensors": (TIP,), "excitation": Excitation(position=LENGTH)}))


def swing(step, newmark, n_steps):
    """(M,) tip of a beam without damping that is let go, and its energy balance."""
    settings = ChainSettings(step, newmark, rotary_inertia=False)
    plant = sensed(bare(rayleigh_damping=(0.0, 0.0)))
    steps = move_chain(chain_of(plant, 6, settings), np.zeros(n_steps), STILL, 1, (LENGTH, 5.0))
    return steps.read[0], steps.energy


@pytest.mark.parametrize(("newmark", "order", "step"), [(0.0, 2.0, 2e-5), (1.0 / 12.0, 4.0, 2e-4)])
def test_order_in_time(newmark, order, step):
    """Leapfrog, and the beta at which its first error cancels (Fox and Goodwin)."""
    span = 1000 * step
    ends = []
    for part in (1, 2, 16):
        tip, _ = swing(step / part, newmark, round(span / step) * part + 1)
        ends.append(tip[::part])
    errors = [np.abs(end - ends[2]).max() for end in ends[:2]]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


def test_energy_of_a_free_beam_stays():
    """All of it is that of the static deflection; angles of 1e-3 change the chain's inertia by their squares."""
    _, energy = swing(1e-4, 1.0 / 12.0, 4000)
    assert np.ptp(energy.stored) < 1e-6 * energy.stored[0]
    assert energy.stored[0] == pytest.approx(0.5 * 5.0**2 * LENGTH**3 / (3.0 * EI), rel=1e-3)


def test_energy_of_a_beam_that_bounces_on_springs_stays():
    """What leaves the beam is in the sleeves' springs, and comes back."""
    tip = Sleeve(name="tip", position=1.0, clearance=1e-4, stiffness=1e5, damping=0.0)
    plant = sensed(bare(0.0, tip, rayleigh_damping=(0.0, 0.0)))
    chain = chain_of(plant, 16, ChainSettings(2e-5, 1.0 / 12.0, rotary_inertia=False))
    steps = move_chain(chain, np.zeros(20000), STILL, 1, (LENGTH, 20.0))
    assert np.abs(steps.forces).max() > 20.0
    assert steps.energy.fault < 1e-6
    free = steps.forces[0] == 0.0
    returned = steps.energy.taken[free]
    # A little stays behind where a contact begins or ends within a step.
    assert np.ptp(returned) < 1e-4 * np.ptp(steps.energy.stored)


def test_the_first_period_is_the_beams():
    tip, _ = swing(1e-4, 1.0 / 12.0, 4000)
    period = 2.0 * np.pi / (wave_numbers(1)[0] ** 2 * np.sqrt(EI / (LINE_MASS * LENGTH**4)))
    lines = np.abs(np.fft.rfft(tip * np.hanning(len(tip)), 1 << 18))
    assert np.argmax(lines) * 1e4 / (1 << 18) == pytest.approx(1.0 / period, rel=2e-3)


def test_too_long_a_step_is_one_error_that_says_what_to_change():
    chain = chain_of(build_plant(REFERENCE), 24, ChainSettings(2e-3, 1.0 / 12.0, rotary_inertia=False))
    message = (
        r"mujoco: the motion grew without bound \d\.\d{4} s after the start with steps of 0\.002 s; take more steps"
    )
    with pytest.raises(DivergenceError, match=message):
        move_chain(chain, np.ones(2000), STILL, 1)


@pytest.mark.parametrize(
    ("p", "rate"), [(1e-6, 0.3), (-1e-6, 0.3), (2e-6, -0.3), (3e-6, 0.05), (-1e-5, 0.3), (1e-5, 0.3)]
)
def test_a_contact_acts_on_the_part_of_the_step_in_which_it_is_closed(p, rate):
    h = 2e-5
    share, amid = closed_part(p, rate, h)
    way = p + rate * np.linspace(-0.5, 0.5, 200001) * h
    assert share == pytest.approx(np.mean(way > 0.0), abs=1e-4)
    assert share * amid == pytest.approx(np.mean(np.maximum(way, 0.0)), abs=1e-10)


def test_a_contact_that_would_pull_is_let_go():
    law = KelvinVoigt(1e5, 80.0)
    force = PointForce(Port(1.0), law.normal_force, law.values, contact=(1e-4, 0.0, 0.0))
    items = compile_items([force], [Port(1.0)])
    assert contact_force(items, 0, 0.0, 1e-5, 1.1e-4, -1.0) == 0.0
    assert contact_force(items, 0, 0.0, 1e-5, 1.5e-4, 0.0) == pytest.approx(-5.0)
    assert contact_force(items, 0, 0.0, 1e-5, -1.5e-4, 0.0) == pytest.approx(5.0)


def test_the_engines_functions_are_found_and_its_warnings_come_back():
    assert engine_address("mj_step1") != engine_address("mj_step2")
    with pytest.raises(ZeroDivisionError), without_warnings():
        raise ZeroDivisionError
    with without_warnings():
        pass


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, -1.3])
@pytest.mark.parametrize("clearance", [1e-4, 0.0])
def test_a_round_contact_is_the_plane_one_along_the_radius(angle, clearance):
    law = KelvinVoigt(1e5, 80.0)
    plain = PointForce(
        Port(1.0), law.normal_force, law.values, contact=(clearance, 2e-5, 0.0), bilateral=clearance == 0
    )
    (force,) = round_contacts([plain])
    items = compile_items([force], [Port(1.0), Port(1.0, across=True)])
    cable = RoundLaw(force, 1e-5)
    r, speed, up, aside = 1.6e-4, 0.01, np.cos(angle), np.sin(angle)
    radial = contact_force(items, 0, 0.0, 1e-5, 2e-5 + r, speed)
    found = round_force(items, 0, 0.0, 1e-5, 2e-5 + r * up, r * aside, speed * up, speed * aside)
    assert found == pytest.approx((radial * up, radial * aside), rel=1e-9)
    assert cable(0.0, (2e-5 + r * up, r * aside), (speed * up, speed * aside)) == pytest.approx(found, rel=1e-9)
    assert radial < 0.0


def test_a_round_contact_knows_a_way_out_of_its_centre():
    law = KelvinVoigt(1e5, 80.0)
    plain = PointForce(Port(1.0), law.normal_force, law.values, contact=(0.0, 0.0, 0.0), bilateral=True)
    (force,) = round_contacts([plain])
    items = compile_items([force], [Port(1.0), Port(1.0, across=True)])
    assert round_force(items, 0, 0.0, 1e-5, 0.0, 0.0, 0.0, 0.2) == pytest.approx((0.0, -80.0 * 0.2))
    assert round_force(items, 0, 0.0, 1e-5, 0.0, 0.0, 0.0, 0.0) == (0.0, 0.0)
    assert RoundLaw(force, 1e-5)(0.0, (0.0, 0.0), (0.0, 0.2)) == pytest.approx((0.0, -80.0 * 0.2))
