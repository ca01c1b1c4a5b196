"""Which building generators a style is built of, by the use of buildings, with weights."""

from __future__ import annotations

from collections.abc import Mapping

from cityx.system.tables import table

Weights = Mapping[str, float]

# Style family -> use group -> generators and weights.
TABLE = table("assets/styles", dict[str, dict[str, float]], "families")
# Region -> use group -> generators and weights, in the place of those of its family.
REGIONAL_TABLE = table("assets/styles", dict[str, dict[str, float]], "regional")
ALWAYS = table("assets/styles", dict[str, float], "always")
# Words of a brief that favour generators, and by how much, whatever the family.
STYLE_WORDS = table("assets/styles", dict[str, float], "words")
