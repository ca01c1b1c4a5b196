"""Which building generators a style is built of, by the use of buildings: `data/styles.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from cityx.system.tables import DATA, read_table

Weights = Mapping[str, float]
_HELD = read_table(DATA / "styles.toml")

# Style family -> use group -> generators and weights.
TABLE: Mapping[str, Mapping[str, Weights]] = MappingProxyType(_HELD["families"])
ALWAYS: Mapping[str, Weights] = MappingProxyType(_HELD["always"])
# Words of a brief that favour generators, and by how much, whatever the family.
STYLE_WORDS: Mapping[str, Weights] = MappingProxyType(_HELD["words"])
