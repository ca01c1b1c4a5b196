"""Measure how well instructions are read: precision, recall and F1 over slots.

    python benchmarks/brief.py [--tasks FILE] [--set dev|held|hard|last|unseen]

The tasks of the agent benchmark and our own sentences are read without a language model; an item
is one key=value. Numbers may differ by one per mille. Prints each sentence that is not exact.
"""

from __future__ import annotations

import argparse
import json
import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from cityx.language import Brief, read_brief, read_note

ROOT = Path(__file__).parents[1]
TASKS = ROOT.parent / "shared" / "notes" / "bench_tasks.md"
SENTENCES = ROOT / "tests" / "language" / "sentences.json"
CLOSE = 1e-3  # numbers of gold are rounded
KINDS = {"osm": "osm", "semantic": "semantic", "height": "height", "satellite": "satellite"}


@dataclass(frozen=True)
class Sentence:
    """An instruction with what should be read in it."""

    name: str
    text: str
    gold: tuple[str, ...]
    inputs: tuple[tuple[str, str], ...] = ()
    base: bool = False
    note: str = ""


def kind_of(name: str) -> str:
    """Return the kind of a file of the benchmark, which its name begins with."""
    return next((kind for start, kind in KINDS.items() if name.startswith(start)), "text")


def read_tasks(path: Path) -> list[Sentence]:
    """Read the tasks of the agent benchmark from its Markdown."""
    found = []
    for block in path.read_text().split("\n- id: ")[1:]:
        fields = dict(re.findall(r"^  (\w+): (.*)$", block, re.MULTILINE))
        files = [name.strip() for name in fields.get("inputs", "[]").strip("[]").split(",")]
        note = fields.get("note", "").strip('"').partition(" says: ")[2]
        slots = re.findall(r'"([^"]*)"|([^,\[\]\s][^,\[\]]*)', fields["slots"])
        found.append(
            Sentence(
                block.split("\n")[0].strip(),
                fields["text"].strip('"'),
                tuple((quoted or plain).strip() for quoted, plain in slots),
                tuple((name, kind_of(name)) for name in files if name),
                fields.get("base", "empty") != "empty",
                note,
            )
        )
    return found


def read_sentences(path: Path, only: str = "") -> list[Sentence]:
    """Read our own sentences, those for development, those held out, or all."""
    records = json.loads(path.read_text())
    return [
        Sentence(
            f"{record['set']}{number:03d}",
            record["text"],
            tuple(record["slots"]),
            tuple((name, kind) for name, kind in record.get("inputs", [])),
            record.get("base", False),
        )
        for number, record in enumerate(records)
        if only in ("", record["set"])
    ]


def brief_of(sentence: Sentence) -> Brief:
    """Read an instruction, and the text file that came with it."""
    brief = read_brief(sentence.text, inputs=sentence.inputs, base=sentence.base)
    return brief.joined(read_note(sentence.note)) if sentence.note else brief


def same(gold: str, read: str) -> bool:
    """Return whether two items say the same."""
    key, _, value = gold.partition("=")
    other_key, _, other = read.partition("=")
    if key != other_key:
        return False
    try:
        return abs(float(value) - float(other)) <= CLOSE * max(1.0, abs(float(value)))
    except ValueError:
        return value == other


def compare(gold: Iterable[str], read: Sequence[str]) -> tuple[int, list[str], list[str]]:
    """Return how many items agree, those that are missing and those that are too many."""
    left = list(read)
    missing = []
    agreed = 0
    for item in dict.fromkeys(gold):
        match = next((one for one in left if same(item, one)), None)
        if match is None:
            missing.append(item)
        else:
            left.remove(match)
            agreed += 1
    return agreed, missing, left


def score(title: str, sentences: Sequence[Sentence]) -> float:
    """Print what is not exact and the figures; return F1."""
    agreed = asked = read_count = exact = 0
    begin = time.process_time()
    briefs = [brief_of(sentence) for sentence in sentences]
    seconds = time.process_time() - begin
    for sentence, brief in zip(sentences, briefs, strict=True):
        read = [f"{key}={value}" for key, value in brief.items()]
        hits, missing, extra = compare(sentence.gold, read)
        agreed += hits
        asked += len(dict.fromkeys(sentence.gold))
        read_count += len(read)
        exact += not missing and not extra
        if missing or extra or brief.unread:
            print(f"{sentence.name}  {sentence.text}")
            print(f"      missing {missing}  extra {extra}  unread {list(brief.words_unread)}")
    precision, recall = agreed / max(1, read_count), agreed / max(1, asked)
    f1 = 2 * precision * recall / max(1e-9, precision + recall)
    print(
        f"{title}: F1 {f1:.3f}  precision {precision:.3f}  recall {recall:.3f}  exact {exact} of "
        f"{len(sentences)}  {seconds / max(1, len(sentences)) * 1000:.1f} ms a sentence\n"
    )
    return f1


def main() -> None:
    """Score the tasks, when they are at hand, and our own sentences."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", type=Path, default=TASKS)
    parser.add_argument("--set", default="", choices=["", "dev", "held", "hard", "last", "unseen"])
    options = parser.parse_args()
    read_brief("A warm start.")
    if options.tasks.is_file():
        score("tasks", read_tasks(options.tasks))
    for name in [options.set] if options.set else ["dev", "held", "hard", "last", "unseen"]:
        score(name, read_sentences(SENTENCES, name))


if __name__ == "__main__":
    main()
