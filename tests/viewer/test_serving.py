"""The server: who has the token sees and changes the city, nobody else; nothing takes a path."""

import json
import time

import pytest
import requests
from page_server import TOKEN, serving

from cityx.projects.desk import Desk
from cityx.protocol.gate import Call

WITH = {"Authorization": f"Bearer {TOKEN}"}
WAIT_S = 60


@pytest.fixture(scope="module")
def url(town, page):  # noqa: ARG001  without a page nothing is served
    with serving(town) as port:
        yield f"http://127.0.0.1:{port}"


def get(url, path, **headers):
    return requests.get(f"{url}/{path}", headers=WITH | headers, timeout=WAIT_S)


def call(url, tool, **arguments):
    """Call a tool as the page does, and wait for its job."""
    reply = requests.post(f"{url}/tools/{tool}", json=arguments, headers=WITH, timeout=WAIT_S)
    while reply.json()["status"] == "accepted":
        waited = {"job_id": reply.json()["job_id"], "seconds": 2}
        reply = requests.post(f"{url}/tools/job_wait", json=waited, headers=WITH, timeout=WAIT_S)
    return reply.json()


@pytest.mark.parametrize(
    "path",
    ["scene.json", "report.json", "objects/0123456789abcdef", "find?text=church", "places?ids=",
     "events", "chunks/x.glb"],
)  # fmt: skip
def test_nothing_of_the_city_is_told_without_the_token(url, path):
    for headers in ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"}):
        reply = requests.get(f"{url}/{path}", headers=headers, timeout=WAIT_S)
        assert (reply.status_code, reply.json()["code"]) == (401, "TOKEN")


def test_pages_of_other_sites_and_other_names_of_this_machine_are_refused(url):
    assert get(url, "scene.json", Origin="http://evil.example").status_code == 403
    assert get(url, "scene.json", Origin="null").status_code == 403
    assert get(url, "scene.json", Host="evil.example").status_code == 421
    assert get(url, "", Host="evil.example").status_code == 421
    assert get(url, "scene.json", Origin=url).status_code == 200


def test_the_page_itself_runs_only_its_own_script(url):
    reply = requests.get(url, timeout=WAIT_S)
    policy = reply.headers["Content-Security-Policy"]
    assert "script-src 'self' 'wasm-unsafe-eval';" in policy
    loaded, _, framing = policy.partition("frame-ancestors")
    assert "http" not in loaded
    assert framing.split() == ["'self'", "http://127.0.0.1:*", "http://localhost:*"]  # notebooks
    assert "<canvas" in reply.text


def test_every_file_of_the_scene_is_given_and_may_be_kept_for_ever(url):
    scene = get(url, "scene.json").json()
    names = [f"chunks/{item['name']}.glb" for item in scene["chunks"]]
    names += [f"packs/{item['name']}.glb" for item in scene["packs"]]
    for name in [*names, f"paints/{scene['paints']}.glb"]:
        reply = get(url, name)
        assert reply.status_code == 200
        assert reply.content[:4] == b"glTF"
        assert "immutable" in reply.headers["Cache-Control"]


@pytest.mark.parametrize(
    "path",
    ["chunks/00000000000000000000000000000000.glb", "chunks/..%2f..%2freport.json.glb",
     "packs/%2e%2e%2fscene.glb", "anything/x.glb", "objects/zzzz", "objects/0000000000000001"],
)  # fmt: skip
def test_what_there_is_not_is_refused_in_words(url, path):
    reply = get(url, path)
    assert reply.status_code == 404
    if reply.headers["content-type"] == "application/json":
        assert reply.json()["status"] == "rejected"


def test_details_tell_whence_an_object_is_and_what_made_it(url, town):
    with Desk(town) as desk:
        table = desk.city.layout.buildings
    row = table.iloc[0]
    told = get(url, f"objects/{int(row['id']):016x}").json()
    assert told["source"] == row["source"]
    assert told["generator"] == row["generator"]
    assert told["tags"] == json.loads(row["tags"])
    assert "OpenStreetMap" in told["licence"]
    assert "building/shell-v1" in [made["action"] for made in told["made_by"]]
    assert told["place"] == pytest.approx(list(row["geometry"].centroid.coords[0]), abs=10)


