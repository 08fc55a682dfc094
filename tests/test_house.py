"""The rules of the house that no single room can check: arrows, mirrors, start-up and the lock file."""

import ast
import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HOUSE = Path(__file__).parents[1]
MAY_IMPORT = {
    "models": {"models"},
    "identification": {"models", "identification"},
    "testbed": {"models", "identification", "testbed"},
}
HEAVY = {"numpy", "scipy", "numba", "pydantic", "matplotlib", "typer", "pint", "h5py", "mujoco", "exudyn", "trimesh"}
PYPROJECT = tomllib.loads((HOUSE / "pyproject.toml").read_text())


def imported_modules(source: str) -> set[str]:
    """Every module that the source names in an import statement, wherever it stands."""
    modules = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            modules.add("." * node.level + (node.module or ""))
    return modules


def forbidden_imports(room: str, source: str) -> set[str]:
    """What a file of that room may not import; a relative import is refused because it hides its room."""
    closed = (set(MAY_IMPORT) | {"tests"}) - MAY_IMPORT[room]
    return {name for name in imported_modules(source) if name.startswith(".") or name.split(".")[0] in closed}


def lock() -> dict[str, str]:
    lines = (HOUSE / "requirements.lock").read_text().splitlines()
    return {canonicalize_name(name): version for name, version in (line.split("==") for line in lines)}


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_arrows_point_one_way(room):
    files = sorted((HOUSE / room).rglob("*.py"))
    assert files
    wrong = {str(f.relative_to(HOUSE)): bad for f in files if (bad := forbidden_imports(room, f.read_text()))}
    assert not wrong


@pytest.mark.parametrize(
    ("room", "source"),
    [
        ("models", "import identification.frf"),
        ("models", "def late():\n    from testbed import metrics"),
        ("identification", "from testbed.metrics import mac"),
        ("identification", "from .. import testbed"),
    ],
)
def test_an_arrow_that_points_back_is_seen(room, source):
    assert forbidden_imports(room, source)


@pytest.mark.parametrize(("room", "source"), [("testbed", "from models.rig import Rig"), ("models", "import numpy")])
def test_an_arrow_that_points_forward_is_allowed(room, source):
    assert not forbidden_imports(room, source)


def test_every_test_folder_mirrors_a_folder_of_code():
    tests = HOUSE / "tests"
    folders = {file.parent.relative_to(tests) for file in tests.rglob("test_*.py")}
    assert {folder for folder in folders if not (HOUSE / folder).is_dir()} == set()


def test_test_files_have_unique_names_and_no_packages():
    """Without packages pytest imports a test file by its bare name, so two of one name would collide."""
    names = Counter(file.name for file in (HOUSE / "tests").rglob("*.py"))
    assert [name for name, count in names.items() if count > 1] == []
    assert "__init__.py" not in names


def test_version_answers_before_anything_heavy_is_imported():
    command = [sys.executable, "-X", "importtime", "-m", "testbed", "--version"]
    result = subprocess.run(command, cwd=HOUSE, capture_output=True, text=True, check=True)
    imported = {line.split("|")[-1].strip().split(".")[0] for line in result.stderr.splitlines()}
    assert re.fullmatch(r"testbed \d+\.\d+\.\d+\n", result.stdout)
    assert "testbed" in imported
    assert imported & HEAVY == set()
    assert len(result.stderr.splitlines()) < 200  # 67 modules with those of a bare interpreter


def test_the_lock_holds_exact_versions_only_and_in_order():
    lines = (HOUSE / "requirements.lock").read_text().splitlines()
    assert [line for line in lines if not re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!]+", line)] == []
    assert lines == sorted(set(lines), key=str.lower)


def test_the_lock_satisfies_every_declared_dependency():
    project = PYPROJECT["project"]
    declared = [Requirement(r) for r in [*project["dependencies"], *project["optional-dependencies"]["dev"]]]
    locked = lock()
    unmet = [str(r) for r in declared if not r.specifier.contains(locked.get(canonicalize_name(r.name), "0"))]
    missing = [r.name for r in declared if canonicalize_name(r.name) not in locked]
    assert (unmet, missing) == ([], [])
