"""Every contact law of the folder: closed forms, limits, and what all of them keep."""

import ctypes
import importlib
import inspect
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import models.contact
from models.contact import CONTACT_LAWS
from models.contact.dissipating import Dissipating
from models.contact.hertz import Hertz
from models.contact.hunt_crossley import HuntCrossley
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.protocol import ContactLaw
from models.contact.time_varying import TimeVarying
from models.law import law_address

NOT_FOR_A_RIG_FILE = {
    "time_varying",  # its table comes from the effect time_varying_damping
    "dissipating",  # its numbers come from the study of contact laws
}
LAWS = {
    "kelvin_voigt": KelvinVoigt(1e5, 80.0),
    "hunt_crossley": HuntCrossley(1e5, 2.0),
    "hertz": Hertz(1e7, 80.0),
    "dissipating": Dissipating(1e7, 2.0),
    "time_varying": TimeVarying(1e5, (1.0, 2.0, 4.0), (80.0, 20.0, 40.0)),
}
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


def normal(law, p, p_rate, t=0.0):
    return law.normal_force(t, p, p_rate, 0.0, law.values)


def test_the_registry_holds_every_file_that_a_rig_file_can_name():
    files = {file.stem for file in Path(models.contact.__file__).parent.glob("*.py")} - {"__init__", "protocol"}
    assert set(CONTACT_LAWS) | NOT_FOR_A_RIG_FILE == files == set(LAWS)
    assert not set(CONTACT_LAWS) & NOT_FOR_A_RIG_FILE


@pytest.mark.parametrize("name", LAWS)
def test_name_key_and_file_are_one(name):
    cls = type(LAWS[name])
    assert cls.name == name
    assert cls is getattr(importlib.import_module(f"models.contact.{name}"), name.title().replace("_", ""))
    assert name not in CONTACT_LAWS or CONTACT_LAWS[name] is cls
    assert len(cls.source) > 20
    assert inspect.getdoc(cls) != inspect.getdoc(ContactLaw)


@every_law
def test_a_law_that_says_so_is_straight(law):
    instants = ((0.0, 1e-5, 0.0), (1.0, 2e-4, 0.3), (3.0, 1e-6, -1.0), (5.0, 4e-4, 0.1))
    forces = np.array([normal(law, p, p_rate, t) for t, p, p_rate in instants])
    motion = np.array(instants)[:, 1:]
    nearest = np.linalg.lstsq(motion, forces, rcond=None)[0]
    if law.straight is None:
        assert np.abs(motion @ nearest - forces).max() > 1e-3 * np.abs(forces).max()
    else:
        assert motion @ np.array(law.straight) == pytest.approx(forces, rel=1e-14)


def test_kelvin_and_voigts_law_is_straight_and_none_that_derives_from_it_with_a_force_of_its_own():
    class Stiffening(KelvinVoigt):
        @staticmethod
        def normal_force(t, p, p_rate, z, c):
            return c[0] * p * p * p + c[1] * p_rate

    class Doubled(KelvinVoigt):
        @property
        def values(self):
            return 2.0 * self.stiffness, self.damping

    assert KelvinVoigt(1e5, 80.0).straight == (1e5, 80.0)
    assert Stiffening(1e5, 80.0).straight is None
    assert Doubled(1e5, 80.0).straight == (2e5, 80.0)


@every_law
def test_the_spring_is_the_given_stiffness_and_pushes(law):
    assert law.elastic(1e-4) == pytest.approx(10.0)
    assert normal(law, 0.0, 0.0) == 0.0
    assert normal(law.stiffer(1.5), 1e-4, 0.0) == pytest.approx(15.0)


@every_law
def test_stiffer_changes_nothing_else(law):
    assert law.stiffer(2.0).stiffer(0.5) == law
    assert type(law.stiffer(2.0)) is type(law)


@every_law
@given(p=st.floats(0.0, 1e-3), p_rate=st.floats(-0.5, 0.5), t=st.floats(0.0, 6.0))
def test_the_part_that_depends_on_speed_only_takes_energy(law, p, p_rate, t):
    assert (normal(law, p, p_rate, t) - normal(law, p, 0.0, t)) * p_rate >= 0.0


