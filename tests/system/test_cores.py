import threading

import pytest

from cityx.system import cores
from cityx.system.cores import in_threads


@pytest.mark.parametrize("threads", [None, 1, 2, 7])
def test_results_come_in_the_order_of_the_items(threads):
    assert in_threads(lambda item: item * item, range(20), threads) == [n * n for n in range(20)]
    assert in_threads(str, [], threads) == []


def test_as_many_work_at_once_as_there_are_cores(monkeypatch):
    monkeypatch.setattr(cores, "core_count", lambda: 3)
    together = threading.Barrier(3, timeout=10.0)
    assert in_threads(lambda _: together.wait() >= 0, range(3)) == [True] * 3


def test_a_single_core_needs_no_thread(monkeypatch):
    monkeypatch.setattr(cores, "core_count", lambda: 1)
    names = in_threads(lambda _: threading.current_thread().name, range(3))
    assert set(names) == {threading.current_thread().name}


def test_what_fails_in_a_thread_is_raised():
    with pytest.raises(ZeroDivisionError):
        in_threads(lambda item: 1 // item, [1, 0, 2], 2)
