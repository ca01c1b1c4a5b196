"""Actions of other packages, run in a process of their own."""

import importlib

import pytest

from cityx.city.content import content_hash
from cityx.errors import ActionFailed
from cityx.protocol import registry
from cityx.protocol.example_city import example_city
from cityx.protocol.gate import Call
from cityx.protocol.isolation import Limits, run_apart

SOURCE = '''
import os
import time
from dataclasses import replace
from typing import Annotated

from cityx.city import City
from cityx.protocol import Choice, action


HOW = Choice("note", "sleep", "eat", "die", "ask")


@action("nature/odd-v1", limits=["Does odd things."], requires=("layout",))
def odd(city: City, *, how: Annotated[str, HOW] = "note") -> City:
    """Do something odd.

    Parameters
    ----------
    city
        The city.
    how
        What.
    """
    if how == "sleep":
        time.sleep(60)
    if how == "eat":
        bytearray(64 << 30)
    if how == "die":
        os._exit(7)
    told = os.environ.get("ODD_API_KEY", "no key") if how == "ask" else str(os.getpid())
    return replace(city, notes=(*city.notes, told))
'''


@pytest.fixture
def odd(tmp_path, monkeypatch):
    (tmp_path / "odd_plugin.py").write_text(SOURCE)
    info = tmp_path / "odd-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: odd\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[cityx.actions]\nnature/odd-v1 = odd_plugin:odd\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("ODD_API_KEY", "hush")
    importlib.invalidate_caches()
    return registry()


def test_it_runs_elsewhere_sees_no_keys_and_changes_what_it_may(odd):
    from cityx.protocol.running import run_step

    city = example_city()
    made = run_step(city, Call("odd"), odd)
    assert made.notes[-1].isdecimal()
    assert run_apart(city, Call("odd", {"how": "ask"})).notes == ("no key",)
    assert content_hash(made).total == content_hash(city).total


@pytest.mark.parametrize(
    ("how", "limits", "said"),
    [
        ("sleep", Limits(seconds=12.0), "longer than 12 seconds"),
        ("eat", Limits(), "MemoryError"),
        ("die", Limits(), "ended with code 7"),
        ("wrong", Limits(), "is none of"),
    ],
)
def test_what_it_does_wrong_ends_with_it(odd, how, limits, said):
    assert "nature/odd-v1" in odd
    with pytest.raises(ActionFailed, match=said):
        run_apart(example_city(), Call("nature/odd-v1", {"how": how}), limits=limits)
