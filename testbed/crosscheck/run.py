"""The cross-check over files: ``crosscheck.json``, a page and its figures in a folder."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from models.plant import build_plant
from testbed.crosscheck.page import crosscheck_json, page_of
from testbed.crosscheck.study import crosscheck
from testbed.figures.crosscheck import bounds_figure, convergence_figure, sleeves_figure
from testbed.figures.save import save
from testbed.outputs import Json, json_text, staged
from testbed.whole_rig import whole_rig


def run_crosscheck(
    rig_path: Path,
    others: Sequence[str],
    out: Path,
    *,
    seed: int,
    jobs: int,
    command: Sequence[str],
    progress: Progress,
) -> Json:
    """Cross-check the simulators on a rig and write the result.

    Args:
        rig_path: the rig file.
        others: simulators that the modal model is held against.
        out: folder of the results.
        seed: of the excitation's phases.
        jobs: processes.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``crosscheck.json``.

    Raises:
        InputError: a rig that a simulator cannot carry, or a folder that cannot be written.
        DivergenceError: a simulator lost the motion.
    """
    rig = whole_rig(rig_path)
    found = crosscheck(rig, others, progress, seed=seed, jobs=jobs)
    content = crosscheck_json(found)
    with staged(out) as stage:
        (stage / "crosscheck.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page_of(found, shlex.join(command)), encoding="utf-8")
        save(bounds_figure(found.measures), stage / "figures", "bounds")
        save(sleeves_figure(found.motions, build_plant(rig)), stage / "figures", "sleeves")
        save(convergence_figure(found.convergence), stage / "figures", "convergence")
    return content
