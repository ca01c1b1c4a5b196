"""Making datasets: what is killed goes on, and ends with the bytes of what nothing disturbed."""

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import boxworld
import pytest
from boxworld import HANDS, ORDER, Quiet, made, world

from cityx.dataset import making
from cityx.dataset.card import MADE
from cityx.dataset.classes import CLASS
from cityx.dataset.making import Hands
from cityx.dataset.manifest import DiskFull, Done, Manifest
from cityx.dataset.order import Faults, Order, differences, sources_of
from cityx.dataset.taking import Failed
from cityx.dataset.workers import Died, Pool
from cityx.dataset.writers.files import Written
from cityx.dataset.writers.format import Place
from cityx.errors import InputError, UsageError

SMALL = replace(ORDER, views=6, formats=("raw",), channels=("depth", "semantic"), lidar="")
TOLD = {"README.md", "runs.jsonl"}  # how fast it was made differs from run to run


def contents(folder):
    files = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    return {
        str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
        for p in files if p.name not in TOLD
    }  # fmt: skip


def card_of(folder):
    return (folder / "README.md").read_text().replace(folder.name, "NAME").split(MADE)[0]


def test_numbers_are_of_the_table():
    assert (CLASS["road"], CLASS["building"], CLASS["car"]) == (
        boxworld.ROAD, boxworld.BUILDING, boxworld.CAR,
    )  # fmt: skip


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "out"
    made(out)
    return out


def test_a_dataset_holds_every_shot_once_with_checksums(undisturbed):
    lines = [json.loads(line) for line in (undisturbed / "manifest.jsonl").read_text().splitlines()]
    assert [line["number"] for line in lines if "number" in line] == list(range(20))
    named = {file["path"]: file for line in lines for file in line["files"]}
    there = contents(undisturbed)
    assert set(named) == set(there) - {"manifest.jsonl", "dataset.json"}
    assert all(named[path]["sha256"] == there[path] for path in named)
    assert all(named[path]["size"] == (undisturbed / path).stat().st_size for path in named)
    assert not (undisturbed / ".work").exists()


def killed_at(out, delays, seed):
    """Kill runs until they are used up; returns how many shots were done at each kill."""
    command = [sys.executable, boxworld.__file__, str(out)]
    environment = {**os.environ, "BOXWORLD_PAUSE": "0.1"}
    counts = []
    for delay in delays:
        begun = 0
        with subprocess.Popen(command, env=environment, start_new_session=True) as process:
            # From the first file on, a moment that nobody chose.
            while process.poll() is None and not (begun or list(out.glob("raw/*/*.exr"))):
                time.sleep(0.01)
            begun = time.monotonic()
            time.sleep(delay)
            alone = random.Random(seed).random() < 0.5  # with its workers, or the parent alone
            if alone:
                process.kill()
            else:
                os.killpg(process.pid, signal.SIGKILL)
            assert process.wait() == -signal.SIGKILL
        manifest = Manifest(out / ".work" / "manifest.sqlite")
        counts.append(len(manifest.numbers()))
        manifest.close()
        seed += 1
    return counts


@pytest.mark.slow
def test_three_kills_leave_no_hole_and_no_duplicate(undisturbed, tmp_path):
    world(tmp_path)
    draw = random.Random(8)
    delays = [draw.uniform(0.05, 0.45) for _ in range(3)]
    counts = killed_at(tmp_path / "out", delays, seed=1)
    assert counts == sorted(counts)
    assert counts[-1] < 20
    summary = made(tmp_path / "out", workers=2)
    assert (summary.made, summary.total) == (20 - counts[-1], 20)
    assert contents(tmp_path / "out") == contents(undisturbed)
    assert card_of(tmp_path / "out") == card_of(undisturbed)


class Killed(BaseException):
    """Stands for the kill: nothing catches it."""


@pytest.mark.sweep(2)
@pytest.mark.parametrize("step", range(1, 12, 2))
def test_a_kill_while_formats_are_finished_changes_nothing(
    undisturbed, tmp_path, monkeypatch, step
):
    out = tmp_path / "out"
    count = 0
    plain = os.fsync

    def stopping(number):
        nonlocal count
        count += finishing
        if count == step:
            raise Killed
        plain(number)

    finishing = False
    finish = making._Run._finish

    def watched(self):
        nonlocal finishing
        finishing = True
        finish(self)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", stopping)
        patch.setattr(making._Run, "_finish", watched)
        with pytest.raises(Killed):
            made(out, workers=1)
    assert made(out).made == 0
    assert contents(out) == contents(undisturbed)


def test_any_number_of_workers_gives_the_same_bytes(tmp_path, undisturbed):
    made(tmp_path / "out", workers=3, renew=4)
    assert contents(tmp_path / "out") == contents(undisturbed)


