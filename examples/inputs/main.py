"""Build a city from every kind of input and show each beside it: docs/inputs.png.

    python examples/inputs/main.py [NAME ...] [-o docs/inputs.png] [--samples 16] [--work DIR]

Images, maps and heights are read from ``../shared``; what is absent is left out. Dubai: CC0,
Humans in the Loop. Kampala: OpenAerialMap, CC BY 4.0. Alexandria: US federal lidar. Gothenburg:
Lindberg et al., with the UMEP code. The towns need no input at all.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from cityx.options import BuildOptions, HowToRead, RenderOptions
from cityx.projects.build import build
from cityx.projects.views import render_views

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"
SIDE = 420  # pixels of a picture
CAPTION = 26
COLUMNS = 4  # pictures in a row, two to each input
TOWN = (700.0, 700.0)  # metres


@dataclass(frozen=True)
class Example:
    """Files of ``../shared/data``, how they are read, and what stands below the picture."""

    title: str
    files: tuple[str, ...] = ()
    read: HowToRead = field(default_factory=HowToRead)
    settings: tuple[str, ...] = ()
    size: tuple[float, float] | None = None


EXAMPLES = {
    "dubai": Example(
        "aerial image, Dubai", ("satellite/dubai/tile2_part002.jpg",),
        HowToRead(pixel=0.7, fidelity="plausible"),
    ),
    "kampala": Example(
        "drone image, Kampala", ("satellite/kampala/{kampala}",), HowToRead(pixel=0.3),
    ),
    "map_dubai": Example("semantic map, six classes", ("semantic/dubai/tile7_part003.png",)),
    "map_cover": Example(
        "semantic map, land cover", ("semantic/goteborg_kronenhuset_landcover.tif",),
        HowToRead(legend="gothenburg"),
    ),
    "alexandria": Example("surface and ground, Alexandria",
                          ("height/alexandria_va_dsm.tif", "height/alexandria_va_dtm.tif")),
    "gothenburg": Example("surface and ground, Gothenburg",
                          ("height/goteborg_kronenhuset_dsm.tif",
                           "height/goteborg_kronenhuset_dem.tif")),
    "grid": Example("nothing: a river town", settings=("pattern=grid", "river=yes"), size=TOWN),
    "radial": Example("nothing: a radial town", settings=("pattern=radial",), size=TOWN),
    "organic": Example(
        "nothing: an old town by the sea",
        settings=("pattern=organic", "coast=south", "shore=200"), size=TOWN,
    ),
    "suburb": Example(
        "nothing: a suburb", settings=("pattern=cul_de_sac", "zone=suburb"), size=TOWN
    ),
}  # fmt: skip


def picture_of(path: Path) -> Image.Image:
    """Return an input as a picture: an image as it is, heights as hill-shade."""
    import rasterio

    with rasterio.open(path) as dataset:
        bands = dataset.read()
    if len(bands) >= 3:
        return Image.fromarray(np.moveaxis(bands[:3], 0, 2).astype(np.uint8))
    values = bands[0].astype(float)
    found, number = np.unique(values, return_inverse=True)
    if len(found) < 24:  # classes: each a grey of its own
        grey = np.linspace(40, 250, len(found))[number.reshape(values.shape)]
        return Image.fromarray(grey.astype(np.uint8)).convert("RGB")
    values = np.where(np.abs(values) > 1e4, np.nan, values)
    values = np.nan_to_num(values, nan=float(np.nanmin(values)))
    south, east = np.gradient(values)
    shade = np.clip(160 + 90 * (east - south) / np.hypot(np.hypot(east, south), 1.0), 0, 255)
    return Image.fromarray(shade.astype(np.uint8)).convert("RGB")


def square(picture: Image.Image) -> Image.Image:
    """Scale a picture into a square with its form kept."""
    share = SIDE / max(picture.size)
    size = (max(round(picture.width * share), 1), max(round(picture.height * share), 1))
    scaled = picture.convert("RGB").resize(size)
    held = Image.new("RGB", (SIDE, SIDE), "white")
    held.paste(scaled, ((SIDE - scaled.width) // 2, (SIDE - scaled.height) // 2))
    return held


def made(name: str, example: Example, work: Path, samples: int) -> list[tuple[str, Image.Image]]:
    """Return captioned pictures of an example: its input and the city, or two views of a town."""
    files = [DATA / file for file in example.files]
    city = work / name
    if not (city / "report.json").is_file():
        options = BuildOptions(
            formats=(), render=False, read=example.read, settings=example.settings,
            size=example.size, time="15:00",
        )  # fmt: skip
        build(files, city, options, say=print)
    views = ("top",) if files else ("top", "aerial")
    cities = []
    for view in views:
        path = city / "renders" / f"{view}.png"
        if not path.is_file():
            render_views(city, RenderOptions(view, samples, (SIDE, SIDE)), say=print)
        cities.append(square(Image.open(path)))
    if not files:
        return [(example.title, cities[0]), ("the same from the air", cities[1])]
    return [(example.title, square(picture_of(files[0]))), ("the city built from it", cities[0])]


def sheet(pictures: list[tuple[str, Image.Image]]) -> Image.Image:
    """Lay pictures out with their captions."""
    rows = -(-len(pictures) // COLUMNS)
    height = SIDE + CAPTION
    out = Image.new("RGB", (COLUMNS * SIDE, rows * height), "white")
    draw = ImageDraw.Draw(out)
    font = ImageFont.load_default(15)
    for index, (title, picture) in enumerate(pictures):
        x, y = index % COLUMNS * SIDE, index // COLUMNS * height
        out.paste(picture, (x, y))
        draw.text((x + 6, y + SIDE + 4), title, fill="black", font=font)
    return out


def known(example: Example) -> Example:
    """Fill in an image of Kampala that shows more ground than a street corner."""
    folder = DATA / "satellite" / "kampala"
    tiles = sorted(path.name for path in folder.glob("*")) if folder.is_dir() else []
    # Zoom 19 is 0.3 m per pixel; the last tiles lie in the east, which the network never saw.
    chosen = max((tile for tile in tiles if tile.startswith("z19")), default="none")
    return replace(example, files=tuple(file.format(kampala=chosen) for file in example.files))


def main() -> None:
    """Build, render and lay out what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(EXAMPLES), help=", ".join(EXAMPLES))
    parser.add_argument("-o", "--out", type=Path, default=Path("docs/inputs.png"))
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--work", type=Path, default=Path("build/inputs"))
    options = parser.parse_args()
    pictures = []
    for name in options.names:
        example = known(EXAMPLES[name])
        if all((DATA / file).is_file() for file in example.files):
            pictures += made(name, example, options.work, options.samples)
        else:
            print(f"{name}: its input is not in {DATA}")
    sheet(pictures).quantize(256).save(options.out, optimize=True)


if __name__ == "__main__":
    main()
