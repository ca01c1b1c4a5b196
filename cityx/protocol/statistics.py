"""The share of each format among inputs and outputs, beside the paper's table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import FORMATS, Format

# Percent of inputs (PIDF) and of outputs (PODF), as printed; they are counts over 222 inputs and
# 126 outputs, so the inputs sum to 99.99.
PAPER: Mapping[Format, tuple[float, float]] = MappingProxyType(
    {
        Format.SCENE_LAYOUT: (0.0, 19.05),
        Format.NOISE_FUNCTION: (0.45, 0.0),
        Format.IMAGE: (0.90, 0.0),
        Format.TEXTURE_MATERIAL: (0.90, 32.54),
        Format.GEOGRAPHIC_DATA: (1.35, 0.0),
        Format.POINT: (3.15, 0.0),
        Format.BOOLEAN: (4.50, 0.0),
        Format.COMPLEX_GEOMETRY: (4.50, 43.65),
        Format.COLOR: (5.86, 0.0),
        Format.BASIC_GEOMETRY: (7.66, 0.0),
        Format.STRING: (8.11, 0.0),
        Format.SURFACE: (12.61, 2.38),
        Format.LINE: (13.96, 2.38),
        Format.RANDOM_NUMBER: (36.04, 0.0),
    }
)


@dataclass(frozen=True)
class FormatShare:
    """One row of the table.

    Attributes
    ----------
    format
        The format.
    inputs, outputs
        Number of ports.
    pidf, podf
        Percent of all inputs and of all outputs.
    paper_pidf, paper_podf
        The same as the paper prints them.
    """

    format: Format
    inputs: int
    outputs: int
    pidf: float
    podf: float
    paper_pidf: float
    paper_podf: float

    @property
    def name(self) -> str:
        """The format's name in the paper's table."""
        return FORMATS[self.format].paper_name


def input_formats(record: Encapsulation) -> list[Format]:
    """Return the format of every input: data ports, then parameters that are no port."""
    ports = {port.name: port.format for port in record.takes}
    scalars = [p.format for p in record.parameters if p.name not in ports]
    return [*ports.values(), *scalars]


def format_shares(records: Iterable[Encapsulation]) -> tuple[FormatShare, ...]:
    """Count formats over all records, in the order of the paper's table."""
    inputs: Counter[Format] = Counter()
    outputs: Counter[Format] = Counter()
    for record in records:
        inputs.update(input_formats(record))
        outputs.update(port.format for port in record.gives)
    total_in, total_out = max(1, inputs.total()), max(1, outputs.total())
    return tuple(
        FormatShare(
            fmt,
            inputs[fmt],
            outputs[fmt],
            100 * inputs[fmt] / total_in,
            100 * outputs[fmt] / total_out,
            *PAPER[fmt],
        )
        for fmt in Format
    )
