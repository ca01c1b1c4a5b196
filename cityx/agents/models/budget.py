"""The budget for language models: requests, tokens and money over a whole run."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from cityx.agents.pool import Message, Pool, Role
from cityx.errors import CityxError

LETTERS_PER_TOKEN = 3  # fewer than any tokenizer takes of English or JSON, so never too few tokens
IMAGE_TOKENS = 1600  # of a picture of 1024 x 1024; vendors count 765 to 1400
MOST_ANSWER = 4096  # tokens of one answer
LEAST_ANSWER = 256  # with fewer, no plan fits


class BudgetSpent(CityxError):
    """What models may cost in a run is spent; nothing more is asked of them."""

    exit_code = 2


@dataclass(frozen=True)
class Limits:
    """What a run may spend on models.

    Attributes
    ----------
    requests
        Calls of a model.
    tokens
        Given and answered together.
    usd
        Dollars; holds for models whose price is known.
    """

    requests: int = 80
    tokens: int = 400_000
    usd: float | None = None


@dataclass
class Ledger:
    """What a run has spent; kept in its messages, so that a resumed run continues counting.

    Attributes
    ----------
    limits
        What may be spent.
    requests, tokens, usd
        Spent so far.
    unpriced
        Whether a price was not known.
    """

    limits: Limits = field(default_factory=Limits)
    requests: int = 0
    tokens: int = 0
    usd: float = 0.0
    unpriced: bool = False
    _pool: Pool | None = None
    _waiting: list[Message] = field(default_factory=list)

    def attach(self, pool: Pool) -> None:
        """Write down in the messages of a run; what it spent before it was interrupted counts."""
        told = pool.read("budget")
        self.requests += len(told)
        self.tokens += sum(pool.tokens())
        self.usd += sum(float(message.body.get("usd") or 0.0) for message in told)
        self._pool = pool
        for message in self._waiting:
            pool.say(message)
        self._waiting.clear()

    def room(self, letters: int, images: int = 0) -> tuple[int, int]:
        """Estimate a request and return its tokens and those that are left for the answer.

        Raises
        ------
        BudgetSpent
            If it would go beyond the budget; nothing has been sent.
        """
        given = math.ceil(letters / LETTERS_PER_TOKEN) + images * IMAGE_TOKENS
        limits = self.limits
        if self.requests >= limits.requests:
            raise BudgetSpent(f"The budget of {limits.requests} requests to models is spent.")
        if limits.usd is not None and self.usd >= limits.usd:
            raise BudgetSpent(f"The budget of {limits.usd:g} dollars for models is spent.")
        left = limits.tokens - self.tokens - given
        if left < LEAST_ANSWER:
            raise BudgetSpent(
                f"The budget of {limits.tokens} tokens for models is spent: {self.tokens} are used "
                f"and the next request needs about {given + LEAST_ANSWER}."
            )
        return given, min(left, MOST_ANSWER)

    def spend(
        self, role: Role, model: str, tokens_in: int, tokens_out: int, usd: float | None
    ) -> None:
        """Write down one request; `usd` is None where the price is not known."""
        self.requests += 1
        self.tokens += tokens_in + tokens_out
        self.usd += usd or 0.0
        self.unpriced |= usd is None
        message = Message(
            role, "budget", {"model": model, "usd": usd}, tokens_in=tokens_in, tokens_out=tokens_out
        )
        if self._pool is not None:
            self._pool.say(message)
        else:
            self._waiting.append(message)
