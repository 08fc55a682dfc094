"""The GLB holds what moves: keys for every stretch of the beam, in the units and the order of the format."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.plant import build_plant
from models.rig_file import read_rig
from testbed.film.glb import moving_glb
from testbed.film.take import Take

PLANT = build_plant(read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml"))
LENGTH = PLANT.structure.length
X = np.linspace(0.0, LENGTH, 11)
TIME = np.linspace(1.0, 1.1, 30)
N, SECONDS, MAGNIFIED = 12, 6.0, 50.0
SHAPE = np.outer((X / LENGTH) ** 2, 1e-3 * np.sin(2.0 * np.pi * TIME / 0.1))
TAKE = Take(PLANT, X, TIME, SHAPE, TIME, np.zeros((2, len(TIME))))


@pytest.fixture(scope="module")
def parts():
    data = moving_glb(TAKE, N, SECONDS, MAGNIFIED)
    magic, version, total = struct.unpack("<4sII", data[:12])
    assert (magic, version, total) == (b"glTF", 2, len(data))
    size = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def values(parts, accessor):
    tree, binary = parts
    about = tree["accessors"][accessor]
    view = tree["bufferViews"][about["bufferView"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[about["type"]]
    row = np.frombuffer(binary, "<f4", about["count"] * width, view["byteOffset"])
    return row.reshape(-1, width)


def keys_of(parts, name, path):
    tree, _ = parts
    number = next(i for i, node in enumerate(tree["nodes"]) if node.get("name") == name)
    (animation,) = tree["animations"]
    channel = next(c for c in animation["channels"] if c["target"] == {"node": number, "path": path})
    sampler = animation["samplers"][channel["sampler"]]
    return values(parts, sampler["input"])[:, 0], values(parts, sampler["output"])


def test_every_stretch_has_its_keys(parts):
    tree, _ = parts
    assert len(tree["animations"][0]["channels"]) == 3 * (len(X) - 1)
    moved = {channel["target"]["node"] for channel in tree["animations"][0]["channels"]}
    assert all("matrix" not in tree["nodes"][number] for number in moved)
    assert len({tree["nodes"][number]["mesh"] for number in moved}) == 1


def test_stretches_begin_where_the_beam_is_and_reach_the_next_point(parts):
    _, shapes = TAKE.frames(N)
    for i in (0, 4, len(X) - 2):
        time, place = keys_of(parts, f"stretch {i + 1} (beam)", "translation")
        assert time == pytest.approx(np.linspace(0.0, SECONDS, N))
        assert place[:, 0] == pytest.approx(np.full(N, X[i]), abs=1e-6)
        assert place[:, 1] == pytest.approx(MAGNIFIED * shapes[:, i], abs=1e-6)
        _, turn = keys_of(parts, f"stretch {i + 1} (beam)", "rotation")
        _, scale = keys_of(parts, f"stretch {i + 1} (beam)", "scale")
        assert np.linalg.norm(turn, axis=1) == pytest.approx(np.ones(N), abs=1e-6)
        angle = 2.0 * np.arctan2(turn[:, 2], turn[:, 3])
        end = place + scale[:, :1] * np.stack([np.cos(angle), np.sin(angle), np.zeros(N)], axis=1)
        assert end[:, 0] == pytest.approx(np.full(N, X[i + 1]), abs=1e-6)
        assert end[:, 1] == pytest.approx(MAGNIFIED * shapes[:, i + 1], abs=1e-6)


def test_a_rig_that_nobody_plays_stands_as_it_begins(parts):
    tree, _ = parts
    for node in tree["nodes"]:
        if "(beam)" in node.get("name", ""):
            for path in ("translation", "rotation", "scale"):
                assert node[path] == pytest.approx(keys_of(parts, node["name"], path)[1][0].tolist(), abs=1e-6)


def test_surfaces_are_not_mirrors_and_have_normals(parts):
    tree, _ = parts
    assert all(m["pbrMetallicRoughness"]["metallicFactor"] < 0.5 for m in tree["materials"])
    for mesh in tree["meshes"]:
        (primitive,) = mesh["primitives"]
        assert {"POSITION", "NORMAL"} <= set(primitive["attributes"])
        assert "material" in primitive


def test_keys_carry_their_range_as_the_format_asks(parts):
    tree, _ = parts
    for sampler in tree["animations"][0]["samplers"]:
        for accessor in sampler.values():
            if isinstance(accessor, int):
                about, held = tree["accessors"][accessor], values(parts, accessor)
                assert about["min"] == pytest.approx(held.min(axis=0).tolist())
                assert about["max"] == pytest.approx(held.max(axis=0).tolist())


def test_sleeves_stand_where_they_are_with_their_gap_magnified_alike(parts):
    tree, _ = parts
    for contact in PLANT.contacts:
        (node,) = [node for node in tree["nodes"] if node.get("name") == contact.sleeve]
        assert node["matrix"][12] == pytest.approx(contact.position)
        primitive = tree["meshes"][node["mesh"]]["primitives"][0]
        corners = values(parts, primitive["attributes"]["POSITION"])
        inner = np.hypot(corners[:, 1], corners[:, 2]).min()
        drawn = 0.006 * LENGTH
        assert inner == pytest.approx(drawn + MAGNIFIED * contact.clearance, rel=1e-5)


def test_a_rig_without_sleeves_is_drawn_too():
    bare = replace(TAKE, plant=replace(PLANT, contacts=()), contact_forces=np.zeros((0, len(TIME))))
    assert moving_glb(bare, N, SECONDS, MAGNIFIED)[:4] == b"glTF"
