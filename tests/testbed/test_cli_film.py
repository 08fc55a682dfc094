"""``testbed film``: files that are there, and what it refuses."""

import json

import numpy as np
import pytest
from cli_files import make_files, write_frfs
from PIL import Image

from models.rig_file import read_rig
from testbed.cli.app import main
from testbed.figures.film import frames
from testbed.film.glb import magnification
from testbed.film.run import FRAMES


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    here = tmp_path_factory.mktemp("film")
    make_files(here)
    write_frfs(read_rig(here / "rig.toml"), here / "frf.uff")
    return here


def film(folder, of, *more):
    return main(["film", str(folder / "rig.toml"), str(folder / of), "--out", str(folder / "out"), *more])


def test_a_record_is_filmed(folder, capsys):
    assert film(folder, "sweep.csv", "--from", "0.1", "--to", "0.2", "--json") == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((folder / "out" / "film.json").read_text())
    assert content["slowed"] == pytest.approx(80.0)
    picture = Image.open(folder / "out" / "sweep.gif")
    assert picture.n_frames == FRAMES
    first = picture.convert("RGB").copy()
    picture.seek(FRAMES // 2)
    assert first.tobytes() != picture.convert("RGB").tobytes()
    assert (folder / "out" / "sweep.glb").read_bytes()[:4] == b"glTF"


def test_it_says_that_the_model_moves_and_not_what_was_measured(folder, capsys, monkeypatch):
    titles = []

    def drawn(take, n, title):
        titles.append(title)
        return frames(take, 2, title)

    monkeypatch.setattr("testbed.film.run.frames", drawn)
    assert film(folder, "sweep.csv", "--from", "0.1", "--to", "0.12") == 0
    driven = "the excitation measured in sweep.csv, not by the motion measured there"
    shows = f"the model of rig.toml in modal, moved by {driven}"
    assert capsys.readouterr().out.splitlines()[0] == f"shows {shows}"
    assert json.loads((folder / "out" / "film.json").read_text())["shows"] == shows
    assert titles == [f"the model of rig.toml in modal, 400 times slower,\nmoved by {driven}"]


def test_a_stretch_outside_of_the_record_is_refused(folder, capsys):
    assert film(folder, "sweep.csv", "--from", "5", "--to", "4") == 2
    message = capsys.readouterr().err
    assert "--from 5 --to 4" in message
    assert "within it" in message
    assert film(folder, "sweep.csv", "--to", "1e-4") == 2


def test_a_record_that_begins_in_motion_is_refused(folder, capsys):
    text = (folder / "sweep.csv").read_text().splitlines()
    head = next(i for i, line in enumerate(text) if line.startswith("time"))
    (folder / "late.csv").write_text("\n".join([*text[: head + 1], *text[head + 400 :]]))
    assert film(folder, "late.csv") == 2
    assert "it begins in motion" in capsys.readouterr().err


def test_an_experiment_is_filmed_about_its_hardest_push_and_not_out_of_its_plane(folder, capsys):
    (folder / "pull.toml").write_text(PULL)
    assert film(folder, "pull.toml", "--json") == 0
    content = json.loads(capsys.readouterr().out)
    assert content["files"] == ["sweep_1.gif", "sweep_1.glb"]
    assert content["shows"] == "the model of rig.toml in modal, moved by the excitation of sweep_1 in pull.toml"
    assert 0.0 <= content["first"] < content["last"] <= 0.5
    (folder / "turned.toml").write_text(PULL + "angle = 20.0\n")
    assert film(folder, "turned.toml") == 2
    assert "a film shows the rig's plane" in capsys.readouterr().err


def test_only_a_start_shows_six_periods_from_there(folder, capsys):
    assert film(folder, "sweep.csv", "--from", "0.1", "--json") == 0
    content = json.loads(capsys.readouterr().out)
    assert (content["first"], content["last"] > 0.1) == (0.1, True)


def test_what_does_not_say_what_drove_the_rig_is_refused(folder, capsys):
    assert film(folder, "frf.uff") == 2
    assert "no channel of the excitation" in capsys.readouterr().err


def test_an_oscillator_is_refused(folder, tmp_path, capsys):
    (tmp_path / "rig.toml").write_text(OSCILLATOR)
    (tmp_path / "pull.toml").write_text(PULL)
    assert film(tmp_path, "pull.toml") == 2
    assert "'oscillator'" in capsys.readouterr().err


OSCILLATOR = """[structure]
kind = "oscillator"
mass = 1.0
stiffness = 1e4
damping = 1.0
[excitation]
name = "shaker"
[[sensors]]
name = "A"
"""
PULL = """fs = 1024.0
seed = 1
[excitation]
kind = "sweep"
low = 5.0
high = 50.0
amplitude = 1.0
duration = 0.5
"""


@pytest.mark.parametrize(("largest", "factor"), [(1e-3, 100.0), (2.1e-3, 50.0), (0.06, 2.0), (0.5, 0.2)])
def test_the_magnification_is_a_round_number(largest, factor):
    assert magnification(np.array([0.5, -1.0]) * largest, 1.0) == factor
