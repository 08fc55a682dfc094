import subprocess
import sys

import numpy as np
import pytest
from simulator_scenes import FS, REFERENCE, noise

from models.errors import DivergenceError, InputError
from models.plant import build_plant
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.simulators import SIMULATORS, simulator
from models.simulators.protocol import Resolution, Trial

ENGINES = ("mujoco", "exudyn")


@pytest.mark.parametrize("name", SIMULATORS)
def test_each_goes_by_its_name_and_names_its_source(name):
    assert simulator(name).name == name
    assert simulator(name).source


def test_a_name_that_is_not_there_is_told_with_the_nearest():
    with pytest.raises(
        InputError, match=r"simulator = 'mujocco'; the simulators are modal, .*; did you mean 'mujoco'\?"
    ):
        simulator("mujocco")


def test_an_engine_that_is_not_installed_is_told_by_name(monkeypatch):
    monkeypatch.setitem(SIMULATORS, "absent", ("an_engine_that_nobody_has.simulator", "Absent"))
    with pytest.raises(InputError, match=r"'an_engine_that_nobody_has' is not installed; .*; pip install"):
        simulator("absent")


def test_no_engine_is_loaded_before_it_is_asked_for():
    code = "import sys, models.simulators; print(sorted({'mujoco', 'exudyn', 'trimesh'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ENGINES)
def test_an_oscillator_is_refused_by_name(name):
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.7),
        excitation=Excitation(),
        sensors=(Sensor(name="tip"),),
    )
    with pytest.raises(InputError, match=rf"{name}: an oscillator .*; the simulator {name} carries .*; leave it out"):
        simulator(name).run(build_plant(rig), Trial(FS, np.zeros(16)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"axial_force": 100.0}, "an axial load"),
        ({"loss_factor": 0.01}, "one loss factor for all modes"),
        ({"stiffness_rate": 1e-3}, "stiffness_drift, a bending stiffness that changes in time"),
    ],
)
@pytest.mark.parametrize("name", ENGINES)
def test_what_an_engine_does_not_carry_is_named(name, change, words):
    from dataclasses import replace

    plant = build_plant(REFERENCE)
    changed = replace(plant, structure=replace(plant.structure, **change))
    assert simulator(name).cannot_carry(changed, Resolution()) == (words,)
    assert simulator("modal").cannot_carry(changed, Resolution()) == ()
    assert simulator(name).cannot_carry(plant, Resolution()) == ()


@pytest.mark.parametrize("name", ENGINES)
def test_nothing_is_written_into_the_working_folder_nor_said(name, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    plant = build_plant(REFERENCE)
    simulator(name).run(plant, Trial(FS, noise(64, 5.0)))
    simulator(name).natural_freqs(plant, 3, Resolution())
    with pytest.raises(DivergenceError):
        simulator(name).run(plant, Trial(FS, 1e13 * noise(64, 5.0)))
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")
