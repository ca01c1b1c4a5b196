from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.library.grow import grow_library
from cityx.assets.library.local_text import LocalText
from cityx.assets.people.looks import Person, drawn_person, words_of
from cityx.assets.people.people import body_of, figure, person, posed
from cityx.assets.people.poses import push, run, sit, stand, walk
from cityx.assets.people.skeleton import JOINTS, NUMBER, PARENT, joint_motions
from cityx.assets.styles.materials import MATERIALS
from cityx.errors import UsageError
from cityx.geometry.solids import area_vectors, open_groups, volumes_by_group

CROWD = [drawn_person(number) for number in range(200)]
SOME = CROWD[:24]
PHASES = np.linspace(0.0, 1.0, 17)
PLAIN = Person(hair="cropped", height=1.75, sex="male")


def solids_of(made):
    first = made.mesh.faces[:, 0]
    return np.searchsorted(made.parts, first, side="right") - 1, len(made.parts) - 1


def feet(made, side):
    """Vertices that the foot of a side moves."""
    numbers = [NUMBER[f"{side}_ankle"], NUMBER[f"{side}_toes"]]
    return np.isin(made.weights.joints, numbers).all(axis=1)


@pytest.mark.parametrize("detail", [2, 3])
@pytest.mark.parametrize("who", SOME, ids=range(len(SOME)))
def test_a_figure_is_of_closed_solids_and_sound(who, detail):
    made = figure(who, detail=detail)
    part, count = solids_of(made)
    assert not open_groups(made.mesh.faces, part, len(made.mesh.vertices), count).any()
    assert (volumes_by_group(made.mesh.vertices, made.mesh.faces, part, count) > 0).all()
    assert np.isfinite(made.mesh.vertices).all()
    assert np.isfinite(made.mesh.uv).all()
    assert set(made.mesh.materials) <= set(MATERIALS)
    assert ((made.mesh.tint >= 0) & (made.mesh.tint * 0.8 <= 1.0)).all()


@pytest.mark.parametrize("detail", [2, 3])
@pytest.mark.parametrize("height", [1.0, 1.2, 1.45, 1.63, 1.8, 2.0])
@pytest.mark.parametrize("hair", ["bald", "short", "afro", "long", "bun"])
def test_a_person_is_exactly_as_high_as_asked(height, hair, detail):
    age = "child" if height < 1.5 else "adult"
    z = figure(replace(PLAIN, height=height, age=age, hair=hair), detail=detail).mesh.vertices[:, 2]
    assert z.max() == pytest.approx(height, abs=1e-9)
    assert z.min() == pytest.approx(0.0, abs=1e-9)


def test_heads_are_a_seventh_and_a_half_of_adults_and_more_of_children():
    def heads(height, age):
        who = replace(PLAIN, height=height, age=age, hair="bald")
        body = body_of(who)
        return height / (body.skull * body.unit)

    assert heads(1.8, "adult") == pytest.approx(7.5, abs=0.1)
    assert heads(1.55, "adult") == pytest.approx(7.5, abs=0.1)
    assert 5.0 < heads(1.0, "child") < heads(1.2, "child") < heads(1.5, "child") < 7.0


def test_limbs_have_the_proportions_of_people():
    joints = body_of(PLAIN).joints() * body_of(PLAIN).unit / PLAIN.height
    z = {name: joints[number, 2] for name, number in NUMBER.items()}
    assert z["left_knee"] == pytest.approx(0.285, abs=0.01)
    assert z["left_hip"] == pytest.approx(0.53, abs=0.015)
    assert z["left_shoulder"] == pytest.approx(0.80, abs=0.015)
    hands = figure(PLAIN).weights.joints[:, 0] == NUMBER["left_wrist"]
    tips = figure(PLAIN).mesh.vertices[hands, 2].min() / PLAIN.height
    assert tips == pytest.approx(0.38, abs=0.02)


def test_women_are_narrower_at_the_shoulders_and_wider_at_the_hips():
    man, woman = (body_of(replace(PLAIN, sex=sex)) for sex in ("male", "female"))
    assert woman.trunk([0.79])[0, 0] < man.trunk([0.79])[0, 0]
    assert woman.trunk([0.62])[0, 0] < man.trunk([0.62])[0, 0]
    assert woman.trunk([0.51])[0, 0] > man.trunk([0.51])[0, 0]
    stout = body_of(replace(PLAIN, build=1.0))
    assert (stout.trunk([0.61]) > 1.1 * man.trunk([0.61])).all()


