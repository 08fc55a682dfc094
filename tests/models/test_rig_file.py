"""The rig's file: what is written is read back, and a file that cannot be read or written says so."""

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.rig import Beam, EffectEntry, Excitation, Oscillator, Rig, Sensor, Sleeve
from models.rig_file import read_rig, write_rig

REFERENCE = Path(__file__).parents[1] / "data" / "reference_rig.toml"
OSCILLATOR_TOML = '[structure]\nkind = "oscillator"\nmass = 1.0\nstiffness = 2.0\ndamping = 0.1\n'


@pytest.fixture
def reference():
    return read_rig(REFERENCE)


def test_the_reference_rig_is_read_as_its_owner_describes_it(reference):
    assert reference.structure == Beam(
        kind="beam",
        length=1.469,
        diameter=0.02,
        youngs_modulus=210e9,
        density=7850.0,
        rayleigh_damping=(1.2, 6e-6),
        gravity=9.81,
    )
    assert [sleeve.position for sleeve in reference.sleeves] == [0.45, 1.0]
    assert reference.sleeve("sleeve 2") == Sleeve(
        name="sleeve 2", position=1.0, clearance=1.5e-4, law="kelvin_voigt", stiffness=1e5, damping=80.0
    )
    assert reference.excitation == Excitation(name="shaker", node=100, position=1.30, quantity="force")
    assert [s.position for s in reference.sensors] == [0.15, 0.3, 0.45, 0.65, 0.83, 1.0, 1.2, 1.44]
    assert reference.effects == ()
    assert len(reference.parameters()) == 9


def test_a_byte_order_mark_and_windows_line_ends_are_read(tmp_path, reference):
    path = tmp_path / "rig.toml"
    path.write_bytes(b"\xef\xbb\xbf" + REFERENCE.read_bytes().replace(b"\n", b"\r\n"))
    assert read_rig(path) == reference


def test_the_three_parts_stand_apart(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(OSCILLATOR_TOML.replace("1.0", "-1.0"))
    with pytest.raises(InputError) as caught:
        read_rig(path)
    parts = caught.value
    assert (parts.given, parts.expected) == ("rig.toml: structure.mass = -1.0 kg", "a mass is above 0")
    assert parts.mend == "weigh what moves"


def test_a_path_that_is_no_file_is_named_whole(tmp_path):
    with pytest.raises(InputError) as caught:
        read_rig(tmp_path / "none.toml")
    assert str(caught.value) == f"{tmp_path / 'none.toml'} does not exist; a rig is a TOML file; correct the path"
    with pytest.raises(InputError) as caught:
        read_rig(tmp_path)
    assert str(caught.value) == f"{tmp_path} is a directory; a rig is a TOML file; name the file inside it"


def test_a_file_that_cannot_be_opened_says_why(tmp_path, monkeypatch):
    def refuse(_path):
        raise PermissionError(13, "Permission denied")

    path = tmp_path / "rig.toml"
    path.write_text(OSCILLATOR_TOML)
    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(InputError, match="Permission denied; a rig file can be read; correct its permissions"):
        read_rig(path)


def test_without_a_model_file_everything_is_written_out(tmp_path):
    write_rig(Rig(structure=Oscillator(kind="oscillator", mass=1, stiffness=2, damping=0.1)), tmp_path / "rig.toml")
    assert (tmp_path / "rig.toml").read_text() == OSCILLATOR_TOML + "gravity = 0.0\n"


def test_a_rig_that_could_not_be_read_back_is_not_written(tmp_path, reference):
    target = tmp_path / "rig.updated.toml"
    with pytest.raises(InputError) as caught:
        write_rig(reference.with_values({"sleeves[0].clearance": -1e-5}), target, like=REFERENCE)
    assert str(caught.value).startswith("rig.updated.toml: sleeves[0].clearance = -1e-05 m; a clearance is 0 or more; ")
    assert list(tmp_path.iterdir()) == []


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, reference):
    def full(_self, _target):
        raise OSError(28, "No space left on device")

    target = tmp_path / "rig.toml"
    target.write_text("old")
    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(InputError, match="cannot be written: No space left on device; a rig is written into"):
        write_rig(reference, target)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("rig.toml", "old")]


def test_a_folder_that_is_missing_or_in_the_way_is_an_input_error(tmp_path, reference):
    for target in (tmp_path / "none" / "rig.toml", tmp_path):
        with pytest.raises(InputError, match="create the folder or choose another path"):
            write_rig(reference, target)
    assert list(tmp_path.iterdir()) == []


