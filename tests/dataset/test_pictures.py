import json
import subprocess
import sys
from contextlib import closing
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from dataset_town import EYE, HOUSES, dataset_town
from PIL import Image

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import Environment
from cityx.city.store import read_view, write_city
from cityx.dataset import pictures as module
from cityx.dataset.pictures import QUALITIES, PictureFailed, chosen_quality, noise_of, pictures
from cityx.dataset.shots import Shot
from cityx.errors import EngineError, UsageError
from cityx.ids import id_text
from cityx.outputs.cryptomatte import coverage_of, filter_offsets
from cityx.system import blender_process

OpenEXR = pytest.importorskip("OpenEXR", reason="the extra `dataset` is not installed")
QUICK = replace(QUALITIES["draft"], samples=4, rays=2)
NIGHT = Environment(sun_elevation=-0.3, lamps=1.0, hour=22.0, exposure=3.0, night_lights=0.4)
WINTER = Environment(cloud_cover=1.0, snow=1.0, snowfall=2.0, visibility=900.0)
LIGHTS = (None, NIGHT, WINTER, Environment(rain=5.0, wetness=1.0, cloud_cover=1.0))
SHOTS = tuple(
    Shot(f"eye_{i}", replace(EYE, heading=EYE.heading + 0.4 * i), "eye", i, moment=2.0 * (i % 3),
         environment=LIGHTS[i % 4])
    for i in range(5)
)  # fmt: skip
CHANNELS = ("rgb", "diffuse", "ao", "glossy_direct", "glossy_indirect", "glossy_colour",
            "crypto_object", "crypto_material")  # fmt: skip


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    folder = tmp_path_factory.mktemp("town") / "city"
    write_city(dataset_town(), folder)
    return folder


# --- without Blender ------------------------------------------------------------------------------


def test_an_unknown_quality_is_named_with_all_other_faults():
    with pytest.raises(UsageError, match=r'no quality "papr".*"paper"[\s\S]*0 samples are not'):
        chosen_quality("papr", samples=0)
    assert chosen_quality("paper").size == (1920, 1080)
    assert chosen_quality("paper").samples == 10_000
    assert chosen_quality("draft", samples=3, denoise=False).samples == 3


def test_noise_is_the_relative_deviation_of_surfaces():
    rng = np.random.default_rng(1)
    clean = np.full((200, 200, 3), 0.4, np.float32)
    noisy = clean * (1 + 0.05 * rng.standard_normal((200, 200, 1))).astype(np.float32)
    noisy[:, :20] = 99.0  # sky
    noisy[50, 50:90] = 1000.0  # fireflies
    surface = np.ones((200, 200), bool)
    surface[:, :20] = False
    assert noise_of(noisy, clean, surface) == pytest.approx(0.05, rel=0.03)
    assert noise_of(noisy, clean, np.zeros_like(surface)) == 0.0


def scripted(monkeypatch, tmp_path, body):
    """Let the process be a few lines of Python that are run for each picture."""
    script = tmp_path / "worker.py"
    script.write_text(f"""import json, os, pathlib, sys
job = json.load(open(sys.argv[1]))
log = pathlib.Path({str(tmp_path)!r}) / 'log'
log.open('a').write('start ')
{body}
for request in job['renders']:
    path = pathlib.Path(request['path'])
    print('@cityx ' + json.dumps([0.5, 'rendering ' + path.stem]), flush=True)
    log.open('a').write(path.stem + ' ')
    tried = log.read_text().split().count(path.stem)
    if path.stem == 'eye_3' or (path.stem == 'eye_1' and tried == 1):
        os.abort()
    path.touch()
    print('@cityx ' + json.dumps({{'made': str(path), 'facts': {{}}}}), flush=True)
result = {{'files': [], 'timings': {{}}, 'peak_rss_mb': 1, 'device': 'CPU', 'objects': 1}}
json.dump(result | {{'blender': '4.5'}}, open(job['result'], 'w'))
""")
    start = blender_process.subprocess.Popen
    monkeypatch.setattr(
        blender_process.subprocess,
        "Popen",
        lambda command, **rest: start([command[0], str(script), command[-1]], **rest),
    )
    return tmp_path / "log"


def test_a_shot_that_ends_blender_is_tried_once_more_and_then_named(monkeypatch, tmp_path):
    log = scripted(monkeypatch, tmp_path, "")
    names = []
    with pytest.raises(PictureFailed, match=r"2 times at the shot eye_3: .*signal 6") as failed:  # noqa: PT012
        for shot, _, _ in module._rendered(tmp_path, SHOTS, ["rgb"], QUICK, tmp_path, 50, False):
            names.append(shot.name)
    assert failed.value.shot is SHOTS[3]
    assert names == ["eye_0", "eye_1", "eye_2"]
    assert log.read_text().split() == [
        "start", "eye_0", "eye_1", "start", "eye_1", "eye_2", "eye_3", "start", "eye_3",
    ]  # fmt: skip


