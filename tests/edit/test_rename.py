import pytest

from cityx.edit.objects.rename import rename
from cityx.errors import ActionFailed
from cityx.ids import id_text


def test_a_street_gets_another_name_and_nothing_else(park):
    road = park.layout.roads.iloc[0]
    new = rename(park, objects=(id_text(int(road["id"])),), name="King Street")
    names = new.layout.roads.set_index("id")["name"]
    assert names[road["id"]] == "King Street"
    others = park.layout.roads.set_index("id")["name"].drop(road["id"])
    assert (names.drop(road["id"]) == others).all()


def test_what_has_no_name_gets_none(park):
    tree = park.scene.instances["trees"].object_id[0]
    with pytest.raises(ActionFailed, match="no name"):
        rename(park, objects=(id_text(int(tree)),), name="Old Oak")
