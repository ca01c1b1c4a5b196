"""Change small towns by six sentences and put pictures of before and after on one sheet.

    python examples/edits/main.py [-o docs/edits.png] [--samples 20] [--only NAME ...]

Each pair is seen by one camera.
"""

from __future__ import annotations

import argparse
import math
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cityx_bench.runner import build_scene
from PIL import Image, ImageDraw, ImageFont

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.projects.edit import edit_city
from cityx.projects.views import TIMEOUT_S

RENDERED = (480, 300)  # pixels
CELL = (376, 235)  # of one picture on the sheet
GAP, TITLE = 6, 22
PAIRS = 2  # in a row of the sheet
EYE = 1.7  # metres


@dataclass(frozen=True)
class Change:
    """A sentence and where it is looked at.

    Attributes
    ----------
    name, scene, text
        What the pictures are called, the base scene, the sentence.
    position
        Of the camera, metres.
    view
        Heading clockwise from north, pitch and field of view, degrees.
    """

    name: str
    scene: str
    text: str
    position: tuple[float, float, float]
    view: tuple[float, float, float]

    @property
    def camera(self) -> Camera:
        """The camera of both pictures."""
        heading, pitch, fov = map(math.radians, self.view)
        return Camera(self.name, self.position, heading, pitch, fov, *RENDERED)


CHANGES = (
    Change("trees", "grid_s", "Plant a tree every 10 m along the main street.",
           (-187.0, -96.5, 2.4), (87.0, 3.0, 64.0)),
    Change("cycles", "grid_s", "Add a cycle lane to both sides of the main street.",
           (-50.0, -107.0, 13.0), (62.0, -24.0, 62.0)),
    Change("glass", "grid_s", "Make the three tallest buildings glass.",
           (-260.0, -215.0, 120.0), (48.0, -24.0, 48.0)),
    Change("foot", "river_s", "Close the north street to cars.",
           (-72.0, 93.0, 9.0), (62.0, -16.0, 62.0)),
    Change("pond", "park_s", "Dig a pond in park1 and plant 12 trees in the park.",
           (-82.0, -92.0, 52.0), (42.0, -30.0, 56.0)),
    Change("storm", "grid_s", "Turn the scene into a thunderstorm at night.",
           (-50.0, -107.0, 13.0), (62.0, -24.0, 62.0)),
)  # fmt: skip


def rendered(folder: Path, change: Change, out: Path, samples: int) -> Path:
    """Render a stored city by the camera of a change."""
    job = BlenderJob(folder / "city", renders=(RenderRequest(change.camera, out, samples),))
    run_worker(job, timeout_s=TIMEOUT_S, progress=lambda *_: None)
    return out


def pair(change: Change, work: Path, samples: int) -> tuple[Path, Path]:
    """Return the pictures of a scene before and after a change."""
    base = work / change.scene
    if not base.exists():
        build_scene(change.scene, base)
    folder = work / change.name
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(base, folder)
    before = rendered(folder, change, work / f"{change.name}_before.png", samples)
    edit_city(folder, change.text)
    return before, rendered(folder, change, work / f"{change.name}_after.png", samples)


def sheet(changes: Sequence[Change], work: Path) -> Image.Image:
    """Put the pairs side by side, each under its sentence."""
    width = 2 * CELL[0] + GAP
    rows = -(-len(changes) // PAIRS)
    page = Image.new(
        "RGB", (PAIRS * (width + 2 * GAP) - GAP, rows * (CELL[1] + TITLE + GAP)), "white"
    )
    draw = ImageDraw.Draw(page)
    font = ImageFont.load_default(15)
    for number, change in enumerate(changes):
        x = (number % PAIRS) * (width + 2 * GAP)
        y = (number // PAIRS) * (CELL[1] + TITLE + GAP)
        draw.text((x + 2, y + 2), change.text, "black", font)
        for side, word in enumerate(("before", "after")):
            picture = Image.open(work / f"{change.name}_{word}.png").convert("RGB").resize(CELL)
            page.paste(picture, (x + side * (CELL[0] + GAP), y + TITLE))
    return page


def main() -> None:
    """Make the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("docs/edits.png"))
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--only", nargs="*", default=[change.name for change in CHANGES])
    parser.add_argument("--work", type=Path, help="Folder of scenes and pictures, to be kept.")
    given = parser.parse_args()
    work = given.work or Path(tempfile.mkdtemp())
    work.mkdir(parents=True, exist_ok=True)
    for change in CHANGES:
        if change.name in given.only:
            pair(change, work, given.samples)
    sheet(CHANGES, work).quantize(256, dither=Image.Dither.FLOYDSTEINBERG).save(given.out)


if __name__ == "__main__":
    main()
