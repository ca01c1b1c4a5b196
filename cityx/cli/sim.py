"""The command `cityx sim`; heavy modules are imported when it runs."""
# Annotations stay values here: typer reads them at every start.

import resource
import signal
from pathlib import Path
from typing import Annotated, Any

import typer

from cityx.errors import MissingExtra, UsageError


def sim(
    place: Annotated[
        Path,
        typer.Argument(metavar="PLACE", help="Folder of a built city or of tiles, or a map file."),
    ],
    at: Annotated[
        str, typer.Option(help="Of tiles the place to be in: LAT,LON or X,Y in metres.")
    ] = "",
    to: Annotated[
        str, typer.Option(help="Of tiles: drive from --at to this place, over as many as it takes.")
    ] = "",
    area: Annotated[str, typer.Option(help="Of tiles, metres about it, WxH.")] = "1000x1000",
    task: Annotated[
        str, typer.Option(help="drive, deliver, walk, fly, explore or contact.")
    ] = "drive",
    fleet: Annotated[
        str, typer.Option(help="Many agents at once: car=2,bus=1,bicycle=2,robot=3,drone=1.")
    ] = "",
    episodes: Annotated[int, typer.Option(min=1, max=100_000, help="Routes that are driven.")] = 5,
    seed: Annotated[int, typer.Option(help="Of the first episode.")] = 0,
    vehicle: Annotated[
        str | None,
        typer.Option(
            help="small_car, car, van, lorry, bus or bicycle; of walks robot, person or wheelchair."
        ),
    ] = None,
    density: Annotated[
        float | None, typer.Option(help="Vehicles on a kilometre of lane; else 6.")
    ] = None,
    people: Annotated[
        int | None, typer.Option(help="On foot about the agent, where tasks have people.")
    ] = None,
    robot: Annotated[
        Path | None, typer.Option(help="MJCF file of the robot of contact; else CityX's own.")
    ] = None,
    goal_m: Annotated[
        float | None, typer.Option(help="Metres of a route; else 120, or 150.")
    ] = None,
    record: Annotated[
        Path | None, typer.Option(help="File (.npz) that takes the actions and digests.")
    ] = None,
    replay: Annotated[
        Path | None, typer.Option(help="Drive a recording again and compare each digest.")
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option(help="Folder that takes an episode of --replay as a city and a plan."),
    ] = None,
    episode: Annotated[int, typer.Option(min=1, help="Number of it in the recording.")] = 1,
    picture: Annotated[
        Path | None, typer.Option(help="Film (.gif) of the vehicle from above, or a strip (.png).")
    ] = None,
    camera: Annotated[
        bool, typer.Option("--camera", help="The picture is what the agent's camera sees.")
    ] = False,
    keyboard: Annotated[
        bool, typer.Option("--keyboard", help="Drive by the keys W A S D of this terminal.")
    ] = False,
    view: Annotated[
        bool, typer.Option("--view", help="Show it live in the browser, beside the city.")
    ] = False,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Of the page that --view shows; 0 for any.")
    ] = 0,
    browser: Annotated[bool, typer.Option(help="With --view, open the page.")] = True,
    serve: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Let other processes step environments of PLACE, at tcp://127.0.0.1:PORT or "
            "ipc://FILE.",
        ),
    ] = None,
    any_interface: Annotated[
        bool,
        typer.Option("--any-interface", help="With --serve, other machines may reach it."),
    ] = False,
) -> None:
    """Run episodes of a task in a city by rule and say what happened."""
    if to:
        unused = {
            "--people": people, "--goal-m": goal_m, "--fleet": fleet, "--robot": robot,
            "--record": record, "--replay": replay, "--export": export, "--picture": picture,
            "--camera": camera, "--keyboard": keyboard, "--view": view, "--serve": serve,
        }  # fmt: skip
        if named := [flag for flag, value in unused.items() if value]:
            raise UsageError(f"--to drives by rule among vehicles alone; leave out {named[0]}.")
        if task != "drive":
            raise UsageError(f"--to drives; leave out --task {task}.")
        _journey(place, at, to, seed, {"vehicle": vehicle, "density": density})
        return
    if at:
        from cityx.cli.tiles import size_of
        from cityx.tiles.joining import joined_folder

        place = joined_folder(place, at, size_of(area))
    given = {"vehicle": vehicle, "density": density, "people": people, "goal_m": goal_m,
             "robot": None if robot is None else str(robot)}  # fmt: skip
    options = {key: value for key, value in given.items() if value is not None}
    if serve is not None:
        unused = {"--replay": replay, "--record": record, "--picture": picture, "--view": view}
        for flag, value in unused.items():
            if value:
                raise UsageError(f"--serve runs no episodes of its own; leave out {flag}.")
        _served(place, options, serve, anywhere=any_interface)
        return
    if any_interface:
        raise UsageError("--any-interface says where --serve can be reached; give --serve too.")
    if replay is not None:
        if export is not None:
            _exported(replay, place, episode, export)
            return
        from cityx.sim.record import read_recording
        from cityx.sim.record import replay as drive_again

        steps = drive_again(read_recording(replay), place)
        typer.echo(f"{steps} steps again, every digest the same")
        return
    if export is not None:
        raise UsageError("--export takes an episode of a recording; give --replay FILE as well.")
    if view and (record is not None or picture is not None):
        raise UsageError("--view shows a run and keeps none; leave out --record and --picture.")
    if keyboard and (view or fleet):
        raise UsageError("--keyboard drives one agent in the terminal; leave out --view, --fleet.")
    if picture is not None and picture.suffix not in (".gif", ".png"):
        raise UsageError(f"--picture {picture} is no picture; its name ends in .gif or .png.")
    if camera and picture is None:
        raise UsageError("--camera says what --picture shows; give --picture FILE as well.")
    if fleet:
        _fleet(place, fleet, options, seed, picture)
        return
    from cityx.sim.drives import certificate_lines, driven, walk_lines
    from cityx.sim.places import scenery_of, walks_of, world_of
    from cityx.sim.tasks import CONTACT, DRIVE, task_of

    name = task_of(task).name
    if name == CONTACT:
        scenery_of(place, world_of(place))  # is kept, for who meets things
    found: Any = walks_of(place) if name != DRIVE or people else world_of(place)
    lines = certificate_lines(world_of(found)) if name == DRIVE else walk_lines(found[1])
    for line in lines:
        typer.echo(line)
    if view:
        _shown(place, found, name, options, episodes, seed, port=port, browser=browser)
        return
    kept: dict[str, Any] = {
        "task": name, "record": record, "film": picture,
        "scenery": scenery_of(place, world_of(found)) if camera else None,
    }  # fmt: skip
    if keyboard:
        _by_hand(found, options, episodes, seed, kept)
        return
    trips = driven(found, options, episodes, seed, say=typer.echo, **kept)
    typer.echo(
        f"{trips.ends.get('goal', 0)} of {trips.count} reached their goal, {trips.metres:.0f} m "
        f"in {trips.seconds:.0f} s"
    )
    for path in (record, picture):
        if path is not None:
            typer.echo(str(path))


