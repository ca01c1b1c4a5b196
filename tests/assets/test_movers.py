import numpy as np
import pytest

from cityx.assets.people.gaits import going, lift_at, stride_of
from cityx.assets.people.head import CYCLE_HELMET, HELMET
from cityx.assets.people.looks import STYLES, drawn_person
from cityx.assets.people.people import figure
from cityx.assets.people.skeleton import NUMBER
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.vehicles.car_bodies import BODIES
from cityx.assets.vehicles.large_vehicles import LARGE
from cityx.assets.vehicles.movers import (
    RIDERS,
    SPECIAL,
    figure_of,
    is_person,
    kind_of,
    looks_of,
    paints_of,
    person_look,
    person_of,
    registered,
    size_of,
    vehicle,
    vehicle_looks,
)
from cityx.assets.vehicles.moving import rider_look
from cityx.assets.vehicles.two_wheelers import TWO_WHEELERS, wheel_of
from cityx.city.tracks import GAIT
from cityx.errors import UsageError
from cityx.geometry.solids import open_groups, volumes_by_group
from cityx.places.profiles import profile_named, profile_names

SOME = [drawn_person(number) for number in range(12)]
# Length, width and height of what is registered, metres: least and most.
REAL = {
    "car": ((3.3, 4.8), (1.4, 1.95), (1.35, 1.92)), "van": ((3.3, 5.6), (1.4, 2.1), (1.75, 2.65)),
    "bus": ((11, 13), (2.5, 2.55), (2.9, 3.3)), "truck": ((7, 9), (2.4, 2.55), (3.2, 3.8)),
    "tram": ((13, 16), (2.3, 2.65), (3.0, 3.6)), "bicycle": ((1.6, 1.9), (0.5, 0.7), (1.6, 1.9)),
    "motorcycle": ((1.8, 2.2), (0.65, 0.8), (1.5, 1.8)),
}  # fmt: skip


@pytest.mark.parametrize("detail", [2, 3])
@pytest.mark.parametrize("look", vehicle_looks())
def test_a_vehicle_has_real_size_and_stands_on_its_wheels(look, detail):
    made = vehicle(look, detail=detail)
    for value, (least, most) in zip(made.size, REAL[made.kind], strict=True):
        assert least <= value <= most
    low, high = made.body.mesh.vertices.min(axis=0), made.body.mesh.vertices.max(axis=0)
    assert low[2] > 0.1  # the wheels alone are on the ground
    assert high[1] - low[1] == pytest.approx(made.size[0], abs=0.13)
    for wheel in made.wheels:
        points = wheel.prototype.mesh.vertices
        assert np.hypot(points[:, 1], points[:, 2]).max() == pytest.approx(wheel.radius, abs=0.005)
        assert wheel.place[2] == pytest.approx(wheel.radius)
        assert abs(wheel.place[1]) < made.size[0] / 2


MODELS = {**LARGE, **TWO_WHEELERS}


@pytest.mark.parametrize("look", MODELS)
def test_a_vehicle_is_of_closed_solids_of_known_materials(look):
    parts = MODELS[look].parts(MODELS[look])
    if look in TWO_WHEELERS:
        parts = [*parts, *wheel_of(MODELS[look])]
    assert parts
    for mesh in parts:
        group = np.zeros(len(mesh.faces), np.int64)
        assert set(mesh.materials) <= set(MATERIALS)
        assert not open_groups(mesh.faces, group, len(mesh.vertices), 1).any()
        assert volumes_by_group(mesh.vertices, mesh.faces, group, 1)[0] > 0


def test_every_kind_has_looks_and_every_look_a_kind():
    places = [profile_named(name).vehicles for name in profile_names()]
    looks = {look: kind for kind in REAL for place in places for look, _ in looks_of(kind, place)}
    looks |= {look: kind for kind, look in SPECIAL.values()}
    assert set(looks) == set(vehicle_looks())
    assert all(vehicle(look).kind == kind for look, kind in looks.items())
    for look in looks:
        colors, shares = paints_of(look)
        assert shares.sum() == pytest.approx(1.0)
        assert ((colors >= 0) & (colors * 0.8 <= 1.0)).all()


def test_plates_of_a_place_make_no_other_vehicle():
    look = registered("car_sedan", "gb", 23)
    assert look == "car_sedan_gb23"
    assert registered("truck", "gb", 2) == "truck"
    assert vehicle(look).size == vehicle("car_sedan").size
    assert kind_of(look) == kind_of("car_sedan")
    assert np.array_equal(paints_of("car_black_cab_gb1")[0], paints_of("car_black_cab")[0])
    with pytest.raises(UsageError, match='No vehicle looks like "car_sedan_zz9"'):
        vehicle("car_sedan_zz9")


