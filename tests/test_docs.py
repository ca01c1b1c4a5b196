"""Pages in docs/, README.md and CONTRIBUTING.md name what exists, are short, and link to pages."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("docs/*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]
# Written by commands: the phrase book and tables of results.
GENERATED = {"docs/phrases.md", "docs/results.md"}
MOST_WORDS = 900


def _slug(heading: str) -> str:
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _anchors(text: str) -> set[str]:
    return {_slug(line.lstrip("# ")) for line in text.splitlines() if line.startswith("#")}


def _missing(page: Path) -> list[str]:
    missing = []
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        if re.match(r"\w+:", target):
            continue
        if not file.exists() or (anchor and anchor not in _anchors(file.read_text())):
            missing.append(target)
    return missing


def _is_known(dotted: str) -> bool:
    """Whether a dotted name is a module, a name in one, or a group of entry points."""
    base = ROOT.joinpath(*dotted.split("."))
    holders = [base.parent / "__init__.py", base.parent.with_suffix(".py")]
    return (
        base.is_dir()
        or base.with_suffix(".py").exists()
        or any(re.search(rf"\b{base.name}\b", f.read_text()) for f in holders if f.exists())
        or any(f'"{dotted}"' in file.read_text() for file in ROOT.glob("cityx/*/*.py"))
    )


@pytest.mark.parametrize("name", NAMES)
def test_every_module_that_a_page_names_exists(name):
    text = (ROOT / name).read_text()
    paths = set(re.findall(r"\b(?:cityx|benchmarks|examples|training)/[\w./]*\w", text))
    dotted = set(re.findall(r"`(cityx(?:\.[a-z_]\w*)+)", text))
    assert [path for path in paths if not (ROOT / path).exists()] == []
    assert [word for word in dotted if not _is_known(word)] == []


@pytest.mark.parametrize("name", sorted(set(NAMES) - GENERATED))
def test_a_page_has_at_most_900_words(name):
    text = re.sub(r"<!-- begin.*?<!-- end|```.*?```", "", (ROOT / name).read_text(), flags=re.S)
    assert len([word for word in text.split() if word != "|"]) <= MOST_WORDS


@pytest.mark.parametrize("name", NAMES)
def test_every_relative_link_resolves(name):
    assert _missing(ROOT / name) == []


def test_every_page_is_linked_from_the_index():
    linked = set(re.findall(r"\]\((\w+\.md)\)", (ROOT / "docs/index.md").read_text()))
    assert {page.name for page in ROOT.glob("docs/*.md")} - {"index.md"} <= linked


def test_every_term_of_the_glossary_stands_in_its_module():
    page = (ROOT / "docs/glossary.md").read_text()
    rows = re.findall(r"^\| ([^|]+?) \| [^|]+ \| `(cityx/[^`]+)` \|$", page, flags=re.M)
    assert len(rows) > 50
    lost = []
    for terms, path in rows:
        text = " ".join((ROOT / path).read_text().lower().split())
        words = re.sub(r"\(.*\)", "", terms).lower().split(",")
        lost += [(word.strip(), path) for word in words if word.strip() not in text]
    assert lost == []


def test_the_changelog_is_short_and_sorted():
    text = (ROOT / "CHANGELOG.md").read_text()
    version = re.search(r'__version__ = "(.+)"', (ROOT / "cityx/version.py").read_text())
    assert version is not None
    assert f"## {version[1]}" in text
    assert len(text.splitlines()) <= 80
    assert {"### Added", "### Changed", "### Fixed"} <= set(text.splitlines())
