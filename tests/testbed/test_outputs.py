"""Results are written whole or not at all."""

import pytest

from models.errors import InputError
from testbed.outputs import LAST, check_open, staged


def test_files_and_folders_arrive_together(tmp_path):
    with staged(tmp_path / "out") as stage:
        (stage / "figures").mkdir()
        (stage / "figures" / "a.png").write_text("picture")
        (stage / LAST).write_text("{}")
        assert not (tmp_path / "out" / LAST).exists()
    assert sorted(str(f.relative_to(tmp_path / "out")) for f in (tmp_path / "out").rglob("*")) == [
        "figures", "figures/a.png", LAST,
    ]  # fmt: skip


def test_a_folder_that_is_open_is_not_made_yet(tmp_path):
    check_open(tmp_path / "deep" / "er")
    assert not any(tmp_path.iterdir())


def test_a_folder_in_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file is a file; results go into a folder"):
        check_open(tmp_path / "file" / "out")


def test_a_failure_leaves_what_was_there(tmp_path):
    (tmp_path / "a.json").write_text("old")

    def fail():
        with staged(tmp_path) as stage:
            (stage / "a.json").write_text("half")
            raise ArithmeticError

    with pytest.raises(ArithmeticError):
        fail()
    assert [file.read_text() for file in tmp_path.rglob("*")] == ["old"]


def test_a_folder_that_is_a_file_is_told_in_three_parts(tmp_path):
    (tmp_path / "out").write_text("")
    message = r"--out .*out: .*/out is a file; results go into a folder .*; name another"
    with pytest.raises(InputError, match=message), staged(tmp_path / "out"):
        pass


@pytest.mark.parametrize(
    ("obstacle", "message"),
    [
        ("z.html/", r"--out .*: .*/z.html is a folder, and a file is to be written there; .*; name another folder"),
        ("figures", r"--out .*: .*/figures is a file; results go into a folder .*; .*, or move away what is there"),
    ],
)
def test_nothing_is_replaced_where_one_target_is_blocked(tmp_path, obstacle, message):
    (tmp_path / "a.json").write_text("old")
    (tmp_path / obstacle).mkdir() if obstacle.endswith("/") else (tmp_path / obstacle).write_text("")

    def write():
        with staged(tmp_path) as stage:
            (stage / "figures").mkdir()
            for name in ("a.json", "z.html", "figures/a.png"):
                (stage / name).write_text("new")

    with pytest.raises(InputError, match=message):
        write()
    assert (tmp_path / "a.json").read_text() == "old"
    assert {path.name for path in tmp_path.iterdir()} == {"a.json", obstacle.strip("/")}


def test_obstacles_are_seen_before_anything_is_written(tmp_path):
    (tmp_path / "run.json").mkdir()
    (tmp_path / "figures").write_text("")
    check_open(tmp_path, ["other.json", "run.json/"])
    with pytest.raises(InputError, match=r"run.json is a folder"):
        check_open(tmp_path, ["other.json", "run.json"])
    with pytest.raises(InputError, match=r"figures is a file"):
        check_open(tmp_path, ["figures/"])
