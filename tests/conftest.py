"""What holds for every test: where real measurements are found, and how hypothesis searches."""

import os

import pytest
from hypothesis import settings

# The same examples on every machine; no deadline, since a first call may compile.
settings.register_profile("house", deadline=None, derandomize=True)
settings.load_profile("house")


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("real_data") and not os.environ.get("TESTBED_DATA"):
        pytest.skip("TESTBED_DATA names no folder with other people's measurements")
