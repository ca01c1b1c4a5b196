"""Plans of signals: they fit each other, and those who turn get out."""

from importlib.util import find_spec

import numpy as np
import pytest
from lxml import etree
from made_streets import MIDDLE, city_of

from cityx.motion.vehicles import halts_of
from cityx.traffic import network as networks
from cityx.traffic import stages
from cityx.traffic.coordination import CYCLE, coordinate
from cityx.traffic.laying import streets_of
from cityx.traffic.turners import let_turners_out

needs_sumo = pytest.mark.skipif(
    find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
)

# A street with two signals 22 m apart; the second plan begins with the side street.
STREET = """<net>
<edge id="a"><lane length="80" speed="11"/></edge><edge id="b"><lane length="22" speed="11"/></edge>
<edge id="c"><lane length="80" speed="11"/></edge>
<connection from="a" to="b" dir="s" tl="one" linkIndex="0" via=":one_0_0"/>
<connection from="b" to="c" dir="s" tl="two" linkIndex="0" via=":two_0_0"/>
<tlLogic id="one"><phase duration="27" state="G"/><phase duration="33" state="r"/></tlLogic>
<tlLogic id="two"><phase duration="33" state="r"/><phase duration="27" state="G"/></tlLogic>
</net>"""
# Link 0 turns across link 1, which comes towards it.
CROSSING = """<net>
<junction id="j"><request foes="10" response="10"/><request foes="01" response="00"/></junction>
<connection from="a" to="b" tl="j" linkIndex="0" via=":j_0_0"/>
<connection from="c" to="d" tl="j" linkIndex="1" via=":j_1_0"/>
<tlLogic id="j"><phase duration="24" state="gG"/><phase duration="3" state="yy"/>
<phase duration="33" state="rr"/></tlLogic></net>"""


def test_who_has_green_at_one_signal_has_it_at_the_next():
    root = etree.fromstring(STREET)
    coordinate(root)
    green = {}
    for plan in root.iter("tlLogic"):
        shown = "".join(p.get("state") * int(p.get("duration")) for p in plan.findall("phase"))
        green[plan.get("id")] = np.roll([c == "G" for c in shown], int(plan.get("offset")))
    later = 4  # seconds: two to start, two for the way
    assert (np.roll(green["one"], later) & green["two"]).sum() == 27


def test_who_turns_goes_alone_at_the_end_of_green():
    root = etree.fromstring(CROSSING)
    let_turners_out(root)
    phases = [(float(p.get("duration")), p.get("state")) for p in root.iter("phase")]
    assert phases == [(18, "gG"), (3, "gy"), (3, "Gr"), (3, "yr"), (33, "rr")]
    assert sum(seconds for seconds, _ in phases) == CYCLE


# Link 0 turns across link 1 into the street into which link 2, as green as it, turns towards it.
SAME_STREET = """<net>
<junction id="j"><request foes="110" response="110"/><request foes="001" response="000"/>
<request foes="001" response="000"/></junction>
<connection from="a" to="b" tl="j" linkIndex="0" via=":j_0_0"/>
<connection from="c" to="d" tl="j" linkIndex="1" via=":j_1_0"/>
<connection from="c" to="b" tl="j" linkIndex="2" via=":j_2_0"/>
<tlLogic id="j"><phase duration="24" state="gGg"/><phase duration="3" state="yyy"/>
<phase duration="33" state="rrr"/></tlLogic></net>"""


def test_who_turns_into_the_same_street_is_held_as_well():
    root = etree.fromstring(SAME_STREET)
    let_turners_out(root)
    assert [p.get("state") for p in root.iter("phase")] == ["gGg", "gyy", "Grr", "yrr", "rrr"]


def star(arms):
    rays = [(90 * np.cos(a), 90 * np.sin(a)) for a in np.arange(arms) * 2 * np.pi / arms]
    return [([MIDDLE, ray], {"lanes": 4, "lanes_forward": 2, "width": 13.0}) for ray in rays]


@needs_sumo
@pytest.mark.parametrize("arms", [5, 6])
def test_everybody_gets_green_at_a_junction_of_many_arms(arms, tmp_path, monkeypatch):
    city = city_of(star(arms), signals=[MIDDLE])
    found = streets_of(city, halts_of(city))
    least = []
    for name, plans in (("made", stages.restage), ("before", lambda _: None)):
        monkeypatch.setattr(networks, "restage", plans)
        (tmp_path / name).mkdir()
        file = networks.make_network(found, city.frame, tmp_path / name).file
        root = etree.parse(file).getroot()
        plan = root.find("tlLogic")
        shown = [(float(p.get("duration")), p.get("state")) for p in plan.findall("phase")]
        heads = {int(c.get("linkIndex")) for c in root.iter("connection") if c.get("tl")}
        green = [sum(t for t, state in shown if state[head] in "gG") for head in sorted(heads)]
        least.append((min(green), min(green) / sum(t for t, _ in shown)))
        requests = {j.get("id"): j.findall("request") for j in root.iter("junction")}
        rules = requests[plan.get("id")]
        bit = {key: [r.get(key)[::-1] for r in rules] for key in ("foes", "response")}
        for _, state in shown:
            lit = [head for head in heads if state[head] in "gG"]
            for i in lit:
                for j in lit:  # who meets on green knows who gives way
                    if bit["foes"][i][j] == "1" and i != j:
                        assert "1" in (bit["response"][i][j], bit["response"][j][i])
                        assert state[i] == "g" or bit["response"][i][j] == "0"
    assert least[0][0] >= stages.LEAST
    assert least[0][1] >= least[1][1]
