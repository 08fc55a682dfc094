import ast
import subprocess
import sys
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[2]

CALLER = """
from models.compiled import compiled
from callee import factor

@compiled
def scaled(x: float) -> float:
    return factor() * x

print(scaled(10.0), sum(scaled.stats.cache_hits.values()))
"""

CALLEE = """
from models.compiled import compiled

@compiled
def factor() -> float:
    return {value}
"""


def run_in_a_new_process(folder):
    """Result and whether it came from the cache."""
    python = f"import sys; sys.path[:0] = [{str(HOUSE)!r}, {str(folder)!r}]; import caller"
    done = subprocess.run([sys.executable, "-c", python], capture_output=True, text=True, check=True)
    value, hits = done.stdout.split()
    return float(value), int(hits) > 0


def test_the_cache_is_used_until_another_file_of_the_folder_changes(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(value=2.0))
    assert run_in_a_new_process(tmp_path) == (20.0, False)
    assert run_in_a_new_process(tmp_path) == (20.0, True)
    (tmp_path / "callee.py").write_text(CALLEE.format(value=3.0))
    assert run_in_a_new_process(tmp_path) == (30.0, False)


SHAPED = """
from typing import NamedTuple
from models.compiled import compiled
{source}

@compiled
def scaled(shape) -> float:
    return 10.0 * shape.size

print(scaled(Shape({value})), sum(scaled.stats.cache_hits.values()))
"""


def test_a_cache_that_names_a_type_of_a_file_that_is_gone_is_not_read(tmp_path):
    of_type = "class Shape(NamedTuple):\n    size: float\n"
    (tmp_path / "shapes.py").write_text("from typing import NamedTuple\n\n" + of_type)
    (tmp_path / "caller.py").write_text(SHAPED.format(source="from shapes import Shape", value=2.0))
    assert run_in_a_new_process(tmp_path) == (20.0, False)
    (tmp_path / "shapes.py").rename(tmp_path / "forms.py")
    kept = (tmp_path / "caller.py").stat()
    (tmp_path / "caller.py").write_text(SHAPED.format(source="from forms  import Shape", value=2.0)[: kept.st_size])
    assert run_in_a_new_process(tmp_path) == (20.0, False)


MODELS = Path(__file__).parents[2] / "models"
BUILT_IN = ("contact_forces", "lanes", "law_call", "step_options", "straight_contacts")
"""Files whose code or constants are built into kernels of others."""


class Kernels:
    """The compiled functions of a file of the stepper."""

    def __init__(self, name):
        tree = ast.parse((MODELS / f"{name}.py").read_text(encoding="utf-8"))
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
        self.functions = {node.name: node for node in functions if "njit" in ast.dump(ast.List(node.decorator_list))}
        imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module]
        self.source = {alias.name: node.module.removeprefix("models.") for node in imports for alias in node.names}

    def files_of(self, function):
        """Those that its code comes from, its own but for itself, and through what it calls."""
        named = {node.id for node in ast.walk(self.functions[function]) if isinstance(node, ast.Name)}
        found = {self.source[name] for name in named if self.source.get(name) in BUILT_IN}
        for name in named - {function}:
            if name in self.functions:
                found |= self.files_of(name)
            elif self.source.get(name) in ("contact_forces", "straight_contacts"):
                other = Kernels(self.source[name])
                found |= other.files_of(name) if name in other.functions else set()
        return found

    def noticed_by(self, function):
        calls = [node for node in self.functions[function].decorator_list if isinstance(node, ast.Call)]
        (names,) = [[arg.value for arg in call.args] for call in calls if call.func.id == "noticing"] or [[]]
        return {name.removesuffix(".py") for name in names}

    def is_kept(self, function):
        """Whether it is cached by itself."""
        return "INLINE" not in ast.dump(ast.List(self.functions[function].decorator_list))


@pytest.mark.parametrize("name", ["contact_forces", "straight_contacts", "stepping", "live_band", "thinning"])
def test_a_kept_kernel_notices_every_file_that_is_built_into_it(name):
    kernels = Kernels(name)
    kept = [function for function in kernels.functions if kernels.is_kept(function)]
    assert kept
    missed = {each: kernels.files_of(each) - {name} - kernels.noticed_by(each) for each in kept}
    assert {each: files for each, files in missed.items() if files} == {}
