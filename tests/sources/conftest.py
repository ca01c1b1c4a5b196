from math import cos, radians
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

LAT, LON = 52.5, 13.4
METRES = 111_320.0
SHARED = Path(__file__).parents[2] / "../shared/data"


class Drawing:
    """A small map drawn in metres about a place in Berlin."""

    def __init__(self, folder):
        self.folder = folder
        self.nodes, self.elements, self.ids = [], [], 0
        self.known = {}

    def node(self, x, y, **tags):
        key = self.known.get((x, y))
        if key is None or tags:
            self.ids += 1
            key = self.known[x, y] = self.ids
            lat, lon = LAT + y / METRES, LON + x / METRES / cos(radians(LAT))
            self.nodes.append(
                f'<node id="{key}" lat="{lat:.8f}" lon="{lon:.8f}">{_tags(tags)}</node>'
            )
        return key

    def way(self, points, /, **tags):
        self.ids += 1
        refs = "".join(f'<nd ref="{self.node(*point)}"/>' for point in points)
        self.elements.append(f'<way id="{self.ids}">{refs}{_tags(tags)}</way>')
        return self.ids

    def box(self, x, y, width, depth, /, **tags):
        ring = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth), (x, y)]
        return self.way(ring, **tags)

    def relation(self, members, /, **tags):
        self.ids += 1
        inside = "".join(f'<member type="way" ref="{ref}" role="{role}"/>' for ref, role in members)
        self.elements.append(f'<relation id="{self.ids}">{inside}{_tags(tags)}</relation>')
        return self.ids

    def text(self):
        return f"<osm version='0.6'>{''.join(self.nodes + self.elements)}</osm>"

    def file(self, name="map.osm"):
        path = self.folder / name
        path.write_text(self.text(), encoding="utf-8")
        return path

    def city(self, **options):
        from cityx.sources.osm import read_osm

        return read_osm(self.file(), **options)


def _tags(tags):
    return "".join(
        f"<tag k={quoteattr(key.replace('__', ':'))} v={quoteattr(str(value))}/>"
        for key, value in tags.items()
    )


@pytest.fixture
def drawing(tmp_path):
    return Drawing(tmp_path)


@pytest.fixture
def shared_osm():
    def find(name):
        path = SHARED / "osm" / name
        if not path.exists():
            pytest.skip(f"{name} is not in ../shared/data/osm")
        return path

    return find


@pytest.fixture
def shared_height():
    def find(name):
        path = SHARED / "height" / name
        if not path.exists():
            pytest.skip(f"{name} is not in ../shared/data/height")
        return path

    return find