def _by_hand(
    place: Any, options: dict[str, Any], episodes: int, seed: int, kept: dict[str, Any]
) -> None:
    """Let whoever sits at the terminal drive, and say at the end what happened."""
    from cityx.sim.drives import driven
    from cityx.sim.keyboard import Hand, Keyboard

    told: list[str] = []
    with Keyboard().listening() as keys:
        hand = Hand(keys, lambda text: typer.echo(text, nl=False))
        try:
            driven(place, options, episodes, seed, say=told.append, who=hand, **kept)
        except KeyboardInterrupt:
            told.append("ended by hand")
    for line in told:
        typer.echo(line)


def _fleet(place: Path, bodies: str, options: dict[str, Any], seed: int, film: Path | None) -> None:
    """Run an episode of a fleet of mixed bodies, and say who arrived."""
    from cityx.sim.drives import fleet_driven

    counts: dict[str, int] = {}
    for part in bodies.split(","):
        name, _, number = part.strip().partition("=")
        if not number.isdigit():
            raise UsageError(
                f'--fleet has "{part}"; it takes numbers by name, such as car=2,bus=1.'
            )
        counts[name] = int(number)
    for flag in ("vehicle", "robot"):
        if flag in options:
            raise UsageError(f"--fleet says who is there; leave out --{flag}.")
    ends = fleet_driven(place, {"bodies": counts, **options}, seed, say=typer.echo, film=film)
    arrived = sum(number for (_, how), number in ends.items() if how == "goal")
    typer.echo(f"{arrived} of {sum(counts.values())} reached their goal")
    if film is not None:
        typer.echo(str(film))


