import numpy as np
import pytest

from cityx.assets.colliders import collider_of, shapeless
from cityx.assets.shapes import fine_shapes, prototype
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.vehicles.car_bodies import BODIES
from cityx.assets.vehicles.car_faces import front, rear
from cityx.assets.vehicles.car_parts import PART, REGISTRATIONS, car_parts, fixed_to, meshes_of
from cityx.assets.vehicles.number_plates import PLATES, number_plate
from cityx.assets.vehicles.vehicles import PAINT_SHARES, PAINTS, car
from cityx.geometry.turns import matrices
from cityx.places.profiles import profile_named, profile_names


@pytest.mark.parametrize("name", BODIES)
def test_a_car_has_real_size_and_stands_on_its_wheels(name):
    mesh = car(name).mesh
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert 3.3 < high[1] - low[1] < 5.6
    assert 1.4 < high[0] - low[0] < 2.25
    assert 1.35 < high[2] < (2.7 if BODIES[name].service else 2.6)
    if BODIES[name].kei:  # what the class may measure at most
        assert high[1] - low[1] <= 3.45
        assert BODIES[name].width <= 1.48
        assert high[2] <= 2.0
    assert low[2] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("name", BODIES)
def test_a_car_has_paint_glass_rubber_and_a_bounded_mesh(name):
    mesh = car(name).mesh
    assert {"car_paint", "car_glass", "rubber"} <= set(mesh.materials) <= set(MATERIALS)
    assert 300 <= mesh.triangle_count <= (1800 if BODIES[name].service else 1500)


@pytest.mark.parametrize("name", BODIES)
def test_a_car_is_the_same_left_and_right(name):
    x = car(name).mesh.vertices[:, 0]
    assert x.min() == pytest.approx(-x.max(), abs=1e-4)


@pytest.mark.parametrize("place", profile_names())
def test_every_place_has_its_share_of_bodies(place):
    vehicles = profile_named(place).vehicles
    assert sum(vehicles.cars.values()) == pytest.approx(1.0)
    assert sum(vehicles.vans.values()) == pytest.approx(1.0)
    assert ("black_cab" in vehicles.cars) == ("gb" in profile_named(place).lineage)
    assert ("kei_car" in vehicles.cars) == (place == "jp")


def plate_of(country, number, *, rear=False, kei=False):
    with fine_shapes():
        parts = number_plate(country, number, 2.0, 0.5, rear=rear, kei=kei)
        return prototype("plate", "vehicle", parts).mesh


@pytest.mark.parametrize("country", PLATES)
def test_plates_differ_from_number_to_number_and_look_away_from_the_car(country):
    found = [plate_of(country, number) for number in range(REGISTRATIONS)]
    assert len({mesh.vertices.tobytes() for mesh in found}) == REGISTRATIONS
    wide, high = PLATES[country].size
    for mesh, y in ((found[0], -2.0), (plate_of(country, 0, rear=True), 2.0)):
        low, top = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        assert top[0] - low[0] == pytest.approx(wide, abs=1e-3)
        assert top[2] - low[2] == pytest.approx(high, abs=1e-3)
        assert np.abs((low[1], top[1])).max() == pytest.approx(abs(y), abs=0.03)
        assert np.sign(low[1]) == np.sign(top[1]) == np.sign(y)


def test_plates_have_the_colours_of_their_country():
    def ground(country, **options):
        mesh = plate_of(country, 0, **options)
        return MATERIALS[mesh.materials[mesh.material[0]]]

    assert min(ground("gb").color) == min(ground("jp").color) > 0.5
    red, green, blue = ground("gb", rear=True).color
    assert red > green > 4 * blue  # yellow behind
    assert ground("jp", kei=True).color[2] < 0.1
    assert not ground("gb").takes_tint  # nor the colour of the car


@pytest.mark.parametrize("name", BODIES)
def test_the_makes_of_a_body_differ_before_or_behind(name):
    body = BODIES[name]
    faces = dict.fromkeys(body.faces)
    with fine_shapes():
        looks = [front(body, face) + rear(body, face) for face in faces]
    shapes = {b"".join(mesh.vertices.tobytes() for mesh in look) for look in looks}
    assert len(shapes) == len(faces)


def test_a_car_of_one_country_and_number_is_always_the_same():
    make = car.__wrapped__.__wrapped__  # neither remembered nor kept
    made = [make("estate", detail=3, country="gb", number=1) for _ in range(2)]
    assert made[0].mesh.vertices.tobytes() == made[1].mesh.vertices.tobytes()
    assert made[0].name == "car_estate_gb1_fine"


def test_a_car_is_its_bare_body_and_its_parts():
    make = car.__wrapped__.__wrapped__
    whole = make("kei_van", detail=3, country="jp", number=5)
    bare = make("kei_van", detail=3, country="jp", number=None)
    parts = car_parts("kei_van", "jp", 5)
    assert {part.prototype.kind for part in parts} == {PART}
    together = prototype("", "", [bare.mesh, *meshes_of(parts)]).mesh
    assert together.triangle_count == whole.mesh.triangle_count
    ordered = [mesh.vertices[np.lexsort(mesh.vertices.T)] for mesh in (whole.mesh, together)]
    assert ordered[0] == pytest.approx(ordered[1], abs=1e-4)
    assert shapeless([bare])[0].mass == shapeless([whole])[0].mass == 950.0
    assert not collider_of(parts[1].prototype)


@pytest.mark.parametrize("body", ["sedan", "van"])
def test_registrations_share_body_and_face_and_differ_in_their_plates(body):
    found = [car_parts(body, "gb", number) for number in range(REGISTRATIONS)]
    names = [[parts[at].prototype.name for parts in found] for at in range(3)]
    assert [len(set(each)) for each in names] == [3, REGISTRATIONS, REGISTRATIONS]
    shared = car_parts("estate", "gb", 7)[1].prototype
    assert shared is found[7][1].prototype
    ahead, behind = (found[7][at] for at in (1, 2))
    assert ahead.place[1] < -1.5
    assert behind.place[1] > 1.5
    assert behind.about


def test_parts_follow_a_car_on_a_slope():
    rear = car_parts("sedan", "eu", 0)[2]
    turn = np.array([[0.1, -0.05, 2.0]])
    place, own = fixed_to(rear, np.array([[5.0, 6.0, 7.0]]), turn)
    car_turn = matrices(turn)[0]
    assert place[0] == pytest.approx(car_turn @ np.array(rear.place) + [5.0, 6.0, 7.0])
    assert matrices(own)[0] @ [0.0, -1.0, 0.0] == pytest.approx(car_turn @ [0.0, 1.0, 0.0])


def test_shares_are_of_a_whole_and_colours_physical():
    assert PAINT_SHARES.sum() == pytest.approx(1.0)
    assert PAINT_SHARES[:4].sum() > 0.7  # white, black, grey and silver
    assert np.all((PAINTS >= 0) & (PAINTS * 0.8 <= 1.0))
