"""Where objects are from: the map, a rule, or an edit since the city was built."""

import pytest
from copies import copy_of

from cityx.city.content import content_hash
from cityx.projects.desk import Desk
from cityx.protocol.gate import Call
from cityx.viewer.provenance import is_map, provenance


@pytest.mark.parametrize(
    ("source", "told"),
    [("osm/way/45", True), ("drawn/plan.dxf", True), ("made/block/3", False), ("", False)],
)
def test_sources_of_files_are_maps(source, told):
    assert is_map(source) is told


def test_an_edit_is_told_apart_from_the_map_and_from_what_a_rule_made(built_town, tmp_path):
    folder = copy_of(built_town(lod=1), tmp_path / "town")
    with Desk(folder) as desk:
        first = content_hash(desk.city)
        ids = [f"{number:016x}" for number in desk.city.layout.buildings["id"].tolist()]
        before = provenance(desk.city, first, None)
        assert set(ids) <= set(before["ids"]["map"])
        assert before["ids"]["edited"] == []
        assert (before["layers"]["ground"], before["layers"]["trees"]) == (0, 1)
        desk.change([Call("edit/recolor-v1", {"objects": [ids[0]], "color": 0x2040C0})])
        after = provenance(desk.city, content_hash(desk.city), first)
    assert set(after["ids"]["edited"]) & set(ids) == {ids[0]}  # and what belongs to it
    assert ids[0] not in after["ids"]["map"]