def test_the_model_file_must_be_there(tmp_path, reference):
    with pytest.raises(InputError, match=r"none\.toml does not exist"):
        write_rig(reference, tmp_path / "rig.toml", like=tmp_path / "none.toml")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no permission bits and needs a privilege for links")
def test_permissions_and_a_link_survive_the_replacement(tmp_path, reference):
    target, link = tmp_path / "rig.toml", tmp_path / "link.toml"
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(target)
    write_rig(reference, link)
    assert link.is_symlink()
    assert read_rig(target) == reference
    assert target.stat().st_mode & 0o777 == 0o640


names = st.text(st.characters(codec="utf-8"), min_size=1, max_size=8).filter(
    lambda s: s.isprintable() and s == s.strip()
)
positive = st.floats(min_value=0.0, exclude_min=True, allow_infinity=False)
non_negative = st.floats(min_value=0.0, allow_infinity=False)
finite = st.floats(allow_nan=False, allow_infinity=False)
sensitivities = st.sampled_from(["100 mV/g", "2.25e-3 V/N"])
setting = st.one_of(finite, st.integers(-(2**53), 2**53), st.booleans(), names, st.lists(finite, max_size=3))
keys = st.sampled_from(["damping", "times", "against", "a-b", "dotted.key", "ü", ""])


@st.composite
def structures(draw):
    if draw(st.booleans()):
        numbers = {key: draw(positive) for key in ("length", "diameter", "youngs_modulus", "density")}
        eta = draw(st.tuples(non_negative, non_negative))
        return Beam(kind="beam", **numbers, rayleigh_damping=eta, gravity=draw(finite))
    stiffness, damping = draw(non_negative), draw(non_negative)
    return Oscillator(
        kind="oscillator", mass=draw(positive), stiffness=stiffness, damping=damping, gravity=draw(finite)
    )


@st.composite
def rigs(draw):
    structure = draw(structures())
    is_beam = structure.kind == "beam"
    along = st.floats(0.0, structure.length, exclude_min=True) if is_beam else st.none()
    sleeve_names = draw(st.lists(names, max_size=3, unique=True)) if is_beam else []
    sensor_names = draw(st.lists(names, max_size=3, unique=True))
    nodes = draw(st.lists(st.integers(0, 9999), min_size=len(sensor_names), max_size=len(sensor_names), unique=True))
    quantity = draw(st.sampled_from(["force", "base_acceleration", "base_velocity", "base_displacement"]))
    uncertain = list(structure.uncertain) + (["sleeves.clearance", "sleeves.damping"] if is_beam else [])
    places = [{}, *({"sleeve": name} for name in sleeve_names), *({"sensor": name} for name in sensor_names)]
    return Rig(
        structure=structure,
        tolerances=draw(st.dictionaries(st.sampled_from(uncertain), st.floats(0.0, 1.0, exclude_min=True))),
        sleeves=[
            Sleeve(
                name=name,
                position=draw(along),
                clearance=draw(non_negative),
                stiffness=draw(positive),
                damping=draw(non_negative),
            )
            for name in sleeve_names
        ],
        excitation=Excitation(
            name=draw(names),
            node=draw(st.none() | st.integers(0, 9999)),
            position=draw(along) if quantity == "force" else None,
            quantity=quantity,
            sensitivity=draw(st.none() | sensitivities),
        ),
        sensors=[
            Sensor(name=name, node=node, position=draw(along), sensitivity=draw(st.none() | sensitivities))
            for name, node in zip(sensor_names, nodes, strict=True)
        ],
        effects=[
            EffectEntry(kind=draw(names), **draw(st.sampled_from(places)), **draw(st.dictionaries(keys, setting)))
            for _ in range(draw(st.integers(0, 3)))
        ],
    )


@given(rig=rigs())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
def test_what_is_written_is_read(tmp_path, rig):
    write_rig(rig, tmp_path / "rig.toml")
    assert read_rig(tmp_path / "rig.toml") == rig


@given(old=rigs(), new=rigs())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
def test_any_rig_can_be_written_like_any_other(tmp_path, old, new):
    write_rig(old, tmp_path / "old.toml")
    write_rig(new, tmp_path / "new.toml", like=tmp_path / "old.toml")
    assert read_rig(tmp_path / "new.toml") == new
