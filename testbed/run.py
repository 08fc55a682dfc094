"""The loop over files: diagnosis, updated rig, report and history in a folder, and not twice for the same inputs."""

import json
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path

from identification.progress import Progress
from testbed.history import UPDATED, Model, check_history, remember
from testbed.inputs import Inputs, sha256
from testbed.loop import diagnosis_json, rig_of
from testbed.outputs import LAST, Json, check_open, json_text, staged
from testbed.proposal import EXPERIMENT, RIG, stale, write_experiment

DIAGNOSIS, REPORT = "diagnosis.json", "report.html"
OUTPUTS = (DIAGNOSIS, UPDATED, REPORT)


@dataclass(frozen=True)
class Outcome:
    """A finished run.

    Attributes:
        diagnosis: the content of ``diagnosis.json``.
        out: the folder of all results.
        kept: whether an earlier run of the same inputs had finished and was not repeated.
    """

    diagnosis: Json
    out: Path
    kept: bool


def run_diagnosis(
    inputs: Inputs,
    out: Path,
    *,
    seed: int,
    jobs: int,
    again: bool,
    command: Sequence[str],
    progress: Progress,
    alike: bool = False,
    within: float | None = None,
) -> Outcome:
    """Diagnose and write everything into a folder, unless it holds the same run already.

    Args:
        inputs: rig and records.
        out: folder of the results.
        seed: of every random choice.
        jobs: cores.
        again: repeat a run that had finished.
        command: as typed, for the history and the report.
        progress: told what is being done.
        alike: whether the same may be wrong with all sleeves.
        within: minutes after which no further search is begun.

    Raises:
        InputError: records that do not fit the rig or do not tell their noise, a folder that cannot be written, or a
            history in it that is damaged.
        ArithmeticError: the given rig's motion leaves the finite numbers.
    """
    wanted = {**inputs.digests, "seed": seed, "alike": alike, **({} if within is None else {"within": within})}
    if not again and is_finished(out, wanted):
        progress(f"{out}: this rig, these records, seed and version were diagnosed before; kept (--again repeats it)")
        return Outcome(json.loads((out / DIAGNOSIS).read_text(encoding="utf-8")), out, kept=True)
    check_open(out, (*OUTPUTS, LAST, EXPERIMENT, RIG))
    check_history(out)
    content = _diagnose(inputs, out, wanted, jobs=jobs, command=shlex.join(command), progress=progress)
    return Outcome(content, out, kept=False)


def is_finished(out: Path, wanted: Json) -> bool:
    """Whether a folder holds the untouched results of a finished run of these inputs.

    Args:
        out: folder of results.
        wanted: digests, seed and options.
    """
    try:
        run = json.loads((out / LAST).read_text(encoding="utf-8"))
        return bool(run["inputs"] == wanted and run["outputs"] == _digests(out))
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _digests(folder: Path) -> dict[str, str]:
    return {name: sha256(folder / name) for name in OUTPUTS}


def _diagnose(inputs: Inputs, out: Path, wanted: Json, *, jobs: int, command: str, progress: Progress) -> Json:
    from identification.diagnose import diagnose
    from testbed.report import provenance, write_report

    seed, alike, within = wanted["seed"], wanted["alike"], 60.0 * wanted.get("within", inf)
    diagnosis = diagnose(
        inputs.rig, inputs.records, inputs.holdout, seed=seed, jobs=jobs, alike=alike, within=within, progress=progress
    )
    content = diagnosis_json(diagnosis)
    content["where"]["findings"] += [f for f in inputs.findings if f not in content["where"]["findings"]]
    models = [Model(stage.label, rig_of(stage.hypothesis), stage.score.nrmse) for stage in diagnosis.stages]
    with staged(out) as stage:
        (stage / DIAGNOSIS).write_text(json_text(content), encoding="utf-8")
        remember(out, stage, models, like=inputs.rig_path, command=command)
        write_experiment(diagnosis.next_experiment, inputs.rig_path, stage, home=out)
        write_report(diagnosis, inputs.rig, stage, provenance(inputs.rig_path, inputs.record_paths, seed, command))
        run = {"inputs": wanted, "outputs": _digests(stage), "command": command}
        (stage / LAST).write_text(json_text(run), encoding="utf-8")
    for name in stale(diagnosis.next_experiment):
        (out / name).unlink(missing_ok=True)
    return json.loads((out / DIAGNOSIS).read_text(encoding="utf-8"))  # type: ignore[no-any-return]
