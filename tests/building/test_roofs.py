import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.roofs.roof_heights import THICKNESS
from cityx.building.roofs.shapes import SHAPES, RoofBrief, roof_shape, shell_batch
from cityx.geometry.polygons import clean_polygons
from cityx.geometry.solids import GLAZED, ROOF, area_vectors, open_parts, volumes_by_group

RECTANGLE = shapely.box(0, 0, 12, 8)
ELL = shapely.Polygon([(0, 0), (14, 0), (14, 6), (6, 6), (6, 16), (0, 16)])
YARD = shapely.box(0, 0, 30, 24).difference(shapely.box(10, 8, 20, 16))

OCTAGON = shapely.Point(0, 0).buffer(6.0, quad_segs=2)
# The values of roof:shape in Simple 3D Buildings and what is often found beside them.
WIKI_SHAPES = (
    "flat", "gabled", "hipped", "half-hipped", "side_hipped", "side_half-hipped", "pyramidal",
    "gambrel", "mansard", "skillion", "lean_to", "saltbox", "double_saltbox",
    "quadruple_saltbox", "round", "dome", "onion", "cone", "sawtooth", "crosspitched",
    "butterfly", "zollinger", "gabled_height_moved", "hipped-and-gabled", "cross_gabled",
    "gabled_row", "half_hipped",
)  # fmt: skip
# An octagon has no end to raise, a courtyard neither an end nor a middle.
_ENDS = ("half-hipped", "side_hipped", "side_half-hipped", "hipped-and-gabled")
UNFIT = {"octagon": _ENDS, "yard": (*_ENDS, "pyramidal", "onion")}


def brief(shapes, words, *, direction=np.nan, across=False, parapet=0.0, overhang=0.0, rise=3.0):
    outlines = shapely.orient_polygons(np.array(shapes, dtype=object))
    count = len(outlines)
    points = int(shapely.get_num_coordinates(outlines).sum() - sum(
        1 + len(shape.interiors) for shape in outlines if not shape.is_empty))  # fmt: skip
    return RoofBrief(
        shapely.to_wkb(outlines),
        np.array(words),
        np.full(count, -0.5),
        np.full(count, 6.0),
        np.full(count, 6.0 + rise),
        np.zeros(count),
        np.full(count, direction),
        np.full(count, across),
        np.full(count, parapet),
        np.full(count, overhang),
        np.ones(points, bool),
    )


def volume(solids, count=1):
    return volumes_by_group(solids.vertices, solids.faces, solids.face_part, count)


@pytest.mark.parametrize("word", SHAPES)
def test_every_shape_stands_on_a_rectangle_as_asked(word):
    solids, built = shell_batch(brief([RECTANGLE], [word], parapet=0.8, overhang=0.4))
    assert built.tolist() == [word]
    assert not open_parts(solids, 1).any()
    assert solids.vertices[:, 2].max() == pytest.approx(9.0)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.sampled_from(SHAPES))
