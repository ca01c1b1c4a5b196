"""Streets as SUMO's plain XML: nodes, edges with lanes, connections."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import shapely

from cityx.city.frame import Frame
from cityx.geometry.arrays import FloatArray
from cityx.traffic.streets import Lane, Streets, Way

# Kind of band, or "private" for lanes of cars that belong there -> classes of SUMO that may use it.
ALLOWED = {
    "drive": "private emergency authority passenger hov taxi bus coach delivery truck trailer "
             "motorcycle moped bicycle evehicle",
    "bus": "bus coach taxi emergency bicycle",
    "cycle": "bicycle",
    "walk": "pedestrian",
    "private": "private emergency authority delivery bicycle",
}  # fmt: skip
CLOSED = "custom1"  # a class that no vehicle has
WALKED = 2.0  # metres per second that a walk allows
CHANGED = 50.0  # metres of a way on which drivers get from one lane to another
PARTS = ("nod", "edg", "con")


def write_plain(streets: Streets, frame: Frame, folder: Path, name: str = "city") -> list[Path]:
    """Write the files from which netconvert makes a network.

    Returns
    -------
    files
        ``NAME.nod.xml``, ``NAME.edg.xml`` and ``NAME.con.xml``.
    """
    files = [folder / f"{name}.{part}.xml" for part in PARTS]
    content = (_nodes(streets, frame), _edges(streets), _connections(streets))
    for path, root, lines in zip(files, ("nodes", "edges", "connections"), content, strict=True):
        text = "\n".join(lines)
        path.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n<{root}>\n{text}\n</{root}>\n')
    return files


def junction_name(junction: int) -> str:
    """Return the name of a junction."""
    return f"j{junction}"


def tag(element: str, **attributes: object) -> str:
    """Write an element without content."""
    words = (f"{key.rstrip('_')}={quoteattr(str(value))}" for key, value in attributes.items())
    return f"<{element} {' '.join(words)}/>"


def shape_text(shape: FloatArray) -> str:
    """Write points as SUMO does, in millimetres."""
    return " ".join(",".join(f"{value:.3f}" for value in point) for point in shape.tolist())


def _nodes(streets: Streets, frame: Frame) -> Iterable[str]:
    used = sorted({end for way in streets.ways for end in (way.source, way.target)})
    ends = _ends(streets)
    bounds = np.concatenate([lane.shape for way in streets.ways for lane in way.lanes])
    low, high = bounds[:, :2].min(axis=0), bounds[:, :2].max(axis=0)
    box = ",".join(f"{value:.3f}" for value in (*low, *high))
    world = frame.to_geographic(np.stack([low, high])).ravel()
    yield tag("location", netOffset="0.00,0.00", convBoundary=box,
              origBoundary=",".join(f"{value:.7f}" for value in world),
              projParameter=frame.projection)  # fmt: skip
    for junction in used:
        x, y, z = (f"{value:.3f}" for value in streets.place[junction])
        kind = "traffic_light" if streets.signals[junction] else "priority"
        around = outline(ends[junction])
        yield tag("node", id=junction_name(junction), x=x, y=y, z=z, type=kind,
                  shape=shape_text(around))  # fmt: skip


def _ends(streets: Streets) -> dict[int, list[FloatArray]]:
    """Corners of the arms of each junction, (2, 3) each: right and left as one looks into them."""
    arms: dict[tuple[int, int, int], list[FloatArray]] = {}
    for way in streets.ways:
        for lane in way.lanes:
            for junction, side, shape in ((way.source, 0, lane.shape),
                                          (way.target, 1, lane.shape[::-1])):  # fmt: skip
                ahead = shape[1, :2] - shape[0, :2]
                across = np.array([-ahead[1], ahead[0]]) / max(float(np.hypot(*ahead)), 1e-9)
                across *= lane.width / 2
                corners = shape[0] + np.array([[*across, 0.0], [*-across, 0.0]])
                key = (junction, way.edge, side ^ way.name.startswith("-"))
                arms.setdefault(key, []).append(corners)
    found: dict[int, list[FloatArray]] = {}
    for (junction, _, _), parts in arms.items():
        corners = np.concatenate(parts)
        span = np.linalg.norm(corners[:, None, :2] - corners[None, :, :2], axis=2)
        found.setdefault(junction, []).append(corners[list(divmod(int(span.argmax()), len(span)))])
    return found


def outline(arms: list[FloatArray]) -> FloatArray:
    """(k, 3) corners of the ground between the ends of arms, counter-clockwise.

    Where their corners, in the order of the arms, make no ring the hull of them is taken.
    """
    points = np.concatenate(arms)
    middle = points[:, :2].mean(axis=0)
    ordered = []
    for arm in sorted(arms, key=lambda arm: _bearing(arm[:, :2].mean(axis=0) - middle)):
        away = arm[:, :2].mean(axis=0) - middle
        turned = np.cross(away, arm[1, :2] - arm[0, :2])
        ordered.append(arm if turned > 0 else arm[::-1])
    ring = np.concatenate(ordered)
    if len(arms) > 1:
        shape = shapely.Polygon(ring[:, :2])
        if shape.is_valid and shape.exterior.is_ccw:
            return ring
    hull = shapely.convex_hull(shapely.multipoints(points[:, :2]))
    if hull.geom_type != "Polygon":
        hull = shapely.buffer(hull, 0.1, cap_style="square")
    corners = shapely.get_coordinates(hull)[:-1]
    return np.column_stack([corners, np.full(len(corners), points[:, 2].mean())])


def _bearing(step: FloatArray) -> float:
    return float(np.arctan2(step[1], step[0]))


def _edges(streets: Streets) -> Iterable[str]:
    for way in streets.ways:
        lanes = "\n".join(
            _lane(way, index, left_hand=streets.left_hand) for index in range(len(way.lanes))
        )
        head = tag("edge", id=way.name, from_=junction_name(way.source),
                   to=junction_name(way.target), numLanes=len(way.lanes), priority=way.rank,
                   spreadType="center", shape=shape_text(way.lanes[-1].shape))  # fmt: skip
        yield f"{head[:-2]}>\n{lanes}\n</edge>"


def allowed_on(lane: Lane) -> str:
    """Return the classes of SUMO that may use a lane, parted by spaces."""
    owned = lane.kind == "drive" and lane.local == "private"
    return CLOSED if lane.closed else ALLOWED["private" if owned else lane.kind]


def _lane(way: Way, index: int, *, left_hand: bool) -> str:
    lane = way.lanes[index]
    walked = lane.kind == "walk"
    barred = {}
    # Nobody changes over what lies between two lanes; the first lane is the one at the kerb.
    kerb, middle = ("changeLeft", "changeRight") if left_hand else ("changeRight", "changeLeft")
    short = way.length < CHANGED
    if index and (short or way.apart[index - 1]):
        barred[kerb] = CLOSED
    if index < len(way.apart) and (short or way.apart[index]):
        barred[middle] = CLOSED
    return tag("lane", index=index, allow=allowed_on(lane), width=f"{lane.width:.3f}",
               speed=f"{WALKED if walked else lane.speed:.3f}", shape=shape_text(lane.shape),
               **barred)  # fmt: skip


def _connections(streets: Streets) -> Iterable[str]:
    led = set()
    for link in streets.links:
        source, target = streets.ways[link.source[0]], streets.ways[link.target[0]]
        led.add(source.name)
        yield tag("connection", from_=source.name, to=target.name, fromLane=link.source[1],
                  toLane=link.target[1], shape=shape_text(link.shape))  # fmt: skip
    for way in streets.ways:
        if way.name not in led:  # else netconvert would guess where it leads to
            yield tag("connection", from_=way.name)
    for crossing in streets.crossings:
        names = " ".join(streets.ways[way].name for way in crossing.ways)
        yield tag("crossing", node=junction_name(crossing.junction), edges=names,
                  width=f"{crossing.width:.3f}", shape=shape_text(crossing.shape),
                  priority=str(crossing.first).lower())  # fmt: skip
