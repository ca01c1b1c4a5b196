"""What decides a build besides its inputs, and what of it a planner is told."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cityx.sources.intake import HowToRead

DEFAULT_FORMATS = ("blend", "glb")  # what needs no extra


@dataclass(frozen=True)
class PlannerChoice:
    """Who plays the roles of the agents.

    Attributes
    ----------
    planner
        "offline", or a language model; see `cityx.agents.models.spec.read_spec`.
    base_url
        Address of another server than the model's own, or "".
    record, replay
        File that the model's decisions are added to, or played from; "" for none.
    budget_tokens
        Tokens that models may be given and answer.
    export
        File of prompts for a model that is asked by hand, "" for none.
    shown
        What of the actions' records is planned by; see `cityx.agents.ablation`.
    """

    planner: str = "offline"
    base_url: str = ""
    record: str = ""
    replay: str = ""
    budget_tokens: int = 400_000
    export: str = ""
    shown: str = "DIL"


@dataclass(frozen=True)
class BuildOptions:
    """Everything that decides a build besides its inputs.

    Attributes
    ----------
    size
        (width, depth) of a window to cut out of the map, metres, or None for all of it. Without
        a map, the size of the town.
    at
        (latitude, longitude) of the window's centre, degrees; the site's centre when None. Where
        no input says where it lies, the place of their origin.
    window
        (x, y, width, depth), metres: the part of the plane of towns to build when no input gives a
        layout; x and y are its south-west corner.
    render
        Whether to make the three pictures.
    samples
        Cycles samples per pixel.
    picture
        (width, height) of the pictures, pixels.
    read
        What the user says of inputs that do not say it themselves; seed and place are those above.
    text
        The instruction, in words, or "".
    place
        Name or rectangle of a place whose map is fetched, or "".
    choice
        Who plans.
    settings, wishes
        Arguments of actions and actions of the user's own; see `cityx.agents.requests`.
    """

    seed: int = 0
    workers: int = 1
    lod: int = 2
    style: str = ""
    time: str | None = None
    weather: str | None = None
    size: tuple[float, float] | None = None
    at: tuple[float, float] | None = None
    window: tuple[float, float, float, float] | None = None
    formats: tuple[str, ...] = DEFAULT_FORMATS
    render: bool = True
    samples: int = 48
    picture: tuple[int, int] = (960, 540)
    text: str = ""
    place: str = ""
    read: HowToRead = field(default_factory=HowToRead)
    choice: PlannerChoice = field(default_factory=PlannerChoice)
    settings: tuple[str, ...] = ()
    wishes: tuple[str, ...] = ()


def slots_of(options: BuildOptions) -> dict[str, tuple[Any, ...]]:
    """Return what options ask for, by the keys of a brief; those left out are left out."""
    read = options.read
    size = options.size or (None, None)
    at = options.at or (None, None)
    heights = read.height_range or (None, None)
    found: dict[str, Any] = {
        "time": options.time,
        "weather": options.weather,
        "style": options.style or None,
        "workers": options.workers,
        "size.x": size[0],
        "size.y": size[1],
        "town.width": size[0],
        "town.depth": size[1],
        "at.latitude": at[0],
        "at.longitude": at[1],
        "read.legend": None if Path(read.legend).is_file() else read.legend or None,
        "read.confirm_legend": read.confirm_legend or None,
        "read.pixel": read.pixel,
        "read.fidelity": read.fidelity,
        "read.segment": False if read.segmenter == "none" else None,
        "read.lowest": heights[0],
        "read.highest": heights[1],
        "read.height_crs": read.height_crs or None,
    }
    if options.window:
        x, y, width, depth = options.window
        found |= {
            "town.x": x + width / 2, "town.y": y + depth / 2, "town.bounded": False,
            "town.width": width, "town.depth": depth,
        }  # fmt: skip
    return {key: (value,) for key, value in found.items() if value is not None}