@pytest.mark.slow
def test_a_cluster_gives_the_same_bytes(tmp_path, undisturbed):
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    command = (
        "import sys, boxworld; from pathlib import Path\n"
        "if __name__ == '__main__':\n    boxworld.made(sys.argv[1], cluster='local:2')\n"
    )
    script = tmp_path / "cluster.py"
    script.write_text(command)
    path = os.pathsep.join([str(Path(boxworld.__file__).parent), *sys.path])
    subprocess.run([sys.executable, script, tmp_path / "out"], check=True, timeout=300,
                   env={**os.environ, "PYTHONPATH": path})  # fmt: skip
    assert contents(tmp_path / "out") == contents(undisturbed)


def test_a_finished_dataset_is_checked(tmp_path):
    out = tmp_path / "out"
    made(out, SMALL)
    assert made(out, SMALL).faults == ()
    victim = next(out.glob("raw/*/*.exr"))
    victim.write_bytes(victim.read_bytes()[:-1] + b"x")
    (out / "index.html").unlink()
    assert made(out, SMALL).faults == (
        f"{victim.relative_to(out)} is not what was written.", "index.html is missing.",
    )  # fmt: skip


def test_another_order_is_refused_with_what_differs(tmp_path):
    out = tmp_path / "out"
    made(out, SMALL)
    before = contents(out)
    with pytest.raises(UsageError) as refused:
        made(out, replace(SMALL, views=7, channels=("depth",)))
    assert str(refused.value) == (
        f'{out} holds another dataset: order.channels is ["depth", "semantic"], ["depth"] is '
        "asked for; order.views is 6, 7 is asked for. Give another folder."
    )
    assert contents(out) == before


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    with pytest.raises(UsageError, match="is not empty and holds no dataset"):
        made(tmp_path / "out", SMALL)


def test_two_runs_do_not_meet(tmp_path):
    with making._alone(tmp_path), pytest.raises(UsageError, match="made by another process"):
        made(tmp_path, SMALL, sources=[world(tmp_path.parent / "elsewhere")])


# --- what goes wrong ------------------------------------------------------------------------------


def hands(shoot):
    return Hands(HANDS.open, HANDS.plan, HANDS.tell, shoot)


def shoot_badly(store, order, threads):
    """Fail at one shot, for good."""
    whole = HANDS.shoot(store, order, threads)

    def shoot(wanted):
        for item in wanted:
            if item.shot.name.endswith("0003_mono"):
                raise ValueError("this shot is cursed")
            yield from whole([item])

    return shoot


def test_a_shot_that_fails_is_named_and_the_others_are_taken(tmp_path):
    order = replace(SMALL, views=5)
    out = tmp_path / "out"
    summary = made(out, order, hands=hands(shoot_badly))
    assert summary.failed == {"boxes/drive_0000_0003_mono": "ValueError: this shot is cursed"}
    assert not (out / "manifest.jsonl").exists()
    assert "cursed" in (out / ".work" / "failed" / "3.txt").read_text()
    assert made(out, order).made == 1
    assert (out / "manifest.jsonl").exists()


def test_a_dataset_without_a_shot_says_so(tmp_path):
    summary = made(tmp_path / "out", replace(SMALL, views=5), hands=hands(shoot_badly),
                   skip_failed=True)  # fmt: skip
    assert len(summary.failed) == 1
    assert "1 shot could not be taken" in (tmp_path / "out" / "README.md").read_text()


def shoot_and_die(store, order, threads):
    """Die at one shot the first time, as when the system takes the memory back."""
    whole = HANDS.shoot(store, order, threads)

    def shoot(wanted):
        for item in wanted:
            mark = store.parent / "died"
            if item.shot.name.endswith("0002_mono") and not mark.exists():
                mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            yield from whole([item])

    return shoot


def test_a_worker_that_dies_is_replaced(tmp_path):
    summary = made(tmp_path / "out", SMALL, hands=hands(shoot_and_die), workers=2)
    assert (summary.made, summary.failed) == (6, {})


def die_at_three(job, chunk):
    for item in chunk:
        if item == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        yield item * job


def test_an_item_that_kills_every_worker_is_given_up():
    pool = Pool(die_at_three, 10, 2, renew=100)
    try:
        results = list(pool.run([[1, 2, 3, 4], [5, 6]]))
    finally:
        pool.close()
    assert sorted(r for r in results if not isinstance(r, Died)) == [10, 20, 40, 50, 60]
    (died,) = [r for r in results if isinstance(r, Died)]
    assert died == Died(3, "its worker ended by signal 9, 2 times")


def process_of(job, chunk):
    assert job is None
    for _ in chunk:
        yield os.getpid()


def test_workers_are_renewed():
    pool = Pool(process_of, None, 1, renew=4)
    try:
        numbers = list(pool.run([[0, 1]] * 6))
    finally:
        pool.close()
    assert [numbers.count(number) for number in dict.fromkeys(numbers)] == [4, 4, 4]


