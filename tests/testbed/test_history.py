"""Stepping back and forth through the models of a folder, and losing none."""

import pytest
from cli_files import make_files

from models.errors import InputError
from models.rig_file import read_rig
from testbed.history import Model, read_history, remember, some_history, step_back, step_forward
from testbed.outputs import staged


@pytest.fixture
def folder(tmp_path):
    make_files(tmp_path)
    return tmp_path


def young(out):
    return read_rig(out / "rig.updated.toml").structure.youngs_modulus


def grow(folder, *moduli, given=None):
    """Remember the rig as given, then with other moduli, each made from the one before."""
    rig = read_rig(folder / "rig.toml") if given is None else given
    models = [Model("as given", rig, 0.3)]
    models += [Model(f"E = {value:g}", rig.with_values({"youngs_modulus": value}), 0.1) for value in moduli]
    with staged(folder / "out") as stage:
        remember(folder / "out", stage, models, like=folder / "rig.toml", command="testbed add")
    return folder / "out"


def test_back_to_the_rig_as_given_and_forward_again(folder):
    out = grow(folder, 211e9, 212e9)
    assert young(out) == 212e9
    assert [step_back(out).model, young(out)] == ["E = 2.11e+11", 211e9]
    assert [step_back(out).model, young(out)] == ["as given", 210e9]
    assert (out / "rig.updated.toml").read_bytes() == (folder / "rig.toml").read_bytes()
    with pytest.raises(InputError, match="the first of its line; a step back needs a model before; testbed history"):
        step_back(out)
    step_forward(out)
    assert [step_forward(out).model, young(out)] == ["E = 2.12e+11", 212e9]
    with pytest.raises(InputError, match="nothing was made from the current model"):
        step_forward(out)


def test_a_second_command_on_the_same_rig_follows_it(folder):
    grow(folder, 211e9)
    history = read_history(grow(folder, 212e9))
    assert [(e.model, e.parent) for e in history.entries] == [
        ("as given", None),
        ("E = 2.11e+11", 1),
        ("E = 2.12e+11", 1),
    ]


def test_a_command_on_the_updated_rig_goes_on_from_there(folder):
    out = grow(folder, 211e9)
    grow(folder, 212e9, given=read_rig(out / "rig.updated.toml"))
    assert [entry.parent for entry in read_history(out).entries] == [None, 1, 2]


@pytest.mark.parametrize("edited", ["# by hand\n", "[[ no toml"])
def test_what_was_changed_by_hand_is_kept_before_it_is_replaced(folder, edited):
    out = grow(folder, 211e9)
    (out / "rig.updated.toml").write_text(edited)
    assert step_back(out).model == "E = 2.11e+11"
    assert young(out) == 211e9
    assert (out / "history" / "0003.toml").read_text() == edited
    assert step_forward(out).model == "changed by hand"
    grow(folder, 213e9)  # a file that is no rig does not stop the next command


def test_a_folder_without_history_is_told(tmp_path):
    with pytest.raises(InputError, match="no history; testbed diagnose and testbed add keep one"):
        some_history(tmp_path)


def test_a_damaged_index_is_told_and_not_overwritten(folder):
    out = grow(folder, 211e9)
    (out / "history" / "history.json").write_text("{}")
    with pytest.raises(InputError, match=r"history.json: .*; the index of a history is written by this program"):
        grow(folder, 212e9)
    assert (out / "history" / "history.json").read_text() == "{}"


def test_comments_of_the_owner_stay(folder):
    out = grow(folder, 211e9)
    assert "# The owner's comment." in (out / "rig.updated.toml").read_text()
