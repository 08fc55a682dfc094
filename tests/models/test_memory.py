"""A process that simulates keeps what it frees; counted in pages that the system had to hand out again."""

import subprocess
import sys

import pytest

COUNT = """
import resource
import numpy as np
{first}

def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

def work():
    arrays = [np.ones(2**19) for _ in range(4)]  # of 4 MB, freed together
    return sum(float(each[-1]) for each in arrays)

work()
before = faults()
for _ in range(20):
    work()
print(faults() - before)
"""


def faults_with(first):
    run = subprocess.run([sys.executable, "-c", COUNT.format(first=first)], capture_output=True, text=True, check=True)
    return int(run.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="page faults are counted as Linux does")
def test_freed_arrays_are_used_again_where_the_c_library_lets_them():
    asked = subprocess.run(
        [sys.executable, "-c", "from models.memory import keep_freed_memory; print(keep_freed_memory())"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    if asked.stdout.strip() == "False":
        pytest.skip("the C library is not glibc")
    assert faults_with("import models.simulate") < 0.05 * faults_with("")