def test_search_takes_ids_names_and_what_a_thing_is_like(url, town):
    with Desk(town) as desk:
        table = desk.city.layout.buildings
    over = get(url, "find?text=buildings over 20 m").json()
    highs = {f"{number:016x}" for number in table["id"][table["height"] > 20]}
    assert {item["id"] for item in over["objects"]} == highs
    assert highs
    one = sorted(highs)[0]
    assert {item["id"] for item in get(url, f"find?text={one}").json()["objects"]} == {one}
    nothing = get(url, "find?text=qwxyz")
    assert nothing.json()["code"] == "USAGE"
    assert "buildings over 30 m" in nothing.json()["message"]


def test_a_sentence_changes_the_city_and_undo_takes_it_back(url, town):
    first = get(url, "scene.json").json()
    done = call(url, "run_brief", text="make the tallest building red")
    assert done["status"] == "ok"
    second = get(url, "scene.json").json()
    names = [{chunk["name"] for chunk in scene["chunks"]} for scene in (first, second)]
    assert len(names[0] - names[1]) == len(names[1] - names[0]) == 1
    assert call(url, "run_brief", text="undo")["status"] == "ok"
    third = get(url, "scene.json").json()
    assert (third["hash"], third["chunks"]) == (first["hash"], first["chunks"])
    with Desk(town) as desk:
        assert desk.revision == third["revision"]


def test_a_sentence_takes_what_is_drawn_beside_it_and_refuses_what_is_no_path(url):
    first = get(url, "scene.json").json()["hash"]
    path = {"points": [[-60, -60], [0, -60], [0, 0], [-60, 0]], "area": True}
    done = call(url, "run_brief", text="plant three limes in this area", drawn=path)
    assert (done["status"], done["warnings"]) == ("ok", [])
    assert call(url, "run_brief", text="undo")["status"] == "ok"
    assert get(url, "scene.json").json()["hash"] == first
    for drawn, said in (
        ({"points": [[0, 0]]}, "drawn"),
        ({"points": [[0, 0], [0, 0]]}, "too small"),
        ({"points": [[0, 0], [1, 1]], "file": "/etc/passwd"}, "file"),
    ):
        refused = call(url, "run_brief", text="put benches along this", drawn=drawn)
        assert refused["status"] == "rejected"
        assert said in refused["message"]


def test_what_nobody_understands_changes_nothing(url):
    before = get(url, "scene.json").json()
    reply = call(url, "run_brief", text="flibber the gnomes")
    assert reply["status"] == "rejected"
    assert "gnomes" in reply["message"]
    assert get(url, "scene.json").json()["hash"] == before["hash"]


@pytest.mark.parametrize(
    ("tool", "body", "said"),
    [
        ("render", "{}", "has no tool"),
        ("run_brief", "{", "not JSON"),
        ("run_brief", "[]", "object"),
        ("run_brief", '{"text": "x", "path": "/etc/passwd"}', "path"),
        ("undo", "[" * 5000, "not JSON"),
        ("run_brief", '{"text": "' + "x" * 300_000 + '"}', "bytes"),
    ],
)
def test_requests_that_make_no_sense_are_refused_in_words(url, tool, body, said):
    reply = requests.post(f"{url}/tools/{tool}", data=body, headers=WITH, timeout=WAIT_S)
    assert reply.json()["status"] == "rejected"
    assert said in reply.json()["message"]


def test_pages_hear_of_a_change_that_another_process_made(url, town):
    with requests.get(f"{url}/events", headers=WITH, stream=True, timeout=WAIT_S) as news:
        lines = news.iter_lines(chunk_size=1)
        first = json.loads(next(lines)[6:])
        with Desk(town) as desk:
            desk.change([Call("background/weather-v1", {"preset": "snow"})])
        heard = first
        begun = time.monotonic()
        while heard["folder"] == first["folder"] and time.monotonic() - begun < WAIT_S:
            line = next(lines)
            heard = json.loads(line[6:]) if line.startswith(b"data") else heard
        assert time.monotonic() - begun < 10
    assert get(url, "scene.json").json()["environment"]["weather"] == "snow"
