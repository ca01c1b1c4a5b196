"""Nodes taken out of the XML by pattern are the nodes a parser would have found."""

import numpy as np
import pytest

from cityx.sources.osm.elements import Collector
from cityx.sources.osm.reader import read_elements

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<osm version="0.6" generator="a &gt; b">\n'
PLAIN = (
    '<node id="5" lat="1.5" lon="-2.25"/>',
    '<node id="3" version="2" user="a &gt; b" lat="1" lon="2" uid="7"/>',
    '<node id="9" lat="-3.5" lon="2" version="4" visible="true" />',
    "<node id='2' visible='true' lat='1' lon='2' />",
    '<node lat="4" lon="5" id="11"/>',
)
OTHERS = (
    '<node id="7" lat="1" lon="2">\n<tag k="natural" v="tree"/>\n</node>',
    '<node id="3" version="1" lat="50" lon="50"/>',
    '<way id="1"><nd ref="3"/><nd ref="5"/><tag k="highway" v="service"/></way>',
    '<node id="8" lat="1" lon="2e0"/>',
)
ODD = (
    '<!-- <node id="20" lat="1" lon="2"/> -->',
    "<note><![CDATA[<node id='21' lat='1' lon='2'/>]]></note>",
    '<node id="22" lat="1" lon="2" action="delete"/>',
    '<node id="23" lat="100" lon="2"/>',
)


def read(tmp_path, text):
    path = tmp_path / "map.osm"
    path.write_text(text)
    return read_elements(path)


@pytest.mark.parametrize("odd", ["", *ODD])
@pytest.mark.parametrize("chunk", [1 << 20, 97])
def test_taking_plain_nodes_out_changes_nothing(tmp_path, monkeypatch, odd, chunk):
    monkeypatch.setattr("cityx.sources.osm.reader.CHUNK", chunk)
    lines = [odd, *PLAIN, OTHERS[0], *OTHERS[1:]]
    text = HEAD + "\n".join(lines) + "\n</osm>\n"
    fast = read(tmp_path, text)
    monkeypatch.setattr(Collector, "take_plain_nodes", lambda _, block: block)
    slow = read(tmp_path, text)
    assert np.array_equal(fast.node_id, slow.node_id)
    assert np.array_equal(fast.lonlat, slow.lonlat)
    assert fast.node_tags == slow.node_tags
    assert np.array_equal(fast.way_nodes, slow.way_nodes)
    assert fast.skipped == slow.skipped


def test_plain_nodes_do_not_reach_the_parser():
    collector = Collector()
    rest = collector.take_plain_nodes("\n".join(PLAIN[:3]).encode())
    assert collector.node_id == [5, 9]
    assert b'id="3"' in rest  # its user's name needs a parser
    assert collector.lat == [1.5, -3.5]