def test_any_outline_gets_a_closed_shell_below_its_top(seed, word):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 14))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    ring = rng.uniform(3, 15, (count, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    shapes = [*clean_polygons([shapely.Polygon(ring)]), ELL, YARD]
    solids, built = shell_batch(brief(shapes, [word] * 3, parapet=0.8, overhang=0.4))
    assert not open_parts(solids, 3).any()
    assert (built[1:] != "").all()
    assert (volume(solids, 3)[1:] > 0).all()
    assert solids.vertices[:, 2].max() <= 9.0 + 1e-9


def test_a_gabled_roof_holds_half_a_block_above_its_eave():
    solids, _ = shell_batch(brief([RECTANGLE], ["gabled"]))
    assert volume(solids) == pytest.approx([96 * 6.5 + 96 * 1.5])


def test_a_hipped_roof_holds_the_volume_of_its_ridge():
    solids, _ = shell_batch(brief([RECTANGLE], ["hipped"]))
    assert volume(solids) == pytest.approx([96 * 6.5 + 8 * 3 / 6 * (2 * 12 + 4)])


def test_the_ridge_runs_along_the_longer_side_unless_across():
    for across, axis in ((False, 1), (True, 0)):
        solids, _ = shell_batch(brief([RECTANGLE], ["gabled"], across=across))
        ridge = solids.vertices[solids.vertices[:, 2] > 8.99]
        assert np.ptp(ridge[:, axis]) == pytest.approx(0.0, abs=1e-9)


def test_a_skillion_slopes_down_the_way_its_tag_points():
    solids, _ = shell_batch(brief([RECTANGLE], ["skillion"], direction=np.radians(90)))
    high = solids.vertices[solids.vertices[:, 2] > 8.99]
    assert high[:, 0] == pytest.approx(np.zeros(len(high)), abs=1e-9)


def test_a_turned_outline_gets_a_turned_roof():
    for word in ("gabled", "hipped", "half-hipped", "mansard", "round"):
        straight, _ = shell_batch(brief([RECTANGLE], [word]))
        turned, _ = shell_batch(brief([shapely.affinity.rotate(RECTANGLE, 37, (0, 0))], [word]))
        assert volume(turned) == pytest.approx(volume(straight), rel=1e-6)


def test_wings_of_a_house_end_in_gables():
    solids, built = shell_batch(brief([ELL], ["gabled"]))
    assert built.tolist() == ["wings"]
    on_wall = shapely.distance(shapely.points(solids.vertices[:, :2]), ELL.exterior) < 1e-6
    assert (on_wall & (solids.vertices[:, 2] > 8.0)).sum() >= 2


@pytest.mark.parametrize("word", WIKI_SHAPES)
def test_every_value_of_roof_shape_is_built_on_every_plan_that_admits_it(word):
    shape = roof_shape(word)
    plans = [RECTANGLE, ELL, OCTAGON, YARD]
    solids, built = shell_batch(brief(plans, [shape] * 4, parapet=0.8, overhang=0.0))
    assert not open_parts(solids, 4).any()
    names = ("rectangle", "ell", "octagon", "yard")
    admitted = [shape not in UNFIT.get(plan, ()) for plan in names]
    wings = {"wings": "gabled"}
    got = [wings.get(name, name) == shape for name in built.tolist()]
    assert got == admitted
    vector = area_vectors(solids.vertices, solids.faces)
    for row, plan in enumerate(plans):
        mine = solids.face_part == row
        under = mine & (vector[:, 2] < 0) & (solids.vertices[solids.faces[:, 0], 2] < 0)
        assert -vector[under, 2].sum() == pytest.approx(plan.area, rel=5e-3)
        top = solids.vertices[solids.vertex_part == row, 2].max()
        assert top == pytest.approx(9.0, abs=0.05)


def test_a_crosspitched_roof_has_a_gable_over_every_side():
    solids, _ = shell_batch(brief([RECTANGLE], ["crosspitched"]))
    for x, y in ((6, 0), (12, 4), (6, 8), (0, 4)):
        at = np.hypot(solids.vertices[:, 0] - x, solids.vertices[:, 1] - y) < 1e-6
        assert solids.vertices[at, 2].max() == pytest.approx(9.0)
    assert solids.vertices[:, 2].min() < 6.0  # and its corners stay at the eave
    corner = np.hypot(*solids.vertices[:, :2].T) < 1e-6
    assert solids.vertices[corner, 2].max() == pytest.approx(6.0)


def test_the_upright_faces_of_a_sawtooth_roof_are_glazed():
    solids, _ = shell_batch(brief([RECTANGLE], ["sawtooth"]))
    vector = area_vectors(solids.vertices, solids.faces)
    glazed = vector[solids.role == GLAZED]
    assert len(glazed)
    assert (np.abs(glazed[:, 2]) < 0.02 * np.linalg.norm(glazed, axis=1)).all()


def test_a_mansard_is_steep_below_and_shallow_above():
    for plan in (RECTANGLE, ELL):
        solids, _ = shell_batch(brief([plan], ["mansard"]))
        vector = area_vectors(solids.vertices, solids.faces)[solids.role == ROOF]
        pitch = np.degrees(np.arctan2(np.hypot(vector[:, 0], vector[:, 1]), vector[:, 2]))
        assert ((pitch > 60) | (pitch < 30)).all()
        assert (pitch > 60).any()
        assert (pitch < 30).any()


def test_the_overhang_over_a_gable_lies_in_the_plane_of_its_roof():
    plain, _ = shell_batch(brief([ELL], ["gabled"]))
    solids, _ = shell_batch(brief([ELL], ["gabled"], overhang=0.5))
    outside = shapely.distance(shapely.points(solids.vertices[:, :2]), ELL) > 0.2
    z = solids.vertices[outside, 2]
    assert z.max() == pytest.approx(plain.vertices[:, 2].max(), abs=0.01)  # at the ridge's end
    slope = 3.0 / 3.0  # the wings are 6 m wide and 3 m high
    assert z.min() == pytest.approx(6.0 - 0.5 * slope - THICKNESS, abs=0.01)


def test_a_parapet_stands_above_its_deck():
    solids, _ = shell_batch(brief([RECTANGLE], ["flat"], parapet=0.8))
    deck = solids.vertices[solids.faces[solids.role == ROOF][:, :3]][:, :, 2]
    assert np.unique(deck).tolist() == pytest.approx([8.2])


def test_eaves_stop_at_a_neighbour():
    free = brief([RECTANGLE], ["gabled"], overhang=0.4)
    blocked = RoofBrief(**{**free.__dict__, "free": np.array([False, True, True, True])})
    reach = [shell_batch(each)[0].vertices[:, 0].max() for each in (free, blocked)]
    assert reach == pytest.approx([12.24, 12.0])  # narrower over a gable


def test_roof_planes_slope_and_their_texture_is_in_metres():
    solids, _ = shell_batch(brief([RECTANGLE], ["gabled"]))
    up = solids.uv[solids.role == ROOF][:, :3, 1]
    assert np.ptp(up, axis=1) == pytest.approx(np.full(4, 5.0), abs=1e-4)  # 4 m at 3 m rise


def test_unknown_words_are_flat_and_synonyms_are_known():
    assert [roof_shape(word) for word in ("9.0", "many", "Lean_To", "cone", "hip")] == [
        "flat",
        "flat",
        "skillion",
        "pyramidal",
        "hipped",
    ]


def test_an_outline_whose_rings_touch_gets_another_roof():
    touching = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(0, 0), (4, 2), (2, 4)]])
    solids, built = shell_batch(brief([touching], ["hipped"]))
    assert built.tolist() == ["flat"]
    assert not open_parts(solids, 1).any()
