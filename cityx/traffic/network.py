"""The network of SUMO: made by netconvert, with the shapes of our own lanes in it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.ops import substring

from cityx.city.frame import Frame
from cityx.errors import EngineError, InputError
from cityx.geometry.arrays import FloatArray
from cityx.system.remembered import Remembered
from cityx.traffic.conflicts import conflicts_of, facing, settle
from cityx.traffic.coordination import CYCLE, coordinate
from cityx.traffic.engine import last, run_program
from cityx.traffic.plain import junction_name, shape_text, write_plain
from cityx.traffic.stages import restage
from cityx.traffic.streets import Streets
from cityx.traffic.turners import let_turners_out

NET = "city.net.xml"
LEAST = 0.1  # metres that SUMO wants a lane to be long
TIMEOUT_S = 600.0
WAITING = 3.0  # metres that a vehicle which waits amid a junction leaves to others
BUMPER = 0.5  # metres that who waits there keeps to the ways of others
_NAME = re.compile(r"'(-?[0-9a-f]{16})(?:#\d*)?(?:_\d+)?'")


@dataclass(frozen=True)
class Network:
    """A network on disk, and which lane of it is which of ours.

    Attributes
    ----------
    file
        The network.
    lanes
        Name of a lane to its way and its place on it.
    links
        Name of a lane across a junction to its link.
    crossings
        Name of an edge on which people cross to its crossing.
    facing
        Name of a lane across a junction to those that nobody may begin while somebody is on it,
        who would come towards them in the same place.
    """

    file: Path
    lanes: dict[str, tuple[int, int]]
    links: dict[str, int]
    crossings: dict[str, int]
    facing: dict[str, tuple[str, ...]] = field(default_factory=dict)


_LAST: Remembered[tuple[bytes, Network]] = Remembered()  # changes in turn are of the same streets


def make_network(
    streets: Streets, frame: Frame, folder: Path, *, said: Callable[[str], str] = str
) -> Network:
    """Make the network of SUMO from streets.

    Parameters
    ----------
    streets
        The streets.
    frame
        Where they lie.
    folder
        Where ``city.net.xml`` and the plain files it is made from are written.
    said
        Says of the id of an edge which street it is, for errors.

    Raises
    ------
    InputError
        If there is nothing to drive on.
    EngineError
        If netconvert refuses the streets; names them.
    """
    if not streets.ways:
        raise InputError("The city has no street that anything drives on, so it has no traffic.")
    file = folder / NET
    content, network = _LAST.get(lambda: _made(streets, frame, folder, said), [streets], frame)
    if network.file != file:
        file.write_bytes(content)
    return replace(network, file=file)


def _made(
    streets: Streets, frame: Frame, folder: Path, said: Callable[[str], str]
) -> tuple[bytes, Network]:
    """Make a network; also return what its file holds."""
    names = [file.name for file in write_plain(streets, frame, folder)]
    options = [
        *(word for pair in zip("nex", names, strict=True) for word in (f"-{pair[0]}", pair[1])),
        "--output-file", NET, "--offset.disable-normalization", "--precision", "3",
        "--no-turnarounds", "--walkingareas",
        "--tls.cycle.time", f"{CYCLE:g}",
        "--internal-junctions.vehicle-width", f"{WAITING:g}", "--xml-validation", "never",
        *(["--lefthand"] if streets.left_hand else []),
    ]  # fmt: skip
    try:
        lines = run_program("netconvert", options, folder, timeout_s=TIMEOUT_S)
    except EngineError as error:
        raise EngineError(named(str(error), said)) from error
    file = folder / NET
    if not file.exists():
        raise EngineError(f"netconvert wrote no network:\n{named(last(lines), said)}")
    network = _with_own_shapes(streets, file)
    return file.read_bytes(), network


def named(text: str, said: Callable[[str], str]) -> str:
    """Add street names to the edge ids in a message of the engine."""
    return _NAME.sub(lambda found: f"{found[0]} ({said(found[1].lstrip('-'))})", text)


def _with_own_shapes(streets: Streets, file: Path) -> Network:
    """Put our shapes into a network, which netconvert has cut and drawn out to fit its junctions.

    What it wrote when and from which files is left out: the same streets give the same bytes.
    """
    from lxml import etree

    tree = etree.parse(file, etree.XMLParser(remove_comments=True, huge_tree=True))
    root = tree.getroot()
    found = {lane.get("id"): lane for lane in root.iter("lane")}
    lanes: dict[str, tuple[int, int]] = {}
    for number, way in enumerate(streets.ways):
        for index, lane in enumerate(way.lanes):
            name = f"{way.name}_{index}"
            if name not in found:
                raise EngineError(f"netconvert left out lane {name}.")
            lanes[name] = (number, index)
            _set_shape(found[name], lane.shape, way.length)
    conflicts = conflicts_of(streets)
    links = _set_links(streets, root, found, conflicts.free)
    first = {number: name for name, number in reversed(links.items())}
    settle(root, conflicts, first)
    restage(root)
    let_turners_out(root)
    coordinate(root)
    crossings = _set_crossings(streets, root)
    for element in root.iter("lane"):
        element.attrib.pop("customShape", None)
    etree.indent(root, "    ")
    file.write_bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8") + b"\n")
    last = {number: name for name, number in links.items()}
    against: dict[str, list[str]] = {}
    for pair in facing(streets, conflicts).tolist():
        for one, other in (pair, pair[::-1]):
            if one in last and other in first:
                against.setdefault(last[one], []).append(first[other])
    towards = {name: tuple(sorted(others)) for name, others in sorted(against.items())}
    return Network(file, lanes, links, crossings, towards)


def _set_links(
    streets: Streets, root: Any, found: dict[str, Any], free: FloatArray
) -> dict[str, int]:
    """Set the shapes of lanes across junctions; also say which link each of them is.

    Who waits amid a junction does so before it meets anybody's way, whatever netconvert thinks.
    """
    keys = ("from", "fromLane", "to", "toLane")
    via = {tuple(c.get(key) for key in keys): c.get("via") for c in root.iter("connection")}
    after = {(c.get("from"), c.get("fromLane")): c.get("via")
             for c in root.iter("connection") if c.get("from").startswith(":")}  # fmt: skip
    links = {}
    for number, link in enumerate(streets.links):
        ends = streets.ways[link.source[0]].name, streets.ways[link.target[0]].name
        name = via.get((ends[0], str(link.source[1]), ends[1], str(link.target[1])))
        chain = []
        while name is not None:
            chain.append(found[name])
            links[name] = number
            name = after.get(tuple(name.rsplit("_", 1)))
        sizes = [max(float(lane.get("length")), LEAST) for lane in chain]
        cuts = np.r_[0.0, np.cumsum(sizes)] / max(sum(sizes), LEAST)
        size = max(float(np.linalg.norm(np.diff(link.shape, axis=0), axis=1).sum()), LEAST)
        cuts[1:-1] = np.minimum(cuts[1:-1], max(free[number] - BUMPER, LEAST) / size)
        for lane, begin, end in zip(chain, cuts[:-1], cuts[1:], strict=True):
            shape = _part(link.shape, float(begin), float(end))
            _set_shape(lane, shape, float(np.linalg.norm(np.diff(shape, axis=0), axis=1).sum()))
    return links


def _set_crossings(streets: Streets, root: Any) -> dict[str, int]:
    """Set the shapes of crossings; also say which of ours each edge of them is."""
    numbers = {}
    for number, crossing in enumerate(streets.crossings):
        names = sorted(streets.ways[way].name for way in crossing.ways)
        numbers[junction_name(crossing.junction), *names] = number
    found = {}
    for edge in root.iter("edge"):
        if edge.get("function") != "crossing":
            continue
        junction = edge.get("id")[1:].rpartition("_c")[0]
        number = numbers[(junction, *sorted(edge.get("crossingEdges").split()))]
        found[edge.get("id")] = number
        lane = edge.find("lane")
        shape = streets.crossings[number].shape
        lane.attrib.pop("outlineShape", None)
        _set_shape(lane, shape, float(np.linalg.norm(shape[1] - shape[0])))
    return found


def _part(shape: FloatArray, begin: float, end: float) -> FloatArray:
    """Return the part of a line between two shares of its length."""
    if begin <= 0.0 and end >= 1.0:
        return shape
    part = substring(shapely.LineString(shape), begin, end, normalized=True)
    points = shapely.get_coordinates(part, include_z=True)
    return points if len(points) > 1 else np.repeat(points, 2, axis=0)


def _set_shape(lane: Any, shape: FloatArray, length: float) -> None:
    lane.set("shape", shape_text(shape))
    lane.set("length", f"{max(length, LEAST):.3f}")
