import os
import signal
import subprocess
import sys

import pytest

from cityx.system.extensions import forget, refusals, refuse
from cityx.system.forked import CAN_FORK, Forked

pytestmark = pytest.mark.skipif(not CAN_FORK, reason="processes are copied on Linux alone")


def test_a_copy_does_the_work_and_what_it_changes_stays_with_it():
    seen = [1]

    def work():
        seen.append(2)
        return os.getpid(), sum(seen)

    copy = Forked(work)
    seen.append(10)
    process, total = copy.result()
    assert process != os.getpid()
    assert (total, seen) == (3, [1, 10])
    assert copy.spent.keys() == {"wall_s", "cpu_s"}


def test_without_a_copy_the_work_is_done_when_it_is_asked_for():
    copy = Forked(os.getpid, apart=False)
    assert copy.result() == os.getpid()
    assert copy.spent is None


def test_what_a_copy_raises_is_raised_here_and_said_once(capfd):
    def fails():
        raise ValueError("no ground")

    with pytest.raises(ValueError, match="no ground"):
        Forked(fails).result()
    assert capfd.readouterr() == ("", "")


def test_the_work_of_a_copy_that_is_killed_is_done_here():
    mine = os.getpid()

    def work():
        if os.getpid() != mine:
            os.kill(os.getpid(), signal.SIGKILL)
        return 7

    assert Forked(work).result() == 7


def test_what_cannot_be_sent_is_made_here():
    assert Forked(lambda: lambda: 7).result()() == 7


def test_a_refusal_of_a_copy_is_known_here():
    forget()
    Forked(lambda: refuse("Format x was left out.")).result()
    assert refusals() == ("Format x was left out.",)
    forget()


def test_a_copy_ends_with_the_process_that_it_is_a_copy_of():
    program = (
        "import os, time; from cityx.system.forked import Forked; "
        "copy = Forked(lambda: time.sleep(60)); print('begun', flush=True); time.sleep(60)"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"begun\n"
    process.kill()
    process.communicate(timeout=10)  # a copy that lives on would hold the pipe
