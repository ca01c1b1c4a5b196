"""The page of results holds what the logs hold, and says how to make what is missing."""

import json

import pytest
from cityx_bench.commands import bench
from cityx_bench.results import groups_of, page_of, write_page
from cityx_bench.scoring import Sample
from cityx_bench.survey.answers import keep
from cityx_bench.survey.study import make_study, read_study, sources_of
from PIL import Image
from typer.testing import CliRunner

from cityx.errors import InputError
from cityx.protocol.catalogue import registry_hash
from cityx.protocol.registry import registry

LATE = {"code": "STAGE_ORDER", "action": "layout/coast-v1", "message": "it is too late"}


def sample(task, *, driver="offline", right=True, executed=True, lod=0, seed=0, category="generate",
           code=None, faults=(), quality=()):  # fmt: skip
    goal = {"predicate": "n(tree) >= 60", "met": right, "evidence": "there are 59 trees"}
    return Sample(
        task, "", category, driver, seed, lod, code or registry_hash(registry()), True, executed,
        right, [goal], [], list(faults), [], {}, {}, dict(quality),
        0.1, 2.0,
    )  # fmt: skip


def log(folder, samples):
    folder.mkdir(parents=True, exist_ok=True)
    lines = "".join(f"{json.dumps(one.to_json())}\n" for one in samples)
    (folder / "samples.jsonl").write_text(lines)


def section(text, title):
    return text.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


@pytest.fixture
def logs(tmp_path):
    return tmp_path / "bench"


def page(logs):
    return page_of(logs, logs.parent / "docs" / "results.md")


def test_without_logs_every_section_names_its_command(logs):
    text = page(logs)
    assert text.count("No log yet; this makes it: `cityx bench ") == 5
    for command in (f"inputs -o {logs}/inputs", f"agents --driver offline -o {logs}/agents",
                    f"agents --arm all --lod 0 -o {logs}/ablation",
                    f"quality -o {logs}/quality", f"speed MAPS --peers installed -o {logs}/speed",
                    "survey make NAME=FOLDER"):  # fmt: skip
        assert f"cityx bench {command}" in text
    assert "No answers yet: no study was made." in section(text, "Survey")


def test_agents_stand_by_driver_with_rates_faults_and_what_failed(logs):
    log(logs / "agents", [
        sample("P01"), sample("P02", right=False),
        sample("P03", right=False, executed=False, faults=[LATE], category="edit"),
        sample("P01", driver="null", right=False),
    ])  # fmt: skip
    text = section(page(logs), "Agents")
    null, offline = text.split("### offline")
    assert "cityx bench agents --driver offline --seeds 0 --lod 0 --only P01,P02,P03" in offline
    rates = "2/3 = 66.67 % (21-94) | 1/2 = 50.00 % (9-91) | 1/3 = 33.33 % (6-79)"
    assert f"| all | {rates} |" in offline
    assert "| edit | 0/1 = 0.00 % (0-79) |" in offline
    assert "| STAGE_ORDER | 1 |" in offline
    assert "n(tree) >= 60: there are 59 trees" in offline
    assert "STAGE_ORDER layout/coast-v1: it is too late" in offline
    assert "| P01 |" not in offline  # it is right
    assert "| all | 1/1 = 100.00 % (21-100) | 0/1 = 0.00 % (0-79) |" in null
    assert "there are 59 trees" not in null  # it is the floor


def test_the_last_of_a_log_counts_and_other_actions_are_told(logs):
    log(logs / "agents", [
        sample("P01", right=False, code="0" * 32), sample("P02", code="1" * 32),
        sample("P01", right=False, code="1" * 32), sample("P01", code="1" * 32),
    ])  # fmt: skip
    (group,) = groups_of(logs / "agents").values()
    assert [(one.task, one.right) for one in group] == [("P01", True), ("P02", True)]
    assert "Logged by the state 11111111 of CityX; this page was written by another one, " in page(
        logs
    )


def test_arms_are_compared_on_the_tasks_that_all_of_them_solved(logs):
    arms = {"offline": (True, True), "offline:DI": (True, False), "offline:-": (False, False)}
    log(logs / "ablation", [
        sample(f"P0{k + 1}", driver=driver, right=right, executed=right,
               faults=() if right else [LATE])
        for driver, marks in arms.items() for k, right in enumerate(marks)
    ] + [sample("P03")])  # fmt: skip
    text = page(logs)
    own = section(text, "Ablation")
    assert "--arm all --seeds 0 --lod 0 --only P01,P02 -o" in own
    assert "| D + I + L | 2/2 = 100.00 % (34-100) |" in own
    assert "| D + I | 1/2 = 50.00 % (9-91) | 1/1 = 100.00 % (21-100) | 1/2 = 50.00 %" in own
    assert "Not run yet: D + L, I + L, D, I, L." in own
    assert "| none: code of a fault | times |" in own
    beside = section(text, "The paper's figures, beside ours")
    assert "| D + I | 69.00, 60.87 | 69/100 = 69.00 % (59-77) | 42/69 = 60.87 % (49-72) |" in beside
    assert beside.count("| 42/100 = 42.00 % (33-52) | 1/2 = 50.00 % (9-91) |") == 1
    assert "| none | - | - | - | - | 0/2 = 0.00 % (0-66) |" in beside
    assert "| GPT-4 | 91.00, 81.32 | 91/100 = 91.00 %" in beside


