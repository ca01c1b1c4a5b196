"""Maps from the network: a place by its name or its rectangle, kept in the local cache.

Nothing here runs unless a user asks for a place; no action and no model can.
"""

from __future__ import annotations

import gzip
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import blake2b
from math import cos, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import urlsplit

from cityx.errors import InputError, UsageError
from cityx.system.atomic import replaced
from cityx.version import __version__

if TYPE_CHECKING:
    import requests

OVERPASS = "https://overpass-api.de/api/interpreter"
NOMINATIM = "https://nominatim.openstreetmap.org/search"
AGENT = f"cityx/{__version__} (city generator)"  # both services ask programs to say who they are
LARGEST = 25.0  # square kilometres; larger maps come as extracts, not from a shared server
MAX_BYTES = 512 << 20  # of XML
CHUNK = 1 << 18
SECONDS = 180  # that the server may take
KILOMETRES = 111.32  # of a degree of latitude
ELSEWHERE = "download an extract (download.geofabrik.de, extract.bbbike.org) and give the file"

Say = Callable[[str], None]


class Place(NamedTuple):
    """A rectangle of the Earth, degrees."""

    name: str
    west: float
    south: float
    east: float
    north: float

    @property
    def km2(self) -> float:
        """Area in square kilometres."""
        middle = radians((self.south + self.north) / 2)
        width = (self.east - self.west) * KILOMETRES * cos(middle)
        return width * (self.north - self.south) * KILOMETRES


def retrieve(place: str, folder: Path, *, say: Say = lambda _: None) -> Path:
    """Return the map file of a place, from the folder or, the first time, from the network.

    Parameters
    ----------
    place
        A name such as "Kruununhaka, Helsinki", or "WEST,SOUTH,EAST,NORTH" in degrees.
    folder
        Where maps are kept; made when absent.

    Raises
    ------
    InputError
        If there is no such place or no connection, or the place is too large.
    """
    box = _rectangle(place)
    path = folder / f"{_slug(place)}_{blake2b(place.encode(), digest_size=4).hexdigest()}.osm.gz"
    if path.exists():
        return path
    found = box or _geocoded(place)
    say(f"{found.name}: {found.km2:.2f} km2")
    if found.km2 > LARGEST:
        raise InputError(
            f"{found.name} covers {found.km2:,.0f} km2, more than the {LARGEST:g} km2 that may be "
            f"asked of a shared server; name a smaller place, or {ELSEWHERE}."
        )
    folder.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        _download(found, temporary)
    return path


def _rectangle(text: str) -> Place | None:
    """Read four numbers, or return None for a name."""
    try:
        west, south, east, north = (float(word) for word in text.split(","))
    except ValueError:
        return None
    if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
        raise UsageError(
            f'"{text}" is no rectangle: give WEST,SOUTH,EAST,NORTH in degrees, such as '
            "24.94,60.165,24.96,60.175."
        )
    return Place(f"rectangle {text}", west, south, east, north)


def _slug(text: str) -> str:
    return re.sub(r"[^\w.-]+", "_", text.lower())[:60].strip("_")


def _geocoded(name: str) -> Place:
    """Ask Nominatim where a place is."""
    asked = {"q": name, "format": "jsonv2", "limit": "1"}
    with _asked("GET", os.environ.get("CITYX_NOMINATIM", NOMINATIM), params=asked) as answer:
        try:
            found = answer.json()
            if not found:
                raise InputError(f'No place is called "{name}"; add its city and country.')
            south, north, west, east = (float(edge) for edge in found[0]["boundingbox"])
        except (ValueError, KeyError, TypeError, IndexError) as error:
            raise InputError(f"{answer.url} gave an answer that cannot be read.") from error
    return Place(str(found[0].get("display_name", name)), west, south, east, north)


def _download(place: Place, path: Path) -> None:
    """Ask Overpass for everything in a rectangle, and pack it with the rectangle it covers."""
    box = f"{place.south:.7f},{place.west:.7f},{place.north:.7f},{place.east:.7f}"
    query = (
        f"[out:xml][timeout:{SECONDS}][maxsize:{MAX_BYTES}];"
        f"(nwr({box});<;);(._;>;);out meta qt;"  # with relations that hold them, and all nodes
    )
    url = os.environ.get("CITYX_OVERPASS", OVERPASS)
    bounds = (
        f'<bounds minlat="{place.south:.7f}" minlon="{place.west:.7f}" '
        f'maxlat="{place.north:.7f}" maxlon="{place.east:.7f}"/>'
    )
    with _asked("POST", url, data={"data": query}) as answer, gzip.open(path, "wb") as file:
        done, end = 0, b""
        for block in _with_bounds(answer.iter_content(CHUNK), bounds.encode()):
            file.write(block)
            done += len(block)
            end = (end + block)[-4096:]
            if done > MAX_BYTES:
                raise InputError(
                    f"{place.name} is more than {MAX_BYTES >> 20} MB of XML; name a smaller place."
                )
    # The server tells of its own limits in a remark at the end of an answer that looks complete.
    remark = re.search(rb"<remark>(.*?)</remark>", end, re.DOTALL)
    if remark or b"</osm>" not in end:
        why = remark[1].decode(errors="replace").strip() if remark else "the answer is cut off"
        raise InputError(f"{url} could not give {place.name}: {why}; try later, or {ELSEWHERE}.")


def _with_bounds(blocks: Iterator[bytes], bounds: bytes) -> Iterator[bytes]:
    """Put an element behind the start tag of the root."""
    held = b""
    for block in blocks:
        held += block
        root = re.search(rb"<osm[^>]*>", held)
        if root:
            yield held[: root.end()] + bounds + held[root.end() :]
            yield from blocks
            return
    yield held


@contextmanager
def _asked(method: str, url: str, **more: Any) -> Iterator[requests.Response]:
    """Ask a server, and turn what can go wrong into a sentence."""
    import requests

    try:
        with requests.request(
            method, url, headers={"User-Agent": AGENT}, timeout=SECONDS, stream=True, **more
        ) as answer:
            answer.raise_for_status()
            yield answer
    except requests.HTTPError as error:
        raise InputError(f"{url} refused: {error}; try later, or {ELSEWHERE}.") from error
    except requests.RequestException as error:
        host = urlsplit(url).netloc
        raise InputError(
            f"No connection to {host} ({type(error).__name__}); {ELSEWHERE}."
        ) from error
