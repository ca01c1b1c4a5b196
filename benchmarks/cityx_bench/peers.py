"""Peers: programs that read the same maps, where they are found, and what of ours does the same."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from cityx.errors import EngineError, MissingExtra, UsageError, nearest

PARSE = "layout/inputs"  # our step that reads the map
LONGEST = 900.0  # seconds that a peer may take
INSTALLED = "installed"  # word for all peers that can be run here


def _python(module: str, package: str = "") -> Callable[[], str]:
    """Return what tells whether a module of Python is missing, and how to have it."""

    def lacking() -> str:
        found = importlib.util.find_spec(module) is not None
        return "" if found else f"it is not installed: pip install {package or module}"

    return lacking


def _blosm() -> str:
    """Look for the add-on where Blender keeps those of its users."""
    roots = [Path(os.environ[name]) for name in ("BLENDER_USER_SCRIPTS",) if name in os.environ]
    roots += [path / part for path in (Path.home() / ".config" / "blender").glob("*")
              for part in ("scripts", "extensions")]  # fmt: skip
    if any(path for root in roots for path in root.glob("*/blosm/__init__.py")):
        return ""
    return "Blender has no add-on blosm: get its archive from https://github.com/vvoovv/blosm"


def _osm2streets() -> str:
    if shutil.which("node") is None:
        return "node is not installed"
    asked = ["node", "-e", "require.resolve('osm2streets-js/osm2streets_js.js')"]
    done = subprocess.run(asked, capture_output=True, check=False)
    return "it is not installed: npm install osm2streets-js" if done.returncode else ""


@dataclass(frozen=True)
class Peer:
    """A program that reads the same map, and what of ours does the same.

    Attributes
    ----------
    name
        As asked for.
    makes
        What comes out of it.
    program
        What runs the script: the words before it and the map.
    script
        Reads the .osm file that is its last argument, and prints its CPU seconds.
    steps
        Our steps that come as far.
    lacking
        Returns why it cannot be run here, "" when it can.
    reads
        File of the built city that it is given instead of the map.
    """

    name: str
    makes: str
    program: tuple[str, ...]
    script: str
    steps: tuple[str, ...]
    lacking: Callable[[], str]
    reads: str = ""


_OSMIUM = """
import sys, time
import osmium, shapely
begin = time.process_time()
shapes, make = [], osmium.geom.WKBFactory()
for thing in osmium.FileProcessor(sys.argv[1]).with_locations().with_areas():
    try:
        if thing.is_area() and "building" in thing.tags:
            shapes.append(shapely.from_wkb(bytes.fromhex(make.create_multipolygon(thing))))
        elif thing.is_way() and "highway" in thing.tags:
            shapes.append(shapely.from_wkb(bytes.fromhex(make.create_linestring(thing))))
    except RuntimeError:
        pass
print(time.process_time() - begin)
"""
_TRIMESH = """
import sys, time
from pathlib import Path
import trimesh
scene = trimesh.load(sys.argv[1], file_type="glb")
begin = time.process_time()
Path(sys.argv[1]).write_bytes(scene.export(file_type="glb"))
print(time.process_time() - begin)
"""
_OSMNX = """
import sys, time
import osmnx
begin = time.process_time()
osmnx.features_from_xml(sys.argv[1], tags={"building": True})
osmnx.graph_from_xml(sys.argv[1])
print(time.process_time() - begin)
"""
_NETCONVERT = """
import resource, sys
from pathlib import Path
from cityx.traffic.engine import run_program
path = Path(sys.argv[1])
run_program("netconvert", ["--osm-files", path.name, "-o", "net.xml"], path.parent, timeout_s=900.0)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
"""
# Blocks with flat roofs, and streets as curves: what the add-on makes without its paid assets.
_BLOSM = """
import sys, time
from pathlib import Path
import bpy, addon_utils
addon_utils.enable("blosm", default_set=True)
bpy.context.preferences.addons["blosm"].preferences.dataDir = str(Path(sys.argv[1]).parent)
chosen = bpy.context.scene.blosm
chosen.dataType, chosen.osmSource, chosen.osmFilepath = "osm", "file", sys.argv[1]
chosen.mode = "3Dsimple"
begin = time.process_time()
if bpy.ops.blosm.import_data() != {"FINISHED"}:
    sys.exit("the import was cancelled")