def shoot_until_full(store, order, threads):
    """Let the process write files of no more than so many bytes."""
    import resource

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    whole = HANDS.shoot(store, order, threads)

    def shoot(wanted):
        for item in wanted:
            if item.shot.frame == 3:
                resource.setrlimit(resource.RLIMIT_FSIZE, (2000, resource.RLIM_INFINITY))
            yield from whole([item])

    return shoot


def test_a_full_disk_ends_with_a_sentence_and_what_is_done(tmp_path):
    out = tmp_path / "out"
    order = replace(SMALL, views=5, formats=("webdataset",))
    with pytest.raises(DiskFull) as full:
        made(out, order, hands=hands(shoot_until_full))
    assert str(full.value) == (
        f"The disk is full. 3 shots are done and stay in {out}; the same command goes on where "
        "this one stopped."
    )
    assert full.value.exit_code == 3
    assert made(out, order).made == 2


def test_the_disk_budget_is_kept(tmp_path, undisturbed, monkeypatch):
    out = tmp_path / "out"
    size = sum(path.stat().st_size for path in undisturbed.rglob("*") if path.is_file())
    budget = size // 2
    monkeypatch.setattr(Order, "bytes_of_a_shot", lambda _: 1)  # an estimate that is far too low
    with pytest.raises(DiskFull, match=r"The budget of .* GB is used up\. [0-9]+ shots are done"):
        made(out, budget=budget)
    there = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    assert there < 1.1 * budget + 200_000  # the manifest and the panels of the page come on top
    made(out)
    assert contents(out) == contents(undisturbed)


def test_what_cannot_fit_is_refused_before_any_work(tmp_path):
    with pytest.raises(UsageError, match=r"about 0\.07\d* GB are needed and 0\.001 GB may be used"):
        made(tmp_path / "out", replace(SMALL, views=50, size=(400, 1333)), budget=10**6)
    assert not (tmp_path / "out").exists()


def no_view(*_):
    raise InputError("the plan street has no legal view here: 400 of 400 are underground.")


def test_a_plan_without_a_view_leaves_nothing_behind(tmp_path):
    blind = Hands(HANDS.open, no_view, HANDS.tell, HANDS.shoot)
    with pytest.raises(InputError, match="no legal view"):
        made(tmp_path / "out", SMALL, hands=blind)
    assert not (tmp_path / "out").exists()


# --- several cities -------------------------------------------------------------------------------


def test_several_cities_make_one_dataset(tmp_path):
    sources = [world(tmp_path, name) for name in ("first", "second")]
    made(tmp_path / "out", SMALL, sources=sources, workers=2)
    lines = [json.loads(x) for x in (tmp_path / "out" / "manifest.jsonl").read_text().splitlines()]
    shots = [(line["number"], line["city"]) for line in lines if "number" in line]
    assert shots == [(n, "first" if n < 6 else "second") for n in range(12)]


def test_words_name_cities(tmp_path):
    world(tmp_path, "a")
    world(tmp_path / "b", "a")
    (tmp_path / "map.osm").write_text("<osm/>")
    (tmp_path / "list.txt").write_text(f"{tmp_path / 'a'}\n# not this\n\n{tmp_path / 'map.osm'}\n")
    faults = Faults()
    found = sources_of([tmp_path / "b" / "a"], str(tmp_path / "list.txt"), faults)
    assert [(s.name, s.kind) for s in found] == [("a", "folder"), ("a_2", "folder"), ("map", "map")]
    found = sources_of([], "3-5,9", faults)
    assert [(s.name, s.seed) for s in found] == [
        ("town_000003", 3), ("town_000004", 4), ("town_000005", 5), ("town_000009", 9),
    ]  # fmt: skip
    assert not faults.found
    sources_of([tmp_path / "lost"], "", faults)
    assert str(faults.found[0]).startswith(f"{tmp_path / 'lost'} does not exist.")


def test_identities_tell_their_differences():
    assert differences({"a": {"b": 1}, "c": 2}, {"a": {"b": 2}, "c": 2}) == [
        "a.b is 1, 2 is asked for"
    ]


def test_the_manifest_forgets_nothing_that_is_noted(tmp_path):
    done = Done(Place(4, 2, "town"), "street_4", (Written("a.png", "00", 7),), {"coco": {"x": 1}},
                {"pixels": 3})  # fmt: skip
    manifest = Manifest(tmp_path / "manifest.sqlite")
    manifest.add(done)
    manifest.close()
    again = Manifest(tmp_path / "manifest.sqlite")
    assert (again.numbers(), again.size()) == ({4}, 7)
    (kept,) = again.parts("coco")()
    assert (kept.place, kept.part) == (Place(4, 2, "town"), {"x": 1})
    again.close()


def test_failures_can_be_told_apart_from_a_full_disk():
    assert not Failed(None, "no").full
    assert Order().views == 100
    assert Quiet().lines == []
