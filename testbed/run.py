"""The loop over files: diagnosis, updated rig, report and history in a folder, and not twice for the same inputs."""

import json
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from identification.hypothesis import Hypothesis
from identification.progress import Progress
from models.errors import InputError
from models.record import AnyRecord, FrfRecord, ModeShapeRecord, Record
from testbed.compare import compare
from testbed.compare_json import comparison_json
from testbed.history import UPDATED, Model, remember
from testbed.inputs import Inputs, sha256
from testbed.loop import Json, diagnosis_json, rig_of
from testbed.outputs import LAST, json_text, staged

DIAGNOSIS, REPORT = "diagnosis.json", "report.html"
OUTPUTS = (DIAGNOSIS, UPDATED, REPORT)
LINEAR_ONLY = "from one level of FRFs or mode shapes no nonlinearity can be seen: it is compared and not learned from"


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
    inputs: Inputs, out: Path, *, seed: int, jobs: int, again: bool, command: Sequence[str], progress: Progress
) -> Outcome:
    """Diagnose and write everything into a folder, unless it holds the same run already.

    Args:
        inputs: rig and records.
        out: folder of the results.
        seed: of every random choice.
        jobs: threads.
        again: repeat a run that had finished.
        command: as typed, for the history and the report.
        progress: told what is being done.

    Raises:
        InputError: nothing to learn from, or a folder that cannot be written.
        ArithmeticError: the given rig's motion leaves the finite numbers.
    """
    wanted = {**inputs.digests, "seed": seed}
    if not again and is_finished(out, wanted):
        progress(f"{out}: this rig, these records, seed and version were diagnosed before; kept (--again repeats it)")
        return Outcome(json.loads((out / DIAGNOSIS).read_text(encoding="utf-8")), out, kept=True)
    content = _diagnose(inputs, out, wanted, jobs=jobs, seed=seed, command=shlex.join(command), progress=progress)
    return Outcome(content, out, kept=False)


def is_finished(out: Path, wanted: Json) -> bool:
    """Whether a folder holds the untouched results of a finished run of these inputs.

    Args:
        out: folder of results.
        wanted: digests and seed.
    """
    try:
        run = json.loads((out / LAST).read_text(encoding="utf-8"))
        return bool(run["inputs"] == wanted and run["outputs"] == _digests(out))
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _digests(folder: Path) -> dict[str, str]:
    return {name: sha256(folder / name) for name in OUTPUTS}


def _diagnose(
    inputs: Inputs, out: Path, wanted: Json, *, jobs: int, seed: int, command: str, progress: Progress
) -> Json:
    from identification.diagnose import diagnose
    from testbed.report import provenance, write_report

    timed, linear = _sorted(inputs.records)
    aside, _ = _sorted(inputs.holdout)
    if not timed:
        raise InputError(
            f"{', '.join(r.name for r in inputs.records)}: no time record",
            f"a diagnosis learns from at least one time record; {LINEAR_ONLY}",
            "name a time record too, or compare with testbed compare",
        )
    diagnosis = diagnose(inputs.rig, timed, aside, seed=seed, jobs=jobs, progress=progress)
    content = diagnosis_json(diagnosis)
    content["where"]["findings"] += [f for f in inputs.findings if f not in content["where"]["findings"]]
    content["where"]["findings"] += [f"{record.name}: {LINEAR_ONLY}" for record in linear]
    if linear:
        given, final = diagnosis.stages[0].hypothesis, diagnosis.final.hypothesis
        content["where"]["linear"] = {"as given": _linear(given, linear), "updated": _linear(final, linear)}
    models = [Model(stage.label, rig_of(stage.hypothesis), stage.score.nrmse) for stage in diagnosis.stages]
    with staged(out) as stage:
        (stage / DIAGNOSIS).write_text(json_text(content), encoding="utf-8")
        remember(out, stage, models, like=inputs.rig_path, command=command)
        write_report(diagnosis, inputs.rig, stage, provenance(inputs.rig_path, inputs.record_paths, seed, command))
        run = {"inputs": wanted, "outputs": _digests(stage), "command": command}
        (stage / LAST).write_text(json_text(run), encoding="utf-8")
    return json.loads((out / DIAGNOSIS).read_text(encoding="utf-8"))  # type: ignore[no-any-return]


def _sorted(records: Sequence[AnyRecord]) -> tuple[list[Record], list[FrfRecord | ModeShapeRecord]]:
    """Time records, and those of small motion about rest."""
    return [r for r in records if isinstance(r, Record)], [r for r in records if not isinstance(r, Record)]


def _linear(hypothesis: Hypothesis, records: Sequence[AnyRecord]) -> list[Json]:
    """How near a model comes to FRFs (NRMSE) and mode shapes (mean relative error of frequency, mean MAC)."""
    rows: list[Json] = []
    for row in comparison_json(compare(hypothesis, records))["records"]:
        if "modes" not in row:
            rows.append({"record": row["record"], "nrmse": row["nrmse"]})
            continue
        errors = [abs(mode["model_freq"] / mode["measured_freq"] - 1.0) for mode in row["modes"]]
        likeness = [mode["mac"] for mode in row["modes"]]
        rows.append({"record": row["record"], "freq_error": np.nanmean(errors), "mac": np.nanmean(likeness)})
    return rows
