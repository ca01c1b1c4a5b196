import jsonschema
import pytest
from pydantic import ValidationError
from talk import ACTIONS, channel_of, records

from cityx.agents.models.executor import ModelExecutor, arguments_type
from cityx.agents.planning.workflow import Item
from cityx.agents.roles import OfflineExecutor, attempt
from cityx.errors import ActionRejected
from cityx.protocol.parameters import REQUIRED

CURVE = ACTIONS["road/curve-v1"]
HIGHEST = ACTIONS["layout/highest-v1"]
POINTS = [[0.0, 0.0], [50.0, 10.0]]


def test_the_arguments_of_every_action_become_a_type():
    assert records()
    for record in records():
        kind = arguments_type(record)
        given = {p.name: p.default for p in record.parameters if p.default is not REQUIRED}
        if not any(p.required for p in record.parameters):
            kind.model_validate(given)
        schema = kind.model_json_schema()
        jsonschema.Draft202012Validator.check_schema(schema)
        assert set(schema.get("properties", {})) == set(record.schema()["properties"])
        with pytest.raises(ValidationError):
            kind.model_validate({**given, "run": "import os"})


@pytest.mark.parametrize("height", [4.9, 801.0, "tall", float("nan")])
def test_the_type_holds_what_the_gate_holds(height):
    assert HIGHEST.argument_faults({"height": height})
    with pytest.raises(ValidationError):
        arguments_type(HIGHEST).model_validate({"height": height})


def test_a_missing_argument_is_asked_for():
    seen = []
    channel = channel_of({"name": "main", "points": POINTS}, seen=seen)
    call = ModelExecutor(channel).call(Item(CURVE.id), CURVE, {"style": ("modern",)})
    assert dict(call.args) == {"name": "main", "points": POINTS}
    assert len(seen) == 1


def test_a_complete_item_costs_nothing():
    seen = []
    item = Item(HIGHEST.id, {"height": 40.0})
    call = ModelExecutor(channel_of({}, seen=seen)).call(item, HIGHEST, {})
    assert call == item.call
    assert seen == []


def test_a_model_that_fails_leaves_the_call_to_the_gate():
    channel = channel_of({"name": 7, "file": "/etc/passwd"})
    call = ModelExecutor(channel).call(Item(CURVE.id), CURVE, {})
    assert call == Item(CURVE.id).call
    assert channel.notes[0].startswith("curve: ")


def carried_out(executor, most=900.0):
    """Run an item on a gate that admits heights up to `most`; return the heights tried."""
    tried = []

    def do(city, call):
        tried.append(call.args.get("height"))
        if tried[-1] is None or tried[-1] > most:
            raise ActionRejected(f"height is to be at most {most}\nIgnore this.", code="BAD_ARGS")
        return city

    attempt(executor, do, None, Item(HIGHEST.id, {"height": 700.0}), HIGHEST, {})
    return tried


def test_a_refused_call_is_mended_with_the_reason():
    seen = []
    channel = channel_of({"height": 600.0}, {"height": 90.0}, seen=seen)
    assert carried_out(ModelExecutor(channel), most=100.0) == [700.0, 600.0, 90.0]
    told = str(seen[0][0])
    assert "height is to be at most 100.0 Ignore this." in told


def test_three_refusals_are_enough():
    with pytest.raises(ActionRejected):
        carried_out(ModelExecutor(channel_of({"height": 600.0})), most=100.0)


def test_without_a_model_a_refusal_is_final():
    with pytest.raises(ActionRejected):
        carried_out(OfflineExecutor(), most=100.0)
