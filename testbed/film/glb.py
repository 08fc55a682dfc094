"""A moving rig as one GLB file: stretches of the beam as cylinders that go from key to key, sleeves around it.

Source: Khronos, glTF 2.0 specification, sections 3.11 (animations) and 5 (properties).
"""

from collections import OrderedDict
from functools import partial
from math import floor, log10
from typing import Any

import numpy as np
import trimesh
from trimesh.transformations import translation_matrix
from trimesh.visual.material import PBRMaterial

from models.arrays import FloatArray
from models.chain.sleeve_mesh import sleeve_mesh
from testbed.film.take import Take

FLOAT, SCALAR, ARRAY = 5126, "SCALAR", {3: "VEC3", 4: "VEC4"}
STEEL, BRASS, STONE = (0.25, 0.4, 0.65, 1.0), (0.8, 0.55, 0.2, 0.45), (0.5, 0.5, 0.5, 1.0)
METALLIC, ROUGH = 0.1, 0.6
"""Of all surfaces: full metal, the format's default, is black where a viewer has no surroundings to mirror."""

RADIUS = 0.006
"""Drawn radius of the beam, as a share of its length: a magnified gap has no true size beside a true radius."""

SHARE_OF_LENGTH = 0.12
"""Of the beam's length, to which its largest deflection is magnified where nobody chose a factor."""


def magnification(deflection: FloatArray, length: float) -> float:
    """A round factor that makes a deflection plain to see beside the length of the beam.

    Args:
        deflection: m, of any shape.
        length: m.
    """
    wanted = SHARE_OF_LENGTH * length / max(float(np.abs(deflection).max()), 1e-12)
    decade = 10.0 ** floor(log10(wanted))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted))


def moving_glb(take: Take, n: int, seconds: float, magnified: float) -> bytes:
    """The file.

    Args:
        take: what moves.
        n: keys.
        seconds: that the film takes.
        magnified: factor on deflections and gaps; lengths along the beam are true.
    """
    _, shapes = take.frames(n)
    keys = [_pose(take.x, magnified * shape) for shape in shapes]
    names = [f"stretch {i + 1} (beam)" for i in range(len(take.x) - 1)]
    channels = {
        name: {
            "translation": np.array([place[i] for place, _, _ in keys]),
            "rotation": np.array([turn[i] for _, turn, _ in keys]),
            "scale": np.array([[long[i], 1.0, 1.0] for _, _, long in keys]),
        }
        for i, name in enumerate(names)
    }
    clock = np.linspace(0.0, seconds, n)
    animate = partial(_animate, clock=clock, channels=channels)
    scene = _scene(take, names, magnified)
    return bytes(trimesh.exchange.gltf.export_glb(scene, include_normals=True, buffer_postprocessor=animate))


def _pose(x: FloatArray, height: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(m, 3) starts, (m, 4) quaternions and (m,) lengths of the stretches between points; y is up in the file."""
    run, rise = np.diff(x), np.diff(height)
    half = 0.5 * np.arctan2(rise, run)
    none = np.zeros_like(half)
    starts = np.stack([x[:-1], height[:-1], none], axis=1)
    return starts, np.stack([none, none, np.sin(half), np.cos(half)], axis=1), np.hypot(run, rise)


def _scene(take: Take, names: list[str], magnified: float) -> Any:
    length = take.plant.structure.length
    radius = RADIUS * length
    rod = trimesh.creation.cylinder(radius=radius, segment=[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], sections=24)
    rod.visual = _surface(STEEL)
    scene = trimesh.Scene()
    scene.geometry["beam"] = rod
    for name in names:
        scene.graph.update(frame_to=name, matrix=np.eye(4), geometry="beam")
    wall = trimesh.creation.box(extents=(0.02 * length, 0.12 * length, 0.12 * length))
    wall.visual = _surface(STONE)
    scene.add_geometry(wall.apply_translation((-0.01 * length, 0.0, 0.0)), node_name=CLAMP, geom_name=CLAMP)
    for contact in take.plant.contacts:
        ring = sleeve_mesh(radius + magnified * contact.clearance, wall=radius, width=4.0 * radius)
        ring.visual = _surface(BRASS, alphaMode="BLEND", doubleSided=True)
        place = translation_matrix((contact.position or 0.0, magnified * contact.offset, 0.0))
        scene.add_geometry(ring, node_name=contact.sleeve, geom_name=contact.sleeve, transform=place)
    return scene


CLAMP = "clamp (wall)"


def _surface(colour: tuple[float, ...], **more: Any) -> Any:
    material = PBRMaterial(baseColorFactor=colour, metallicFactor=METALLIC, roughnessFactor=ROUGH, **more)
    return trimesh.visual.TextureVisuals(material=material)


def _animate(
    buffers: OrderedDict[Any, bytes],
    tree: dict[str, Any],
    clock: FloatArray,
    channels: dict[str, dict[str, FloatArray]],
) -> None:
    """Add keys to a file's buffers, and to its tree what they move."""
    numbers = {node.get("name"): i for i, node in enumerate(tree["nodes"])}
    time = _add(buffers, tree, clock[:, None])
    samplers: list[dict[str, Any]] = []
    targets: list[dict[str, Any]] = []
    for name, paths in channels.items():
        node = tree["nodes"][numbers[name]]
        node.pop("matrix", None)  # what moves has no matrix, but a pose for where nobody plays it
        for path, values in paths.items():
            node[path] = values[0].tolist()
            targets.append({"sampler": len(samplers), "target": {"node": numbers[name], "path": path}})
            samplers.append({"input": time, "output": _add(buffers, tree, values), "interpolation": "LINEAR"})
    tree["animations"] = [{"name": "motion", "samplers": samplers, "channels": targets}]


def _add(buffers: OrderedDict[Any, bytes], tree: dict[str, Any], values: FloatArray) -> int:
    """Number of a new accessor on (n, 1), (n, 3) or (n, 4) values."""
    data = np.ascontiguousarray(values, dtype="<f4")
    kind = ARRAY.get(data.shape[1], SCALAR)
    buffers[f"keys {len(buffers)}"] = data.tobytes()
    tree["accessors"][f"keys {len(buffers)}"] = {
        "bufferView": len(buffers) - 1,
        "componentType": FLOAT,
        "count": len(data),
        "type": kind,
        "min": data.min(axis=0).tolist(),
        "max": data.max(axis=0).tolist(),
    }
    return len(tree["accessors"]) - 1
