"""Cells of the ground: they cover the site and follow the terrain within the stated tolerance."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city.terrain import Terrain
from cityx.ground import cells
from cityx.ground.cells import relief_lines, tile_lines

EXTENT = (-130.0, -40.0, 310.0, 250.0)


def hills(cell: float, height: float, wave: float) -> Terrain:
    x = np.arange(-400.0, 401.0, cell)
    heights = height * np.sin(x[None, :] / wave) * np.cos(x[:, None] / wave)
    return Terrain((-400.0, -400.0), cell, heights)


def faces_of(lines: np.ndarray) -> np.ndarray:
    border = shapely.box(*EXTENT).exterior
    noded = shapely.get_parts(shapely.unary_union([*lines, border]))
    return shapely.get_parts(shapely.polygonize(noded))


def test_tiles_are_no_larger_than_asked() -> None:
    faces = faces_of(tile_lines(EXTENT, 100.0))
    assert shapely.area(faces).sum() == pytest.approx(440 * 290)
    assert len(faces) == 6 * 4  # cut at -100, 0, ... 300 and at 0, 100, 200
    assert np.ptp(shapely.bounds(faces)[:, [0, 2]], axis=1).max() <= 100.0


def test_cells_lie_the_same_whatever_the_site() -> None:
    wide, narrow = (-300.0, -250.0, 350.0, 330.0), (-199.0, -131.0, 203.5, 222.0)
    inner = shapely.box(-60.0, 10.0, 60.0, 90.0)
    for terrain in (hills(4.0, 12.0, 60.0), None):
        found = [
            shapely.intersection(
                shapely.union_all(
                    tile_lines(extent, 100.0)
                    if terrain is None
                    else relief_lines(extent, terrain, 64.0)[0]
                ),
                inner,
            )
            for extent in (wide, narrow)
        ]
        assert found[0].length >= 80.0
        assert found[0].equals(found[1])


@settings(max_examples=25, deadline=None)
@given(
    cell=st.sampled_from([2.0, 5.0, 13.0, 30.0]),
    height=st.floats(0.5, 40.0),
    wave=st.floats(15.0, 200.0),
)
def test_corners_of_every_cell_follow_the_terrain(cell: float, height: float, wave: float) -> None:
    terrain = hills(cell, height, wave)
    lines, tolerance = relief_lines(EXTENT, terrain, 200.0)
    faces = faces_of(lines)
    assert shapely.area(faces).sum() == pytest.approx(440 * 290)
    step = cell * np.ceil(cells.FINEST / cell)
    box = shapely.bounds(faces)
    size = box[:, 2:] - box[:, :2]
    large = (size > 1.5 * step).all(axis=1)
    assert tolerance == cells.TOLERANCE
    u, v = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9))
    for xmin, ymin, xmax, ymax in box[large]:
        x, y = xmin + u * (xmax - xmin), ymin + v * (ymax - ymin)
        there = terrain.height_at(np.column_stack([x.ravel(), y.ravel()])).reshape(9, 9)
        a, b, c, d = there[0, 0], there[0, -1], there[-1, 0], there[-1, -1]
        even = (a * (1 - u) + b * u) * (1 - v) + (c * (1 - u) + d * u) * v
        kept = tolerance if xmax - xmin > 3 * step else cells.ROUGH
        # Nodes of the smallest cells keep the tolerance; between them the terrain may bend once.
        assert np.abs(there - even).max() <= 2 * kept + height * (step / wave) ** 2 / 4


def test_even_ground_is_not_divided() -> None:
    tilted = Terrain((-500.0, -500.0), 10.0, np.add.outer(np.arange(101.0), np.arange(101.0)))
    lines, tolerance = relief_lines(EXTENT, tilted, 160.0)
    assert tolerance == cells.TOLERANCE
    assert shapely.area(faces_of(lines)).max() == pytest.approx(160.0**2)


def test_a_rough_site_has_no_more_cells_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cells, "MOST", 100)
    lines, tolerance = relief_lines(EXTENT, hills(5.0, 20.0, 40.0), 200.0)
    assert tolerance > cells.TOLERANCE
    assert len(faces_of(lines)) <= 100
