import mujoco
import numpy as np
import pytest
from chain_scenes import EI, LENGTH, REFERENCE, STATIC, chain_of
from scipy.linalg import eigh

from models.chain.mjcf import SLEEVE_DENSITY, build_spec, to_xml
from models.chain.sleeve_mesh import SECTIONS, WALL, WIDTH, sleeve_mesh
from models.plant import build_plant


@pytest.fixture(scope="module")
def chain():
    return chain_of(build_plant(REFERENCE), 24)


@pytest.fixture(scope="module")
def xml(chain):
    return to_xml(build_spec(chain.plant, chain.segments, STATIC))


def free_freqs(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    stiffness = np.diag(np.array(model.jnt_stiffness, float).reshape(model.njnt, -1)[:, 0])
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True)[:4]) / (2.0 * np.pi)


def test_the_saved_file_loads_again_with_the_same_frequencies(chain, xml):
    """To the six digits that the engine writes."""
    loaded = mujoco.MjModel.from_xml_string(xml)
    np.testing.assert_allclose(free_freqs(loaded), free_freqs(chain.model), rtol=1e-6)


def test_the_saved_file_has_words_and_names(xml):
    assert "<!-- A cantilever" in xml
    assert 'name="hinge 24"' in xml
    assert 'name="sleeve 2"' in xml


def test_the_beam_weighs_what_it_weighs(chain):
    """All but the clamp's half segment, which never moves."""
    beam = sum(chain.model.body(f"segment {i + 1}").mass[0] for i in range(24))
    structure = chain.plant.structure
    assert beam == pytest.approx(structure.line_mass * LENGTH * (1.0 - 0.5 / 24), rel=1e-12)
    assert chain.model.jnt_stiffness.ravel()[0] == pytest.approx(EI * 24 / LENGTH)


def test_the_sleeves_mesh_has_the_volume_and_inertia_of_its_ring():
    """A ring of a regular polygon: the circle's area times (n / 2 pi) sin(2 pi / n), at n = 96 a share of 0.9993."""
    inner = 0.0102
    ring = sleeve_mesh(inner)
    outer, width = inner * (1.0 + WALL), inner * WIDTH
    angle = 2.0 * np.pi / SECTIONS
    share = np.sin(angle) / angle
    volume = np.pi * (outer**2 - inner**2) * width * share
    assert ring.is_watertight
    assert ring.volume == pytest.approx(volume, rel=1e-9)
    polar = share * (2.0 + np.cos(angle)) / 3.0 * np.pi / 2.0 * (outer**4 - inner**4) * width
    across = 0.5 * polar + volume * width**2 / 12.0
    np.testing.assert_allclose(np.linalg.eigvalsh(ring.moment_inertia), sorted([across, across, polar]), rtol=1e-9)
    np.testing.assert_allclose(ring.moment_inertia[0, 0], polar, rtol=1e-9)


def test_the_engine_has_the_sleeves_mass_and_inertia(chain):
    structure = chain.plant.structure
    ring = sleeve_mesh(structure.diameter / 2 + chain.plant.contacts[0].clearance)
    body = chain.model.body("sleeve 1")
    assert body.mass[0] == pytest.approx(SLEEVE_DENSITY * ring.volume, rel=1e-5)
    expected = SLEEVE_DENSITY * np.linalg.eigvalsh(ring.moment_inertia)
    np.testing.assert_allclose(np.sort(body.inertia), expected, rtol=1e-5)


def test_as_many_segments_as_a_command_takes_are_bodies_that_may_be():
    """Of short ones a fixed moment about the beam's axis would be more than those about the others allow."""
    model = chain_of(build_plant(REFERENCE), 1000).model
    about, *across = np.sort(model.body_inertia[2], axis=0)[::-1]
    assert 0.0 < about <= sum(across) * (1.0 + 1e-9)
