import subprocess
import sys
from pathlib import Path

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
