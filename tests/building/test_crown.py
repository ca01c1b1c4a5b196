from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from cityx.assets.trims.dormers import DEPTH, DORMERS, dormer_front, dormer_roof
from cityx.building.facade import cornices
from cityx.building.facade.cornices import corner_stones, mouldings
from cityx.building.facade.facade import facade, pitched_field
from cityx.building.facade.facade_plan import facade_of
from cityx.building.facade.placing import Placing
from cityx.building.facade.wall_faces import wall_faces
from cityx.building.growth import grown, piece_of
from cityx.building.roofs.dormers import dormers
from cityx.building.roofs.roof_edges import OVERLAP, gable_windows
from cityx.building.shell import shell
from cityx.checks.facade_checks import blind_windows
from cityx.city import City, Frame, Layout, make_table
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import NO_VERTEX, concatenate, one_mesh
from cityx.city.mesh_measures import check_closed, volume
from cityx.city.scene import Scene
from cityx.geometry.solids import open_parts

BOX = shapely.box(0, 0, 24, 12)
EAVE, RISE = 12.0, 5.0


def city_of(shapes, roof, *, rise=RISE, use="apartments"):
    count = len(shapes)
    ids = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(7919)
    same = {"id": ids, "use": [use] * count, "levels": [4] * count}
    buildings = make_table("buildings", np.array(shapes, object), place=["urban"] * count, **same)
    parts = make_table(
        "parts", np.array(shapes, object), building=ids, top=[EAVE + rise] * count,
        base=[0.0] * count, walls=[True] * count, roof_shape=[roof] * count,
        roof_height=[rise] * count, roof_direction=[np.nan] * count, wall_color=[-1] * count,
        roof_color=[-1] * count, **same,
    )  # fmt: skip
    street = shapely.LineString([(-50, -8), (150, -8)])
    roads = make_table("roads", np.array([street], object), id=[5], kind=["residential"])
    layout = Layout((-50, -20, 150, 30), buildings, parts, roads)
    return replace(shell(City("block", Frame(48.0, 15.6), layout)), lod=2)


def stage(city):
    """What a facade knows before it is crowned."""
    found = facade_of(city)
    building = found.volumes.building[found.walls.part]
    key = np.arange(found.walls.count, dtype=np.uint64)
    placing = Placing(found.walls, wall_faces(found.volumes.polygons), building, key)
    return placing, found, pitched_field(city, found)


def named(scene, word):
    names = np.array([prototype.name for prototype in scene.prototypes])
    found = list(scene.instances.values())
    return [
        (names[rows.prototype[row]], rows.position[row], rows.rotation[row], rows.scale[row])
        for rows in found
        for row in range(rows.count)
        if names[rows.prototype[row]].startswith(word)
    ]


def dressed(found, head):
    count = len(found.volumes.top)
    designs = replace(found.designs, head=np.full(count, head), string=np.ones(count, bool))
    return replace(found, designs=designs)


@pytest.mark.parametrize("roof", ["gabled", "hipped", "mansard", "half-hipped"])
def test_dormers_stand_on_one_slope_and_end_below_the_ridge(roof):
    made = 0
    for number in range(6):
        city = replace(city_of([BOX], roof), seed=number)
        placing, found, field = stage(city)
        dormers(placing, found, city, field)
        for name, prototype in placing.prototypes.items():
            if not name.endswith("_front"):
                continue
            kind = name.split("_")[1]
            number = list(placing.prototypes).index(name)
            for _, rows in placing.rows:
                mine = rows.prototype == number
                for at, yaw, scale in zip(
                    rows.position[mine], rows.rotation[mine, 2], rows.scale[mine], strict=True
                ):
                    inward = np.array([-np.sin(yaw), np.cos(yaw)])
                    aside = np.array([np.cos(yaw), np.sin(yaw)]) * scale[0] * DORMERS[kind][0] / 2
                    owner = found.volumes.building[:1]
                    z = [field.at((at[:2] + side * aside)[None], owner)[0][0] for side in (-1, 1)]
                    assert z == pytest.approx([at[2]] * 2, abs=0.06)  # on the slope at both sides
                    _, slope = field.at(at[None, :2], owner)
                    tall = sum(DORMERS[kind][1:])
                    back = scale[2] * tall / float(slope[0] @ inward)
                    behind = field.at((at[:2] + inward * back)[None], owner)[0][0]
                    assert behind == pytest.approx(at[2] + scale[2] * tall, abs=0.1)
                    made += 1
                assert prototype.kind == "trim"
    assert made


