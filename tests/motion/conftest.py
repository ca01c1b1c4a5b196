from dataclasses import replace

import pytest
from cityx_bench.scenes import SCENES, write_drawing

from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_step
from cityx.sources.drawn import read_drawn


def laid(name, folder):
    """The ground of a base scene, with nothing built on it."""
    scene = SCENES[name]
    city = read_drawn(write_drawing(scene.draw(), scene.extent, folder / f"{name}.geojson"))
    city = replace(city, lod=2)
    for action in ("road/network-v1", "road/lanes-v1", "road/ground-v1"):
        city = run_step(city, Call(action), registry())
    return city


@pytest.fixture(scope="session")
def park(tmp_path_factory):
    """A park with a path around it, a plaza and four streets."""
    return laid("park_s", tmp_path_factory.mktemp("park"))


@pytest.fixture(scope="session")
def river(tmp_path_factory):
    """Two banks, joined by two bridges."""
    return laid("river_s", tmp_path_factory.mktemp("river"))