def _journey(tiles: Path, at: str, to: str, seed: int, given: dict[str, Any]) -> None:
    """Drive from a place to another over tiles, and say what came of it."""
    from cityx.sim.options import DriveOptions, options_of
    from cityx.sim.tasks import DRIVE, task_of
    from cityx.tiles.journey import journey
    from cityx.tiles.order import read_order
    from cityx.tiles.region import place_of

    order, _ = read_order(tiles)
    ends = [place_of(order, text, option) for text, option in ((at, "--at"), (to, "--to"))]
    options = options_of(
        {key: value for key, value in given.items() if value is not None}, task_of(DRIVE).options
    )
    assert isinstance(options, DriveOptions)
    trip = journey(tiles, ends[0], ends[1], options=options, seed=seed, say=typer.echo)
    typer.echo(
        f"{trip.end}: {trip.metres:,.0f} m in {len(trip.track) * 0.1:.0f} s through "
        f"{len(trip.tiles)} tiles, digest {trip.digest}"
    )
    typer.echo(
        f"{len(trip.tiles) - 1} borders crossed; of {trip.shared:,} lanes on both sides "
        f"{trip.same:,} are the same line with the same id"
    )
    own, others = (resource.getrusage(who)
                   for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))  # fmt: skip
    typer.echo(
        f"{own.ru_utime + own.ru_stime:.0f} s of the processor and {own.ru_maxrss / 1024:.0f} MB "
        f"at most; {others.ru_utime + others.ru_stime:.0f} s and {others.ru_maxrss / 1024:.0f} MB "
        "in those that built tiles and worlds"
    )
    if trip.end != "goal":
        raise typer.Exit(1)


def _served(place: Path, options: dict[str, Any], address: str, *, anywhere: bool) -> None:
    """Answer other processes until the command is stopped."""
    try:
        from cityx.sim.bridge.addresses import checked_address
        from cityx.sim.bridge.server import Desk
        from cityx.sim.bridge.server import serve as answer
    except ImportError as error:
        raise MissingExtra(
            'The bridge needs ZeroMQ and MessagePack: install them with  pip install "cityx[sim]"'
        ) from error
    checked_address(address, anywhere=anywhere)
    from cityx.sim.places import store_of

    store_of(place)
    for one in (signal.SIGINT, signal.SIGTERM):  # also where the parent had them ignored
        signal.signal(one, signal.default_int_handler)
    answer(Desk(place, options), address, anywhere=anywhere, say=typer.echo)


def _exported(recording: Path, place: Path, episode: int, out: Path) -> None:
    """Write an episode of a recording as a city and a plan, and say what takes its pictures."""
    from cityx.sim.episodes import episode_of, write_episode
    from cityx.sim.record import read_recording

    found = episode_of(read_recording(recording), place, episode)
    plan = write_episode(found, place, out)
    typer.echo(f"episode {episode}, {len(found.time)} moments of {len(found.names)} movers")
    typer.echo(f"cityx dataset {out} --plan {plan} --rig surround --format nuscenes -o DATASET")


def _shown(
    place: Path, found: Any, task: str, options: dict[str, Any], episodes: int, seed: int, *,
    port: int, browser: bool,
) -> None:  # fmt: skip
    """Run episodes on the page of the city, until the command is stopped."""
    from cityx.sim.places import store_of
    from cityx.sim.tasks import engine_of
    from cityx.viewer.view import check_ready
    from cityx.viewer.view import view as view_city

    folder = store_of(place).parent
    check_ready(folder)
    from cityx.viewer.simulation import Simulation

    engine = engine_of(task, 1, 1, {"place": found, **options})
    with Simulation(engine, task, episodes=episodes, seed=seed, say=typer.echo) as simulation:
        view_city(folder, port=port, browser=browser, say=typer.echo, simulation=simulation)
