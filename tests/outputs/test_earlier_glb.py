"""A file made from an earlier one has the bytes of one that is made anew."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from glb_scenes import box, small_city, view

from cityx.city import Scene, concatenate
from cityx.outputs import earlier_glb, gltf_mesh
from cityx.outputs.earlier_glb import read_earlier
from cityx.outputs.glb import MOST_OBJECTS, write_glb


def houses(*heights, tint=(0.5, 0.25, 0.1)):
    """Houses in a row; those of ten metres and more have a step on the roof."""
    own = []
    for number, height in enumerate(heights):
        house = box(100 + number, (20 * number, 0, 0), (10, 8, height), tint=tint)
        if height >= 10:
            top = box(100 + number, (20 * number + 2, 2, height), (3, 3, 2))
            step = concatenate([house, top])
            house = replace(
                step, object_id=house.object_id,
                vertex_start=step.vertex_start[[0, -1]], face_start=step.face_start[[0, -1]],
            )  # fmt: skip
        own.append(house)
    return concatenate(own)


def city(batch, **meshes):
    scene = small_city().scene
    for name, own in {"buildings": batch, **meshes}.items():
        scene = scene.with_mesh(name, own)
    return view(scene)


@pytest.fixture
def flattened(monkeypatch):
    """Counts the objects that are flattened or weighed."""
    seen = []
    flat, fast = earlier_glb.flat_mesh, earlier_glb.standing_fast
    monkeypatch.setattr(earlier_glb, "flat_mesh", lambda b, *a: seen.append(b.count) or flat(b, *a))
    monkeypatch.setattr(
        earlier_glb, "standing_fast", lambda n, b: seen.append(b.count) or fast(n, b)
    )
    return seen


CHANGES = {
    "taller": (6, 7, 9, 5, 8, 7), "a step more": (6, 7, 12, 5, 8, 7), "one gone": (6, 11, 5, 8, 7),
    "one more": (6, 7, 11, 5, 8, 7, 9), "the same": (6, 7, 11, 5, 8, 7),
}  # fmt: skip


@pytest.mark.parametrize("piece", [4, 7, 16, 16_384])
@pytest.mark.parametrize("change", CHANGES)
def test_a_file_from_an_earlier_one_is_the_same_as_one_made_anew(
    tmp_path, monkeypatch, flattened, change, piece
):
    monkeypatch.setattr(gltf_mesh, "PIECE", piece)
    before, after = city(houses(6, 7, 11, 5, 8, 7)), city(houses(*CHANGES[change]))
    write_glb(before, tmp_path / "before.glb")
    write_glb(after, tmp_path / "anew.glb")
    given = (before.scene.meshes, tmp_path / "before.glb")
    stats = write_glb(after, tmp_path / "from.glb", like=given)
    assert (tmp_path / "from.glb").read_bytes() == (tmp_path / "anew.glb").read_bytes()
    assert stats.size == (tmp_path / "from.glb").stat().st_size
    assert flattened, "nothing was taken from the file"
    if piece > 100 and change in ("taller", "a step more"):
        assert max(flattened) == 1  # of six houses and the ground


def test_a_colour_that_comes_or_goes_is_seen(tmp_path):
    white, red = (houses(5, 6, 7, tint=tint) for tint in ((1, 1, 1), (1, 0.2, 0.2)))
    mixed = concatenate([white.take([0, 1]), red.take([2])])
    states = [city(batch) for batch in (white, mixed, white)]
    for number, (before, after) in enumerate(pairwise(states)):
        paths = [tmp_path / f"{name}{number}.glb" for name in ("before", "anew", "from")]
        write_glb(before, paths[0])
        write_glb(after, paths[1])
        write_glb(after, paths[2], like=(before.scene.meshes, paths[0]))
        assert paths[1].read_bytes() == paths[2].read_bytes()


@pytest.mark.parametrize("fault", ["cut", "another program", "another city", "no file", "text"])
def test_a_file_that_is_not_as_it_was_written_is_not_used(tmp_path, fault):
    before, path = city(houses(6, 7, 11)), tmp_path / "before.glb"
    write_glb(before, path)
    meshes = before.scene.meshes
    assert set(read_earlier(path, meshes, MOST_OBJECTS)) == set(meshes)
    if fault == "cut":
        path.write_bytes(path.read_bytes()[:-4000])
    elif fault == "another program":
        path.write_bytes(path.read_bytes().replace(b'"generator":"CityX', b'"generator":"Other'))
    elif fault == "another city":
        meshes = city(houses(6, 7)).scene.meshes
    elif fault == "text":
        path.write_bytes(b"no model")
    else:
        path.unlink()
    assert read_earlier(path, meshes, MOST_OBJECTS) == {}
    after = city(houses(6, 7, 12))
    write_glb(after, tmp_path / "anew.glb")
    write_glb(after, tmp_path / "from.glb", like=(meshes, path))
    assert (tmp_path / "from.glb").read_bytes() == (tmp_path / "anew.glb").read_bytes()


def test_a_city_without_meshes_is_no_help(tmp_path):
    write_glb(view(Scene()), tmp_path / "empty.glb")
    assert read_earlier(tmp_path / "empty.glb", {}, MOST_OBJECTS) == {}


def test_numbers_that_are_broken_stay_as_they_are_made(tmp_path):
    batch = houses(6, 7, 11)
    points = batch.vertices.copy()
    points[3] = np.nan
    before, after = city(batch), city(replace(batch, vertices=points))
    write_glb(before, tmp_path / "before.glb")
    write_glb(after, tmp_path / "anew.glb")
    write_glb(after, tmp_path / "from.glb", like=(before.scene.meshes, tmp_path / "before.glb"))
    assert (tmp_path / "from.glb").read_bytes() == (tmp_path / "anew.glb").read_bytes()
