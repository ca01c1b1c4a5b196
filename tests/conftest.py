import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for `town`


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory):
    """Keep the user's cache out of the tests, and the tests out of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CITYX_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def town_map(tmp_path_factory):
    """A map file of a small town."""
    from town import small_town

    return small_town().write(tmp_path_factory.mktemp("map") / "town.osm")


@pytest.fixture(scope="session")
def scene_folder(tmp_path_factory):
    """Return the folder of a base scene of the benchmark, built once; it is only to be read."""
    from functools import cache

    from cityx_bench.runner import build_scene

    folder = tmp_path_factory.mktemp("scenes")

    @cache
    def built(name):
        build_scene(name, folder / name)
        return folder / name

    return built


@pytest.fixture(scope="session")
def scene(scene_folder):
    """Return a base scene of the benchmark as a city."""
    from functools import cache

    from cityx.city.store import read_city

    return cache(lambda name: read_city(scene_folder(name) / "city"))
