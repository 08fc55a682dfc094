"""The study of contact laws over files: ``contact_laws.json``, a page and its figures in a folder."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from models.rig import Beam
from testbed.contact_laws.ball_study import ball_study, strikes
from testbed.contact_laws.beam_study import beam_study, frf_study
from testbed.contact_laws.laws import STUDY_LAWS
from testbed.contact_laws.page import Study, page_of, study_json
from testbed.figures.contact_laws import LOOP_SET, LOOP_SPEED, beam_figure, loops_figure, restitution_figure
from testbed.figures.save import save
from testbed.outputs import Json, json_text, staged
from testbed.whole_rig import whole_rig


def run_contact_laws(rig_path: Path, out: Path, *, command: Sequence[str], progress: Progress) -> Json:
    """Study the contact laws on a ball and on a rig, and write the result.

    Args:
        rig_path: the rig file.
        out: folder of the results.
        command: as typed, for the page.
        progress: told what is being done.

    Returns:
        the content of ``contact_laws.json``.

    Raises:
        InputError: a rig that is no beam with sleeves, or a folder that cannot be written.
        DivergenceError: a simulator lost the motion.
    """
    rig = whole_rig(rig_path)
    if not isinstance(rig.structure, Beam) or not rig.sleeves or rig.excitation is None:
        raise InputError(
            f"{rig_path.name}: no beam that a force drives and sleeves support",
            "the study lets a beam strike its sleeves",
            "give the rig a beam, a sleeve and an excitation",
        )
    study = Study(ball_study(progress), beam_study(rig, progress), frf_study(rig, progress))
    content = study_json(study)
    loops = {key: strikes(law, LOOP_SET, LOOP_SPEED, ["modal"])["modal"] for key, law in STUDY_LAWS.items()}
    with staged(out) as stage:
        (stage / "contact_laws.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page_of(study, shlex.join(command)), encoding="utf-8")
        save(restitution_figure(study.balls), stage / "figures", "restitution")
        save(loops_figure(loops), stage / "figures", "loops")
        save(beam_figure(study.beams), stage / "figures", "beam")
    return content
