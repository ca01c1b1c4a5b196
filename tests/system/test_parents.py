"""How processes end: what was said is written, and the status is told."""

import subprocess
import sys


def test_a_process_that_ends_at_once_has_said_all_and_frees_nothing():
    code = """
import atexit
from cityx.system.parents import end_at_once
atexit.register(print, "freed")
print("said", end="")
end_at_once(3)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (3, "said", "")


def test_a_command_does_what_waits_for_the_end():
    code = """
import atexit, sys
from cityx.cli import main
atexit.register(print, "freed")
sys.argv = ["cityx", "--version"]
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stdout.startswith("cityx ")
    assert done.stdout.endswith("freed\n")
