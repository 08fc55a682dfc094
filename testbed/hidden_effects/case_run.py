"""One case from its draw to its judgement, as its file holds it."""

import traceback
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from threadpoolctl import threadpool_limits

from identification.assess import assess
from identification.diagnose import diagnose
from models.effects import entry_of
from models.rig import Beam
from testbed.hidden_effects.cases import Case, draw_case
from testbed.hidden_effects.judge import judged, rig_numbers
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.trials import HELD, LEARNT
from testbed.loop import diagnosis_json
from testbed.outputs import Json


def run_case(task: Task, threads: int = 1, draw: Callable[[Task], Case] = draw_case) -> Json:
    """Draw a case, diagnose its records and judge the diagnosis; a crash is a result too, told under ``failure``.

    Args:
        task: the case.
        threads: of the diagnosis.
        draw: makes the case; tests give one that is quick.
    """
    about = task.about
    began = perf_counter()
    try:
        with threadpool_limits(1):
            case = draw(task)
            drawn = perf_counter() - began
            about |= described(case)
            about |= diagnosed(case, threads)
    except Exception as failure:  # noqa: BLE001 - a crash is a result of the benchmark, told with its message
        return about | told(failure)
    return about | {"seconds": {"draw": drawn, "diagnosis": about["diagnosis"]["seconds"], "threads": threads}}


def told(failure: Exception) -> Json:
    """What a file holds of a case that crashed.

    Args:
        failure: caught.
    """
    frames = traceback.extract_tb(failure.__traceback__)
    where = [f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in frames]
    return {"failure": f"{type(failure).__name__}: {failure}", "where": where}


def described(case: Case) -> Json:
    """What a case is, in plain values.

    Args:
        case: drawn.
    """
    return {
        "engine": case.truth.engine,
        "parts": case.truth.resolution.n_parts,
        "steps_per_sample": case.truth.resolution.steps_per_sample,
        "hidden": hidden_in(case),
        "snr_db": case.snr_db,
        "snr_of_force_db": case.snr_of_force_db,
        "growth": case.growth,
        "amplification": case.amplification,
        "chaotic": case.chaotic,
        "wanted": list(case.wanted),
        "shown": list(case.shown),
        "calibrated_on_model": case.calibrated,
        "turned_down": case.turned_down,
        "noise_nrmse": case.noise_nrmse,
        "rig": case.rig.model_dump(mode="json", exclude_none=True),
        "built": _built(case),
        "records": {
            record.name: {"fs": record.fs, "seconds": record.duration, "force_rms": float(record.excitation.std())}
            for record in (*case.records, case.holdout)
            if record.excitation is not None
        },
    }


def diagnosed(case: Case, threads: int) -> Json:
    """The diagnosis of a case, its judgement, and its errors over the true noise.

    Args:
        case: drawn.
        threads: of the diagnosis.
    """
    found = diagnose(case.rig, case.records, (case.holdout,), seed=case.task.number, jobs=threads)
    content: Json = diagnosis_json(found)
    calibrated = found.calibrated
    held_out = assess(calibrated.hypothesis, (case.holdout,), jobs=threads, seed=case.task.number).nrmse
    noise = case.noise_nrmse[HELD]
    learnt = sum(case.noise_nrmse[name] ** 2 for name in LEARNT) / len(LEARNT)
    errors = content["holdout"]
    return {
        "judged": judged_case(case, content),
        "rig_numbers": rig_numbers(found.rig_estimates, _built(case)),
        "calibrated_ratio": calibrated.score.nrmse / learnt**0.5,
        "held_out": {
            "before": errors["as given"] / noise,
            "calibrated": held_out / noise,
            "after": errors["updated"] / noise,
            "noise_nrmse": noise,
            "noise_nrmse_as_estimated": errors["noise_nrmse"],
        },
        "diagnosis": content,
        "decisions": list(found.decisions),
    }


def _built(case: Case) -> dict[str, float]:
    """The numbers that the rig truly has, by path."""
    return {parameter.path: parameter.value for parameter in case.truth.built.parameters()}


def judged_case(case: Case, diagnosis: Json) -> Json:
    """What the scores need to know of a diagnosis of a case.

    Args:
        case: drawn.
        diagnosis: as ``diagnosis.json``.
    """
    beam = case.rig.structure
    assert isinstance(beam, Beam)
    sleeves = {sleeve.name: sleeve.position for sleeve in case.rig.sleeves}
    return judged(diagnosis, case.task.kind, hidden_in(case), sleeves, beam.length)


def hidden_in(case: Case) -> list[Json]:
    """Kind, place and numbers of each hidden effect, in plain values.

    Args:
        case: drawn.
    """
    return [entry_of(effect).model_dump(mode="json", exclude_none=True) for effect in case.truth.hidden]
