import json
import subprocess
import sys
from dataclasses import replace
from math import atan2, degrees, radians
from pathlib import Path

import numpy as np
import pytest
from conftest import box, quarter
from PIL import Image

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import Environment, Scene, concatenate, one_mesh
from cityx.city.camera import Camera
from cityx.city.store import write_city
from cityx.ids import id_text

pytestmark = pytest.mark.blender
ABOVE = Camera("above", (0.0, 0.0, 60.0), 0.0, radians(-90), radians(12), 64, 64)


@pytest.fixture(scope="module")
def held(small_city, tmp_path_factory):
    """The made-up quarter saved, reopened in another process and described."""
    folder = tmp_path_factory.mktemp("blend")
    write_city(small_city, folder / "city")
    street = Camera("street", (17.0, -8.0, 1.7), 0.05, 0.05, width=64, height=64)
    job = BlenderJob(
        folder / "city", folder / "city.blend", (RenderRequest(street, folder / "s.png", 4),)
    )
    result = run_worker(job, timeout_s=300)
    script = Path(__file__).with_name("inspect_blend.py")
    words = subprocess.run(
        [sys.executable, script, folder / "city.blend"], capture_output=True, text=True, check=True
    ).stdout
    record = json.loads(next(line for line in words.splitlines() if line.startswith("@{"))[1:])
    return record, result, folder


def test_every_building_is_found_again_by_its_id(held, small_city):
    record, _, _ = held
    ids = [id_text(i) for i in small_city.scene.meshes["buildings"].object_id.tolist()]
    assert record["ids"] == sorted(ids)
    assert record["names"] == sorted(f"building_{text}" for text in ids)
    assert record["properties"]["name"] == "Town hall"
    assert record["properties"]["source"].startswith("test/")


def test_every_row_is_an_instance(held, small_city):
    rows = {layer: table.count for layer, table in small_city.scene.instances.items()}
    assert held[0]["instances"] == rows


def test_meshes_are_valid_flat_and_carry_colour_and_metres(held):
    record, _, _ = held
    assert record["valid"]
    assert record["flat"]
    assert record["packed"]
    assert {"UVMap", "tint", "position"} <= set(record["attributes"])
    assert "bitumen" in record["materials"]
    assert {"Buildings", "Ground", "Windows", "Prototypes", "Cameras"} <= set(record["collections"])


def test_prototypes_are_shaded_round_but_for_their_creases(held):
    assert held[0]["round"]
    assert held[0]["creases"]  # pairs of whether an edge is steep and whether it shows
    assert all(steep == shown for steep, shown in held[0]["creases"])


def test_the_worker_reports_files_times_and_memory(held):
    _, result, folder = held
    assert result.files == (folder / "city.blend", folder / "s.png")
    assert {"setup", "save", "render street"} <= set(result.timings)
    assert result.peak_rss_mb > 50
    with Image.open(folder / "s.png") as picture:
        assert picture.size == (64, 64)
    assert not list(folder.glob(".*"))


def test_a_draft_is_there_first_and_changes_nothing(held, tmp_path):
    street = Camera("street", (17.0, -8.0, 1.7), 0.05, 0.05, width=64, height=64)
    seen = []

    def heard(_, text):
        if "a draft lies in" in text:
            seen.append(pixels(tmp_path / "s_draft.png").shape)
            seen.append((tmp_path / "s.png").exists())

    job = BlenderJob(
        held[2] / "city",
        None,
        (RenderRequest(street, tmp_path / "s.png", 4, draft=True),),
        gpu=False,
    )
    result = run_worker(job, timeout_s=300, progress=heard)
    assert seen == [(32, 32, 3), False]
    assert {"draft street", "render street"} <= set(result.timings)
    assert [path.name for path in tmp_path.iterdir()] == ["s.png"]
    assert (pixels(tmp_path / "s.png") == pixels(held[2] / "s.png")).all()


def materials_of(folder):
    """Save the city of a folder; return its materials as a process tells that opens the file."""
    run_worker(BlenderJob(folder / "city", folder / "again.blend"), timeout_s=300)
    script = Path(__file__).with_name("inspect_materials.py")
    words = subprocess.run(
        [sys.executable, script, folder / "again.blend"], capture_output=True, text=True, check=True
    ).stdout
    return json.loads(next(line for line in words.splitlines() if line.startswith("@{"))[1:])


def test_materials_that_were_kept_are_those_that_are_made(small_city, tmp_path, monkeypatch):
    monkeypatch.setenv("CITYX_CACHE", str(tmp_path / "cache"))
    write_city(small_city, tmp_path / "city")
    made = materials_of(tmp_path)
    (kept,) = (tmp_path / "cache").glob("materials-*/*")
    before = kept.stat().st_mtime_ns
    assert materials_of(tmp_path) == made
    assert kept.stat().st_mtime_ns == before
    kept.write_bytes(b"no file of Blender")
    assert materials_of(tmp_path) == made
    # What another city had is neither lost nor taken along.
    other = replace(small_city, scene=Scene({"ground": box_ground()}))
    write_city(other, tmp_path / "other" / "city")
    few = materials_of(tmp_path / "other")
    assert set(few["materials"]) == {"setts"}
    assert not any(image.startswith(("brick", "plaster")) for image in few["images"])
    before = kept.stat().st_mtime_ns
    assert materials_of(tmp_path) == made
    assert kept.stat().st_mtime_ns == before


