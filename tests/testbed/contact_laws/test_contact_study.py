"""The study of contact laws: its closed forms, its tables, its pictures, and what it refuses."""

from pathlib import Path

import pytest

from models.ball.restitution import obtained
from models.plant import build_plant
from models.rig_file import read_rig
from testbed.cli.app import main
from testbed.contact_laws import ball_study, beam_study
from testbed.contact_laws.ball_study import BallRow, meeting_of, strikes
from testbed.contact_laws.beam_study import meetings_of, with_law
from testbed.contact_laws.laws import STUDY_LAWS
from testbed.contact_laws.page import BOUND

REFERENCE = Path(__file__).parents[2] / "data" / "reference_rig.toml"


@pytest.mark.parametrize("key", STUDY_LAWS)
@pytest.mark.parametrize("speed", [0.25, 1.0])
def test_a_ball_comes_back_as_the_closed_form_of_its_law_says(key, speed):
    law = STUDY_LAWS[key]
    wanted = 1.0 if law.lossless else 0.6

    strike = strikes(law, wanted, speed, ["modal"])["modal"]

    assert strike.restitution == pytest.approx(law.expected(wanted, meeting_of(law), speed), abs=5e-4)


def test_grease_takes_a_speed_and_not_a_share_of_it():
    law = STUDY_LAWS["squeeze_film"]
    soft, hard = (law.expected(0.9, meeting_of(law), speed) for speed in (0.5, 1.0))

    assert hard > soft
    assert 1.0 * (1.0 - hard) == pytest.approx(0.5 * (1.0 - soft), rel=1.0)


def test_a_dissipating_law_loses_the_more_the_faster_the_strike():
    law = STUDY_LAWS["flores"]
    values = [law.expected(0.5, meeting_of(law), speed) for speed in (0.1, 0.5, 1.0)]

    assert values == sorted(values, reverse=True)
    assert values[1] == pytest.approx(obtained(1.6))


def test_differences_are_relative_to_the_modal_model():
    modal = BallRow("hertz", 1.0, 0.5, 1.0, "modal", 1.0, 1.0, 1.0, 0.0)
    other = BallRow("hertz", 1.0, 0.5, 1.0, "mujoco", 1.0, 1.02, 1.0, 1e-4)

    assert ball_study.disagreement([modal, other]) == {"hertz": pytest.approx(0.02)}


def test_the_law_goes_into_every_sleeve_and_grease_into_every_gap():
    plant = build_plant(read_rig(REFERENCE))
    greased = with_law(plant, STUDY_LAWS["squeeze_film"], 0.5, meetings_of(plant))

    assert len(greased.laws) == len(plant.laws) + len(plant.contacts)
    assert {law.port.position for law in greased.laws} == {contact.position for contact in plant.contacts}


def test_the_study_writes_its_page_and_its_pictures(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(ball_study, "RESTITUTIONS", (0.5,))
    monkeypatch.setattr(ball_study, "STUDY_LAWS", {key: STUDY_LAWS[key] for key in ("kelvin_voigt", "flores")})
    monkeypatch.setattr(beam_study, "RESTITUTIONS", (0.5,))
    monkeypatch.setattr(beam_study, "STUDY_LAWS", {key: STUDY_LAWS[key] for key in ("kelvin_voigt", "flores")})

    assert main(["study", "contact-laws", str(REFERENCE), "--out", str(tmp_path / "laws")]) == 0

    assert {path.name for path in (tmp_path / "laws").iterdir()} == {"README.md", "contact_laws.json", "figures"}
    page = (tmp_path / "laws" / "README.md").read_text(encoding="utf-8")
    assert f"agree on every law within {BOUND:.0%}" in page.replace("\n", " ")
    assert "Flores et al." in page
    assert "Flores et al." in capsys.readouterr().out


def test_a_rig_without_sleeves_is_refused(tmp_path, capsys):
    text = REFERENCE.read_text(encoding="utf-8")
    bare = tmp_path / "bare.toml"
    bare.write_text(text.split("[[sleeves]]")[0] + "[excitation]" + text.split("[excitation]")[1], encoding="utf-8")

    assert main(["study", "contact-laws", str(bare), "--out", str(tmp_path / "out")]) == 2

    assert "sleeve" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
