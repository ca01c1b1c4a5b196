"""A second reading of a map, by osmium alone: its tagged objects with their shapes."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import shapely

NAMED = re.compile(r"\.(osm|pbf)(\.gz|\.bz2)?$")  # files whose format osmium knows by their name


@dataclass(frozen=True)
class Feature:
    """An object of a map: "way/12", its tags, and its shape in degrees or the metres of a city."""

    name: str
    tags: Mapping[str, str]
    shape: shapely.Geometry


def features(path: Path) -> list[Feature]:
    """Read the tagged objects of an OSM file, relations of areas too; broken ones are left out."""
    import osmium

    with tempfile.TemporaryDirectory() as folder:
        if not NAMED.search(path.name.lower()):
            path = Path(shutil.copyfile(path, Path(folder) / f"map{_format(path)}"))
        try:
            return _read(path)
        except RuntimeError as fault:
            if "out of order" not in str(fault):
                raise
        ordered = Path(folder) / "ordered.osm.pbf"
        reader = osmium.MergeInputReader()
        reader.add_file(str(path))
        with osmium.SimpleWriter(str(ordered)) as writer:
            reader.apply(writer)
        return _read(ordered)


def _format(path: Path) -> str:
    """Return the suffix of the format of a file with another name."""
    with path.open("rb") as file:
        head = file.read(64)
    packed = {b"\x1f\x8b": ".osm.gz", b"BZ": ".osm.bz2"}.get(head[:2], ".osm")
    return ".osm.pbf" if b"OSMHeader" in head else packed


def _read(path: Path) -> list[Feature]:
    import osmium

    factory = osmium.geom.WKBFactory()
    found: dict[str, Feature] = {}
    tagged = osmium.filter.EmptyTagFilter()
    for one in osmium.FileProcessor(str(path)).with_areas().with_filter(tagged):
        tags = dict(one.tags)
        try:
            name, shape = _shaped(one, factory)
        except (RuntimeError, osmium.InvalidLocationError):
            continue
        if name and (name not in found or shape.geom_type.endswith("Polygon")):
            found[name] = Feature(name, tags, shape)
    return [found[name] for name in sorted(found)]


def _shaped(one: Any, factory: Any) -> tuple[str, shapely.Geometry]:
    """Return the name and the shape of an object; an area is of the way or relation it is of."""
    if one.is_node():
        return f"node/{one.id}", shapely.from_wkb(factory.create_point(one))
    if one.is_way():
        return f"way/{one.id}", shapely.from_wkb(factory.create_linestring(one))
    if one.is_area():
        kind = "way" if one.from_way() else "relation"
        return f"{kind}/{one.orig_id()}", shapely.from_wkb(factory.create_multipolygon(one))
    return "", shapely.Point()
