"""The studies over files: JSON, a page and its figure in a folder."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from identification.progress import Progress
from testbed.figures.real_data import beam_figure, frame_figure, silverbox_figure
from testbed.figures.save import save
from testbed.outputs import Json, json_text, staged
from testbed.real_data.bolted_beam import study_bolted_beam
from testbed.real_data.friction_frame import study_friction_frame
from testbed.real_data.page import (
    beam_json,
    beam_page,
    frame_json,
    frame_page,
    silverbox_json,
    silverbox_page,
)
from testbed.real_data.silverbox import study_silverbox


def run_silverbox(folder: Path, out: Path, *, seed: int, jobs: int, command: Sequence[str], progress: Progress) -> Json:
    """Study the Silverbox and write the result.

    Args:
        folder: with the published file.
        out: folder of the results.
        seed: of every random choice.
        jobs: cores.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``silverbox.json``.

    Raises:
        InputError: a file that is missing, or a folder that cannot be written.
    """
    study = study_silverbox(folder, seed, jobs, progress)
    content = silverbox_json(study)
    _write(out, "silverbox", content, silverbox_page(study, shlex.join(command)), silverbox_figure(study))
    return content


def run_friction_frame(
    folder: Path, out: Path, *, seed: int, jobs: int, command: Sequence[str], progress: Progress
) -> Json:
    """Study the friction frame and write the result.

    Args:
        folder: with the published files.
        out: folder of the results.
        seed: of every random choice.
        jobs: processes.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``friction_frame.json``.

    Raises:
        InputError: a file that is missing, or a folder that cannot be written.
    """
    study = study_friction_frame(folder, seed, jobs, progress)
    content = frame_json(study)
    _write(out, "friction_frame", content, frame_page(study, shlex.join(command)), frame_figure(study))
    return content


def run_bolted_beam(folder: Path, out: Path, *, jobs: int, command: Sequence[str], progress: Progress) -> Json:
    """Study the bolted beam and write the result.

    Args:
        folder: with the published files.
        out: folder of the results.
        jobs: cores.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``bolted_beam.json``.

    Raises:
        InputError: a file that is missing, or a folder that cannot be written.
    """
    study = study_bolted_beam(folder, jobs, progress)
    content = beam_json(study)
    _write(out, "bolted_beam", content, beam_page(study, shlex.join(command)), beam_figure(study))
    return content


def _write(out: Path, name: str, content: Json, page: str, figure: Figure) -> None:
    with staged(out) as stage:
        (stage / f"{name}.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page, encoding="utf-8")
        save(figure, stage / "figures", name)
