import numpy as np
import shapely

from cityx.city.ground import LABEL
from cityx.ground.arrangement import arrange, face_areas, regions
from cityx.road.ground.paved_blocks import pave_blocks


def area_of(ground, name):
    return float(face_areas(ground)[ground.labelled(name)].sum())


def test_a_scrap_with_its_stones_amid_a_walk_is_walk(layout_of):
    walk, beside = shapely.box(0, 0, 40, 10), shapely.box(0, 10, 40, 40)
    scrap = shapely.Polygon([(10, 4), (13, 4), (10, 7)])
    front = shapely.box(20, 9, 23, 12)  # reaches the yard behind the walk
    stones = [shapely.buffer(each, 0.1).difference(each) for each in (scrap, front)]
    names = ["sidewalk", "grass", "frontage", "frontage", "edging", "edging"]
    found = regions([walk, beside, scrap, front, *stones], [LABEL[name] for name in names],
                    [50, 12, 60, 60, 55, 55])  # fmt: skip
    ground = pave_blocks(arrange(found, (0, 0, 40, 40)), layout_of([([(-90, -90), (-90, 90)], {})]))
    assert np.isclose(area_of(ground, "frontage"), 9.0, atol=0.05)
    assert np.isclose(area_of(ground, "edging"), stones[1].area, atol=0.05)
