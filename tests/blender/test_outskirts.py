import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import quarter

from cityx.city import one_mesh
from cityx.city.store import write_city

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """A quarter on a plain: what a scene of it shows to several eyes."""
    folder = tmp_path_factory.mktemp("outskirts")
    city = quarter()
    corners = np.array([(-900, -900, 0), (900, -900, 0), (900, 900, 0), (-900, 900, 0)], float)
    plain = one_mesh(2, corners, [(0, 1, 2, 3)], materials=("grass",), uv=corners[None, :, :2])
    city = replace(city, scene=city.scene.with_mesh("surroundings", plain))
    write_city(city, folder / "city")
    script = Path(__file__).with_name("inspect_outskirts.py")
    words = subprocess.run(
        [sys.executable, script, folder / "city"], capture_output=True, text=True, check=True
    ).stdout
    return json.loads(words.splitlines()[-1])


def test_pictures_show_the_site_mirrored_round_itself(shown):
    own, seen = shown["xy"]["truth"], shown["xy"]["street"]
    assert len(own) == 9
    assert len(seen) == 9 * (1 + shown["images"])
    far = 3 * 22.0 + 40.0  # the eastern border of the site
    mirrored = [[round(2 * far - x, 2), y] for x, y in own]
    assert all(place in seen for place in mirrored)


def test_maps_and_truth_show_the_site_alone(shown):
    assert shown["shown"] == {"street": True, "map": False, "truth": False}
    assert shown["plain"] == {"street": [-1.5], "map": [0.0], "truth": [0.0]}
    assert shown["xy"]["map"] == shown["xy"]["truth"]


def test_a_bare_tree_has_twigs_of_bark_where_its_leaves_were(shown):
    summer, twigs, limbs = (shown["tree"][name] for name in ("summer", "twigs", "limbs"))
    assert set(twigs) == set(limbs) == {"bark"}
    assert limbs["bark"] == summer["bark"]
    assert 0.3 < (twigs["bark"] - limbs["bark"]) / summer["foliage"] < 0.5
