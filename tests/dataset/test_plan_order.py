import os
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import pytest
from planned_town import planned

TESTS = Path(__file__).parents[1]
WORDS = {
    "street": (12, {}),
    "drive": (12, {"length": 6, "rig": "surround"}),
    "walk": (6, {"length": 3}),
}


def digest(names):
    """Return what tells plans apart, made in an order of their names."""
    made = {name: planned(name, WORDS[name][0], seed=3, weathers=["clear", "rain"],
                          **WORDS[name][1]).shots for name in names}  # fmt: skip
    return sha256(repr([made[name] for name in WORDS]).encode()).hexdigest()


@pytest.mark.slow  # another process reads its libraries again
def test_plans_are_the_same_in_any_order_and_process():
    here = digest(WORDS)
    assert digest(reversed(WORDS)) == here
    turned = "[*WORDS][1:] + [*WORDS][:1]"
    code = f"from test_plan_order import WORDS, digest; print(digest({turned}))"
    there = {**os.environ, "PYTHONHASHSEED": "7", "NUMBA_NUM_THREADS": "1",
             "PYTHONPATH": os.pathsep.join([str(TESTS), str(TESTS / "dataset"),
                                            str(TESTS.parent)])}  # fmt: skip
    told = subprocess.run([sys.executable, "-c", code], env=there, check=True, capture_output=True)
    assert told.stdout.decode().strip() == here