def test_every_dormer_has_a_window_in_its_front():
    for seed in range(8):
        city = replace(city_of([BOX], "mansard", rise=3.2), seed=seed)
        scene = facade(city).scene
        fronts = named(scene, "dormer_")
        fronts = [each for each in fronts if each[0].endswith("_front")]
        windows = [each for each in named(scene, "window_") if each[1][2] > EAVE]
        assert len(fronts) == len(windows)
        if fronts:
            break
    gap = [min(np.hypot(*(a[1] - b[1])[:2]) for b in windows) for a in fronts]
    assert fronts
    assert max(gap) < 0.2


def test_windows_of_gables_stay_under_the_roof():
    city = city_of([shapely.box(0, 0, 20, 12)], "gabled")
    placing, found, field = stage(city)
    gable_windows(placing, found, city, field)
    rows = [rows for kind, rows in placing.rows if kind == "window"]
    at = np.concatenate([each.position for each in rows])
    assert len(at) >= 2
    assert set(np.abs(at[:, 0] - 10).round(1)) == {10.0}  # in the two ends
    run = np.minimum(at[:, 1], 12 - at[:, 1]) - 0.5
    assert (at[:, 2] + 0.85 < found.volumes.eave[0] + run * RISE / 6.0).all()


def test_low_roofs_have_no_dormers():
    scene = facade(city_of([BOX], "gabled", rise=1.2)).scene
    assert not named(scene, "dormer_")
    assert not named(scene, "roof_window")


def test_roof_windows_lie_in_the_slope():
    for seed in range(20):
        scene = facade(replace(city_of([BOX], "gabled"), seed=seed)).scene
        found = named(scene, "roof_window")
        if found:
            break
    pitch = np.arctan(RISE / 6.0)
    assert found
    for _, at, rotation, _ in found:
        assert rotation[0] == pytest.approx(pitch, abs=1e-3)
        run = min(at[1], 12.0 - at[1])
        assert at[2] == pytest.approx(EAVE + KERB_HEIGHT + run * RISE / 6.0, abs=0.02)


def test_mouldings_close_round_a_free_house_and_at_neighbours():
    row = [shapely.box(0, 0, 12, 11), shapely.box(12, 0, 24, 11), shapely.box(40, 0, 55, 11)]
    city = city_of(row, "flat", rise=0.0)
    placing, found, field = stage(city)
    for head in ("cornice", "coping"):
        solids = mouldings(placing, dressed(found, head), city, field)
        assert len(solids.faces)
        assert not open_parts(solids, 3).any()
        inside = (solids.vertices[:, 0] > 12.05) & (solids.vertices[:, 0] < 39)
        assert not (inside & (solids.vertex_part == 0)).any()  # ends at the neighbour


def test_gables_have_no_cornice():
    city = city_of([BOX], "gabled")
    placing, found, field = stage(city)
    solids = mouldings(placing, dressed(found, "cornice"), city, field)
    high = solids.vertices[:, 2] > EAVE - 1.0
    assert high.any()
    beside_gable = (solids.vertices[:, 1] > 1) & (solids.vertices[:, 1] < 11)
    assert not (high & beside_gable).any()


def test_shells_stay_closed_and_one_object_per_building_under_their_mouldings():
    city = city_of([BOX, shapely.box(40, 0, 60, 14)], "mansard", rise=3.0)
    batch = facade(city).scene.meshes["buildings"]
    assert np.array_equal(batch.object_id, city.scene.meshes["buildings"].object_id)
    assert check_closed(batch).all()


def test_stones_stand_on_the_four_corners_of_a_free_house(monkeypatch):
    city = city_of([BOX], "flat", rise=0.0)
    placing, found, _ = stage(city)
    look = SimpleNamespace(facade=SimpleNamespace(quoins=1.0))
    monkeypatch.setattr(cornices, "looks", lambda: {found.designs.style[0]: look})
    corner_stones(placing, found, 0)
    rows = placing.rows[0][1]
    corners = {tuple(at) for at in rows.position[:, :2].round(3).tolist()}
    assert corners == {(0.0, 0.0), (24.0, 0.0), (24.0, 12.0), (0.0, 12.0)}
    assert rows.position[:, 2].max() < EAVE


