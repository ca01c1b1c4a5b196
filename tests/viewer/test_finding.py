"""What the search of the page finds: by id, address, name, and what things are like."""

import json
from dataclasses import replace

import pytest

from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.viewer.details import find


@pytest.fixture(scope="module")
def city(built_town):
    city = read_city(built_town(lod=1) / "city")
    table = city.layout.buildings.copy()
    tags = [json.loads(text) if text.startswith("{") else {} for text in table["tags"]]
    for row, number in enumerate(("8", "18;20", "18a")):
        tags[row] |= {"addr:housenumber": number, "addr:street": "Hatters' Lane"}
    table["tags"] = [json.dumps(each) for each in tags]
    names = table["name"].tolist()
    names[3] = "The Hatters' Lane Bakery"
    table["name"] = names
    return replace(city, layout=replace(city.layout, buildings=table))


@pytest.mark.parametrize(
    ("text", "row", "how"),
    [
        ("8 Hatters' Lane", 0, "address"), ("hatters' lane 8", 0, "address"),
        ("Hatters' Lane, 18", 1, "address"), ("20 hatters' lane", 1, "address"),
        ("18a Hatters' Lane", 2, "address"), ("hatters' lane", 3, "name"),
    ],
)  # fmt: skip
def test_one_house_is_found_by_its_address_either_way_round(city, text, row, how):
    told = find(city, text)
    number = int(city.layout.buildings["id"].iloc[row])
    assert [told["how"], told["total"]] == [how, 1]
    assert told["objects"][0]["id"] == f"{number:016x}"


def test_ids_and_predicates_are_found_and_what_is_not_there_is_said(city):
    number = f"{int(city.layout.buildings['id'].iloc[0]):016x}"
    assert {item["id"] for item in find(city, number)["objects"]} == {number}
    assert find(city, "buildings over 5 m")["total"] > 1
    with pytest.raises(UsageError, match="Nothing is called"):
        find(city, "9 Hatters Lane of Nowhere")
