import numpy as np
import pytest
import shapely

from cityx.assets.styles.palettes import Finishes
from cityx.building.assembly import TRIM_MATERIAL, assemble
from cityx.building.roofs.roof_edges import eaves_of, ridges_of
from cityx.building.roofs.roof_heights import THICKNESS, roof_field
from cityx.building.roofs.shapes import RoofBrief, shell_batch

HOUSE = shapely.box(0, 0, 12, 8)


def batch(word, overhang=0.0):
    one = np.ones(1)
    brief = RoofBrief(
        shapely.to_wkb(shapely.orient_polygons(np.array([HOUSE], object))), np.array([word]),
        0 * one, 6 * one, 9 * one, 0 * one, np.nan * one, one < 0, 0 * one, overhang * one,
        np.ones(4, bool),
    )  # fmt: skip
    solids, _ = shell_batch(brief)
    names = np.array(["plaster"])
    fields = {name: np.ones((1, 3), np.float32) for name in Finishes.__dataclass_fields__}
    fields |= {"wall_material": names, "roof_material": np.array(["slate"])}
    return assemble(solids, np.array([7], np.uint64), Finishes(**fields))


def roof_of(mesh):
    return mesh.material == mesh.materials.index("slate")


def test_heights_and_slopes_are_those_of_the_roof():
    field = roof_field(batch("gabled"), np.ones(1, bool), ())
    z, slope = field.at(np.array([[6.0, 2.0], [6.0, 4.0], [30.0, 0.0]]), np.full(3, 7, np.uint64))
    assert z[:2] == pytest.approx([7.5, 9.0])
    assert np.isnan(z[2])
    assert slope[0] == pytest.approx([0.0, 0.75])


def test_another_building_has_no_roof_there():
    field = roof_field(batch("gabled"), np.ones(1, bool), ())
    assert np.isnan(field.at(np.array([[6.0, 2.0]]), np.array([8], np.uint64))[0]).all()


def test_a_hipped_roof_has_a_ridge_and_four_hips():
    mesh = batch("hipped")
    lines = ridges_of(mesh, roof_of(mesh))
    level = np.abs(lines.start[:, 2] - lines.end[:, 2]) < 1e-6
    assert (int(level.sum()), int((~level).sum())) == (1, 4)


def test_a_barrel_has_no_ridge():
    mesh = batch("round")
    assert len(ridges_of(mesh, roof_of(mesh)).start) == 0


def test_gutters_run_along_the_two_eaves_of_a_gabled_roof():
    mesh = batch("gabled", overhang=0.4)
    lines = eaves_of(mesh, mesh.material == mesh.materials.index(TRIM_MATERIAL), THICKNESS)
    assert sorted(lines.start[:, 1].round(2).tolist()) == [-0.4, 8.4]
    run = lines.end - lines.start
    outward = np.column_stack([run[:, 1], -run[:, 0]])
    assert ((lines.start[:, :2] - [6, 4]) * outward > -1e-9).all(axis=1).any()
