"""OpenStreetMap files: streamed, tolerant of mistakes, refusing what is hostile."""

from __future__ import annotations

import bz2
import gzip
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO
from xml.parsers import expat

from cityx.errors import InputError
from cityx.sources.osm.elements import Collector, OsmMap

CHUNK = 1 << 20
# OSM XML packs 10 to 30 times; gzip allows 1000, bzip2 millions. Small files may be repetitive.
MAX_RATIO = 250
RATIO_FREE = 64 << 20  # bytes that may be unpacked whatever the ratio
MAX_BYTES = 4 << 30  # of XML; more needs a database, not one file
MAX_TOKEN = 16 << 20  # bytes of one tag; longer ones are attacks
FORMS = ".osm, .osm.gz, .osm.bz2 or .osm.pbf"
_KINDS = {"n": "node", "w": "way", "r": "relation"}


def read_elements(path: Path) -> OsmMap:
    """Read every element of a map file, whatever its suffix says.

    Raises
    ------
    InputError
        If the file is not OpenStreetMap data, is cut off, or is unsafe to unpack.
    """
    path = Path(path)
    head = _head(path)
    if b"OSMHeader" in head[:64]:
        return read_pbf(path)
    if head[:2] == b"\x1f\x8b":
        return _read_xml(path, gzip.open)
    if head[:3] == b"BZh":
        return _read_xml(path, bz2.open)
    if head[:4] == b"PK\x03\x04":
        raise InputError(f"{path} is a zip archive; unpack it and give the {FORMS} inside.")
    return _read_xml(path, None)


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            head = file.read(1024)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error
    if not head.strip():
        raise InputError(f"{path} is empty; give OpenStreetMap data ({FORMS}).")
    return head


@contextmanager
def _reported(path: Path, position: Callable[[], int]) -> Iterator[None]:
    """Turn the errors of unpacking and parsing into one sentence about the file."""
    try:
        yield
    except expat.ExpatError as error:
        raise InputError(_explain(path, error)) from error
    except LookupError as error:
        raise InputError(f"{path} is not OpenStreetMap XML ({error}); give {FORMS}.") from error
    except EOFError as error:
        raise InputError(
            f"{path} is cut off: its packed data ends after {position():,} bytes of XML; "
            "download it again."
        ) from error
    except (OSError, zlib.error) as error:
        raise InputError(
            f"{path} cannot be unpacked: damaged after {position():,} bytes of XML ({error})."
        ) from error


def _explain(path: Path, error: expat.ExpatError) -> str:
    where = f"line {error.lineno}, column {error.offset}"
    what = expat.ErrorString(error.code)
    cut = {"no element found", "unclosed token", "unclosed CDATA section", "partial character"}
    if what in cut and error.lineno > 1:
        return f"{path} is cut off at {where}; download it again."
    return f"{path} is not OpenStreetMap XML ({what} at {where}); give {FORMS}."


def _read_xml(path: Path, unpack: Callable[..., Any] | None) -> OsmMap:
    collector = Collector()
    parser = _parser(path, collector)
    limit = max(RATIO_FREE, path.stat().st_size * MAX_RATIO) if unpack else MAX_BYTES
    done = 0
    feed = _Feed(parser, collector)
    with _reported(path, lambda: done):
        opened: BinaryIO = unpack(path, "rb") if unpack else path.open("rb")
        with opened as file:
            while block := file.read(CHUNK):
                done += len(block)
                if done > min(limit, MAX_BYTES):
                    raise InputError(_too_big(path, done))
                feed(block)
                if feed.waiting > MAX_TOKEN:
                    raise InputError(
                        f"{path} has one tag of over {MAX_TOKEN >> 20} MB near byte "
                        f"{done - feed.waiting:,}; this is not map data."
                    )
        feed.close()
    return collector.finish()


class _Feed:
    """Gives blocks of XML to the parser, less the nodes that the collector takes by itself.

    A class because the end of a block waits for the next one. Comments, character data and
    processing instructions may hold what looks like a node: from the first one on, and before the
    root, the parser gets everything.
    """

    def __init__(self, parser: Any, collector: Collector) -> None:
        self.parser, self.collector = parser, collector
        self.rest = b""
        self.plain = True
        self.fed = 0

    @property
    def waiting(self) -> int:
        """Bytes that wait for the end of their tag."""
        return self.fed - int(self.parser.CurrentByteIndex) + len(self.rest)

    def __call__(self, block: bytes) -> None:
        block, self.rest = self.rest + block, b""
        if self.plain and self.parser.StartElementHandler is not self.collector.start:
            root = block.find(b">", block.find(b"<osm") + 1) + 1 if b"<osm" in block else 0
            self.plain = root > 0
            self._parse(block[:root])
            block = block[root:]
        if self.plain:
            end = block.rfind(b">") + 1
            self.plain = end > 0 and b"<!" not in block and b"<?" not in block
            if self.plain:
                block, self.rest = self.collector.take_plain_nodes(block[:end]), block[end:]
        self._parse(block)

    def _parse(self, block: bytes) -> None:
        self.fed += len(block)
        self.parser.Parse(block, False)

    def close(self) -> None:
        """Give the parser what is left and end the document."""
        self.parser.Parse(self.rest, True)


def _too_big(path: Path, size: int) -> str:
    if size > MAX_BYTES:
        return f"{path} holds over {MAX_BYTES >> 30} GB of XML; cut a smaller area out of it."
    return (
        f"{path} unpacks to more than {MAX_RATIO} times its size ({size:,} bytes and more); "
        "this is not map data."
    )


def _parser(path: Path, collector: Collector) -> Any:
    """Return an expat parser that feeds the collector; document types are refused."""
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def refuse(*_: Any) -> None:
        raise InputError(
            f"{path} declares a document type or entities (line {parser.CurrentLineNumber}); "
            "OpenStreetMap files have none, so it is refused."
        )

    def root(name: str, attributes: dict[str, str]) -> None:
        if name != "osm":
            raise InputError(
                f"{path} is XML with root <{name[:40]}>, not <osm>; give OpenStreetMap ({FORMS})."
            )
        del attributes
        parser.StartElementHandler = collector.start

    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    parser.StartElementHandler = root
    return parser


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
