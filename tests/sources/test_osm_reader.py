import bz2
import gzip

import numpy as np
import osmium
import pytest

from cityx.errors import InputError
from cityx.sources.osm import read_osm
from cityx.sources.osm.reader import read_elements

NODE = '<node id="{}" lat="{}" lon="{}"/>'


def write(folder, text, name="map.osm"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_references_are_found_in_any_order_of_elements_and_with_negative_ids(tmp_path):
    text = (
        '<osm><way id="-5"><nd ref="-2"/><nd ref="7"/><nd ref="99"/>'
        '<tag k="highway" v="path"/></way>'
        f"{NODE.format(7, 1, 2)}{NODE.format(-2, 3, 4)}</osm>"
    )
    osm = read_elements(write(tmp_path, text))
    assert osm.node_id.tolist() == [-2, 7]
    assert osm.way_nodes.tolist() == [0, 1, -1]
    assert osm.missing_nodes().tolist() == [1]
    assert osm.way_tags == [{"highway": "path"}]


def test_deleted_and_invisible_elements_are_gone(tmp_path):
    text = (
        '<osm version="0.6"><node id="1" lat="1" lon="1" action="delete"/>'
        '<node id="2" visible="false"/><node id="3" lat="1" lon="1"/>'
        '<way id="4" action="delete"/><relation id="5" visible="false"/></osm>'
    )
    osm = read_elements(write(tmp_path, text))
    assert osm.node_id.tolist() == [3]
    assert len(osm.way_id) == len(osm.relation_id) == 0


def test_the_highest_and_then_the_last_version_wins(tmp_path):
    node = '<node id="1" version="{}" lat="{}" lon="0"/>'
    text = "".join(node.format(*row) for row in ((2, 5), (1, 6), (2, 7)))
    osm = read_elements(write(tmp_path, f"<osm>{text}</osm>"))
    assert osm.lonlat.tolist() == [[0.0, 7.0]]


def test_garbage_in_numbers_loses_the_element_and_is_counted(tmp_path):
    text = "<osm>" + "".join(
        NODE.format(*row)
        for row in (("x", 1, 1), (1, "nan", 1), (2, "north", 1), (3, 1, 999), (4, 1, 1))
    )
    text += '<way id="9"><nd ref="oops"/><nd/><nd ref="4"/><tag k="a"/></way></osm>'
    osm = read_elements(write(tmp_path, text))
    assert osm.node_id.tolist() == [4]
    assert osm.way_nodes.tolist() == [0]
    assert osm.skipped["damaged <node>"] == 4
    assert osm.skipped["damaged <nd>"] == 2


def test_bounds_are_joined_and_senseless_ones_ignored(tmp_path):
    text = (
        '<osm><bounds minlat="1" minlon="2" maxlat="3" maxlon="4"/>'
        '<bounds minlat="9" minlon="2" maxlat="3" maxlon="4"/>'
        '<bounds minlat="0" minlon="3" maxlat="1" maxlon="5"/></osm>'
    )
    assert read_elements(write(tmp_path, text)).bounds == (2, 0, 5, 3)


def test_packed_files_read_like_plain_ones_whatever_their_suffix(drawing, tmp_path):
    drawing.box(0, 0, 10, 10, building="yes")
    plain = read_elements(drawing.file())
    raw = drawing.text().encode()
    for name, content in (("a.osm", gzip.compress(raw)), ("b.xml", bz2.compress(raw))):
        packed = read_elements(write(tmp_path, content, name))
        assert packed.way_tags == plain.way_tags
        assert (packed.lonlat == plain.lonlat).all()


def test_pbf_reads_like_xml(drawing, tmp_path):
    drawing.box(0, 0, 10, 10, building="yes")
    drawing.node(5, 30, natural="tree")
    plain = read_elements(drawing.file())
    target = tmp_path / "map.osm.pbf"
    with osmium.SimpleWriter(str(target)) as writer:
        for item in osmium.FileProcessor(str(tmp_path / "map.osm")):
            writer.add(item)
    renamed = tmp_path / "renamed.osm"
    renamed.write_bytes(target.read_bytes())
    for path in (target, renamed):
        packed = read_elements(path)
        assert packed.way_tags == plain.way_tags
        assert packed.node_tags == plain.node_tags
        np.testing.assert_allclose(packed.lonlat, plain.lonlat, atol=1e-7)
    damaged = write(tmp_path, renamed.read_bytes()[:-40], "cut.osm.pbf")
    with pytest.raises(InputError, match="damaged or cut off"):
        read_elements(damaged)


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE osm [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;">'
    '<!ENTITY c "&b;&b;&b;&b;">]><osm><node id="1" lat="1" lon="1"><tag k="x" v="&c;"/></node>'
    "</osm>"
)
HOSTILE = {
    "entity bomb": (BOMB, "declares a document type or entities"),
    "external entity": (
        '<!DOCTYPE osm [<!ENTITY x SYSTEM "file:///etc/passwd">]><osm>&x;</osm>',
        "declares a document type",
    ),
    "external document type": ('<!DOCTYPE osm SYSTEM "http://x.y/z.dtd"><osm/>', "declares a doc"),
    "unknown entity": ("<osm><tag k='a' v='&x;'/></osm>", "not OpenStreetMap XML"),
    "empty": ("", "is empty"),
    "blank": ("  \n ", "is empty"),
    "text": ("hello world", "not OpenStreetMap XML"),
    "json": ('{"elements": []}', "not OpenStreetMap XML"),
    "html": ("<html><body>Too many requests</body></html>", "root <html>"),
    "binary": (bytes(range(256)) * 20, "not OpenStreetMap XML"),
    "picture": (b"\x89PNG\r\n\x1a\n" + bytes(100), "not OpenStreetMap XML"),
    "zip": (b"PK\x03\x04" + bytes(60), "is a zip archive"),
    "not gzip": (b"\x1f\x8b" + bytes(100), "cannot be unpacked"),
    "not bzip2": (b"BZh9" + bytes(100), "cannot be unpacked"),
    "not pbf": (b"\x00\x00\x00\x0d\x0a\x09OSMHeader" + bytes(100), "damaged or cut off"),
    "no elements": ("<osm version='0.6'></osm>", "holds no map"),
    "no city": (f"<osm>{NODE.format(1, 1, 1)}</osm>", "holds no city"),
    "wrong encoding": (b'<?xml version="1.0" encoding="klingon"?><osm/>', "not OpenStreetMap XML"),
    "bad utf-8": (b"<osm><note>\xff\xfe</note></osm>", "not OpenStreetMap XML"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_map_is_refused_in_a_sentence(name, tmp_path):
    content, expected = HOSTILE[name]
    with pytest.raises(InputError, match=expected) as refused:
        read_osm(write(tmp_path, content))
    assert refused.value.exit_code == 2


def test_a_file_that_is_cut_off_says_where(drawing, tmp_path):
    drawing.box(0, 0, 10, 10, building="yes")
    text = drawing.text().replace("><", ">\n<")
    with pytest.raises(InputError, match=r"cut off at line 9, column"):
        read_elements(write(tmp_path, "\n".join(text.split("\n")[:8]) + "\n"))
    packed = gzip.compress(text.encode())
    with pytest.raises(InputError, match="cut off: its packed data ends"):
        read_elements(write(tmp_path, packed[: len(packed) // 2]))


def test_decompression_bombs_are_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("cityx.sources.osm.reader.RATIO_FREE", 1 << 20)
    text = b"<osm>" + b"<node/>" * 500_000
    with pytest.raises(InputError, match="unpacks to more than 250 times"):
        read_elements(write(tmp_path, bz2.compress(text)))


def test_one_endless_tag_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("cityx.sources.osm.reader.MAX_TOKEN", 3 << 20)
    with pytest.raises(InputError, match="one tag of over 3 MB"):
        read_elements(write(tmp_path, b"<osm><tag k='" + b"a" * (5 << 20) + b"'/></osm>"))


def test_a_missing_file_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="cannot read"):
        read_elements(tmp_path / "nowhere.osm")
