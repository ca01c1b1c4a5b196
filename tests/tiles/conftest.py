import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "viewer"))  # for `glb` and `validating`


def quiet(_):
    pass


@pytest.fixture(scope="session")
def order_and_map(town_map):
    from cityx.tiles.planning import order_of

    return order_of([town_map], lod=1, size=500.0)


@pytest.fixture(scope="session")
def built_tiles(order_and_map, made_once):
    """The folder of the four tiles that meet in the middle of the small town."""
    from cityx.tiles.run import build_tiles, prepared

    order, source = order_and_map

    def make(folder):
        tiles = prepared(order, source, folder, quiet)
        summary = build_tiles(folder, order, tiles, say=quiet)
        assert (summary.built, summary.failed) == (4, {})

    return made_once("tiles", make)
