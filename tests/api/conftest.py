import pytest
from copies import copy_of


@pytest.fixture(scope="session")
def held(town_map):
    """The small town in memory; only to be looked at."""
    import cityx

    return cityx.build(town_map, lod=1, seed=5)


@pytest.fixture
def own(held, tmp_path):
    """A copy of the small town that a test may change."""

    import cityx

    copy_of(held._folder, tmp_path / "town")
    return cityx.open(tmp_path / "town")