print(time.process_time() - begin)
"""
# The package is written for web pages: its glue is loaded as text, its program from the file.
_OSM2STREETS = """
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
const find = createRequire(process.cwd() + "/");
const file = find.resolve("osm2streets-js/osm2streets_js.js");
const place = JSON.stringify(pathToFileURL(file).href);
const glue = readFileSync(file, "utf8").replaceAll("import.meta.url", place);
const streets = await import("data:text/javascript;base64," + Buffer.from(glue).toString("base64"));
streets.initSync(readFileSync(find.resolve("osm2streets-js/osm2streets_js_bg.wasm")));
const text = readFileSync(process.argv.at(-1), "utf8");
const begin = process.cpuUsage();
const network = new streets.JsStreetNetwork(text, "", {
  debug_each_step: false, dual_carriageway_experiment: false,
  cycletrack_snapping_experiment: false, inferred_sidewalks: true, osm2lanes: false,
});
network.toGeojsonPlain();
network.toLanePolygonsGeojson();
const used = process.cpuUsage(begin);
console.log((used.user + used.system) / 1e6);
"""
_PYTHON = (sys.executable, "-c")
_NETWORK = (PARSE, "road/drawn_streets", "road/network", "road/lanes")
PEERS: Mapping[str, Peer] = MappingProxyType({
    peer.name: peer
    for peer in (
        Peer("osmium", "shapes of buildings and streets", _PYTHON, _OSMIUM, (PARSE,),
             _python("osmium")),
        Peer("trimesh", "the meshes of city.glb, read before, written again", _PYTHON, _TRIMESH,
             ("glb",), _python("trimesh"), "city.glb"),
        Peer("osmnx", "tables of buildings and a graph of streets", _PYTHON, _OSMNX,
             (PARSE, "road/drawn_streets", "road/network"), _python("osmnx")),
        Peer("netconvert", "lanes, junctions and signals, no buildings", _PYTHON, _NETCONVERT,
             _NETWORK, _python("sumo", "eclipse-sumo")),
        Peer("blosm", "buildings as blocks, streets as curves", _PYTHON, _BLOSM,
             (PARSE, "building/prism", "blender setup"), _blosm),
        Peer("osm2streets", "lanes and junctions as polygons, no buildings",
             ("node", "--input-type=module", "-e"), _OSM2STREETS,
             (*_NETWORK, "road/ground"), _osm2streets),
    )
})  # fmt: skip


def peers_named(words: Iterable[str]) -> tuple[tuple[Peer, ...], dict[str, str]]:
    """Return peers by their names; all that can be run here for "installed".

    Returns
    -------
    peers
        Those that are run.
    skipped
        Name to reason, of those that "installed" leaves out.

    Raises
    ------
    UsageError
        For a name that is no peer.
    MissingExtra
        For one that is named and cannot be run.
    """
    found: dict[str, Peer] = {}
    skipped: dict[str, str] = {}
    for word in words:
        if word == INSTALLED:
            reasons = {name: peer.lacking() for name, peer in PEERS.items()}
            skipped = {name: reason for name, reason in reasons.items() if reason}
            found |= {name: PEERS[name] for name in PEERS if name not in skipped}
        elif word not in PEERS:
            raise UsageError(f'There is no peer "{word}".{nearest(word, [*PEERS, INSTALLED])}')
        elif reason := PEERS[word].lacking():
            raise MissingExtra(f"{word} cannot be run: {reason}")
        else:
            found[word] = PEERS[word]
    return tuple(found.values()), skipped


def peer_once(peer: Peer, content: bytes) -> float:
    """Run a peer on a map in a process of its own and return its CPU seconds.

    Raises
    ------
    EngineError
        When it fails or takes longer than `LONGEST`.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.osm"
        path.write_bytes(content)
        command = [*peer.program, peer.script, str(path)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=LONGEST
            )
        except subprocess.TimeoutExpired as error:
            raise EngineError(f"{peer.name} took more than {LONGEST:.0f} s") from error
        if done.returncode:
            last = done.stderr.strip().splitlines()[-1:]
            raise EngineError(f"{peer.name} ended with {done.returncode}: {''.join(last)}")
        return float(done.stdout.split()[-1])
