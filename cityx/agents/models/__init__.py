"""Language models in the roles of the agents; the library behind them is imported when one is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.agents.models.budget import BudgetSpent, Ledger, Limits
from cityx.agents.models.spec import OFFLINE, REPLAY, read_spec, require_library
from cityx.agents.pool import Pool
from cityx.agents.roles import Roles, offline_roles
from cityx.errors import UsageError
from cityx.protocol.encapsulation import Encapsulation
from cityx.system.cache import kept_folder

if TYPE_CHECKING:
    from cityx.agents.models.asking import Channel
    from cityx.agents.models.recording import Decision, Decisions

__all__ = ["BudgetSpent", "Limits", "Recording", "check_choice", "label_actions", "roles_for"]


@dataclass(frozen=True)
class Recording:
    """Where decisions are kept and taken from.

    Attributes
    ----------
    record
        File that new decisions are added to, or None.
    replay
        File of decisions that are played instead of asking, or None.
    kept
        Database of a killed run of the same, whose decisions hold; None or absent without one.
    export
        File of prompts that questions without an answer are added to, see
        `cityx.agents.models.prompts`; None where a model is asked.
    """

    record: Path | None = None
    replay: Path | None = None
    kept: Path | None = None
    export: Path | None = None


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
    if recording.export is not None:
        require_library()
    elif recording.replay is not None:
        from cityx.agents.models.recording import model_of

        require_library()
        model_of(_played(recording.replay).values())
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
    if spec == OFFLINE and recording.replay is None and recording.export is None:
        return offline
    ledger = Ledger(limits or Limits())
    decisions, channel = _channel(spec, base_url, recording, ledger, alone)

    def attach(pool: Pool) -> None:
        ledger.attach(pool)
        decisions.attach(pool.database)

    told = (recording.record, recording.replay, recording.export)
    labels = kept_labels() if told == (None, None, None) else None
    return replace(model_roles(channel, offline, labels), attach=attach)


def kept_labels() -> Path:
    """Return the file of the labels that a model added to the actions of this machine."""
    return kept_folder("labels") / "labels.json"


def label_actions(
    spec: str, base_url: str, registry: str, records: Iterable[Encapsulation]
) -> tuple[dict[str, list[str]], list[str]]:
    """Let a model label the actions, for all cities of this machine; see `models.annotator.label`.

    Raises
    ------
    UsageError, MissingExtra
        If there is no such model.
    """
    from cityx.agents.models.annotator import label

    read_spec(spec, base_url)
    _, channel = _channel(spec, base_url, Recording(), Ledger(Limits()), alone=True)
    try:
        return label(channel, registry, list(records), kept_labels())
    finally:
        channel.close()


def model_roles(channel: Channel, offline: Roles, labels: Path | None = None) -> Roles:
    """Return the roles with a model in each; the offline ones stand behind them.

    Parameters
    ----------
    labels
        File of labels that a model added to actions, None for none.
    """
    from cityx.agents.models.annotator import KeptAnnotator
    from cityx.agents.models.brief_maker import ModelBriefMaker
    from cityx.agents.models.evaluator import ModelEvaluator
    from cityx.agents.models.executor import ModelExecutor
    from cityx.agents.models.planner import ModelPlanner

    planner = ModelPlanner(channel, offline.checker)
    return Roles(
        planner,
        offline.checker,
        ModelBriefMaker(channel, offline.brief_maker),
        ModelExecutor(channel),
        KeptAnnotator(offline.annotator, planner.use, labels),
        ModelEvaluator(channel),
        channel.notes,
        close=channel.close,
    )


def _channel(
    spec: str, base_url: str, recording: Recording, ledger: Ledger, alone: bool
) -> tuple[Decisions, Channel]:
    from cityx.agents.models.asking import Channel
    from cityx.agents.models.library import LibraryRespondent, make_model, silent_model
    from cityx.agents.models.prompts import BY_HAND, PromptFile, decisions_of, read_prompts
    from cityx.agents.models.recording import Decisions, kept_decisions

    secrets: tuple[str, ...] = ()
    if recording.export is not None:
        path = recording.export
        known = decisions_of(read_prompts(path)) if path.exists() else {}
        decisions = Decisions(known, ask=PromptFile(path).ask)
        model = silent_model([], BY_HAND)
    elif recording.replay is not None:
        known = _played(recording.replay)
        decisions = Decisions(known, replayed=True)
        model = silent_model(list(known.values()))
    else:
        chosen = read_spec(spec, base_url)
        secrets = tuple(filter(None, [chosen.secret()]))
        known = kept_decisions(recording.kept)
        decisions = Decisions(known, record=recording.record, secrets=secrets)
        model = make_model(chosen)
    return decisions, Channel(LibraryRespondent(model, ledger, decisions), secrets, alone=alone)


def _played(path: Path) -> dict[tuple[str, int], Decision]:
    """Return the decisions of a recording, or of prompts that were answered by hand."""
    from cityx.agents.models.prompts import decisions_of, is_prompts, read_prompts
    from cityx.agents.models.recording import read_decisions

    if is_prompts(path):
        return decisions_of(read_prompts(path, answered=True))
    return read_decisions(path)
