"""Build the tiles of a part of a map in several ways and tell what is equal, and what they take.

    python benchmarks/tiles.py MAP OUT --at LAT,LON [--across 3] [--size 500] [--lod 2] [--seed 0]
        [--kills 20]
    python benchmarks/tiles.py --plane N OUT [--size 500] [--lod 2] [--seed 0] [--around 1]
    python benchmarks/tiles.py MAP OUT --random N [--size 500] [--lod 2] [--seed 0] [--around 1]

The tiles are built by one worker; then one after the other by three workers of dask, all of
which are killed with the scheduler and the client after some tiles, and by the same command again.
Both give the same files or the difference is told. Then one city of all the tiles and their margin
is built, and what each tile owns of it is compared with the tile.

With --kills that is left out. The tiles are built by two workers, then again while at so many
random moments a process of the run is killed: client, worker or all of them; every other time the
workers are those of a scheduler of dask, and that too may be what is killed. Then a fragment is
broken, files may not grow beyond a limit, a worker lacks a library.

With --plane N tiles of the plane at random, their indices up to 10^8, or with --random N of a map,
are built one after the other by one worker, and then again in other ways, each of which is compared
with the first: each alone in a process of its own, in the opposite order; by three workers in an
order by chance, client and workers killed (-9) when a third of the tiles is done and again when two
thirds are, and resumed; --around of them with the eight about each.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from cityx_bench.windows import compared, table

from cityx.city.store import read_city
from cityx.sources.osm import city_of, coverage_of
from cityx.sources.osm.reader import read_elements
from cityx.tiles.actions import built
from cityx.tiles.content import MOST
from cityx.tiles.grid import Tile, in_order, tile_at
from cityx.tiles.order import Order, read_order
from cityx.tiles.ownership import owned
from cityx.tiles.plane import FARTHEST, plane_order
from cityx.tiles.planning import order_of
from cityx.tiles.run import RUNS, TILES, around, build_tiles, prepared, records

ADDRESS = "tcp://127.0.0.1:18786"
LATER_S = 6.0  # after a tile is done: the next ones are built or written then


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("map", type=Path, nargs="?")
    parser.add_argument("out", type=Path)
    parser.add_argument("--at", help="LAT,LON of the middle tile.")
    parser.add_argument("--plane", type=int, help="So many tiles of the plane instead of a map.")
    parser.add_argument("--random", type=int, help="So many tiles of the map, by chance.")
    parser.add_argument("--around", type=int, default=1, help="Of them in a square of nine.")
    parser.add_argument("--across", type=int, default=3, help="Tiles of a side.")
    parser.add_argument("--size", type=float, default=500.0)
    parser.add_argument("--lod", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kills", type=int, default=0, help="How often a run is killed.")
    options = parser.parse_args()
    if options.plane or options.random:
        if options.random and not options.map:
            parser.error("--random needs a MAP")
        _scattered(options)
        return
    if not (options.map and options.at):
        parser.error("a MAP needs --at; --plane takes none")
    if options.kills:
        _hurt(options)
        return
    one, other = options.out / "one", options.out / "killed"
    _built(options, one, ["--workers", "1"])
    _killed(options, other)
    _built(options, other, ["--cluster", "local:3"])
    _same(one, other)
    _taken(one)
    print(table({"one city": _against_one_city(one, options.map)}))


def _scattered(options: argparse.Namespace) -> None:
    """Build random tiles in several ways and tell what is equal, and what they take."""
    draw = random.Random(options.seed)
    one, other, killed, near = (options.out / name for name in ("one", "alone", "killed", "near"))
    if options.plane:
        order = plane_order(seed=options.seed, lod=options.lod, size=options.size)
        # As many digits are drawn as places: some tiles lie near the origin, some at the farthest.
        tiles = [
            Tile(*(draw.choice((-1, 1)) * int(FARTHEST ** draw.random()) for _ in range(2)))
            for _ in range(options.plane - 1)
        ] + [Tile(FARTHEST - 1, -FARTHEST)]
        every = None
        for folder in (one, other, killed, near):
            prepared(order, None, folder, print)
    else:
        order, source = order_of(
            [options.map], seed=options.seed, lod=options.lod, size=options.size
        )
        every = prepared(order, source, one, print)
        tiles = draw.sample(every, options.random)
        for folder in (other, killed, near):
            _split_like(one, folder)
    build_tiles(one, order, tiles, say=print)
    _one_by_one(order, tiles, other)
    shuffled = draw.sample(tiles, len(tiles))
    for done in (len(tiles) // 3, 2 * len(tiles) // 3, len(tiles)):
        run = multiprocessing.get_context("spawn").Process(
            target=_in_a_group, args=(killed, order, shuffled)
        )
        run.start()
        while run.is_alive() and (len(records(killed)) < done or done == len(tiles)):
            time.sleep(0.1)
        while run.is_alive() and run.pid is not None and os.getpgid(run.pid) != run.pid:
            time.sleep(0.1)  # it is still being loaded
        if run.is_alive() and run.pid is not None:
            os.killpg(run.pid, signal.SIGKILL)
        run.join()
        halves = len([*(killed / TILES).glob(".*")])
        print(f"{len(records(killed))} tiles done by three workers, {halves} half written")
    for tile in draw.sample(tiles, min(options.around, len(tiles))):
        square = [each for each in (tile, *tile.around)
                  if (order.plane is None or max(map(abs, (each.column, each.row))) <= FARTHEST)
                  and (every is None or each in every)]  # fmt: skip
        build_tiles(near, order, in_order(square), say=print)
    print("each alone, in a process of its own, backwards:")
    _same(one, other)
    print("by three workers, in an order by chance, killed twice:")
    _same(one, killed)
    print("among their neighbours, 3 x 3:")
    _same(one, near, both=True)
    _taken(one)
    counts = [record["counts"] for record in records(one).values()]
    print({name: sum(count[name] for count in counts) for name in counts[0]})


def _split_like(one: Path, other: Path) -> None:
    """Give a folder the fragments of another, so that the map is split once."""
    other.mkdir(parents=True)
    for name in ("fragments", "tiles.json"):
        copy = shutil.copytree if (one / name).is_dir() else shutil.copy2
        copy(one / name, other / name)


def _one_by_one(order: Order, tiles: list[Tile], folder: Path) -> None:
    """Build each tile by a command of its own, the last one first."""
    for tile in reversed(tiles):
        x, y = ((index + 0.5) * order.size for index in (tile.column, tile.row))
        words = [sys.executable, "-m", "cityx.cli", "tiles", "get", str(folder), f"{x:.0f},{y:.0f}"]
        subprocess.run(words, check=True)


def _in_a_group(folder: Path, order: Order, tiles: list[Tile]) -> None:
    """Build tiles by three workers, in a group of processes that can be killed together."""
    os.setsid()
    build_tiles(folder, order, tiles, workers=3, say=print)


def _command(options: argparse.Namespace, out: Path, more: list[str]) -> list[str]:
    """Return the command for the tiles about the middle one."""
    from cityx.sources.osm import site_of

    frame, _ = site_of(read_elements(options.map), str(options.map))
    latitude, longitude = map(float, options.at.split(","))
    x, y = frame.to_local([[longitude, latitude]])[0].tolist()
    west, south, _, _ = tile_at(x, y, options.size).box(options.size)
    side = (options.across - 1) * options.size + 2.0
    middle = f"--at={west + options.size / 2:.0f},{south + options.size / 2:.0f}"
    return [
        sys.executable, "-m", "cityx.cli", "tiles", "build", str(options.map), "-o", str(out),
        "--size", f"{options.size:g}", "--lod", str(options.lod), "--seed", str(options.seed),
        middle, "--area", f"{side:g}x{side:g}", *more,
    ]  # fmt: skip


def _extending(options: argparse.Namespace, out: Path) -> list[str]:
    """Return the command for the same tiles of a map that is split already."""
    words = _command(options, out, [])
    area = words.index("--area")
    return [*words[:4], "extend", str(out), words[area - 1], *words[area : area + 2]]


def _built(options: argparse.Namespace, out: Path, more: list[str]) -> None:
    began = time.monotonic()
    subprocess.run(_command(options, out, more), check=True)
    print(f"{out.name}: {time.monotonic() - began:.0f} s by the clock")


def _killed(options: argparse.Namespace, out: Path) -> None:
    """Begin to build and kill client, scheduler and workers when two tiles are done."""
    command = _command(options, out, ["--cluster", "local:3"])
    run = subprocess.Popen(command, start_new_session=True)
    while run.poll() is None and len(records(out)) < 2:
        time.sleep(0.2)
    os.killpg(run.pid, signal.SIGKILL)
    run.wait()
    halves = len([*(out / TILES).glob(".*")])
    print(f"killed with {len(records(out))} tiles done, {halves} half written")


def _hurt(options: argparse.Namespace) -> None:
    """Kill a run again and again, and let tiles fail for other reasons; tell what comes of it."""
    whole, hurt = options.out / "whole", options.out / "hurt"
    _built(options, whole, ["--workers", "2"])
    # The map is split once; what is killed are the workers and who gives them work.
    _split_like(whole, hurt)
    draw = random.Random(options.seed)
    command = _extending(options, hurt)
    for number in range(options.kills):
        dask = _dask() if number % 2 else None
        asked = ["--workers", "2"] if dask is None else ["--cluster", ADDRESS]
        run = _started([*command, *asked])
        first, more = len(records(hurt)), draw.randint(0, 2)
        wait = draw.uniform(0.0, LATER_S) if more else 0.0
        while run.poll() is None and not _begun(hurt, first, more):
            time.sleep(0.02)
        with suppress(subprocess.TimeoutExpired):
            run.wait(wait)
        whom = draw.choice(("all", "client", "worker", *(["scheduler"] if dask else [])))
        _kill(run, dask, whom, draw)
        ended = run.wait(600)
        for one in dask or ():
            _end(one)
        halves = len([*(hurt / TILES).glob(".*")])
        of = " of dask" if dask else ""
        print(f"kill {number + 1}: {whom}{of}, exit {ended}, {len(records(hurt))} tiles done, "
              f"{halves} half written", flush=True)  # fmt: skip
        if len(records(hurt)) == len(records(whole)):
            every = sorted(tile.name for tile in records(whole))
            for name in draw.sample(every, len(every) * 3 // 4):
                shutil.rmtree(hurt / TILES / name)
    _built(options, hurt, ["--workers", "2"])
    _same(whole, hurt)
    for name in ("index.json", "tileset.json"):
        print(f"{name} equal: {(whole / name).read_bytes() == (hurt / name).read_bytes()}")
    print(f"left half written: {len([*(hurt / TILES).glob('.*')])}")
    _fail(options, hurt)
    _built(options, hurt, [])
    _same(whole, hurt)


def _begun(folder: Path, first: int, more: int) -> bool:
    """Return whether so many more tiles are done than at first; for none, if one is written."""
    if more:
        return len(records(folder)) >= first + more
    return any((folder / TILES).glob(".*"))


def _started(command: list[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)  # fmt: skip


def _dask() -> tuple[subprocess.Popen[bytes], subprocess.Popen[bytes]]:
    """Start a scheduler of dask, and two workers that are started again when they are lost."""
    host, port = ADDRESS.removeprefix("tcp://").split(":")
    dask = [sys.executable, "-m", "dask"]
    scheduler = _started([*dask, "scheduler", "--host", host, "--port", port, "--no-dashboard"])
    workers = _started([*dask, "worker", ADDRESS, "--nworkers", "2", "--nthreads", "1",
                        "--no-dashboard"])  # fmt: skip
    return scheduler, workers


def _end(run: subprocess.Popen[bytes]) -> None:
    with suppress(ProcessLookupError):
        os.killpg(run.pid, signal.SIGKILL)
    run.wait()


def _kill(
    run: subprocess.Popen[bytes], dask: tuple[subprocess.Popen[bytes], ...] | None, whom: str,
    draw: random.Random,
) -> None:  # fmt: skip
    """Kill a run, or one process of it, so that it cannot say a word."""
    if run.poll() is not None:
        return
    if whom == "worker":
        parent = run.pid if dask is None else dask[1].pid
        listed = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
        with suppress(ProcessLookupError, IndexError):
            os.kill(int(draw.choice(listed)), signal.SIGKILL)
        return
    if whom == "scheduler" and dask is not None:
        dask[0].kill()
        return
    if whom == "client":
        run.kill()
        run.wait()
        time.sleep(1.0)  # its workers see that it is gone
    for one in (run, *(dask or ())):
        _end(one)


def _fail(options: argparse.Namespace, folder: Path) -> None:
    """Build with a broken fragment, with files that may not grow, without a library."""
    tiles = [tile.name for tile in records(folder)]
    broken = folder / "fragments" / f"{tiles[0]}.npz"
    kept = broken.read_bytes()
    command = _extending(options, folder)

    def tell(said: str, **how: Any) -> None:
        done = subprocess.run(command, capture_output=True, text=True, check=False, **how)
        print(f"{said}: exit {done.returncode}, {len(records(folder))} of {len(tiles)} tiles")
        print("   " + "\n   ".join((done.stdout + done.stderr).strip().splitlines()[-4:]))

    broken.write_bytes(kept[: len(kept) // 2])
    for name in tiles[:2]:
        shutil.rmtree(folder / TILES / name)
    tell("a broken fragment")
    broken.write_bytes(kept)
    sizes = [path.stat().st_size for path in (folder / TILES / tiles[1]).rglob("*.*")]
    most = max(sizes) // 2
    shutil.rmtree(folder / TILES / tiles[1])
    tell(f"files of {most:,} bytes at most",
         preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))  # fmt: skip
    with tempfile.TemporaryDirectory() as place:
        (Path(place) / "meshopt.py").write_text("raise ImportError('not installed')\n")
        paths = os.pathsep.join([place, os.environ.get("PYTHONPATH", "")])
        shutil.rmtree(folder / TILES / tiles[0], ignore_errors=True)
        tell("a worker without the extra view", env={**os.environ, "PYTHONPATH": paths})


def _same(one: Path, other: Path, *, both: bool = False) -> None:
    """Compare the files of tiles, of all or of those that two folders both have."""
    ours, theirs = records(one), records(other)
    tiles = {*ours} & {*theirs} if both else {*ours, *theirs}
    unequal = [
        f"{tile.name}/{name}" for tile in sorted(tiles)
        for name in {*ours[tile]["files"], *theirs[tile]["files"]}
        if ours[tile]["files"].get(name) != theirs[tile]["files"].get(name)
    ]  # fmt: skip
    files = sum(len(ours[tile]["files"]) for tile in tiles)
    print(f"{len(tiles)} tiles, {files} files, {len(unequal)} differ: {unequal[:6]}")


def _taken(folder: Path) -> None:
    """Tell what each tile took, and whether memory and sizes are within bounds."""
    told = [json.loads(line) for line in (folder / RUNS).read_text().splitlines()]
    every: list[int] = []
    for one in told:
        tile = folder / TILES / one["tile"]
        sizes = [path.stat().st_size for path in tile.rglob("*.glb")]
        every += sizes
        whole = sum(path.stat().st_size for path in tile.rglob("*") if path.is_file())
        print(
            f"{one['tile']:>8}  {one['cpu_s']:5.1f} s  {one['rss_mb']:4d} MB, "
            f"{one['held_mb']:4d} after it  "
            f"{len(sizes)} GLBs, {sum(sizes) / 1e6:.1f} MB, largest {max(sizes) / 1e6:.2f}; "
            f"all {whole / 1e6:.1f} MB"
        )
    print(f"GLBs: {len(every)}, largest {max(every):,} bytes, "
          f"{sum(size > MOST for size in every)} over {MOST:,}")  # fmt: skip
    held = [one["held_mb"] for one in told]
    first = held[min(3, len(held) - 1)]
    print(f"memory: {max(one['rss_mb'] for one in told)} MB at most; held after the 4th tile "
          f"{first} MB, after the last {held[-1]} MB, {held[-1] / first:.2f} times")  # fmt: skip


def _against_one_city(folder: Path, source: Path) -> dict[str, tuple[int, int]]:
    """Count what tiles have as one city of all of them has it, by kind."""
    order, _ = read_order(folder)
    tiles = list(records(folder))
    box = around(order, tiles)
    osm = read_elements(source)
    coverage = coverage_of(osm, order.frame, around(order, read_order(folder)[1]))
    whole = city_of(
        osm, str(source), seed=order.seed, frame=order.frame, box=box, coverage=coverage
    )
    done = whole.stages_done | {"terrain"}
    whole = built(replace(whole, lod=order.lod, stages_done=done), order.items)
    equal, every = Counter[str](), Counter[str]()
    for tile in tiles:
        inner = tile.box(order.size)
        city = read_city(folder / TILES / tile.name / "city")
        for kind, (same, total) in compared(owned(whole, inner), city, inner).items():
            equal[kind] += same
            every[kind] += total
    return {kind: (equal[kind], every[kind]) for kind in sorted(every)}


if __name__ == "__main__":
    main()