def box_ground():
    return box(1, (0, 0, 0), (20, 20, 1), materials=("setts",))


def pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"), float)


def rendered(folder, city, environment, camera=ABOVE, **options):
    write_city(replace(city, environment=environment), folder / "city")
    job = BlenderJob(
        folder / "city", None, (RenderRequest(camera, folder / "p.png", 32),), **options
    )
    run_worker(job, timeout_s=300)
    return pixels(folder / "p.png").mean(axis=2)


def test_a_shadow_points_away_from_the_sun(tmp_path):
    plane = one_mesh(1, [(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)], [(0, 1, 2, 3)])
    pole = box(2, (-0.15, -0.15, 0.0), (0.15, 0.15, 4.0))
    city = replace(quarter(1), scene=Scene().with_mesh("ground", concatenate([plane, pole])))
    azimuth = 200.0
    sun = Environment(sun_elevation=radians(40), sun_azimuth=radians(azimuth))
    picture = rendered(tmp_path, city, sun)
    rows, columns = np.nonzero(picture < (picture.min() + np.median(picture)) / 2)
    toward = degrees(atan2(columns.mean() - 31.5, 31.5 - rows.mean()))
    assert abs((toward - (azimuth - 180.0) + 180) % 360 - 180) < 5.0


def test_an_instance_shows_its_own_tint_and_place(tmp_path):
    city = quarter(1)
    rows = city.scene.instances["windows"]
    red, blue = (1.0, 0.02, 0.02), (0.02, 0.02, 1.0)
    tile = replace(
        city.scene.prototypes[rows.prototype[0]],
        mesh=box(1, (-1, -1, 0), (1, 1, 1), materials=("plastic",)),
    )
    two = replace(
        rows,
        **{name: getattr(rows, name)[:2] for name in rows.__dataclass_fields__}
        | {
            "prototype": np.zeros(2, np.int32),
            "position": np.array([(-3.0, 0, 0), (3.0, 0, 0)]),
            "tint": np.array([red, blue], np.float32),
        },
    )
    city = replace(city, scene=Scene().with_instances("windows", [tile], two))
    write_city(city, tmp_path / "city")
    run_worker(BlenderJob(tmp_path / "city", None, (RenderRequest(ABOVE, tmp_path / "p.png", 16),)))
    picture = pixels(tmp_path / "p.png")
    per_metre = 32 / (60 * np.tan(radians(6)))
    left, right = (picture[32, round(32 + x * per_metre)] for x in (-3.0, 3.0))
    assert left[0] > left[2] + 50
    assert right[2] > right[0] + 50


def test_fog_hides_what_is_far(tmp_path):
    air = Environment(visibility=60.0, cloud_cover=1.0)  # as far as the camera is high
    assert np.std(rendered(tmp_path, quarter(1), air)) < 5.0  # of 255


def test_what_is_far_behind_a_pane_is_not_speckled_by_haze(tmp_path):
    square = np.array([(-90, -90, 0), (90, -90, 0), (90, 90, 0), (-90, 90, 0)], float)
    ground = one_mesh(1, square, [(0, 1, 2, 3)], materials=("bitumen",), tint=(0.05,) * 3)
    levels = [square + np.array([0.0, 0.0, 590.0 - n]) for n in range(4)]
    panes = [one_mesh(2, level, [(0, 1, 2, 3)], materials=("pane",)) for level in levels]
    city = replace(quarter(1), scene=Scene().with_mesh("ground", concatenate([ground, *panes])))
    air = Environment(visibility=13_000.0, cloud_cover=1.0)
    high = replace(ABOVE, position=(0.0, 0.0, 600.0))
    assert np.std(rendered(tmp_path, city, air, high)) < 2.0  # of 255


def test_a_picture_does_not_depend_on_those_beside_it_in_any_light(tmp_path):
    write_city(quarter(2), tmp_path / "city")
    night = Environment(sun_elevation=-0.3, lamps=1.0)
    places = ((2.0, 0.2), (9.0, -0.3), (20.0, -0.6))
    eyes = [Camera(f"eye {x}", (x, -9.0, 2.0), turn, 0.0, 1.2, 48, 32) for x, turn in places]
    wishes = [(0, None), (1, None), (2, None), (2, night), (1, night), (0, None)]

    def pictures(name, chosen):
        requests = [RenderRequest(eyes[eye], tmp_path / f"{name}_{k}.png", 4, light, draft=k == 1)
                    for k, (eye, light) in ((k, wishes[k]) for k in chosen)]  # fmt: skip
        result = run_worker(BlenderJob(tmp_path / "city", renders=tuple(requests)), timeout_s=300)
        assert not list(tmp_path.glob("*draft*"))
        return {k: Image.open(path).tobytes() for k, path in zip(chosen, result.files, strict=True)}

    forth, back = pictures("forth", range(6)), pictures("back", range(5, -1, -1))
    assert forth == back
    assert pictures("alone", [1]) == {1: forth[1]}
    assert len(set(forth.values())) == 5  # the first and the last show the same
