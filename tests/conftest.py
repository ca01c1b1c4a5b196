import os
import sys
from collections import defaultdict
from pathlib import Path
from zlib import crc32

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for `town`


def pytest_addoption(parser):
    parser.addoption("--all", action="store_true", help="run every case of every sweep")


@pytest.hookimpl(trylast=True)  # after -k and -m
def pytest_collection_modifyitems(config, items):
    """Leave a sample of each sweep, and let slow modules begin first.

    The sample are the cases whose names have the smallest hashes, the same in every process.
    """
    sweeps, left_out = defaultdict(list), set()
    for item in items:
        if item.get_closest_marker("sweep") and not config.getoption("--all"):
            sweeps[item.nodeid.partition("[")[0]].append(item)
    for cases in sweeps.values():
        cases.sort(key=lambda item: crc32(item.name.encode()))
        left_out.update(cases[cases[0].get_closest_marker("sweep").args[0] :])
    config.hook.pytest_deselected(items=list(left_out))
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items[:] = sorted(
        (item for item in items if item not in left_out), key=lambda item: item.path not in slow
    )


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory):
    """A folder that all processes of one run of the tests have in common."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session")
def made_once(shared_folder):
    """Make a folder in the first process that asks for it; it is only to be read."""
    from fcntl import LOCK_EX, flock

    def made(name, make):
        folder = shared_folder / name
        with (shared_folder / f"{name}.lock").open("w") as lock:
            flock(lock, LOCK_EX)
            if not folder.exists():
                partial = shared_folder / f"{name}.partial"
                make(partial)
                partial.rename(folder)
        return folder

    return made


@pytest.fixture(scope="session", autouse=True)
def _own_cache(shared_folder):
    """Keep the user's cache out of the tests, and the tests out of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CITYX_CACHE", str(shared_folder / "cache"))
        yield


@pytest.fixture(scope="session")
def town_map(made_once):
    """A map file of a small town."""
    from town import small_town

    def make(folder):
        folder.mkdir()
        small_town().write(folder / "town.osm")

    return made_once("map", make) / "town.osm"


@pytest.fixture(scope="session")
def built_town(town_map, made_once):
    """Return the folder of the small town as it is built by some options; it is only to be read."""
    from cityx.options import BuildOptions
    from cityx.projects.build import build

    def built(*formats, **options):
        chosen = {"lod": 2, **options}
        words = [*formats, *(f"{key}_{value}" for key, value in sorted(chosen.items()))]
        wanted = BuildOptions(formats=formats, render=False, **chosen)
        return made_once("-".join(["town", *words]), lambda out: build([town_map], out, wanted))

    return built


@pytest.fixture(scope="session")
def scene_folder(made_once):
    """Return the folder of a base scene of the benchmark, built once; it is only to be read."""
    from cityx_bench.runner import build_scene

    return lambda name: made_once(f"scene-{name}", lambda out: build_scene(name, out))


@pytest.fixture(scope="session")
def scene(scene_folder):
    """Return a base scene of the benchmark as a city."""
    from functools import cache

    from cityx.city.store import read_city

    return cache(lambda name: read_city(scene_folder(name) / "city"))


@pytest.fixture(scope="session")
def crossroads():
    """A crossroads of four arms with houses, a park, a wood and a pond."""
    from crossroads import crossroads_city

    return crossroads_city()