@pytest.mark.parametrize("detail", [2, 3])
def test_both_levels_have_their_number_of_triangles(detail):
    counts = np.array([figure(who, detail=detail).mesh.triangle_count for who in CROWD[:60]])
    low, mean, high = {2: (900, 1600, 1900), 3: (6000, 11_000, 12_500)}[detail]
    assert low <= counts.min()
    assert counts.mean() <= mean
    assert counts.max() <= high


@pytest.mark.parametrize("who", SOME, ids=range(len(SOME)))
def test_both_levels_have_the_same_silhouette(who):
    plain, fine = (figure(who, detail=detail).mesh.vertices for detail in (2, 3))
    assert plain.min(axis=0) == pytest.approx(fine.min(axis=0), abs=0.03)
    assert plain.max(axis=0) == pytest.approx(fine.max(axis=0), abs=0.03)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_person():
    first = person(5, detail=3).mesh
    figure.cache_clear()
    again = person(5, detail=3).mesh
    assert first.vertices.tobytes() == again.vertices.tobytes()
    assert first.tint.tobytes() == again.tint.tobytes()
    assert drawn_person(5, seed=1) != drawn_person(5)
    assert drawn_person(5, age="child").age == "child"


def test_two_hundred_people_are_distinct_and_of_every_kind():
    assert len(set(CROWD)) == 200
    assert len({figure(who).mesh.vertices.tobytes() for who in CROWD}) == 200
    assert {who.age for who in CROWD} == {"child", "adult", "elder"}
    assert len({who.skin for who in CROWD}) >= 7
    assert len({who.hair for who in CROWD}) >= 9
    assert len({who.top for who in CROWD}) >= 10
    assert sum("woman" in words_of(who) for who in CROWD) > 50
    grown = [who.height for who in CROWD if who.age != "child"]
    assert 1.4 < min(grown) < 1.6 < 1.85 < max(grown) <= 2.0


@pytest.mark.parametrize("who", SOME, ids=range(len(SOME)))
def test_every_vertex_hangs_on_at_most_two_joints(who):
    made = figure(who)
    assert made.weights.joints.shape == made.weights.shares.shape == (len(made.mesh.vertices), 2)
    assert (made.weights.shares >= -1e-12).all()
    assert made.weights.shares.sum(axis=1) == pytest.approx(1.0)
    assert ((made.weights.joints >= 0) & (made.weights.joints < len(JOINTS))).all()


def test_parents_stand_before_their_joints_and_sides_mirror_each_other():
    assert (np.arange(len(JOINTS)) > PARENT).all()
    joints = body_of(PLAIN).joints()
    for name, number in NUMBER.items():
        if name.startswith("left_"):
            other = joints[NUMBER[name.replace("left_", "right_")]]
            assert other == pytest.approx(joints[number] * [-1, 1, 1])


def test_no_rotation_leaves_a_figure_as_it_is():
    made = figure(PLAIN)
    still = posed(made, np.zeros((len(JOINTS), 3)))
    assert still.vertices == pytest.approx(made.mesh.vertices, abs=1e-12)


def test_a_knee_bends_the_shank_back_by_its_angle_and_nothing_above():
    made = figure(PLAIN)
    bend = np.zeros((len(JOINTS), 3))
    bend[NUMBER["left_knee"], 0] = np.pi / 2
    turn, shift = joint_motions(made.joints, bend)
    ankle, knee = made.joints[NUMBER["left_ankle"]], made.joints[NUMBER["left_knee"]]
    moved = turn[NUMBER["left_knee"]] @ ankle + shift[NUMBER["left_knee"]]
    assert moved - knee == pytest.approx([ankle[0] - knee[0], knee[2] - ankle[2],
                                          ankle[1] - knee[1]])  # fmt: skip
    above = made.mesh.vertices[:, 2] > 0.4 * PLAIN.height
    after = posed(made, bend, grounded=False).vertices
    assert after[above] == pytest.approx(made.mesh.vertices[above], abs=1e-9)


