from html.parser import HTMLParser

from cityx.checks.report_html import MOST_FAILURES, report_html

REPORT = {
    "cityx": "0.1.0",
    "name": "Soho <b>",
    "seed": 7,
    "hash": "ab12",
    "area_km2": 0.4021,
    "frame": {"latitude": 51.5, "longitude": -0.13, "projection": "+proj=tmerc"},
    "inputs": [{"name": "soho.osm.gz", "kind": "osm"}],
    "attribution": ["© OpenStreetMap contributors, ODbL 1.0"],
    "brief": {"time": "18:30", "style": None},
    "goals": [{"goal": "buildings stand", "met": True, "evidence": "812 of 812"}],
    "counts": {"buildings": 812, "instances": 51234},
    "triangles": {"unique": 400000, "instanced": 90000000},
    "timings_s": {"parse": 0.5, "buildings": 2.0},
    "peak_rss_mb": 731.5,
    "checks": {
        "building_overlap": {"value": 0.0, "limit": 0.01, "ok": True, "bound": "at most"},
        "arrangement_gaps": {"value": float("nan"), "limit": 0.0, "ok": False},
    },
    "failures": [{"id": "00ff", "action": "roof/hipped-v1", "error": "a < b & c"}],
    "notes": ["terrain is flat"],
}
VOID = {"meta", "img", "br"}


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.seen, self.sources = [], [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append(tag)
        self.sources += [value for key, value in attrs if key in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def parsed(page):
    tags = Tags()
    tags.feed(page)
    assert not tags.open
    return tags


def test_every_tag_is_closed_and_nothing_is_fetched():
    tags = parsed(report_html(REPORT, ["renders/street.png", "renders/top view.png"]))
    assert tags.sources == ["renders/street.png", "renders/top%20view.png"]
    assert "script" not in tags.seen
    assert "link" not in tags.seen


def test_text_from_the_input_is_escaped():
    page = report_html(REPORT)
    assert "Soho &lt;b&gt;" in page
    assert "a &lt; b &amp; c" in page
    assert "<b>" not in page


def test_pictures_are_described():
    assert 'alt="The city, street view"' in report_html(REPORT, ["renders/street.png"])


def test_attribution_counts_and_times_are_shown():
    page = report_html(REPORT)
    assert "© OpenStreetMap contributors, ODbL 1.0" in page
    assert "90\u202f000\u202f000" in page
    assert "2.00 s" in page
    assert "0.4021 km²" in page


def test_a_failed_check_turns_the_verdict():
    page = report_html(REPORT)
    assert "✗ 1 of 2 checks hold, 1 of 1 goals are met." in page
    held = {**REPORT, "checks": {"building_overlap": {"value": 0.0, "limit": 0.01, "ok": True}}}
    assert "✓ 1 of 1 checks hold" in report_html(held)


def test_a_long_list_of_failures_is_cut_and_counted():
    failures = [{"id": f"{i:016x}", "action": "a", "error": "e"} for i in range(1500)]
    page = report_html({**REPORT, "failures": failures})
    assert page.count("<code>a</code>") == MOST_FAILURES
    assert "and 1\u202f300 more" in page
    assert "Failures (1500)" in page


def test_an_empty_report_is_still_a_page():
    parsed(report_html({}))
