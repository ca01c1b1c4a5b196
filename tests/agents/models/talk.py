"""Channels to scripted models, for tests."""

import json
import sqlite3

from pydantic_ai.messages import ModelResponse, TextPart, ToolCallPart
from pydantic_ai.models.function import FunctionModel

from cityx.agents.journal import connect
from cityx.agents.models.asking import Channel
from cityx.agents.models.budget import Ledger
from cityx.agents.models.library import LibraryRespondent
from cityx.agents.models.recording import Decisions
from cityx.agents.planning.planner import OfflinePlanner
from cityx.agents.pool import Pool
from cityx.protocol import registry
from cityx.protocol.catalogue import known_records

ACTIONS = registry(outside=False)
OPEN: list[Channel] = []  # closed after every test


def records():
    return known_records(ACTIONS)


def offline_planner():
    return OfflinePlanner(records())


def channel_of(*answers, ledger=None, decisions=None, alone=False, seen=None, name="scripted"):
    """A channel to a model that gives these answers in turn, the last one ever after.

    A dictionary is an answer, a text is said as it is, an exception is raised.
    """
    count = 0

    def reply(messages, info):
        nonlocal count
        if seen is not None:
            seen.append((messages, info))
        answer = answers[min(count, len(answers) - 1)]
        count += 1
        if isinstance(answer, Exception):
            raise answer
        if isinstance(answer, dict) and info.output_tools:
            return ModelResponse(parts=[ToolCallPart(info.output_tools[0].name, answer)])
        if isinstance(answer, dict):
            return ModelResponse(parts=[TextPart(json.dumps(answer))])
        return ModelResponse(parts=[TextPart(answer)] if answer else [])

    model = FunctionModel(reply, model_name=name)
    respondent = LibraryRespondent(model, ledger or Ledger(), decisions or Decisions())
    OPEN.append(Channel(respondent, alone=alone))
    return OPEN[-1]


def pool_in(path):
    database = connect(path)
    assert isinstance(database, sqlite3.Connection)
    return Pool(database, 1)


def prompt_of(messages):
    """All that a model was told."""
    return "\n".join(str(message) for message in messages)
