"""A town by a river as OSM XML, made by code: a quay, terraces, a square, a park without paths."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

LATITUDE, LONGITUDE = 52.37, 4.90
METRES_PER_DEGREE = 111_320.0
COSINE = 0.6105  # of the latitude


class _Map:
    """Collects elements; a class because node numbers count up."""

    def __init__(self) -> None:
        self.elements: list[str] = []
        self.count = 0
        self.known: dict[tuple[float, float], int] = {}

    def node(self, x: float, y: float, **tags: str) -> int:
        """Add a node at metres from the origin; plain nodes in one place are one."""
        if not tags and (x, y) in self.known:
            return self.known[x, y]
        self.count += 1
        latitude = LATITUDE + y / METRES_PER_DEGREE
        longitude = LONGITUDE + x / (METRES_PER_DEGREE * COSINE)
        head = f'node id="{self.count}" lat="{latitude:.7f}" lon="{longitude:.7f}"'
        self._add(head, "", tags)
        if not tags:
            self.known[x, y] = self.count
        return self.count

    def way(self, points: list[tuple[float, float]], **tags: str) -> None:
        """Add a way over points."""
        nodes = [self.node(*point) for point in points]
        self.count += 1
        refs = "".join(f'<nd ref="{node}"/>' for node in nodes)
        self._add(f'way id="{self.count}"', refs, tags)

    def box(self, x: float, y: float, width: float, depth: float, **tags: str) -> None:
        """Add a closed rectangle."""
        corners = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth), (x, y)]
        self.way(corners, **tags)

    def _add(self, head: str, inner: str, tags: dict[str, str]) -> None:
        words = "".join(
            f"<tag k={quoteattr(k.replace('__', ':'))} v={quoteattr(v)}/>" for k, v in tags.items()
        )
        self.elements.append(f"<{head}>{inner}{words}</{head.split()[0]}>")


def river_town(path: Path) -> Path:
    """Write the town: the river flows along y = 0, the park lies in the north."""
    town = _Map()
    town.box(-190, -17, 380, 34, natural="water", water="river")
    for y, name in ((25, "North Quay"), (-25, "South Quay")):
        line = [(x, y) for x in (-180.0, -60.0, 60.0, 180.0)]
        town.way(line, highway="residential", name=name, sidewalk="both", surface="sett",
                 sidewalk__width="4", oneway="yes")  # fmt: skip
    for y in (17, -22):
        town.box(-190, y, 380, 5, highway="pedestrian", area="yes")
    town.way([(-180.0, 90.0), (-60.0, 90.0), (60.0, 90.0), (180.0, 90.0)], highway="secondary",
             name="High Street", sidewalk="both", sidewalk__width="3.5", lanes="2")  # fmt: skip
    for x, name in ((-60.0, "Bridge Street"), (60.0, "Park Street")):
        town.way([(x, 25.0), (x, 90.0), (x, 180.0)], highway="residential", name=name,
                 sidewalk="both")  # fmt: skip
    for x, name in ((-60.0, "Bridge Street"), (60.0, "Park Street")):
        town.way([(x, 25.0), (x, -25.0)], highway="residential", bridge="yes", layer="1",
                 name=name, sidewalk="both")  # fmt: skip
    for number in range(30):
        x = -176.0 + 9.0 * number + (4.0 if number > 12 else 0.0)
        if -71 < x < -47 or 49 < x < 71 or x > 170:
            continue
        tags = {"building": "apartments", "building__levels": str(3 + number * 7 % 3),
                "roof__shape": "gabled" if number % 3 else "mansard"}  # fmt: skip
        town.box(x, 36.5, 8.9, 13, **tags)
        town.box(x, -49.5, 8.9, 13, **tags)
        town.box(x, 184, 8.9, 12, **tags)
        if number % 2:
            town.box(x - 9.0, 66, 17.8, 14, **{**tags, "building": "retail"})
    town.box(-50, 101, 100, 74, leisure="park", name="Town Park")
    town.way([(-12.0 + 11 * dx, 152.0 + 6 * dy) for dx, dy in
              ((-1, 0), (-0.6, 0.9), (0.5, 1.0), (1.0, 0.2), (0.4, -0.9), (-0.7, -0.8), (-1, 0))],
             natural="water", water="pond")  # fmt: skip
    town.box(14, 112, 20, 15, leisure="playground")
    for x in range(-44, 50, 11):
        town.node(float(x), 104.5, natural="tree")
    for x in range(-170, 175, 14):
        if not -72 < x < -48:
            town.node(float(x), 20.3, natural="tree")
    path.write_text(f'<osm version="0.6">{"".join(town.elements)}</osm>')
    return path
