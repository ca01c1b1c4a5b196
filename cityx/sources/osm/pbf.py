"""OpenStreetMap PBF files, read by libosmium."""

from __future__ import annotations

from pathlib import Path

from cityx.errors import InputError
from cityx.sources.osm.elements import Collector, OsmMap

_KINDS = {"n": "node", "w": "way", "r": "relation"}


def read_pbf(path: Path) -> OsmMap:
    """Read every element of a PBF file.

    Raises
    ------
    InputError
        If the file is damaged or cut off.
    """
    import osmium

    collector = Collector()
    try:
        source = osmium.io.File(str(path), "pbf")
        with osmium.io.Reader(source) as reader:
            box = reader.header().box()
            if box.valid():
                low, high = box.bottom_left, box.top_right
                collector.bounds.append((low.lon, low.lat, high.lon, high.lat))
        for item in osmium.FileProcessor(source):
            _add(collector, item)
    except (RuntimeError, ValueError, OSError) as error:
        raise InputError(f"{path} is damaged or cut off: {error}.") from error
    return collector.finish()


def _add(collector: Collector, item: object) -> None:
    tags = {tag.k: tag.v for tag in item.tags}  # type: ignore[attr-defined]
    key, version = item.id, item.version  # type: ignore[attr-defined]
    if not item.visible:  # type: ignore[attr-defined]
        return
    if item.is_node():  # type: ignore[attr-defined]
        if item.location.valid():  # type: ignore[attr-defined]
            place = item.location  # type: ignore[attr-defined]
            collector.add_node(key, place.lon, place.lat, tags, version)
    elif item.is_way():  # type: ignore[attr-defined]
        collector.add_way(key, [node.ref for node in item.nodes], tags, version)  # type: ignore[attr-defined]
    elif item.is_relation():  # type: ignore[attr-defined]
        members = [(_KINDS[m.type], m.ref, m.role) for m in item.members]  # type: ignore[attr-defined]
        collector.add_relation(key, members, tags, version)
