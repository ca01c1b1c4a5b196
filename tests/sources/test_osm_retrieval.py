import gzip
import json
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread
from urllib.parse import parse_qs, urlsplit

import pytest

from cityx.errors import InputError, UsageError
from cityx.sources.osm import read_osm
from cityx.sources.osm.retrieval import retrieve

MAP = """<?xml version="1.0"?>
<osm version="0.6"><note>made here</note>
<node id="1" lat="60.1700" lon="24.9400"/><node id="2" lat="60.1710" lon="24.9420"/>
<way id="1"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/></way>
{end}"""
PLACES = {
    "old town": [60.169, 60.172, 24.938, 24.944],
    "planet": [-80, 80, -170, 170],
    "odd": ["a", "b", "c", "d"],
}


@contextmanager
def servers(monkeypatch, body, status=200):
    """Stand in for both services; yields what was asked."""
    asked = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            name = parse_qs(urlsplit(self.path).query)["q"][0]
            asked.append(name)
            box = PLACES.get(name)
            self.answer(
                json.dumps([{"boundingbox": box, "display_name": name.title()}] if box else [])
            )

        def do_POST(self):
            length = int(self.headers["Content-Length"])
            asked.append(parse_qs(self.rfile.read(length).decode())["data"][0])
            asked.append(self.headers["User-Agent"])
            self.answer(body, status)

        def answer(self, text, status=200):
            self.send_response(status)
            self.end_headers()
            self.wfile.write(text.encode())

        def log_message(self, *_):
            pass

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}"
        monkeypatch.setenv("CITYX_NOMINATIM", address)
        monkeypatch.setenv("CITYX_OVERPASS", address)
        yield asked
        server.shutdown()


def test_a_place_is_fetched_once_and_read(monkeypatch, tmp_path):
    with servers(monkeypatch, MAP.format(end="</osm>")) as asked:
        path = retrieve("old town", tmp_path / "maps")
        assert asked[0] == "old town"
        assert "nwr(60.1690000,24.9380000,60.1720000,24.9440000)" in asked[1]
        assert asked[2].startswith("cityx/")
        retrieve("old town", tmp_path / "maps")
        assert len(asked) == 3
    city = read_osm(path)
    assert city.layout.roads["kind"].tolist() == ["residential"]
    assert b'<bounds minlat="60.1690000"' in gzip.decompress(path.read_bytes())
    assert retrieve("old town", tmp_path / "maps") == path  # without any server


def test_a_rectangle_needs_no_name(monkeypatch, tmp_path):
    with servers(monkeypatch, MAP.format(end="</osm>")) as asked:
        retrieve("24.94,60.165,24.96,60.175", tmp_path)
        assert len(asked) == 2
    with pytest.raises(UsageError, match="is no rectangle"):
        retrieve("24.96,60.165,24.94,60.175", tmp_path)


@pytest.mark.parametrize(
    ("place", "body", "status", "said"),
    [
        ("atlantis", "", 200, 'No place is called "atlantis"'),
        ("planet", "", 200, "more than the 25 km2"),
        ("odd", "", 200, "gave an answer that cannot be read"),
        ("old town", MAP.format(end=""), 200, "the answer is cut off"),
        ("old town", MAP.format(end="<remark>out of memory</remark></osm>"), 200, "out of memory"),
        ("old town", "busy", 429, "refused: 429"),
    ],
)
def test_what_goes_wrong_is_told_and_nothing_is_kept(
    monkeypatch, tmp_path, place, body, status, said
):
    with servers(monkeypatch, body, status), pytest.raises(InputError, match=said):
        retrieve(place, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_without_a_network_the_way_out_is_told(monkeypatch, tmp_path):
    monkeypatch.setenv("CITYX_NOMINATIM", "http://127.0.0.1:9")
    with pytest.raises(InputError, match=r"No connection to 127.0.0.1:9 .*give the file"):
        retrieve("old town", tmp_path)
