import gc
import weakref

import pytest

from cityx.options import BuildOptions
from cityx.projects import build as module
from cityx.projects import storing
from cityx.projects.build import build
from cityx.projects.views import Drawing

TEXT = "A village of 120 x 120 m with four houses"


def _built(folder, monkeypatch, most):
    """Return the report, and whether a city was alive when Blender was handed it."""
    cities, alive = [], []
    made, begin = module.generate, Drawing.begin

    def generated(*args, **kept):
        city = made(*args, **kept)
        cities.append(weakref.ref(city.scene))
        return city

    def begun(drawing):
        gc.collect()
        alive.append(cities[0]() is not None)
        begin(drawing)

    monkeypatch.setattr(storing, "MOST_BESIDE", most)
    monkeypatch.setattr(module, "generate", generated)
    monkeypatch.setattr(Drawing, "begin", begun)
    report = build([], folder, BuildOptions(text=TEXT, formats=("glb",), render=False, lod=1))
    return report, alive


@pytest.mark.parametrize(("most", "held"), [(0, False), (10**9, True)])
def test_a_large_city_is_let_go_of_before_blender_takes_it(tmp_path, monkeypatch, most, held):
    report, alive = _built(tmp_path / "town", monkeypatch, most)
    assert alive == [held]
    assert report["hash"]
    assert (tmp_path / "town" / "city.glb").exists()