def test_a_gabled_house_has_a_capped_ridge_and_two_gutters():
    scene = facade(city_of([BOX], "gabled")).scene
    gutters = named(scene, "gutter")
    assert len(gutters) == 2
    assert sorted(at[1] for _, at, _, _ in gutters) == pytest.approx([-0.35, 12.35], abs=0.01)
    assert all(at[2] < EAVE for _, at, _, _ in gutters)
    length = [scale[0] - OVERLAP for _, _, _, scale in named(scene, "ridge_")]
    assert sum(length) == pytest.approx(24.0 + 2 * 0.21, abs=0.02)  # and over both verges


@pytest.mark.parametrize("kind", DORMERS)
def test_prototypes_of_dormers_are_closed_and_have_their_drawn_size(kind):
    width, height, rise = DORMERS[kind]
    for mesh in (dormer_front(kind).mesh, dormer_roof(kind, "slate").mesh):
        assert check_closed(mesh).all()
        assert volume(mesh)[0] > 0
        assert mesh.vertices[:, 2].max() <= height + rise + 0.1
    assert dormer_roof(kind, "slate").mesh.vertices[:, 1].max() == pytest.approx(DEPTH)
    assert np.ptp(dormer_front(kind).mesh.vertices[:, 0]) == pytest.approx(width)


def test_in_a_row_the_chimney_stands_where_the_ridge_meets_the_party_wall():
    row = [shapely.box(9 * k, 0, 9 * k + 9, 12) for k in range(4)]
    city = city_of(row, "gabled", use="house")
    stacks = []
    for seed in range(4):
        scene = facade(replace(city, seed=seed)).scene
        stacks += [at for _, at, _, _ in named(scene, "chimney")]
    inner = [at for at in stacks if 9 < at[0] < 27]  # the ends of the row look at the street
    assert inner
    assert all(abs((at[0] + 4.5) % 9 - 4.5) < 0.5 for at in inner)
    assert all(abs(at[1] - 6) < 0.1 for at in inner)


def test_what_is_added_to_objects_comes_behind_their_own_faces():
    def cube(number, material):
        rng = np.random.default_rng(number)
        faces = rng.integers(0, 8, (12, 4))
        faces[::3, 3] = NO_VERTEX
        return one_mesh(number, rng.random((8, 3)), faces, materials=(material,))

    shells = concatenate([cube(number, "plaster") for number in (1, 3, 5, 9)])
    added = concatenate([cube(number, "trim") for number in (3, 9)])
    both = grown(shells, [piece_of(added, shells)])
    assert both.object_id.tolist() == [1, 3, 5, 9]
    for row, number in enumerate(both.object_id.tolist()):
        mine = both.take([row])
        own = [each.take(np.flatnonzero(each.object_id == number)) for each in (shells, added)]
        whole = concatenate(own)
        assert np.array_equal(mine.vertices, whole.vertices)
        assert np.array_equal(mine.faces, whole.faces)
        names = [[each.materials[i] for i in each.material] for each in (mine, whole)]
        assert names[0] == names[1]


def test_no_dormer_looks_at_a_part_that_begins_at_its_eave():
    high, low = shapely.box(12, 0, 30, 12), shapely.box(0, 0, 12, 12)
    made = 0
    for seed in range(4):
        city = replace(city_of([low, high], "mansard"), seed=seed)
        parts = city.layout.parts.copy()
        parts["building"] = parts["building"].to_numpy()[0]
        parts["base"], parts["top"] = [0.0, EAVE], [EAVE + RISE, EAVE + 2 * RISE]
        parts["roof_shape"], parts["roof_height"] = ["mansard", "flat"], [RISE, 0.0]
        layout = replace(city.layout, parts=parts, buildings=city.layout.buildings.iloc[:1])
        raised = facade(shell(replace(city, layout=layout, scene=Scene(), lod=2)))
        made += sum(name.endswith("_front") for name, *_ in named(raised.scene, "dormer_"))
        assert not len(blind_windows(raised, raised.scene.instances["windows"]))
    assert made