def test_a_process_that_never_begins_is_tried_twice_and_not_for_each_shot(monkeypatch, tmp_path):
    log = scripted(monkeypatch, tmp_path, "sys.exit(7)")
    with pytest.raises(EngineError, match="ended with status 7"):
        list(module._rendered(tmp_path, SHOTS, ["rgb"], QUICK, tmp_path, 50, False))
    assert log.read_text().split() == ["start", "start"]


def test_processes_are_recycled(monkeypatch, tmp_path):
    log = scripted(monkeypatch, tmp_path, "")
    shots = SHOTS[:1] + SHOTS[2:3] + SHOTS[4:]
    assert len(list(module._rendered(tmp_path, shots, ["rgb"], QUICK, tmp_path, 2, False))) == 3
    assert log.read_text().split() == ["start", "eye_0", "eye_2", "start", "eye_4"]


def test_a_process_that_fails_after_its_last_picture_has_done_its_work(monkeypatch, tmp_path):
    log = scripted(monkeypatch, tmp_path, "import atexit; atexit.register(os._exit, 9)")
    made = module._rendered(tmp_path, SHOTS[:1], ["rgb"], QUICK, tmp_path, 50, False)
    assert [shot.name for shot, _, _ in made] == ["eye_0"]
    assert log.read_text().split() == ["start", "eye_0"]


def test_mattes_alone_need_no_blender(monkeypatch, store):
    monkeypatch.setattr(module, "work", None)
    (record,) = pictures(store, SHOTS[:1], ["crypto_object"], QUICK)
    assert list(record.channels) == ["crypto_object"]
    assert id_text(11) in record.facts["manifests"]["crypto_object"]


# --- with Blender ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def forwards(store):
    return {r.shot.name: r for r in pictures(store, SHOTS, CHANNELS, QUICK, gpu=False)}


@pytest.mark.blender
@pytest.mark.slow
def test_a_picture_depends_neither_on_those_before_it_nor_on_the_process(store, forwards):
    backwards = [*pictures(store, SHOTS[::-1], CHANNELS, QUICK, recycle=3, gpu=False)]
    assert len(backwards) == len(SHOTS)
    for record in backwards:
        first = forwards[record.shot.name]
        assert list(record.channels) == list(first.channels)
        for name, values in record.channels.items():
            assert np.array_equal(values, first.channels[name]), (record.shot.name, name)
        same = {k: v for k, v in record.facts.items() if k not in ("seconds", "memory_mb")}
        assert same == {k: first.facts[k] for k in same}


@pytest.mark.blender
@pytest.mark.slow
def test_channels_have_the_shapes_and_ranges_of_the_table(forwards):
    for record in forwards.values():
        size = (EYE.height, EYE.width)
        for name, values in record.channels.items():
            channel = module.CHANNELS[name]
            assert values.dtype == channel.dtype
            assert values.shape == (size if channel.depth == 1 else (*size, channel.depth))
        shown = record.channels
        assert np.isfinite(shown["rgb"]).all()
        assert shown["rgb"].min() >= 0
        assert 0 <= shown["ao"].min() <= shown["ao"].max() <= 1
        assert 0 <= shown["diffuse"].min() <= shown["diffuse"].max() <= 1.5
    assert {r.channels["picture"].tobytes() for r in forwards.values()}.__len__() == len(SHOTS)


@pytest.mark.blender
@pytest.mark.slow
def test_the_picture_is_the_exact_one_that_people_get(store, forwards, tmp_path):
    shot = SHOTS[0]
    wanted = module._request(shot, ["rgb"], QUICK, tmp_path)
    plain = replace(wanted, passes=(), exact=True)
    run_worker(BlenderJob(store, renders=(plain,), gpu=False), timeout_s=300)
    with Image.open(plain.path) as seen:
        assert np.array_equal(np.asarray(seen), forwards[shot.name].channels["picture"])


@pytest.mark.blender
@pytest.mark.slow
def test_noise_falls_with_samples_within_one_process(store, tmp_path):
    # A process that kept data from picture to picture once left later samples out in silence.
    requests = tuple(
        RenderRequest(EYE, tmp_path / f"{i}.png", samples, passes=("rgb",), threshold=0.0, seed=3)
        for i, samples in enumerate((4, 64, 4))
    )
    run_worker(BlenderJob(store, renders=requests, gpu=False), timeout_s=600)
    values, noise = zip(
        *(module._read(r.path.with_suffix(".exr"), r.path, ["rgb"], r.samples) for r in requests),
        strict=True,
    )
    assert [n["samples_used"] for n in noise] == [4, 64, 4]
    assert np.array_equal(values[0]["rgb"], values[2]["rgb"])
    # A quarter by the root of sixteen; of few samples the denoiser takes more away.
    assert 0.03 < noise[1]["noise"] / noise[0]["noise"] < 0.4


@pytest.mark.blender
@pytest.mark.slow
def test_without_the_denoiser_the_colour_is_that_of_the_samples(store):
    rough = replace(QUICK, denoise=False)
    (noisy,) = pictures(store, SHOTS[:1], ["rgb"], rough, gpu=False)
    (clean,) = pictures(store, SHOTS[:1], ["rgb"], QUICK, gpu=False)
    assert noisy.facts["noise"] == clean.facts["noise"]
    change = np.abs(noisy.channels["rgb"] - clean.channels["rgb"])
    assert np.median(change) > 0.2 * noisy.facts["noise"] * np.median(clean.channels["rgb"])


