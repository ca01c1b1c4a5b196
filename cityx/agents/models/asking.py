"""Asking a model: one question, one typed answer, and what happens when none comes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict

from cityx.agents.models.budget import BudgetSpent
from cityx.agents.models.quoting import plain, scrubbed
from cityx.agents.pool import Role
from cityx.errors import CityxError

MOST_FAILURES = 2  # questions in a row without an answer; then the server is left alone
QUESTION_S = 180.0  # for one question with all its corrections
LONGEST_REASON = 300  # letters of what a server says went wrong


class ModelFailed(CityxError):
    """A model gave no usable answer; the offline player of the role takes over."""


class Answer(BaseModel):
    """What a model answers: exactly these fields."""

    model_config = ConfigDict(extra="forbid", frozen=True)


AnswerT = TypeVar("AnswerT", bound=BaseModel)


def no_faults(_: Any) -> list[str]:
    """Find nothing wrong."""
    return []


def of_no_use(_: Any) -> None:
    """Take nothing of a wrong answer."""


@dataclass(frozen=True)
class Question:
    """One question.

    Attributes
    ----------
    role
        Who asks.
    task
        What is to be done; the same words every time.
    data
        What it is to be done with; text from elsewhere stands in it quoted.
    answer
        Type of the answer.
    name
        What the answer is called.
    mode
        "tool": the answer is the arguments of one call, for choices and arguments. "text": it is a
        JSON object, held to its schema where the server can, for readings and judgements.
    images
        PNG pictures.
    check
        Returns what is wrong with an answer of the right type, in words for the model.
    corrections
        How often a wrong answer may be corrected.
    sound
        Returns what is right of an answer that stays wrong, None where nothing of it is of use.
    """

    role: Role
    task: str
    data: str
    answer: type[BaseModel]
    name: str = "answer"
    mode: Literal["tool", "text"] = "tool"
    images: tuple[bytes, ...] = ()
    check: Callable[[Any], list[str]] = no_faults
    corrections: int = 2
    sound: Callable[[Any], BaseModel | None] = of_no_use


class Respondent(Protocol):
    """A model that answers questions, metered and recorded."""

    async def answer(self, question: Question) -> BaseModel:
        """Return an answer of the type the question asks for, without faults.

        Raises
        ------
        ModelFailed, BudgetSpent
            If there is none.
        """

    async def close(self) -> None:
        """Give back connections."""


@dataclass
class Channel:
    """The way to one model for a whole run; one thread at a time.

    Attributes
    ----------
    respondent
        Who is asked.
    secrets
        Texts that must not be told.
    notes
        What the report says: failures, and who took over.
    alone
        Whether the model must do without the offline roles: then its failures are raised, as a
        benchmark of the model wants it.
    """

    respondent: Respondent
    secrets: tuple[str, ...] = field(default=(), repr=False)
    notes: list[str] = field(default_factory=list)
    alone: bool = False
    _failures: int = 0
    _closed: str = ""
    _runner: asyncio.Runner = field(default_factory=asyncio.Runner)

    def ask(self, question: Question, kind: type[AnswerT]) -> AnswerT | None:
        """Return the answer, None when the offline role has to take over.

        Raises
        ------
        ModelFailed, BudgetSpent
            Instead of None, where the model is alone.
        """
        try:
            answer = self._asked(question)
        except (ModelFailed, BudgetSpent) as error:
            if self.alone:
                raise
            self.note(f"{question.name}: {str(error).rstrip('.')}. Done offline instead.")
            return None
        assert isinstance(answer, kind)
        return answer

    def _asked(self, question: Question) -> BaseModel:
        if self._closed:
            raise ModelFailed(self._closed)
        try:
            answer = self._runner.run(self._in_time(question))
        except BudgetSpent as error:
            self._closed = str(error)
            raise
        except ModelFailed as error:
            self._failures += 1
            if self._failures >= MOST_FAILURES:
                self._closed = "The model failed too often and is not asked any more."
            reason = plain(scrubbed(str(error), self.secrets))[:LONGEST_REASON]
            raise ModelFailed(reason) from None  # the cause may hold a key
        self._failures = 0
        return answer

    async def _in_time(self, question: Question) -> BaseModel:
        try:
            async with asyncio.timeout(QUESTION_S):
                return await self.respondent.answer(question)
        except TimeoutError:
            raise ModelFailed(f"The model took longer than {QUESTION_S:g} seconds.") from None

    def note(self, text: str) -> None:
        """Add a note to the report, once."""
        text = scrubbed(text, self.secrets)
        if text not in self.notes:
            self.notes.append(text)

    def close(self) -> None:
        """Give back connections; nothing is asked afterwards."""
        self._closed = self._closed or "The run has ended."
        self._runner.run(self.respondent.close())
        self._runner.close()
