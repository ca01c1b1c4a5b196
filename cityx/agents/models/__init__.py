"""Language models in the roles of the agents; the library behind them is imported when one is."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.agents.models.budget import BudgetSpent, Ledger, Limits
from cityx.agents.models.spec import OFFLINE, REPLAY, ModelSpec, read_spec, require_library
from cityx.agents.pool import Pool
from cityx.agents.roles import Roles, offline_roles
from cityx.errors import UsageError
from cityx.protocol.encapsulation import Encapsulation

if TYPE_CHECKING:
    from cityx.agents.models.asking import Channel

__all__ = ["BudgetSpent", "Limits", "Recording", "check_choice", "roles_for"]


@dataclass(frozen=True)
class Recording:
    """Where decisions are kept and taken from.

    Attributes
    ----------
    record
        File that new decisions are added to, or None.
    replay
        File of decisions that are played instead of asking, or None.
    database
        Of the city, which keeps every decision; None outside of a run.
    """

    record: Path | None = None
    replay: Path | None = None
    database: sqlite3.Connection | None = field(default=None, compare=False)


def check_choice(spec: str, base_url: str = "", recording: Recording | None = None) -> None:
    """Refuse a planner that cannot be had, before anything is begun; nothing is contacted.

    Raises
    ------
    UsageError, InputError, MissingExtra
        If the words make no model, a key or a file is missing, or the library is.
    """
    recording = recording or Recording()
    if recording.record is not None and recording.replay is not None:
        raise UsageError("--record and --replay exclude each other.")
    if recording.replay is not None:
        from cityx.agents.models.recording import model_of, read_decisions

        require_library()
        model_of(read_decisions(recording.replay).values())
    elif spec == REPLAY:
        raise UsageError('Planner "replay" needs a recording: add --replay FILE.')
    elif spec != OFFLINE:
        read_spec(spec, base_url)
    elif base_url or recording.record is not None:
        raise UsageError(
            "--base-url and --record are for a language model; name one, such as --planner "
            "openai-chat:MODEL."
        )


def roles_for(
    spec: str,
    base_url: str,
    recording: Recording,
    records: Iterable[Encapsulation],
    *,
    pool: Pool | None = None,
    limits: Limits | None = None,
    alone: bool = False,
) -> Roles:
    """Return who plays the roles of a run.

    Parameters
    ----------
    spec
        "offline", "openai:MODEL", "openai-chat:MODEL", "anthropic:MODEL", "ollama:MODEL"...
    base_url
        Address of another server, "" for the service's own.
    recording
        Where decisions are kept and taken from; with a replay, no model is asked.
    records
        Of the actions that may be planned.
    pool
        Messages of the run, where its spending is written down.
    limits
        What may be spent on models.
    alone
        Whether a model's failures are raised; otherwise the offline roles take over.

    Raises
    ------
    UsageError, InputError, MissingExtra
        As of `check_choice`.
    """
    check_choice(spec, base_url, recording)
    offline = offline_roles(records)
    if spec == OFFLINE and recording.replay is None:
        return offline
    channel = _channel(spec, base_url, recording, Ledger(limits or Limits(), pool), alone)
    return model_roles(channel, offline)


def model_roles(channel: Channel, offline: Roles) -> Roles:
    """Return the roles with a model in each; the offline ones stand behind them."""
    from cityx.agents.models.annotator import ModelAnnotator
    from cityx.agents.models.brief_maker import ModelBriefMaker
    from cityx.agents.models.evaluator import ModelEvaluator
    from cityx.agents.models.executor import ModelExecutor
    from cityx.agents.models.planner import ModelPlanner
    from cityx.agents.planning.planner import OfflinePlanner

    assert isinstance(offline.planner, OfflinePlanner)
    return Roles(
        ModelPlanner(channel, offline.planner),
        ModelBriefMaker(channel, offline.brief_maker),
        ModelExecutor(channel),
        ModelAnnotator(channel, offline.annotator),
        ModelEvaluator(channel, offline.evaluator),
        channel.notes,
        channel.close,
    )


def _channel(
    spec: str, base_url: str, recording: Recording, ledger: Ledger, alone: bool
) -> Channel:
    from cityx.agents.models.asking import Channel
    from cityx.agents.models.library import LibraryRespondent, make_model, silent_model
    from cityx.agents.models.recording import Decisions, read_decisions

    if recording.replay is not None:
        replay = read_decisions(recording.replay)
        decisions = Decisions(replay=replay)
        model = silent_model(list(replay.values()))
        return Channel(LibraryRespondent(model, ledger, decisions), alone=alone)
    chosen: ModelSpec = read_spec(spec, base_url)
    secrets = tuple(filter(None, [chosen.secret()]))
    decisions = Decisions(recording.database, recording.record, secrets=secrets)
    respondent = LibraryRespondent(make_model(chosen), ledger, decisions)
    return Channel(respondent, secrets, alone=alone)
