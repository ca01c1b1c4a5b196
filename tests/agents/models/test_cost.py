"""What a model costs for a typical city: calls, and tokens by the estimate of the budget."""

import io
import json
import math

import pytest
from PIL import Image
from talk import channel_of, offline_planner

from cityx.agents.briefs import read_request
from cityx.agents.models.brief_maker import ModelBriefMaker
from cityx.agents.models.budget import IMAGE_TOKENS, LETTERS_PER_TOKEN
from cityx.agents.models.evaluator import ModelEvaluator, checklist_of
from cityx.agents.models.library import size_of
from cityx.agents.models.planner import ModelPlanner
from cityx.agents.models.recording import Decisions
from cityx.agents.planning.planner import Situation
from cityx.agents.roles import OfflineBriefMaker
from cityx.agents.verdict import Sight, View
from cityx.city.store import read_city
from cityx.language import read_brief
from cityx.language.scene import scene_of
from cityx.options import BuildOptions

MOST_CALLS, MOST_TOKENS = 3, 12_000
CITIES = (
    "A harbour town with a lighthouse on the mole, a fountain in the market square, five brick "
    "warehouses along the quay and a six lane boulevard, in drizzle at dusk",
    "A quiet Georgian village with palm trees",
    "I need a delivery-robot test area: wide pavements, kerb ramps, some obstacles, 300 m by 300 m",
    "A university campus with red brick halls around a central lawn, footpaths criss-crossing it, "
    "and bikes everywhere, early October",
    "1 km2 for a heat-island study: 45 % built, 10 % canopy, mean height 18 m",
    "Cyberpunk alley scene, cramped, vertical, holographic ads, wires overhead, steam from vents, "
    "2 am",
)
EDITS = {  # each with what a model makes of it where the rules do not read it right
    "Paint the church white": (),
    "Make the three tallest buildings glass and plant a tree every 10 m along High Street": (),
    "Let the gloaming come over us with a proper soaking": (
        "Set the time to dusk.", "Make it rain.",
    ),
    "Send every last streetlamp to the scrapyard and bathe the place in snow": (
        "Remove all street lamps.", "Make it snow.",
    ),
}  # fmt: skip
FAULT = {"about": "the sky", "wrong": "it is dry", "severity": "major", "edit": "Make it rain."}


def picture():
    out = io.BytesIO()
    Image.new("RGB", (512, 512), "red").save(out, "PNG")
    return out.getvalue()


def costs(text):
    """Return what each role is given and answers, in tokens, for a new city that is looked at."""
    brief, decisions = read_brief(text), Decisions()

    def channel(*answers):
        return channel_of(*answers, decisions=decisions)

    maker = ModelBriefMaker(channel(scene_of(brief).told()), OfflineBriefMaker())
    request = read_request(BuildOptions(text=text), maker=maker)
    situation, rules = Situation(told=request.told), offline_planner()
    base = rules.workflow(request.slots, situation)
    known = ModelPlanner(channel(""), rules).chosen(request.slots, base, situation, frozenset())
    items = [{"action": one.id, "args": {}} for one in known
             if not any(parameter.required for parameter in one.parameters)][:2]  # fmt: skip
    ModelPlanner(channel({"items": items}), rules).workflow(request.slots, situation)
    looked_at(channel, text, request.slots, FAULT)
    return [_tokens(one) for one in decisions._waiting]


def looked_at(channel, text, slots, *faults, changed=False):
    """Let a model look at four pictures, in each of which eight things are named."""
    asked = checklist_of(slots)
    named = ", ".join(f"building 00a1b2c3d4e5f60{n} at 40 % from the left, 50 % from the top"
                      for n in range(8))  # fmt: skip
    views = tuple(View(str(n), f"a street; {named}", picture()) for n in range(4))
    answer = {f"q{place}": "cannot tell" for place in range(len(asked))} | {"faults": [*faults]}
    sight = Sight(text, asked, (), views, changed=changed)
    ModelEvaluator(channel(answer)).look(sight, lambda _: [])


def costs_of_edit(text, city):
    """Return what each role is given and answers, in tokens, for a change that is mended once."""
    decisions = Decisions()

    def channel(*answers):
        return channel_of(*answers, decisions=decisions)

    maker = ModelBriefMaker(channel({"commands": [*EDITS[text]]}), OfflineBriefMaker())
    request = read_request(BuildOptions(text=text), base=True, city=city, maker=maker)
    for faults in ([FAULT], []):
        looked_at(channel, text, request.slots, *faults, changed=True)
    return [_tokens(one) for one in decisions._waiting]


def _tokens(decision):
    letters, images = size_of(decision.request)
    told = math.ceil(letters / LETTERS_PER_TOKEN) + images * IMAGE_TOKENS
    return told + len(json.dumps(decision.response)) // LETTERS_PER_TOKEN


@pytest.mark.parametrize("text", CITIES)
def test_a_typical_city_costs_three_calls_and_twelve_thousand_tokens(text):
    found = costs(text)
    assert len(found) <= MOST_CALLS
    assert sum(found) <= MOST_TOKENS


@pytest.mark.parametrize("text", EDITS)
def test_a_typical_change_costs_three_calls_and_twelve_thousand_tokens(built_town, text):
    found = costs_of_edit(text, read_city(built_town(lod=1) / "city"))
    assert len(found) <= MOST_CALLS
    assert sum(found) <= MOST_TOKENS
