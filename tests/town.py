"""A small town as OSM XML, made by code: streets, houses, a river, a park, trees."""

from __future__ import annotations

import random
from pathlib import Path
from xml.sax.saxutils import quoteattr

LATITUDE, LONGITUDE = 60.17, 24.94
METRES_PER_DEGREE = 111_320.0
SHRINK = 0.4975  # cosine of the latitude


class Town:
    """Collects elements; a class because node numbers count up."""

    def __init__(self) -> None:
        self.elements: list[str] = []
        self.count = 0

    def node(self, x: float, y: float, **tags: str) -> int:
        """Add a node at metres from the origin."""
        self.count += 1
        latitude = LATITUDE + y / METRES_PER_DEGREE
        longitude = LONGITUDE + x / (METRES_PER_DEGREE * SHRINK)
        self._add(f'node id="{self.count}" lat="{latitude:.7f}" lon="{longitude:.7f}"', "", tags)
        return self.count

    def way(self, nodes: list[int], **tags: str) -> int:
        """Add a way over nodes."""
        self.count += 1
        refs = "".join(f'<nd ref="{node}"/>' for node in nodes)
        self._add(f'way id="{self.count}"', refs, tags)
        return self.count

    def box(self, x: float, y: float, width: float, depth: float, **tags: str) -> int:
        """Add a closed rectangular way."""
        corners = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth)]
        nodes = [self.node(*corner) for corner in corners]
        return self.way([*nodes, nodes[0]], **tags)

    def _add(self, head: str, inner: str, tags: dict[str, str]) -> None:
        words = "".join(
            f"<tag k={quoteattr(k.replace('__', ':'))} v={quoteattr(v)}/>" for k, v in tags.items()
        )
        self.elements.append(f"<{head}>{inner}{words}</{head.split()[0]}>")

    def write(self, path: Path, *, shuffle: int | None = None) -> Path:
        """Write the file, with its elements in another order when `shuffle` is a seed."""
        elements = list(self.elements)
        if shuffle is not None:
            random.Random(shuffle).shuffle(elements)
        path.write_text(f'<osm version="0.6">{"".join(elements)}</osm>')
        return path


def small_town() -> Town:
    """Lay out two crossing streets with houses of every roof family, a river, a park."""
    town = Town()
    cross = town.node(0, 0, highway="traffic_signals")
    west, east = town.node(-90, 0), town.node(90, 0)
    south, north = town.node(0, -70), town.node(0, 70)
    town.way([west, cross, east], highway="secondary", lanes="2", name="High Street")
    town.way([south, cross, north], highway="residential", parking__both="lane")
    town.way([town.node(-80, 40), town.node(-20, 42)], highway="footway")
    roofs = ["flat", "gabled", "hipped", "mansard", "pyramidal", "skillion", "gambrel", "round"]
    for index, roof in enumerate(roofs):
        x, y = -82 + 20 * (index % 4), (12 if index < 4 else -28)
        town.box(x, y, 12 + index % 3, 14, building="apartments", roof__shape=roof,
                 building__levels=str(2 + index % 4))  # fmt: skip
    town.box(20, 12, 15, 12, building="retail", building__levels="3")
    town.box(35, 12, 15, 12, building="office", height="24")  # shares a wall with the shop
    church = town.box(60, 14, 16, 24, building="church", height="14", roof__shape="gabled")
    town.box(64, 18, 6, 6, building__part="yes", height="30", roof__shape="dome",
             min_height="0")  # fmt: skip
    assert church
    town.box(-85, -68, 170, 14, natural="water")
    town.box(15, -45, 60, 30, leisure="park")
    for x in range(20, 74, 9):
        town.node(x, -30, natural="tree")
    town.node(-12, 7, highway="street_lamp")
    town.node(12, -7, amenity="bench")
    return town
