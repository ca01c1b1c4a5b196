"""Write the table of the building generators into the documentation.

python examples/buildings/table.py [--write docs/buildings.md]
"""

from __future__ import annotations

import argparse
from pathlib import Path

from cityx.assets.styles import style_shares
from cityx.assets.styles.palettes import GROUPS
from cityx.building import selection
from cityx.building.catalogue import generators
from cityx.places.profiles import profile_named, profile_names
from cityx.protocol.registry import registry

NAME = "examples/buildings/table.py"
BEGIN, END = f"<!-- begin: {NAME} -->", f"<!-- end: {NAME} -->"
SHARED = ("city", "share", "floors", "building")


def _range(pair: tuple[float, float], unit: str) -> str:
    low, high = pair
    if high == float("inf"):
        return f"{low:g} {unit} and more" if low else "any"
    return f"{low:g} to {high:,.0f} {unit}"


def kinds() -> list[str]:
    """Return the table of generators."""
    words: dict[str, list[str]] = {}
    for word, name in selection.PURPOSE.items():
        words.setdefault(name, []).append(word)
    actions = registry()
    lines = [
        "| generator | name | zones | footprint | storeys | parameters of its own | taken by tag |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, kind in generators().items():
        record = actions[f"building/{name}-v1"]
        own = [p.name for p in record.parameters if p.name not in SHARED]
        cells = [
            kind.title, f"`{name}`", ", ".join(kind.zones), _range(kind.area, "m2"),
            _range(kind.levels, "").strip(), ", ".join(own), ", ".join(words.get(name, [])),
        ]  # fmt: skip
        lines.append("| " + " | ".join(cell or "-" for cell in cells) + " |")
    return lines


def choice() -> list[str]:
    """Return the table of weights by style family and use."""
    groups = [word for word in GROUPS if word not in style_shares.ALWAYS]
    lines = [f"| family | {' | '.join(groups)} |", "| --- " * (len(groups) + 1) + "|"]
    for family, rows in style_shares.TABLE.items():
        cells = [", ".join(f"{n} {w:g}" for n, w in rows[group].items()) for group in groups]
        lines.append(f"| {family} | {' | '.join(cells)} |")
    return lines


def regional() -> list[str]:
    """Return the table of weights of profiles of places that differ from their family."""
    lines = ["| profile | use | in the place of its family's |", "| --- | --- | --- |"]
    for name in profile_names():
        profile = profile_named(name)
        inherited = profile_named(profile.lineage[1]) if len(profile.lineage) > 1 else profile
        for group, row in profile.buildings.generators.items():
            if inherited.buildings.generators.get(group) != row:
                cells = ", ".join(f"{n} {w:g}" for n, w in row.items())
                lines.append(f"| {name} | {group} | {cells} |")
    return lines


def tables() -> str:
    """Return the tables."""
    always = "; ".join(
        f"{group}: " + ", ".join(f"{name} {weight:g}" for name, weight in row.items())
        for group, row in style_shares.ALWAYS.items()
    )
    last = f"In every family: {always}."
    return "\n".join([*kinds(), "", *choice(), "", last, "", *regional()])


def written(text: str) -> str:
    """Return a document with its tables renewed."""
    head, _, rest = text.partition(BEGIN)
    return f"{head}{BEGIN}\n{tables()}\n{END}{rest.partition(END)[2]}"


def main() -> None:
    """Print or write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", type=Path)
    options = parser.parse_args()
    if options.write:
        options.write.write_text(written(options.write.read_text()))
    else:
        print(tables())


if __name__ == "__main__":
    main()
