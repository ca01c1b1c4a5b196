"""Heights of bare ground alone: the place they are asked for at, and the fit that is stated."""

import re

import numpy as np
import pytest
import rasterio
from rasterio.transform import Affine

from cityx.checks.terrain_checks import fit_notes
from cityx.errors import UsageError
from cityx.options import BuildOptions, HowToRead
from cityx.projects.build import build
from cityx.sources.input_kinds import Input
from cityx.sources.intake import Inputs, read_sources
from cityx.town.town import town

ROWS = 120


def hills(slope):
    row, column = np.mgrid[0:ROWS, 0:ROWS]
    return 100 + slope * column + 6 * np.sin(row / 15)


def utm(path):
    with rasterio.open(path, "w", driver="GTiff", height=ROWS, width=ROWS, count=1,
                       dtype="float32", crs="EPSG:32633", nodata=np.nan,
                       transform=Affine(5, 0, 500_000, 0, -5, 5_500_000)) as file:  # fmt: skip
        file.write(hills(0.4).astype(np.float32), 1)
    return (49.6518, 15.0035)


def geographic(path):
    corner = Affine(1 / 18_000, 0, -70.0, 0, -1 / 18_000, -33.0)
    with rasterio.open(path, "w", driver="GTiff", height=ROWS, width=ROWS, count=1, dtype="int16",
                       crs="EPSG:4326", nodata=-32768, transform=corner) as file:  # fmt: skip
        file.write(np.rint(hills(0.8)).astype(np.int16), 1)
    return (-33.003, -69.997)


def national(path):
    """Lay a grid of ESRI beside the definition of its coordinate system."""
    from pyproj import CRS

    values = hills(0.1)
    values[3, 4] = -9999
    head = f"ncols {ROWS}\nnrows {ROWS}\nxllcorner 600000\nyllcorner 200000\ncellsize 4\n"
    rows = "\n".join(" ".join(f"{value:.1f}" for value in row) for row in values)
    path.write_text(f"{head}NODATA_value -9999\n{rows}\n")
    path.with_suffix(".prj").write_text(CRS.from_epsg(21781).to_wkt("WKT1_ESRI"))
    return (46.9535, 7.4417)


FILES = [(utm, "a.tif"), (geographic, "b.tif"), (national, "c.asc")]


@pytest.mark.parametrize(("write", "name"), FILES)
def test_a_town_on_heights_alone_lies_where_it_is_asked_for(tmp_path, write, name):
    at = write(tmp_path / name)
    inputs = Inputs((), (Input(tmp_path / name, "height"),))
    city = read_sources(inputs, HowToRead(at=at)).city
    assert (city.frame.latitude, city.frame.longitude) == at
    low, high = np.array(city.layout.extent[:2]), np.array(city.layout.extent[2:])
    assert (low < 0).all()
    assert (high > 0).all()
    with pytest.raises(UsageError, match=r"--at 10.0,10.0 lies outside the heights, which cover"):
        read_sources(inputs, HowToRead(at=(10.0, 10.0)))


@pytest.mark.parametrize(("size", "told"), [((20.0, 300.0), "20x300"), ((3e4, 3e4), "30000x30000")])
def test_a_size_that_no_town_has_is_refused(tmp_path, size, told):
    utm(tmp_path / "a.tif")
    with pytest.raises(UsageError, match=f"--size {told} is no size of a town"):
        build([tmp_path / "a.tif"], tmp_path / "out", BuildOptions(size=size))


def test_a_town_on_a_part_of_its_heights_says_which(tmp_path):
    utm(tmp_path / "a.tif")
    reading = read_sources(Inputs((), (Input(tmp_path / "a.tif", "height"),)), HowToRead())
    notes = town(reading.city, width=200.0, depth=200.0).notes
    assert any(re.search(r"200 x 200 m of the heights, which reach over \d+ x \d+ m", note)
               for note in notes)  # fmt: skip


def test_the_stated_fit_is_of_the_ground_that_stands(tmp_path):
    utm(tmp_path / "a.tif")
    options = BuildOptions(size=(200.0, 200.0), lod=0, render=False, formats=("glb",))
    report = build([tmp_path / "a.tif"], tmp_path / "out", options)
    fit = [note for note in report["notes"] if "the ground as built misses" in note]
    assert len(fit) == 1
    assert "on land" in fit[0]
    assert "in streets" in fit[0]


def test_without_heights_no_fit_is_stated():
    assert fit_notes(read_sources(Inputs((), ()), HowToRead()).city) == ()
