import numpy as np
import pytest

from models.cable.port_law import PortLaw
from models.chain.march import contact_force
from models.contact.hunt_crossley import HuntCrossley
from models.contact.kelvin_voigt import KelvinVoigt
from models.point_forces import PointForce, compile_items
from models.ports import Port

PORT = Port(1.0)


def contact(law, clearance=1e-4, offset=0.0, growth=0.0, *, bilateral=False):
    return PointForce(PORT, law.normal_force, law.values, contact=(clearance, offset, growth), bilateral=bilateral)


@pytest.mark.parametrize(
    "force",
    [
        contact(KelvinVoigt(1e5, 80.0)),
        contact(KelvinVoigt(1e5, 80.0), offset=3e-5),
        contact(KelvinVoigt(1e5, 80.0), growth=1e-3),
        contact(HuntCrossley(1e5, 2.0)),
        contact(KelvinVoigt(1e5, 80.0), 0.0, bilateral=True),
    ],
)
def test_a_contact_is_the_same_to_cable_and_chain(force):
    items, law = compile_items([force], [PORT]), PortLaw([force], 5e-5)
    for t, q, v in np.random.default_rng(1).uniform([0.0, -2e-4, -0.5], [0.1, 2e-4, 0.5], (200, 3)).tolist():
        assert law(t, q, v) == pytest.approx(contact_force(items, 0, t, 5e-5, q, v), rel=1e-12, abs=1e-12)


def test_a_contact_grows_steadily_as_it_closes():
    """A dashpot alone would jump by 16 N where the penetration passes 0 at 0.2 m/s."""
    law = PortLaw([contact(KelvinVoigt(1e5, 80.0))], 5e-5)
    forces = [law(0.0, 1e-4 + p, 0.2) for p in np.linspace(-6e-6, 6e-6, 1201)]
    assert np.abs(np.diff(forces)).max() < 0.1
    assert forces[0] == 0.0
    assert forces[-1] < -16.0


def test_a_state_follows_its_rate_with_second_order():
    """dz/dt = (v - z) / T under v = sin t, started at rest."""
    exact = lambda t: (np.sin(t) - 0.1 * np.cos(t) + 0.1 * np.exp(-t / 0.1)) / 1.01  # noqa: E731
    slow = PointForce(PORT, lambda t, q, v, z, p: -z, (0.1,), rate=lambda t, q, v, z, p: (v - z) / p[0])
    errors = []
    for n in (40, 80):
        law, worst = PortLaw([slow], 2.0 / n), 0.0
        for t in (np.arange(n) + 1) * 2.0 / n:
            assert law.has_states
            worst = max(worst, abs(law(t, 0.0, np.sin(t)) + exact(t)))
            law.settle()
        errors.append(worst)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)


def test_asking_twice_within_a_step_changes_nothing():
    slow = PointForce(PORT, lambda t, q, v, z, p: -z, (0.1,), rate=lambda t, q, v, z, p: (v - z) / p[0])
    law = PortLaw([slow], 0.1)
    once = law(0.1, 0.0, 1.0)
    law(0.1, 0.0, 5.0)
    assert law(0.1, 0.0, 1.0) == once
    law.begin()
    assert law(0.1, 0.0, 1.0) == once
