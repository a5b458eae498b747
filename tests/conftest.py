"""Set-up of all tests."""

import gc
import os
from collections import Counter

import pytest
from hypothesis import settings

LONG = (
    "test_browser.py", "test_kills.py", "test_bounds.py", "test_pages.py", "test_cluster.py", "test_full_disk.py",
    "test_site.py", "test_sweep_command.py", "test_no_other_error_escapes.py",
)  # fmt: skip
"""Files of few tests that take long: begun last, they would leave one worker alone."""

# Before NumPy is there, and for all processes that tests begin: with a thread for each core, two workers on two cores
# spend 1.6 times the CPU on small matrices, waiting. As on another machine (tests/elsewhere.py) there are more.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The same examples in every run, so that a green tree stays green; HYPOTHESIS_PROFILE=default looks for new ones.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Files in the order in which workers take them (`--no-loadscope-reorder`): long ones, then those of most tests."""
    if hasattr(config, "workerinput"):
        tests = Counter(item.path for item in items)
        items.sort(key=lambda item: (item.path.name not in LONG, -tests[item.path]))


def pytest_collection_finish() -> None:
    """What thousands of tests are made of stays: Python need not look through it for cycles again and again."""
    gc.collect()
    gc.freeze()