def test_inputs_are_counted_by_kind(logs):
    log(logs / "inputs", [
        sample("osm_00", category="osm", lod=1), sample("text_00", category="text", lod=1),
        sample("text_01", category="text", lod=1, right=False),
    ])  # fmt: skip
    text = section(page(logs), "Inputs")
    assert f"`cityx bench inputs --kinds osm,text --count 2 --lod 1 -o {logs}/inputs`" in text
    assert "| osm | 1/1 = 100.00 % (21-100) |" in text
    assert "| text_01 |" in text


def test_quality_has_its_plot_beside_the_page(logs):
    from cityx_bench.quality import MEASURES, write_quality

    (logs / "quality").mkdir(parents=True)
    rows = {"a": dict.fromkeys((m.name for m in MEASURES), 0.5) | {"style": float("nan")}}
    write_quality(rows, "cityx bench quality --towns 1", logs / "quality")
    out = logs.parent / "docs" / "results.md"
    write_page(logs, out)
    text = section(out.read_text(), "Quality")
    assert f"`cityx bench quality --towns 1 -o {logs}/quality`" in text
    assert "| a | 0.500 | 0.500 | 0.500 | 0.500 | 0.500 | 0.500 | - |" in text
    assert "](quality.svg)" in text
    assert (out.parent / "quality.svg").read_text().startswith("<svg")


def test_quality_counts_every_city_that_was_generated(logs):
    from cityx_bench.quality import MEASURES

    good = dict.fromkeys((m.name for m in MEASURES), 1.0) | {"overlap": 0.0, "repetition": 0.0}
    log(logs / "inputs", [
        sample("osm_00", category="osm", lod=1, quality=good | {"style": None}),
        sample("osm_01", category="osm", lod=1, quality=good | {"overlap": 0.5, "style": None}),
    ])  # fmt: skip
    log(logs / "agents", [
        sample("P01", quality=good | {"style": 0.5}), sample("P02", category="edit"),
        sample("P01", driver="oracle", quality=good),
    ])  # fmt: skip
    text = section(page(logs), "Quality")
    assert "| inputs: osm, level 1 (2) | 0.250, 1/2 |" in text
    assert "| agents: generate, level 0 (1) | 0.000, 1/1 |" in text
    assert "| 0.500, 0/1 |" in text
    assert "| -, 0/0 |" in text
    assert "](quality.svg)" in text


def test_speed_stands_beside_peers_and_tells_who_was_skipped(logs):
    (logs / "speed").mkdir(parents=True)
    record = {
        "command": "cityx bench speed a.osm", "skipped": {"blosm": "it is absent"},
        "runs": [
            {"map": "a.osm", "lod": 0, "build": "warm", "cpu_s": 2.0, "clock_s": 2.0, "code": "c",
             "peak_mb": 1.0, "buildings": 4, "km2": 1.0, "built_km2": 0.5, "written": 8e6,
             "glb_mb": 1.0, "phases": {"layout/inputs": 0.5}},
            {"map": "a.osm", "lod": 0, "peer": "osmium", "cpu_s": 0.25, "code": "c"},
        ],
    }  # fmt: skip
    (logs / "speed" / "speed.json").write_text(json.dumps(record))
    text = section(page(logs), "Speed")
    assert "| 500 | 4 | 8.00 | 0.25 |" in text  # ms a building, s/km2 built, triangles
    assert "| layout/inputs | 0.25 | 0.50 | 2 |" in text
    assert "Not run: blosm, since it is absent." in text
    (logs / "speed" / "speed.json").write_text("{")
    with pytest.raises(InputError, match=r"speed\.json cannot be read as a log"):
        page(logs)


def test_only_what_people_answered_is_a_score(logs, tmp_path):
    for name in ("ours", "theirs"):
        (tmp_path / name).mkdir()
        for k in range(2):
            Image.new("RGB", (16, 16), (40 * k, 90, 10)).save(tmp_path / name / f"{k}.png")
    folder = logs / "survey"
    words = [f"{name}={tmp_path / name}" for name in ("ours", "theirs")]
    make_study(sources_of(words), folder, title="Cities", seed=0)
    assert "No answers yet." in section(page(logs), "Survey")
    study, _ = read_study(folder)
    ratings = [{"item": item, "question": q.name, "value": 4, "again": False}
               for item in study.items for q in study.questions]  # fmt: skip
    keep({"participant": "someone-1", "group": "expert", "study": study.digest,
          "ratings": ratings}, study, folder)  # fmt: skip
    text = section(page(logs), "Survey")
    assert "| aesthetic | experts | ours | 1 | 2 | 4.00 | one person alone | 100% |" in text


def test_the_command_writes_the_page(logs, tmp_path):
    out = tmp_path / "docs" / "results.md"
    done = CliRunner().invoke(bench, ["results", "--logs", str(logs), "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert out.read_text().startswith("# Results\n")
