import numpy as np
import pytest
from chain_scenes import EI, LENGTH, LINE_MASS, REFERENCE, STATIC, bare, chain_of, flexibility, with_ports

from models.beam.clamped_free import wave_numbers
from models.chain.mjcf import ChainSettings
from models.plant import build_plant
from models.rig import Sleeve


def closed_form(n):
    return wave_numbers(n) ** 2 * np.sqrt(EI / (LINE_MASS * LENGTH**4)) / (2.0 * np.pi)


def test_natural_frequencies_of_the_free_beam_converge_with_fourth_order():
    """The waves' own share of the error is -(k h)^4 / 1440, the rest, of the same order and sign, is the ends'."""
    plant, expected = build_plant(bare()), closed_form(4)
    errors = np.array([chain_of(plant, n).natural_freqs(4) / expected - 1.0 for n in (40, 80)])
    np.testing.assert_allclose(np.log2(np.abs(errors[0] / errors[1]))[1:], 4.0, atol=0.4)
    of_waves = errors[0] / (-((wave_numbers(4) / 40) ** 4) / 1440.0)
    assert np.all((of_waves[1:] > 1.0) & (of_waves[1:] < 2.5))


def test_sixteen_segments_already_give_four_frequencies_within_a_twentieth_per_mille():
    np.testing.assert_allclose(chain_of(build_plant(bare()), 16).natural_freqs(4), closed_form(4), rtol=5e-5)


def test_rotary_inertia_lowers_frequencies_as_rayleigh_says():
    """Relative change -(k r)^2 F / 2 with r = d / 4, where F = (phi', phi') / k^2 is near 1 for high modes."""
    plant = build_plant(bare())
    thin, thick = (
        chain_of(plant, 60, ChainSettings(1e-4, 0.0, rotary_inertia=rotary)).natural_freqs(6)[-1]
        for rotary in (False, True)
    )
    expected = -((wave_numbers(6)[-1] / LENGTH * REFERENCE.structure.diameter / 4.0) ** 2) / 2.0
    assert thick / thin - 1.0 == pytest.approx(expected, rel=0.15)


def test_flexibility_between_ports_is_reciprocal_and_that_of_the_beam():
    """Between two places it is exact; at one place a force bends within a segment what the chain bends at hinges."""
    at = np.array([0.45, 0.8, 1.2, LENGTH])
    chain = chain_of(with_ports(bare(), *at), 16)
    found = chain.rows @ np.linalg.solve(chain.tangent, chain.rows.T)
    np.testing.assert_allclose(found, found.T, rtol=1e-13)
    expected = flexibility(at)
    apart = ~np.eye(len(at), dtype=bool)
    np.testing.assert_allclose(found[apart], expected[apart], rtol=1e-12)
    np.testing.assert_allclose(np.diag(found), np.diag(expected), rtol=1e-3)


def test_the_free_beam_sags_as_beam_theory_says():
    """Gravity is a hundredth, so that the sag stays small beside the length; the rest is the mesh's, order 4."""
    gravity, tip = 0.0981, Sleeve(name="tip", position=LENGTH, clearance=1.0, stiffness=1e5, damping=0.0)
    expected = -LINE_MASS * gravity * LENGTH**4 / (8.0 * EI)
    plant = build_plant(bare(gravity, tip))
    errors = [abs(float(chain_of(plant, n).port_rest[0]) / expected - 1.0) for n in (16, 32)]
    assert errors[1] < 1e-6
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.8)


def test_a_sleeve_carries_what_its_spring_says():
    """Under a beam held up by a stiff spring at the tip: q = k p, and the rest of the weight goes into the clamp."""
    tip = Sleeve(name="tip", position=LENGTH, clearance=1e-4, stiffness=2e5, damping=0.0)
    chain = chain_of(build_plant(bare(9.81, tip)), 24)
    sag, give = LINE_MASS * 9.81 * LENGTH**4 / (8.0 * EI), LENGTH**3 / (3.0 * EI)
    expected = -(1e-4 + (sag - 1e-4) / (1.0 + 2e5 * give))
    assert chain.port_rest[0] == pytest.approx(expected, rel=1e-4)


def test_rest_is_rest():
    """At rest no coordinate is pushed: residual torques are beyond the twelfth digit of what gravity asks for."""
    import mujoco

    from models.chain.rig_chain import spring_stiffness
    from models.equilibrium import forces_at

    chain = chain_of(build_plant(REFERENCE), 24, STATIC)
    data = mujoco.MjData(chain.model)
    data.qpos[:] = chain.rest
    mujoco.mj_forward(chain.model, data)
    push = forces_at(chain.port_rest, chain.ports, chain.forces) @ chain.rows
    left = push - data.qfrc_bias - spring_stiffness(chain.model) * chain.rest
    assert np.abs(left).max() < 1e-9 * np.abs(data.qfrc_bias).max()