@every_law
def test_the_compiled_law_is_the_python_law(law):
    real = ctypes.c_double
    call = ctypes.CFUNCTYPE(real, real, real, real, real, ctypes.POINTER(real))(law_address(law.normal_force))
    rng = np.random.default_rng(3)
    for t, p, p_rate in rng.uniform((-1.0, 0.0, -0.5), (6.0, 1e-3, 0.5), (50, 3)):
        values = (real * len(law.values))(*law.values)
        assert call(t, p, p_rate, 0.0, values) == pytest.approx(normal(law, p, p_rate, t), rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_a_sleeve_gives_stiffness_and_damping(name):
    law = type(LAWS[name]).from_sleeve(2e5, 3.0)
    spring = 2e5 * 1e-4 ** (1.5 if name == "hertz" else 1.0)
    assert law.elastic(1e-4) == pytest.approx(spring)
    expected = {"hunt_crossley": 1.5 * 3.0 * spring, "dissipating": 3.0 * spring}.get(name, 3.0)
    assert law.damping_at(1e-4, 0.2) == pytest.approx(expected)


def impact(law, speed, mass=1.0):
    """Share of its speed that a mass gets back from a wall which cannot pull."""

    def motion(t, state):
        p, p_rate = state
        return p_rate, -max(0.0, normal(law, p, p_rate)) / mass

    def leaves(t, state):
        return state[0] if t > 0.0 else 1.0

    leaves.terminal, leaves.direction = True, -1.0
    contact_time = pi * sqrt(mass / law.stiffness)
    end = solve_ivp(motion, (0.0, 4 * contact_time), (0.0, speed), events=leaves, rtol=1e-10, atol=1e-14,
                    max_step=contact_time / 200)  # fmt: skip
    return -end.y[1, -1] / speed


def test_an_elastic_impact_gives_all_back():
    for law in (KelvinVoigt(1e5, 0.0), HuntCrossley(1e5, 0.0)):
        assert impact(law, 0.1) == pytest.approx(1.0, rel=1e-6)  # the integrator


def test_restitution_of_the_spring_and_dashpot_that_never_pulls():
    """With z = c / (2 sqrt(k m)): the force is 0 where tan(omega_d t) = -2 z sqrt(1 - z^2) / (1 - 2 z^2), at the speed
    exp(-z omega t) times the first, which then stays.
    """
    z = 0.2
    damped = sqrt(1.0 - z * z)
    law = KelvinVoigt(1e5, 2.0 * z * sqrt(1e5))
    angle = np.arctan2(2.0 * z * damped, 2.0 * z * z - 1.0)
    assert impact(law, 0.1) == pytest.approx(exp(-z * angle / damped), rel=1e-5)  # steps end beside the kink


def test_restitution_of_hunt_crossley_falls_with_the_impact_speed():
    """Hunt and Crossley's e = 1 - alpha v for small alpha v; the next order is about (alpha v)^2."""
    for speed in (0.01, 0.02):
        assert 1.0 - impact(HuntCrossley(1e5, 2.0), speed) == pytest.approx(2.0 * speed, rel=2.0 * speed)


def test_hunt_crossley_starts_at_zero_where_the_dashpot_jumps():
    assert normal(HuntCrossley(1e5, 2.0), 0.0, 0.3) == 0.0
    assert normal(KelvinVoigt(1e5, 80.0), 0.0, 0.3) == pytest.approx(24.0)


@pytest.mark.parametrize(
    ("t", "damping"), [(0.0, 80.0), (1.0, 80.0), (1.5, 50.0), (2.0, 20.0), (3.0, 30.0), (7.0, 40.0)]
)
def test_the_table_is_straight_between_its_knots_and_constant_outside(t, damping):
    assert normal(LAWS["time_varying"], 1e-4, 0.1, t) == pytest.approx(10.0 + 0.1 * damping)
