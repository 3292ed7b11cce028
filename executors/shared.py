"""Steps of work shared out over executors of `concurrent.futures`: one loop for processes and for a cluster.

Work crosses between processes as `pickle` sends it, but for read-only mappings, which that refuses.
"""

from __future__ import annotations

import io
import pickle
from abc import abstractmethod
from collections import deque
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from types import MappingProxyType
from typing import Any

from linkwright.core.executors.executor import Executor, Item, Kept, Pulse, Result, Work, WorkersLost, no_pulse


class _Packer(pickle.Pickler):
    """Sends a read-only mapping as a separate copy."""

    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, MappingProxyType):
            return read_only, (dict(obj),)
        return NotImplemented


def read_only(content: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """A read-only mapping of what was sent."""
    return MappingProxyType(dict(content))


def packed(content: object) -> bytes:
    """An object as bytes. Raises what `pickle` raises where something in it cannot be sent."""
    stream = io.BytesIO()
    _Packer(stream, protocol=pickle.HIGHEST_PROTOCOL).dump(content)
    return stream.getvalue()


def unpacked(content: bytes) -> Any:
    """The object that bytes hold; only ever of bytes that this program's processes sent."""
    return pickle.loads(content)


BEAT = 0.1
"""Seconds between two calls of a pulse while results are waited for."""


Begin = Callable[[bytes], Future[bytes]]
"""Begins a step with a packed item."""


class Shared(Executor):
    """An executor whose steps are done elsewhere."""

    _tries = 1
    """How often a step is begun whose worker is lost."""

    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """The results as they come."""
        for number, result, error in self.outcomes(work, items, pulse):
            if error is not None:
                raise error
            yield number, result

    def outcomes(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse, first: int = 0
    ) -> Generator[tuple[int, Any, BaseException | None]]:
        """The number of each item from the `first` on, with its result or with what its step raised (`WorkersLost`
        where it ended its workers), as they come."""
        left = deque(range(first, len(items)))
        if not left:
            return
        tries = dict.fromkeys(left, 0)
        busy: dict[Future[bytes], tuple[int, Begin]] = {}
        ended: list[tuple[int, Any, BaseException | None]] = []
        free = self._open(work, len(left))
        try:
            while left or busy or ended:
                while left and free:
                    number, begin = left.popleft(), free.pop()
                    tries[number] += 1
                    busy[begin(packed(items[number]))] = number, begin
                yield from ended  # workers have their next items before anybody works on these results
                ended.clear()
                pulse()
                for future in wait(busy, BEAT, FIRST_COMPLETED).done:
                    number, begin = busy.pop(future)
                    free.append(begin)
                    error = self._error(future, number, tries[number])
                    if isinstance(error, WorkersLost) and tries[number] < self._tries:
                        left.appendleft(number)
                    else:
                        ended.append((number, None if error else unpacked(future.result()), error))
                if busy and not ended:
                    self._look()
        finally:
            if busy:
                self._give_up()

    @abstractmethod
    def _open(self, work: Work[Any, Any, Any], steps: int) -> list[Begin]:
        """What begins a step of this work, once for each of at most `steps` that can be under way together."""

    @abstractmethod
    def _error(self, future: Future[bytes], number: int, tries: int) -> BaseException | None:
        """What a step raised that was begun so often; `WorkersLost` where it was the end of its workers."""

    @abstractmethod
    def _look(self) -> None:
        """Raise `WorkersLost` where nobody is left who could do the steps that are under way."""

    @abstractmethod
    def _give_up(self) -> None:
        """Drop the steps that are under way."""
