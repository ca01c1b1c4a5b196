"""The command `cityx sim`; heavy modules are imported when it runs."""
# Annotations stay values here: typer reads them at every start.

from pathlib import Path
from typing import Annotated

import typer

from cityx.errors import UsageError


def sim(
    place: Annotated[
        Path, typer.Argument(metavar="PLACE", help="Folder of a built city, or a map file.")
    ],
    episodes: Annotated[int, typer.Option(min=1, max=100_000, help="Routes that are driven.")] = 5,
    seed: Annotated[int, typer.Option(help="Of the first episode.")] = 0,
    vehicle: Annotated[str, typer.Option(help="small_car, car, van or lorry.")] = "car",
    density: Annotated[float, typer.Option(help="Vehicles on a kilometre of lane.")] = 6.0,
    goal_m: Annotated[float, typer.Option(help="Metres of a route.")] = 120.0,
    record: Annotated[
        Path | None, typer.Option(help="File (.npz) that takes the actions and digests.")
    ] = None,
    replay: Annotated[
        Path | None, typer.Option(help="Drive a recording again and compare each digest.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Film (.gif) of the vehicle from above, or a strip (.png).")
    ] = None,
) -> None:
    """Drive routes through a city by rule and say what happened."""
    from cityx.sim.places import world_of

    world = world_of(place)
    if replay is not None:
        from cityx.sim.record import read_recording
        from cityx.sim.record import replay as drive_again

        steps = drive_again(read_recording(replay), world)
        typer.echo(f"{steps} steps again, every digest the same")
        return
    if picture is not None and picture.suffix not in (".gif", ".png"):
        raise UsageError(f"--picture {picture} is no picture; its name ends in .gif or .png.")
    from cityx.sim.drives import certificate_lines, driven

    for line in certificate_lines(world):
        typer.echo(line)
    options = {"vehicle": vehicle, "density": density, "goal_m": goal_m}
    trips = driven(world, options, episodes, seed, say=typer.echo, record=record, film=picture)
    typer.echo(
        f"{trips.ends.get('goal', 0)} of {trips.count} reached their goal, {trips.metres:.0f} m "
        f"in {trips.seconds:.0f} s"
    )
    for path in (record, picture):
        if path is not None:
            typer.echo(str(path))
