import pytest

from cityx.city.content import content_hash

ARRANGED = ("meshes/ground", "meshes/surroundings")  # under houses divided by their volumes


@pytest.fixture(scope="session")
def objects():
    """Return the hashes of all objects of a city, the arranged ground apart."""

    def hashes(city):
        layers = content_hash(city).layers
        return {name: [part.tolist() for part in value] for name, value in layers.items()
                if name not in ARRANGED}  # fmt: skip

    return hashes


@pytest.fixture(scope="session")
def grid(scene):
    """The base scene of sixteen blocks: every street has walks, the main street lamps."""
    return scene("grid_s")


@pytest.fixture(scope="session")
def river(scene):
    """The base scene of two banks, with cars that park along two streets."""
    return scene("river_s")


@pytest.fixture(scope="session")
def park(scene):
    """The base scene of a park with a path around it."""
    return scene("park_s")