@pytest.fixture(scope="module")
def cycles(store, tmp_path_factory):
    """What Cycles says of ids, depth and matte; channels by name."""
    folder = tmp_path_factory.mktemp("cycles")
    camera = replace(EYE, width=120, height=80)
    (folder / "camera.json").write_text(json.dumps(asdict(camera)))
    script = Path(__file__).with_name("inspect_alignment.py")
    subprocess.run(
        [sys.executable, script, store, folder / "camera.json", folder / "out.exr", "2.0"],
        check=True, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    held = {}
    for name in ("out", "out_matte"):
        with OpenEXR.File(str(folder / f"{name}.exr"), separate_channels=True) as file:
            found = {k.removeprefix("ViewLayer."): c.pixels for k, c in file.channels().items()}
        held |= {k: v for k, v in found.items() if name == "out" or k.startswith("Crypto")}
    numbers = json.loads((folder / "out.json").read_text())
    return Shot("cycles", camera, "cycles", moment=2.0), held, numbers


def low_half(ids):
    """Return the lower 32 bits as Blender keeps them: signed, and as a float in passes."""
    return ids.astype(np.uint32).view(np.int32).astype(np.float32)


def edges(ids):
    """Return which pixels have a neighbour of another id."""
    found = np.zeros(ids.shape, bool)
    for axis in (0, 1):
        step = np.moveaxis(np.diff(ids, axis=axis) != 0, axis, 0)
        moved = np.moveaxis(found, axis, 0)
        moved[:-1] |= step
        moved[1:] |= step
    return found


@pytest.mark.blender
@pytest.mark.slow
def test_cycles_and_the_rays_of_the_truth_see_the_same_things_at_the_same_depth(store, cycles):
    from cityx.dataset.sight import sight
    from cityx.dataset.stage import stage_of

    shot, held, numbers = cycles
    stage = stage_of(read_view(store), shot.moment)
    seen = sight(stage, shot)
    size = (shot.camera.height, shot.camera.width)
    piece = np.where(seen.rows >= 0, stage.piece[seen.rows], 0).astype(np.uint64).reshape(size)
    table = np.zeros(len(numbers) + 1, np.uint64)
    for number, text in numbers.items():
        table[int(number)] = int(text, 16)
    own = low_half(table[held["object.X"].astype(int)])
    said = np.where(held["face.X"] != 0, held["face.X"], own)
    said = np.where(held["instance.X"] != 0, held["instance.X"], said)
    sky = held["Depth.Z"] > 1e9
    assert len(np.unique(piece)) > 12  # car, wheels, walker, windows, houses, streets
    away = ~edges(piece)
    same = np.isclose(low_half(piece), np.where(sky, 0, said), rtol=1e-6, atol=0)
    assert same[away].mean() >= 0.999
    depth = seen.hits.distance.reshape(size)
    assert np.abs(depth - held["Depth.Z"])[away & ~sky].max() < 0.01


@pytest.mark.blender
@pytest.mark.slow
def test_the_matte_covers_pixels_as_that_of_cycles_does(store, cycles):
    from cityx.dataset.mattes import mattes
    from cityx.dataset.stage import stage_of

    shot, held, _ = cycles
    stage = stage_of(read_view(store), shot.moment)
    layers, manifests = mattes(stage, shot, ["crypto_object"], filter_offsets(8))
    theirs = np.stack(
        [held[f"CryptoObject{i:02d}.{part}"] for i in range(3) for part in "rgba"], axis=-1
    )
    for number, _, _ in HOUSES[:2]:
        ours = coverage_of(layers["crypto_object"], id_text(number))
        wanted = coverage_of(theirs, f"building_{id_text(number)}")
        part = (wanted > 0.02) & (wanted < 0.98)
        assert part.sum() > 20
        # 256 samples leave a standard error of up to 0.03.
        assert np.abs(ours - wanted).max() < 0.1
        assert np.abs(ours - wanted)[part].mean() < 0.02
    assert id_text(13) in manifests["crypto_object"]  # windows are of their house
    assert id_text(21) not in manifests["crypto_object"]


@pytest.mark.blender
@pytest.mark.slow
def test_memory_stays_flat_over_sixty_pictures_of_one_process(store):
    shots = tuple(
        Shot(f"walk_{i:03d}", replace(EYE, heading=EYE.heading + 0.02 * i, width=24, height=16),
             "walk", i, moment=0.1 * i, environment=LIGHTS[i % 4])
        for i in range(64)
    )  # fmt: skip
    least = replace(QUICK, samples=1)
    with closing(pictures(store, shots, ["rgb", "ao"], least, recycle=64, gpu=False)) as made:
        held = [record.facts["memory_mb"] for record in made]
    assert len(held) == 64
    assert np.mean(held[-8:]) < 1.05 * np.mean(held[12:20])