@pytest.mark.parametrize("gait", [walk, run])
def test_gaits_are_periodic_smooth_and_the_same_on_both_sides(gait):
    assert gait(0.0) == pytest.approx(gait(1.0), abs=1e-12)
    assert gait(0.3) == pytest.approx(gait(-1.7), abs=1e-9)
    steps = [np.abs(gait(t + 0.01) - gait(t)).max() for t in np.arange(0, 1, 0.01)]
    assert max(steps) < np.radians(6.0)
    left, right = gait(0.2)[NUMBER["left_knee"]], gait(0.7)[NUMBER["right_knee"]]
    assert left == pytest.approx(right)


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("who", [PLAIN, CROWD[2], CROWD[14]], ids=["man", "child", "skirt"])
def test_a_walker_stands_on_the_foot_that_bears_it(who, phase):
    made = figure(who)
    z = posed(made, walk(phase)).vertices[:, 2]
    assert abs(z.min()) < 0.015
    lowest = {side: z[feet(made, side)].min() for side in ("left", "right")}
    bearing = "left" if phase % 1.0 < 0.5 else "right"
    assert lowest[bearing] < 0.015
    # One foot swings through while the other one bears.
    if 0.15 < phase % 0.5 < 0.4:
        other = "right" if bearing == "left" else "left"
        assert lowest[other] > lowest[bearing]


@pytest.mark.parametrize("who", SOME[:12], ids=range(12))
@pytest.mark.parametrize("pose", [walk(0.05), walk(0.6), run(0.3), run(0.7), sit(), stand(1.0)])
def test_bending_tears_nothing(who, pose):
    made = figure(who)
    after = posed(made, pose)
    edges = after.faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    before = np.linalg.norm(np.diff(made.mesh.vertices[edges], axis=1)[:, 0], axis=1)
    length = np.linalg.norm(np.diff(after.vertices[edges], axis=1)[:, 0], axis=1)
    assert (length - before).max() < 0.12
    area = np.linalg.norm(area_vectors(after.vertices, after.faces), axis=1).sum()
    rest = np.linalg.norm(area_vectors(made.mesh.vertices, made.mesh.faces), axis=1).sum()
    assert 0.85 * rest < area < 1.15 * rest


def test_who_sits_has_thighs_level_and_shanks_upright():
    made = figure(PLAIN)
    turn, shift = joint_motions(made.joints, sit())
    place = {
        name: turn[NUMBER[name]] @ made.joints[NUMBER[name]] + shift[NUMBER[name]]
        for name in ("left_hip", "left_knee", "left_ankle")
    }
    assert abs(place["left_hip"][2] - place["left_knee"][2]) < 0.06
    assert place["left_knee"][1] < place["left_hip"][1] - 0.3
    assert abs(place["left_knee"][1] - place["left_ankle"][1]) < 0.08


def test_a_prototype_faces_south_and_stands_on_the_ground():
    made = person(3)
    low, high = made.mesh.vertices.min(axis=0), made.mesh.vertices.max(axis=0)
    assert made.kind == "person"
    assert low[2] == pytest.approx(0.0, abs=1e-5)
    toes = made.mesh.vertices[made.mesh.vertices[:, 2] < 0.03, 1]
    assert toes.min() < -0.12  # feet reach further to the front than to the back
    assert toes.min() < -toes.max()
    assert high[0] - low[0] < 0.8


def test_unknown_words_and_heights_are_refused_by_name():
    with pytest.raises(UsageError, match='A person has no hat "crown"; known: cap, beanie'):
        Person(hat="crown")
    with pytest.raises(UsageError, match=r"People are 1\.0 to 2\.0 m high, not 2\.4 m"):
        Person(height=2.4)


def test_a_library_grows_people_with_their_footprint_and_front(tmp_path):
    library = grow_library(tmp_path / "shelf", 12, LocalText(), groups=("people",))
    table = library.catalogue
    assert len(table) == 12
    assert set(table["group"].tolist()) == {"people"}
    assert table["front"] == pytest.approx(np.pi)
    heights = [person(number).mesh.vertices[:, 2].max() for number in range(12)]
    assert sorted(table["height"].tolist()) == pytest.approx(sorted(heights), abs=2e-3)
    area = shapely.area(np.asarray(table["footprint"].tolist(), object))
    assert ((area > 0.05) & (area < 0.6)).all()
    assert len(set(table["description"].tolist())) == 12


@pytest.mark.parametrize("detail", [2, 3])
@pytest.mark.parametrize(("gear", "pose"), [("wheelchair", sit()), ("pram", push(0.1))])
def test_gear_is_of_closed_solids_and_stands_on_the_ground(gear, pose, detail):
    made = figure(replace(PLAIN, gear=gear), detail=detail)
    part, count = solids_of(made)
    assert not open_groups(made.mesh.faces, part, len(made.mesh.vertices), count).any()
    assert (volumes_by_group(made.mesh.vertices, made.mesh.faces, part, count) > 0).all()
    own = posed(made, pose).vertices[made.parts[made.parts_worn] :]
    assert own[:, 2].min() < 0.03  # its wheels
    assert own[:, 2].max() < 1.2
