"""The identifier's study over files: ``identifier.json``, a page and its figures in a folder."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from testbed.figures.identifier_study import bound_figure, objective_figure, verification_figure
from testbed.figures.save import save
from testbed.identifier_study.page import page_of, study_json
from testbed.identifier_study.study import identifier_study
from testbed.outputs import Json, json_text, staged
from testbed.processes import processes


def run_identifier_study(out: Path, *, seeds: int, jobs: int, command: Sequence[str], progress: Progress) -> Json:
    """Study the identifier and write the result.

    Args:
        out: folder of the results.
        seeds: records behind each mean.
        jobs: processes.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``identifier.json``.

    Raises:
        InputError: a folder that cannot be written.
    """
    with processes(jobs) as pool:
        study = identifier_study(seeds, pool, progress)
    content = study_json(study)
    with staged(out) as stage:
        (stage / "identifier.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page_of(study, shlex.join(command)), encoding="utf-8")
        save(verification_figure(study.traces), stage / "figures", "verification")
        save(objective_figure(study.step_search, study.shares), stage / "figures", "objective")
        save(bound_figure(study.cells, two_modes=False), stage / "figures", "bound_one_mode")
        save(bound_figure(study.cells, two_modes=True), stage / "figures", "bound_two_modes")
    return content