@pytest.mark.parametrize("gait", ["walk", "run"])
@pytest.mark.parametrize("who", SOME, ids=range(len(SOME)))
def test_a_foot_that_bears_does_not_slide(who, gait):
    made = figure(who)
    stride = stride_of(made, GAIT[gait])
    share = stride / who.height
    assert (0.7 < share < 1.0) if gait == "walk" else (1.0 < share < 1.4)
    foot = [NUMBER["left_ankle"], NUMBER["left_toes"]]
    toes = np.isin(made.weights.joints, foot).all(axis=1)
    # The foot is flat on the ground in the middle of its time there; the body goes over it.
    phases = np.linspace(0.18, 0.34, 9) if gait == "walk" else np.linspace(0.1, 0.2, 6)
    y = [going(made, GAIT[gait], float(t)).vertices[toes, 1].mean() for t in phases]
    on_ground = np.array(y) - stride * phases
    assert np.ptp(on_ground) < 0.07
    gone = stride * np.ptp(phases)
    assert np.ptp(on_ground) < 0.35 * gone


@pytest.mark.parametrize("gait", ["still", "walk"])
def test_who_walks_or_stands_has_a_foot_on_the_ground(gait):
    made = figure(SOME[0])
    for phase in np.linspace(0, 1, 11):
        low = going(made, GAIT[gait], float(phase)).vertices[:, 2].min()
        assert low == pytest.approx(0.0, abs=1e-9)


def test_who_runs_leaves_the_ground_between_two_steps_and_never_sinks():
    made = figure(SOME[0])
    low = [going(made, GAIT["run"], t).vertices[:, 2].min() for t in np.linspace(0, 1, 51)]
    assert min(low) > -0.002
    assert 0.02 < max(low) < 0.15
    lifts = [lift_at(made, GAIT["run"], t) for t in np.linspace(0, 1, 101)]
    assert np.abs(np.diff(lifts)).max() < 0.03  # it never jumps


def test_words_of_a_look_say_who_it_is():
    look = person_look(7, sex="female", style="business")
    assert look == "person_female_business_7"
    assert is_person(look)
    assert person_of(look).sex == "female"
    assert person_of("person_child_3").age == "child"
    assert person_of("person_7") == drawn_person(7)
    assert size_of("person_7")[2] == drawn_person(7).height


def test_who_jogs_carries_nothing():
    people = [person_of(person_look(number, jogs=True)) for number in range(40)]
    assert {(who.bag, who.shoes) for who in people} == {("", "trainers")}
    assert any(person_of(person_look(number)).bag for number in range(40))


@pytest.mark.parametrize("style", STYLES)
def test_styles_dress_people_each_in_its_way(style):
    tops = {person_of(person_look(n, style=style, age="adult")).top for n in range(40)}
    others = {"casual": "suit", "business": "t_shirt", "sport": "suit"}
    assert others[style] not in tops
    assert len(tops) >= 2


@pytest.mark.parametrize(
    ("look", "said"),
    [("car_hatchbak", 'Did you mean "car_hatchback"'), ("zeppelin", "Known are car_hatchback")],
)
def test_a_look_of_nothing_is_refused(look, said):
    with pytest.raises(UsageError, match=said):
        vehicle(look)
    with pytest.raises(UsageError, match='No person looks like "person_tall_3": tall'):
        person_of("person_tall_3")
    with pytest.raises(UsageError, match="is no look of a person, such as person_7"):
        person_of("person_male")


@pytest.mark.parametrize("detail", [2, 3])
def test_who_rides_with_an_engine_wears_a_helmet_with_a_visor(detail):
    scooter, bicycle = (vehicle(look).seat for look in ("scooter", "bicycle"))
    assert all(person_of(rider_look(number, scooter)).hat == HELMET for number in range(RIDERS))
    hats = {person_of(rider_look(number, bicycle)).hat == CYCLE_HELMET for number in range(RIDERS)}
    assert hats == {True, False}
    mesh = figure_of(rider_look(0, scooter), detail).mesh
    head = mesh.vertices[:, 2].max()
    faces = mesh.faces[mesh.material == mesh.materials.index("car_glass")]
    visor = mesh.vertices[np.unique(faces[faces < len(mesh.vertices)])]
    assert head - 0.32 < visor[:, 2].min() < visor[:, 2].max() < head - 0.03


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("country", ["gb", "eu"])
def test_somebody_drives_a_fine_car_from_the_side_of_its_country(body, country):
    made = vehicle(f"car_{body}_{country}3", detail=3)
    (who,) = [part.prototype for part in made.parts if part.prototype.name.startswith("driver")]
    low, high = who.mesh.vertices.min(axis=0), who.mesh.vertices.max(axis=0)
    assert (low[0] + high[0] > 0) == (country == "eu")
    assert np.abs(who.mesh.vertices[:, 0]).max() < made.size[1] / 2
    assert high[2] < made.size[2] - 0.03  # under the roof
    assert not vehicle(f"car_{body}_{country}3", detail=2).parts
