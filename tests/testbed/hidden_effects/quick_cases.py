"""Cases that take a second, and ways to lose one, for the tests of those who run them."""

import os
import time

import numpy as np

from models.excitations import random_phase_multisine
from models.rig import Beam, Excitation, Rig, Sensor, Sleeve
from testbed.hidden_effects.case_run import run_case
from testbed.hidden_effects.cases import Case
from testbed.hidden_effects.trials import HELD, LEARNT
from testbed.hidden_effects.truth import FINE, Truth, measure
from testbed.virtual.noise import Noise

FS, N = 512.0, 512


def small_rig():
    beam = Beam(
        kind="beam", length=1.2, diameter=0.02, youngs_modulus=210e9, density=7850.0, rayleigh_damping=(4.0, 2e-5)
    )
    return Rig(
        structure=beam,
        tolerances={"youngs_modulus": 0.01},
        sleeves=(Sleeve(name="sleeve 1", position=0.6, clearance=3e-4, stiffness=1e5, damping=80.0),),
        excitation=Excitation(name="shaker", node=100, position=0.8),
        sensors=tuple(Sensor(name=f"P{i}", node=i, position=0.3 * i) for i in (1, 2, 3, 4)),
    )


def small_case(task):
    """A real one: fine elements, noise, nothing hidden."""
    rng = np.random.default_rng(task.number)
    rig = small_rig()
    truth = Truth(rig, (), FINE, Noise(0.007, 0.007, share_of="channel"))
    measured = {
        name: measure(truth, name, random_phase_multisine(rng, FS, N, 4, 8.0, 120.0, 10.0), FS, rng)
        for name in (*LEARNT, HELD)
    }
    return Case(
        task=task,
        rig=rig,
        truth=truth,
        growth=1.0,
        amplification=1.0,
        chaotic=False,
        wanted=(),
        shown=(),
        calibrated=None,
        records=tuple(measured[name][0] for name in LEARNT),
        holdout=measured[HELD][0],
        noise_nrmse={name: noise for name, (_, noise) in measured.items()},
        turned_down={},
    )


def no_case(task):
    """A draw that fails."""
    message = f"{task.name} cannot be drawn"
    raise ArithmeticError(message)


def real_and_small(begun, task, threads):
    """Such a case, which first leaves its process's number in a folder, in a file for each time that it is begun."""
    (begun / f"{task.name} {os.getpid()}").touch()
    return run_case(task, threads, draw=small_case)


def deadly_once(task, threads):
    """A case whose process dies the first time that it is begun, and waits a little otherwise."""
    time.sleep(0.5)
    if task.number == 1:
        os._exit(7)
    return {"case": task.name, "kind": task.kind, "number": task.number, "pid": os.getpid(), "threads": threads}


def slow(task, threads):
    """A case that takes a while."""
    time.sleep(1.0)
    return {"case": task.name, "kind": task.kind, "number": task.number, "pid": os.getpid(), "threads": threads}


def told(folder, task, threads):
    """A case that leaves its process's number in a file and takes for ever."""
    (folder / task.name).write_text(str(os.getpid()), encoding="utf-8")
    time.sleep(600.0)
    return {"threads": threads}
