"""The annotator: label every action, so that those relevant to a wish are found.

First it names the concepts there are: stages, kinds of actions, formats and roles of what goes in
and comes out, words that plugins give themselves. Then it labels each action with those that its
record shows. A language model may add labels from these concepts, never invent one.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Mapping

from cityx.agents.pool import keep_labels, known_labels
from cityx.protocol.encapsulation import Encapsulation

AUTHOR = "record"
Labels = Mapping[str, frozenset[str]]


def labels_of(record: Encapsulation) -> frozenset[str]:
    """Return the labels that follow from the record of an action."""
    found = {f"stage {record.stage}", f"kind {record.kind}", *record.labels}
    for word, ports in (("takes", record.takes), ("gives", record.gives)):
        found |= {f"{word} {port.format.value}" for port in ports}
        found |= {port.role.replace("_", " ") for port in ports if port.role}
    found |= {slot.partition("=")[0] for wish in record.serves for slot in wish.slots}
    return frozenset(found)


def concepts(records: Iterable[Encapsulation]) -> tuple[str, ...]:
    """Return the vocabulary: every label that any record shows, in alphabetical order."""
    return tuple(sorted(frozenset[str]().union(*map(labels_of, records))))


def annotate(
    database: sqlite3.Connection, registry: str, records: Iterable[Encapsulation]
) -> Labels:
    """Label every action, once for a registry; what is stored is taken from there.

    Parameters
    ----------
    database
        Of the city.
    registry
        Hash of the registry.
    records
        Of its actions.
    """
    known = known_labels(database, registry)
    if not known:
        rows = [(r.id, label, AUTHOR) for r in records for label in sorted(labels_of(r))]
        keep_labels(database, registry, rows)
        known = known_labels(database, registry)
    return known


def add_labels(
    database: sqlite3.Connection,
    registry: str,
    added: Mapping[str, Iterable[str]],
    records: Iterable[Encapsulation],
    author: str,
) -> list[str]:
    """Store labels that a model adds; return what was refused, in words."""
    held = list(records)
    known, names = set(concepts(held)), {record.id for record in held}
    rows, refused = [], []
    for action, labels in sorted(added.items()):
        for label in labels:
            if action in names and label in known:
                rows.append((action, label, author))
            else:
                refused.append(f'"{label}" for {action} is no concept of the registry')
    keep_labels(database, registry, rows)
    return refused
