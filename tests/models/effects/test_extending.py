"""The worked example of docs/extending.md, as a reader would follow it: one file and one line of the registry."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from effect_scenes import BEAM, as_compiled, trials_of

from models.effects import EFFECTS, build_effect, entry_of
from models.errors import InputError
from models.plant import build_plant
from models.record import Record
from models.rig import EffectEntry, Excitation, Oscillator, Rig, Sensor
from models.simulate import simulate

PAGE = Path(__file__).parents[3] / "docs" / "extending.md"
FILE, LINE = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def registry(tmp_path_factory):
    """A copy of the registry with the page's line in it, over a module that is the page's file."""
    path = tmp_path_factory.mktemp("effects") / "point_drag.py"
    path.write_text(FILE)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert LINE.count("\n") == 1
    return {**EFFECTS, **eval(f"{{{LINE}}}", vars(module))}  # noqa: S307


def test_the_library_does_not_have_it_yet():
    with pytest.raises(InputError, match="point_drag"):
        build_effect(EffectEntry(kind="point_drag", position=0.7, coefficient=5.0), BEAM, EFFECTS)


def test_a_rig_file_can_name_it(registry):
    entry = EffectEntry(kind="point_drag", position=0.7, coefficient=5.0)
    plant = build_plant(Rig(**{**dict(BEAM), "effects": (entry,)}), registry=registry)
    (law,) = plant.laws
    assert entry_of(plant.effects[0]) == entry
    assert (law.port.position, law.owner) == (0.7, "point_drag at 0.700 m")
    assert law.force(0.0, 0.0, -2.0, 0.0, law.parameters) == 20.0


def test_its_law_compiles(registry):
    for scene, effect in trials_of(registry["point_drag"]):
        (law,) = effect.point_laws(scene.contact, scene.structure)
        motion = (0.0, 1e-4, -0.3, 0.0)
        assert as_compiled(law.force, motion, law.parameters) == pytest.approx(law.force(*motion, law.parameters))


def test_the_simulator_moves_with_it(registry):
    """In steady flow c v^2 balances the force: a free mass under a long push reaches sqrt(F / c)."""
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=3.0, stiffness=0.0, damping=0.0),
        excitation=Excitation(),
        sensors=(Sensor(name="speed", quantity="velocity"),),
        effects=(EffectEntry(kind="point_drag", coefficient=5.0),),
    )
    record = Record("push", 200.0, np.full(4000, 20.0), ("speed",), np.empty((1, 4000)))
    speed = simulate(build_plant(rig, registry=registry), record).channels[0]
    # Away from the ends, where the recorder's low-pass rings on the push that is cut off.
    assert speed[2000:3000] == pytest.approx(2.0, rel=1e-3)
