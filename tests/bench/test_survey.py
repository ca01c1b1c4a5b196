"""A study hides where pictures come from, takes right answers alone and counts them rightly."""

import json
import threading
from math import isnan
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest
from cityx_bench.survey.answers import Rating, faults_of, keep, read_ratings, scores_of, steadiness
from cityx_bench.survey.serving import server_of
from cityx_bench.survey.study import make_study, read_study, sources_of
from PIL import Image
from scipy import stats

from cityx.errors import InputError


def pictures(folder, colour, count=3, size=(64, 40), suffix="png"):
    folder.mkdir(parents=True)
    for k in range(count):
        image = Image.new("RGB", size, (colour, 10 * k, 0))
        image.save(folder / f"{folder.name}_{k}.{suffix}")
    return folder


@pytest.fixture
def study(tmp_path):
    sources = {
        "ours": pictures(tmp_path / "ours", 200),
        "theirs": pictures(tmp_path / "theirs", 90, size=(90, 50), suffix="jpg"),
    }
    return make_study(sources, tmp_path / "study", size=(48, 27)), tmp_path / "study"


def answer(study, person="person-01", /, group="volunteer", value=4, **changes):
    ratings = [
        {"item": item, "again": False, "question": question.name, "value": value}
        for item in study.items
        for question in study.questions
    ]
    return {"study": study.digest, "participant": person, "group": group,
            "ratings": ratings, **changes}  # fmt: skip


def test_nothing_that_is_served_tells_the_sources_apart(study):
    made, folder = study
    page = (folder / "index.html").read_text()
    names = [path.name for path in (folder / "pictures").iterdir()]
    assert len(names) == 6
    for word in ("ours", "theirs", "_0", "jpg"):
        assert word not in page.replace("yours", "")
        assert not any(word in name for name in names)
    shapes = set()
    for path in (folder / "pictures").iterdir():
        with Image.open(path) as image:
            shapes.add((image.size, image.format, image.mode, tuple(image.info)))
    assert shapes == {((48, 27), "PNG", "RGB", ())}
    again, sources = read_study(folder)
    assert again == made
    assert sorted(sources.values()) == ["ours"] * 3 + ["theirs"] * 3


def test_the_same_seed_makes_the_same_bytes(tmp_path):
    sources = {name: pictures(tmp_path / name, 50) for name in ("a", "b")}
    for out in ("one", "two"):
        make_study(sources, tmp_path / out)
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*.*"))
    assert len(files) == 9
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_all_faults_of_the_pictures_are_named_and_nothing_is_written(tmp_path):
    good = pictures(tmp_path / "good", 10)
    (tmp_path / "empty").mkdir()
    (good / "broken.png").write_text("no picture")
    with pytest.raises(InputError) as error:
        make_study({"good": good, "none": tmp_path / "empty"}, tmp_path / "study")
    assert "empty of none holds no picture" in str(error.value)
    assert "broken.png is no picture" in str(error.value)
    assert not (tmp_path / "study").exists()
    with pytest.raises(InputError, match=r"not of the form.*given twice.*is no folder"):
        sources_of([f"a={good}", "b", f"a={good}", "c=nowhere"])


def test_a_study_is_not_made_over_another(study, tmp_path):
    _, folder = study
    with pytest.raises(InputError, match="holds a study already"):
        make_study(sources_of([f"a={tmp_path / 'ours'}", f"b={tmp_path / 'theirs'}"]), folder)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"participant": "../../x"}, "participant is not"),
        ({"participant": 7}, "participant is not"),
        ({"group": "cat"}, "group is 'cat'"),
        ({"study": "other"}, "another study"),
        ({"ratings": []}, "ratings is not a list"),
        ({"ratings": [{"item": "x", "question": "aesthetic", "value": 3}]}, "no picture"),
        ({"ratings": [3]}, "is no object"),
    ],
)
def test_answers_that_are_wrong_are_refused(study, change, said):
    made, folder = study
    with pytest.raises(InputError, match=said):
        keep(answer(made, **change), made, folder)
    assert not (folder / "answers").exists()


@pytest.mark.parametrize("value", [0, 6, 2.5, True, "3", None])
def test_numbers_outside_the_scale_are_refused(study, value):
    made, _ = study
    assert any("1 to 5" in fault for fault in faults_of(answer(made, value=value), made))


def test_a_rating_given_twice_is_refused(study):
    made, _ = study
    record = answer(made)
    record["ratings"].append(dict(record["ratings"][0]))
    assert any("given twice" in fault for fault in faults_of(record, made))
    record["ratings"][-1]["again"] = True
    assert faults_of(record, made) == []


def test_means_count_each_person_once_and_their_intervals_are_those_of_students_t(study):
    made, _ = study
    sources = {item: "ours" if k < 3 else "theirs" for k, item in enumerate(made.items)}
    ratings, means = [], []
    rng = np.random.default_rng(0)
    for person in range(8):
        given = rng.integers(1, 6, person % 3 + 1)  # people who stop early count as much
        means.append(given.mean())
        ratings += [
            Rating(f"p{person}", "volunteer", made.items[k], "aesthetic", int(value), False)
            for k, value in enumerate(given)
        ]
    ratings.append(Rating("p0", "volunteer", made.items[0], "aesthetic", 1, True))
    (score,) = scores_of(ratings, sources, made)
    low, high = stats.t.interval(0.95, 7, np.mean(means), stats.sem(means))
    assert (score.people, score.ratings) == (8, len(ratings) - 1)
    np.testing.assert_allclose([score.mean, score.low, score.high], [np.mean(means), low, high])
    assert steadiness(ratings) == (1, abs(ratings[0].value - 1))


def test_one_person_has_no_interval_and_experts_stand_apart(study):
    made, folder = study
    keep(answer(made, "volunteer-1", value=3), made, folder)
    keep(answer(made, "expert-001", group="expert", value=5), made, folder)
    keep(answer(made, "expert-001", group="expert", value=4), made, folder)  # once more
    _, sources = read_study(folder)
    scores = scores_of(read_ratings((folder / "answers").iterdir(), made), sources, made)
    assert {(one.group, one.mean) for one in scores} == {("volunteer", 3.0), ("expert", 4.0)}
    assert all(one.people == 1 and isnan(one.low) for one in scores)


def test_the_server_gives_the_page_and_keeps_answers_but_never_gives_the_key(study):
    made, folder = study
    with server_of(folder) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        base = f"http://127.0.0.1:{server.server_port}"
        page = urlopen(f"{base}/").read().decode()
        assert made.digest in page
        for path in (
            "/key.json",
            "/answers/person-01.json",
            "/../key.json",
            "/pictures/../key.json",
        ):
            with pytest.raises(HTTPError, match="404"):
                urlopen(base + path)
        with pytest.raises(HTTPError, match="400"):
            urlopen(Request(f"{base}/answers", b"{"))
        urlopen(Request(f"{base}/answers", json.dumps(answer(made)).encode()))
        server.shutdown()
    assert json.loads((folder / "answers" / "person-01.json").read_text()) == answer(made)
