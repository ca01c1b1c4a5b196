"""Quality is measured on what was built, and a table and a plot show every city."""

import json
from dataclasses import replace
from math import isnan, nan
from xml.etree import ElementTree

import numpy as np
import pytest
from cityx_bench.inputs import write_osm
from cityx_bench.quality import MEASURES, plot_of, quality_of, table_of, write_quality

from cityx.checks.facade_checks import repeated_share
from cityx.city.scene import no_instances
from cityx.city.store import read_city
from cityx.errors import InputError
from cityx.options import BuildOptions
from cityx.projects.build import build


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("quality")
    (folder / "maps").mkdir()
    write_osm(folder / "maps" / "town.osm")
    options = BuildOptions(lod=1, formats=(), render=False)
    build([folder / "maps" / "town.osm"], folder / "city", options)
    return folder


def test_a_city_of_a_map_is_measured_in_all_but_its_style(built):
    found = quality_of(built / "city", [built / "maps" / "town.osm"])
    assert list(found) == [measure.name for measure in MEASURES]
    assert [name for name, value in found.items() if isnan(value)] == ["doors", "style"]
    assert all(one.kept(found[one.name]) for one in MEASURES if not isnan(found[one.name]))
    assert found["fidelity"] > 0.85
    assert isnan(quality_of(built / "city")["fidelity"])


def test_another_map_is_no_measure_of_fidelity(built, tmp_path):
    with pytest.raises(InputError, match=r"town\.osm.*is not among the maps"):
        quality_of(built / "city", [tmp_path / "other.osm"])
    (tmp_path / "town.osm").write_text("<osm/>")
    with pytest.raises(InputError, match="its hash differs"):
        quality_of(built / "city", [tmp_path / "town.osm"])
    with pytest.raises(InputError, match="holds no built city"):
        quality_of(tmp_path)


def test_a_house_that_is_built_twice_is_a_repetition(built):
    city = read_city(built / "city" / "city")
    windows = city.scene.instances.get("windows", no_instances())
    buildings = city.layout.buildings
    assert repeated_share(city, windows, 1e6) >= repeated_share(city, windows, 50.0)
    batch = city.scene.meshes["buildings"]
    plain = type(batch)(
        **{**vars(batch), "tint": np.ones_like(batch.tint),
           "material": np.zeros_like(batch.material)}
    )  # fmt: skip
    one = buildings.geometry.iloc[0]
    same = buildings.assign(generator="g", levels=3, geometry=one)
    parts = city.layout.parts.assign(roof_shape="flat")
    layout = replace(city.layout, buildings=same, parts=parts)
    alike = replace(city, layout=layout, scene=city.scene.with_mesh("buildings", plain))
    assert repeated_share(alike, no_instances(), 1.0) == 1.0


def rows(**values):
    return (
        dict.fromkeys((m.name for m in MEASURES), 1.0)
        | {"overlap": 0.0, "repetition": 0.0}
        | values
    )


def test_what_was_not_measured_counts_as_neither(tmp_path):
    table = {"one": rows(style=nan), "two": rows(style=0.5), "three": rows(closed=0.9)}
    text = table_of(table)
    assert "| one | 0.000 | 0.000 | 1.000 | 1.000 | 1.000 | 1.000 | - |" in text
    last = text.splitlines()[-1]
    assert "2/3 (>= 1)" in last
    assert "1/2 (>= 0.7)" in last
    write_quality(table, "cityx bench quality", tmp_path)
    record = json.loads((tmp_path / "quality.json").read_text())
    assert record["cities"]["one"]["style"] is None
    root = ElementTree.fromstring((tmp_path / "quality.svg").read_text())
    dots = [each for each in root.iter() if each.tag.endswith("circle")]
    assert len(dots) == 3 * len(MEASURES) - 1
    assert sum(each.get("fill") == "#b3261e" for each in dots) == 2
    assert plot_of(table) == plot_of(table)
