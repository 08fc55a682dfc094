"""Whether the test that a diagnosis proposes does what it promises: it is carried out on the rig as it really is."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Literal

from threadpoolctl import threadpool_limits

from identification.diagnose import diagnose
from identification.next_experiment.proposal import Proposal
from identification.result import Diagnosis
from models.record import Record
from models.rig import Rig
from models.simulators import simulator
from models.simulators.protocol import Resolution
from testbed.hidden_effects.case_run import hidden_in, judged_case, told
from testbed.hidden_effects.cases import Case, draw_case
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.truth import FINE, Truth, moved
from testbed.loop import diagnosis_json
from testbed.outputs import Json
from testbed.proposal import EXPERIMENT, proposal_json, write_experiment
from testbed.virtual.campaign import runs_of
from testbed.virtual.experiment import read_experiment
from testbed.virtual.laboratory import laboratory_of, read_by_sensors

Outcome = Literal["told apart", "still open", "wrong", "no group", "no test", "no simulator"]
"""What came of a group: by the test, or why there was none. ``no group``: the diagnosis of today states none."""

SIMULATORS = ("mujoco", "exudyn")
"""That let a rig go, in this order where the case's own engine does not; any other test is the own engine's, since two
of them are farther apart than the noise where walls are struck."""


def run_proposed(task: Task, threads: int = 1, draw: Callable[[Task], Case] = draw_case) -> Json:
    """Draw a case, diagnose it, carry out what is proposed and diagnose again; a crash is a result too.

    Args:
        task: a case in which a group was stated.
        threads: of each diagnosis.
        draw: makes the case; tests give one that is quick.
    """
    began = perf_counter()
    try:
        with threadpool_limits(1):
            content = proposed(draw(task), threads)
    except Exception as failure:  # noqa: BLE001 - a crash is a result of the benchmark, told with its message
        return task.about | told(failure)
    return task.about | content | {"seconds": perf_counter() - began}


def proposed(case: Case, threads: int) -> Json:
    """What is proposed for a case, and what comes of it.

    Args:
        case: drawn.
        threads: of each diagnosis.

    Returns:
        ``hidden``, ``before``, and, as far as it comes to that, ``proposal``, ``simulator``, ``after``; ``outcome``.

    Raises:
        DivergenceError: the motion of the test was lost.
    """
    before = diagnose(case.rig, case.records, seed=case.task.number, jobs=threads)
    content: Json = {"hidden": hidden_in(case), "before": _stated(before, case)}
    proposal = before.next_experiment
    if before.verdict != "missing_effect" or not before.indistinguishable:
        return content | {"outcome": "no group"}
    if proposal.test is None or proposal.best is None:
        return content | {"outcome": "no test"}
    content["proposal"] = {key: value for key, value in proposal_json(proposal).items() if key != "options"}
    engine = carrier(case.truth, held=proposal.test.is_held)
    if engine is None:
        return content | {"outcome": "no simulator"}
    rig, record = carried_out(case, proposal, *engine)
    after = diagnose(rig, (*case.records, record), seed=case.task.number, jobs=threads)
    stated = _stated(after, case)
    ends: Outcome = "still open" if after.indistinguishable else "told apart"
    if not (stated["right"] or (after.indistinguishable and stated["in_group"])):
        ends = "wrong"
    return content | {"simulator": engine[0], "after": stated, "outcome": ends}


def carrier(truth: Truth, *, held: bool) -> tuple[str, Resolution] | None:
    """The engine that carries out a test on what is really there, and how finely; None where none carries it.

    Args:
        truth: of a case.
        held: whether the rig is held until it is let go.
    """
    if truth.engine == FINE and not held:
        return FINE, truth.resolution
    own = [truth.engine] if truth.engine in SIMULATORS else []
    for name in dict.fromkeys((*own, *SIMULATORS)):
        resolution = truth.resolution if name == truth.engine else Resolution()
        if not simulator(name).cannot_carry(truth.plant, resolution):
            return name, resolution
    return None


def carried_out(case: Case, proposal: Proposal, engine: str, resolution: Resolution) -> tuple[Rig, Record]:
    """The record of a proposed test, and the owner's rig with the sensor that it may add.

    Args:
        case: drawn.
        proposal: with a test.
        engine: of ``carrier``.
        resolution: how finely.

    Raises:
        DivergenceError: the motion was lost.
    """
    sensors = case.rig.sensors if proposal.rig is None else proposal.rig.sensors
    rig = case.rig.model_copy(update={"sensors": sensors})
    with TemporaryDirectory() as folder:
        write_experiment(replace(proposal, rig=None), Path(folder) / "rig.toml", Path(folder))
        experiment = read_experiment(Path(folder) / EXPERIMENT)
    (run,) = runs_of(experiment, rig)
    added = sensors[len(case.rig.sensors) :]
    built = case.truth.built.model_copy(update={"sensors": (*case.truth.built.sensors, *added)})
    laboratory = replace(laboratory_of(experiment, rig), built=built, hidden=case.truth.hidden)
    rng = laboratory.dice_of(0)
    trial = laboratory.trial_of(run, rng)
    channels = moved(engine, resolution, laboratory.plant, trial)
    return rig, read_by_sensors(laboratory, run, trial, channels, rng)


def _stated(diagnosis: Diagnosis, case: Case) -> Json:
    """What a diagnosis says, and whether that is right."""
    content = diagnosis_json(diagnosis)
    score = judged_case(case, content)
    kept = {key: score[key] for key in ("verdict", "right", "in_group", "probability")}
    effects = [{key: value for key, value in effect.items() if key != "parameters"} for effect in content["effects"]]
    return {**kept, "effects": effects, "indistinguishable": content["indistinguishable"]}
