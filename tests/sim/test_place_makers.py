"""What makes places in a process of its own ends with who asked for them."""

import os
import subprocess
import sys
import time
from pathlib import Path

MAKER = """
import os, time
from pathlib import Path
from cityx.sim.places import answer_order

def made(order):
    if "told" not in order:
        return {"pid": os.getpid()}
    Path(order["told"]).write_text(str(os.getpid()))
    time.sleep(60)

answer_order(made)
"""
ASKS = """
import sys
from cityx.sim.places import in_process
in_process({"told": sys.argv[1]}, "slow_maker")
"""


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_a_maker_ends_when_who_asked_it_is_killed(tmp_path):
    (tmp_path / "slow_maker.py").write_text(MAKER)
    paths = os.pathsep.join([str(tmp_path), *sys.path])
    told = tmp_path / "told"
    asks = subprocess.Popen([sys.executable, "-c", ASKS, str(told)],
                            env={**os.environ, "PYTHONPATH": paths})  # fmt: skip
    while not (told.exists() and told.read_text()):
        assert asks.poll() is None
        time.sleep(0.05)
    pid = int(told.read_text())
    assert is_alive(pid)
    asks.kill()
    asks.wait()
    until = time.monotonic() + 10.0
    while is_alive(pid) and time.monotonic() < until:
        time.sleep(0.05)
    assert not is_alive(pid)
