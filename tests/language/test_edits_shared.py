"""What one command says once holds for all that it adds."""

from cityx.agents.briefs import read_request
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.options import BuildOptions
from cityx.protocol.example_city import example_city


def test_buses_drive_at_the_speed_of_the_traffic_they_are_added_with():
    text = "Add 12 buses and 40 mph traffic on both bridges."
    brief = read_request(BuildOptions(text=text), [], base=True).brief
    (_, buses), (_, traffic) = slots_of_edits(brief, example_city())
    assert buses["agent"] == ("bus",)
    assert buses["speed"] == traffic["speed"]
    assert 17.8 < traffic["speed"][0] < 17.9


def test_buses_of_another_command_drive_as_they_like():
    text = "Add 12 buses on the bridge. Add 40 mph traffic along the main street."
    brief = read_request(BuildOptions(text=text), [], base=True).brief
    slots = [found for _, found in slots_of_edits(brief, example_city())]
    assert "speed" not in next(found for found in slots if found.get("agent") == ("bus",))
