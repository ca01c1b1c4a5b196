"""A stranger's format, dataset writer, check, road kind, species and street object."""

import json

import numpy as np
import pytest
from strangers import built, cityx

from cityx.city.store import read_city


@pytest.fixture(scope="module")
def city_folder(strangers, town, tmp_path_factory):
    out = tmp_path_factory.mktemp("town") / "out"
    built(strangers, town, out, "--lod", 2)
    return out


def prototypes_of(folder):
    return {prototype.name for prototype in read_city(folder / "city").scene.prototypes}


def test_a_format_is_written_and_renewed_by_an_edit(strangers, town, tmp_path):
    out = tmp_path / "out"
    cityx(strangers, "build", town, "-o", out, "--lod", 1, "--no-render", "--formats", "heights")
    before = (out / "heights.csv").read_text()
    assert len(before.splitlines()) == 5
    cityx(strangers, "edit", out, "make the tallest building 47 m tall")
    assert ",47.00" in (out / "heights.csv").read_text()


def test_a_dataset_is_written_in_a_format_of_its_own(strangers, city_folder, tmp_path):
    few = ("--views", 2, "--size", "32x24", "--channels", "depth")
    cityx(strangers, "dataset", city_folder, "-o", tmp_path / "data", "--format", "names", *few)
    names = (tmp_path / "data" / "names" / "all.txt").read_text().splitlines()
    assert len(names) == len(set(names)) == 2


def test_a_check_is_measured_with_the_others(city_folder):
    check = json.loads((city_folder / "report.json").read_text())["checks"]["low_buildings"]
    assert (check["value"], check["ok"]) == (0.0, True)


def test_a_road_kind_has_its_cross_section(city_folder):
    road = read_city(city_folder / "city").layout.roads.iloc[0]
    assert (road["kind"], road["lanes"], road["surface"]) == ("living_street", 1, "sett")
    assert road["width"] == pytest.approx(4.2)


def test_a_mapped_street_object_stands_and_more_are_added(strangers, city_folder):
    assert "beehive" in prototypes_of(city_folder)
    cityx(strangers, "edit", city_folder, "add a hive in the park")
    city = read_city(city_folder / "city")
    number = [p.name for p in city.scene.prototypes].index("beehive")
    count = sum(np.sum(rows.prototype == number) for rows in city.scene.instances.values())
    assert count == 2


def test_a_species_is_planted_by_its_name(strangers, city_folder):
    cityx(strangers, "edit", city_folder, "plant two baobabs in the park")
    assert any("baobab" in name for name in prototypes_of(city_folder))
