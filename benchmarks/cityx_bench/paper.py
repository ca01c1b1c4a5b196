"""The twelve rows of the paper: of 100 proposed actions, how many ran and how many were right.

The paper prints percentages alone. Its SR@1 counts only what ran: each is an exact fraction of the
executed ones, so that the counts follow from what it prints, and what it prints from the counts.
"""

from __future__ import annotations

from typing import NamedTuple

from cityx_bench.scoring import Rates

OF = 100  # proposals behind every row


class Row(NamedTuple):
    """A row of one of the paper's two tables.

    Attributes
    ----------
    executed, right
        Of `OF` proposals; those that are right are among the executed ones.
    er, sr
        ER@1 and SR@1 as they are printed, percent.
    """

    executed: int
    right: int
    er: float
    sr: float

    @property
    def rates(self) -> Rates:
        """The rates that follow from the counts."""
        return Rates.of(OF, self.executed, self.right)


# By the parts of the records that are shown; the paper leaves out "I" and none.
ABLATION = {
    "DIL": Row(94, 78, 94.00, 82.98), "DL": Row(73, 45, 73.00, 61.64),
    "DI": Row(69, 42, 69.00, 60.87), "D": Row(44, 25, 44.00, 56.82),
    "IL": Row(37, 19, 37.00, 51.35), "L": Row(36, 15, 36.00, 41.67),
}  # fmt: skip
MODELS = {
    "GPT-4": Row(91, 74, 91.00, 81.32), "GPT-3.5-turbo": Row(72, 54, 72.00, 75.00),
    "Mistral": Row(78, 48, 78.00, 61.54), "Gemma-7B": Row(39, 27, 39.00, 69.23),
    "Llama2-7B": Row(27, 16, 27.00, 59.26), "Gemma-2B": Row(9, 3, 9.00, 33.33),
}  # fmt: skip
