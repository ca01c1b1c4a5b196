"""Actions of other packages, run in a process of their own."""

import importlib

import numpy as np
import pytest

from cityx.city.content import content_hash
from cityx.errors import ActionFailed, UsageError
from cityx.protocol import isolation, registry
from cityx.protocol.example_city import example_city
from cityx.protocol.gate import Call
from cityx.protocol.isolation import Limits, meshes_apart, run_apart
from cityx.protocol.values import Footprint

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


def install(folder, name, source, entry):
    (folder / f"{name}_plugin.py").write_text(source)
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[cityx.actions]\n{entry}\n")


@pytest.fixture
def odd(tmp_path, monkeypatch):
    install(tmp_path, "odd", SOURCE, "nature/odd-v1 = odd_plugin:odd")
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


HANGING = """
from cityx.city import MeshBatch
from cityx.protocol.plugged import generator
from cityx.protocol.solid_blocks import block
from cityx.protocol.values import Footprint


@generator("building/stuck-v1")
def stuck(footprint: Footprint) -> MeshBatch:
    '''Never end on small footprints.

    Parameters
    ----------
    footprint
        Outline.
    '''
    while footprint.polygon.area < 50:
        pass
    return block(footprint.ring, 9.0)
"""


def test_a_generator_that_hangs_is_named_while_it_is_waited_for_and_stopped(
    tmp_path, monkeypatch, caplog
):
    install(tmp_path, "stuck", HANGING, "building/stuck-v1 = stuck_plugin:stuck")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(isolation, "PATIENCE", 2.0)
    squares = [Footprint(np.array([(0, 0), (a, 0), (a, a), (0, a)], float)) for a in (9, 5)]
    made = meshes_apart(
        registry()["building/stuck"], squares, {}, 0, Limits(each=9.0), package="stuck"
    )
    assert made == ["it took longer than 9 seconds for building 2 of 2"] * 2
    (line,) = [r.getMessage() for r in caplog.records if "building 2 of 2" in r.getMessage()]
    assert line.startswith("waiting for building/stuck-v1 of package stuck, building 2 of 2")
    assert "stopped after 9 s" in line


def test_the_limits_of_time_may_be_said(monkeypatch):
    assert (Limits().seconds, Limits().each) == (300.0, 60.0)
    monkeypatch.setenv("CITYX_PLUGIN_SECONDS", "7")
    assert (Limits().seconds, Limits().each) == (7.0, 7.0)
    monkeypatch.setenv("CITYX_PLUGIN_SECONDS", "soon")
    with pytest.raises(UsageError, match='CITYX_PLUGIN_SECONDS is "soon"; it takes a number'):
        Limits()
