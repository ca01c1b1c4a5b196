"""Clients whose words a model reads; its answers are recorded, and no model is asked."""

import json

import pytest

pytest.importorskip("pydantic_ai", reason="models need the extra llm")
pytest.importorskip("mcp", reason="cityx serve needs the extra mcp")

from mcp import Client
from pydantic_ai.messages import ModelResponse, TextPart
from pydantic_ai.models.function import FunctionModel

from cityx.agents.briefs import read_request
from cityx.agents.models.asking import Channel
from cityx.agents.models.brief_maker import ModelBriefMaker
from cityx.agents.models.budget import Ledger
from cityx.agents.models.library import LibraryRespondent
from cityx.agents.models.recording import Decisions
from cityx.agents.roles import OfflineBriefMaker
from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.options import BuildOptions, PlannerChoice
from cityx.protocol.registry import registry
from cityx.server.app import CityServer
from cityx.server.owner import Owner
from cityx.server.serve import serve

pytestmark = pytest.mark.anyio
WISH = "Let the gloaming come over us with a proper soaking."
SAID = {"commands": ["Set the time to dusk.", "Make it rain."]}


@pytest.fixture
def choice(folder, tmp_path):
    """A recording of the one question that the wish leads to."""
    path = tmp_path / "decisions.jsonl"
    model = FunctionModel(
        lambda *_: ModelResponse(parts=[TextPart(json.dumps(SAID))]), model_name="scripted"
    )
    channel = Channel(LibraryRespondent(model, Ledger(), Decisions(record=path)))
    maker = ModelBriefMaker(channel, OfflineBriefMaker())
    city = read_city(folder / "city")
    read_request(BuildOptions(text=WISH), base=True, city=city, maker=maker)
    channel.close()
    return PlannerChoice(planner="replay", replay=str(path), look=False)


async def test_a_brief_is_read_by_the_model_of_the_server(folder, choice):
    with Owner(folder, registry(), choice) as owner:
        async with Client(CityServer(owner).sdk_server(), cache=None) as client:
            plan = (await client.call_tool("plan", {"text": WISH})).structured_content
            begun = (await client.call_tool("run_brief", {"text": WISH})).structured_content
            done = (
                await client.call_tool("job_wait", {"job_id": begun["job_id"], "seconds": 20})
            ).structured_content
    assert plan["data"]["brief"]["text"] == "Set the time to dusk. Make it rain."
    assert (done["status"], done["state_rev"]) == ("ok", 2)
    assert any("The model put it as" in warning for warning in done["warnings"])


async def test_what_no_recording_answers_is_refused(folder, choice):
    with Owner(folder, registry(), choice) as owner:
        async with Client(CityServer(owner).sdk_server(), cache=None) as client:
            told = (
                await client.call_tool("plan", {"text": "Let the sandman come over us."})
            ).structured_content
    assert told["status"] != "ok"
    assert told["state_rev"] == 1


def test_a_model_that_cannot_be_had_is_refused_before_anything_is_served(folder):
    with pytest.raises(UsageError, match="needs a recording: add --replay FILE"):
        serve(folder, port=None, profile="core", say=print, choice=PlannerChoice(planner="replay"))
