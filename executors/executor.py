"""Work that falls apart into steps that know nothing of each other, and what does them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

Kept = TypeVar("Kept")
Item = TypeVar("Item")
Result = TypeVar("Result")

Pulse = Callable[[], None]
"""Called often while results are waited for; may raise to stop."""


class WorkersLost(KeyboardInterrupt):
    """What does the work is gone, or one step ends whatever worker takes it; the message says which and what to do.

    It stops work as Ctrl-C does, so that whoever keeps the best so far keeps it here too, and nobody takes it for the
    question having no answer.
    """


def no_pulse() -> None:
    """No pulse is asked for."""


@dataclass(frozen=True, eq=False)
class Work(Generic[Kept, Item, Result]):
    """What is done with each item: `prepare` makes what a worker keeps from one item to the next (it is made once in
    each), `step` takes that and an item. A step's result follows from its item alone, wherever and in whatever order
    the steps are done.

    Both are functions of importable modules (or `functools.partial` of them); what they and the items hold can be sent
    (`executors.shared`).
    """

    prepare: Callable[[], Kept]
    step: Callable[[Kept, Item], Result]


def plain(function: Callable[[Item], Result]) -> Work[Callable[[Item], Result], Item, Result]:
    """Work for which nothing is kept: the function called with each item."""
    return Work(partial(_same, function), _called)


def _same(function: Callable[[Item], Result]) -> Callable[[Item], Result]:
    return function


def _called(function: Callable[[Item], Result], item: Item) -> Result:
    return function(item)


class Executor(ABC):
    """Does steps of work; closed at the end of a `with`, which ends its workers."""

    lost: WorkersLost | None = None
    """Why work was stopped where its workers were lost: an answer marked `interrupted` is then the best until there."""

    @property
    @abstractmethod
    def workers(self) -> int:
        """How many steps can be done at the same time."""

    @property
    def shares(self) -> bool:
        """Whether work is shared out at all; otherwise this process does one step after another."""
        return True

    @abstractmethod
    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """Each item's number and result as they come, in any order.

        What a step raises is raised; a step whose worker was killed is done again, and `WorkersLost` is raised where
        that cannot help. Steps under way when the generator is closed are given up.
        """

    def map(
        self,
        work: Work[Kept, Item, Result],
        items: Sequence[Item],
        pulse: Pulse = no_pulse,
        each: Callable[[int, Result], None] | None = None,
    ) -> list[Result]:
        """The results in the items' order; `each` hears of every one (with its item's number) as it comes."""
        results: dict[int, Result] = {}
        try:
            for number, result in self.completed(work, items, pulse):
                results[number] = result
                if each is not None:
                    each(number, result)
        except WorkersLost as error:
            self.lost = error
            raise
        return [results[number] for number in range(len(items))]

    @abstractmethod
    def close(self) -> None:
        """End the workers; another use starts them anew."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class Here(Executor):
    """Does everything in this process, one step after another; what was prepared for the last work is kept."""

    def __init__(self) -> None:
        self._work: Work[Any, Any, Any] | None = None
        self._kept: Any = None

    @property
    def workers(self) -> int:
        """One."""
        return 1

    @property
    def shares(self) -> bool:
        """It is not."""
        return False

    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """The results in the items' order."""
        for number, item in enumerate(items):
            pulse()
            yield number, self.step(work, item)

    def step(self, work: Work[Kept, Item, Result], item: Item) -> Result:
        """One step."""
        if self._work is not work:
            self._work, self._kept = work, work.prepare()
        return work.step(self._kept, item)

    def close(self) -> None:
        """Forget what was prepared."""
        self._work = self._kept = None
