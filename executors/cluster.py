"""A dask cluster: a scheduler somewhere, and workers that have this program installed.

dask itself gives a step to another worker when one is killed. Work and items are sent packed, so that a worker needs
nothing but the same version of this program.
"""

from __future__ import annotations

import logging
import queue
import time
import uuid
from collections.abc import Generator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from linkwright.core.units.quantities import InputError

from .executor import Executor, Item, Kept, Pulse, Result, Work, WorkersLost, no_pulse
from .packing import packed, unpacked

if TYPE_CHECKING:
    from distributed import Client, Future

ANSWER = 5.0
"""Seconds within which a scheduler must answer, and within which it must have a worker."""
ALONE = 30.0
"""Seconds after which a scheduler that has lost all its workers is given up."""
_BEAT = 0.1
_LOOK = 2.0
"""Seconds between two looks at whether anybody is left."""


def _ended(done: queue.SimpleQueue[tuple[int, Future[bytes]]], number: int, future: Future[bytes]) -> None:
    done.put((number, future))


class _WhileConnected(logging.Filter):
    """Lets what dask's client logs pass while it is connected. What it makes of a scheduler that is gone, tracebacks of
    its own tasks among it, adds nothing to the one line that is said of that here."""

    def __init__(self, client: Client) -> None:
        super().__init__()
        self._client = client
        self._loggers: list[logging.Logger] = []
        for name, logger in list(logging.root.manager.loggerDict.items()):
            if isinstance(logger, logging.Logger) and name.split(".")[0] == "distributed":
                self._loggers.append(logger)
                logger.addFilter(self)

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether it is passed on."""
        del record
        return self._client.status == "running"

    def close(self) -> None:
        """Let the loggers be as they were."""
        for logger in self._loggers:
            logger.removeFilter(self)


class Cluster(Executor):
    """The workers of the dask scheduler at an address such as `tcp://10.0.0.1:8786`.

    Raises `InputError` where dask is not installed, nothing answers at the address within seconds, the scheduler has no
    workers, or one of them has another version of this program.

    >>> import linkwright as lw
    >>> try:
    ...     cluster = lw.Cluster("nowhere", patience=0.1)
    ... except lw.InputError as error:
    ...     print(error.key)
    --dask
    """

    def __init__(self, address: str, *, patience: float = ANSWER) -> None:
        """`patience`: seconds within which the scheduler must answer and have a worker."""
        self.address = address
        self._client: Any = self._connected(patience)
        self._quiet = _WhileConnected(self._client)
        with ExitStack() as undo:
            undo.callback(self._leave)
            self._check(patience)
            undo.pop_all()
        self._work: Work[Any, Any, Any] | None = None
        self._name = ""

    def _connected(self, patience: float) -> Client:
        try:
            from distributed import Client
            from distributed.comm.addressing import get_address_host
        except ImportError:
            message = "a cluster needs dask, which is not installed: pip install 'linkwright[cluster]'"
            raise InputError("", "--dask", message) from None
        try:
            # A client of an address that cannot be read says so, and once more in a traceback when it is collected.
            get_address_host(self.address)
            return Client(self.address, timeout=patience, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            message = f"no dask scheduler answers at {self.address} ({reason}); write --dask tcp://HOST:8786"
            raise InputError("", "--dask", message) from None

    def _check(self, patience: float) -> None:
        """See that there are workers and that they can do what is asked of them."""
        from .station import installed

        until = time.monotonic() + patience
        while not self._client.nthreads():
            if time.monotonic() > until:
                message = f"the scheduler at {self.address} has no workers; start some: dask worker {self.address}"
                raise InputError("", "--dask", message)
            time.sleep(_BEAT)
        own = installed()
        for worker, found in self._client.run(installed, on_error="return").items():
            if found != own:
                has = found if isinstance(found, str) and found else "none"
                message = f"the worker {worker} needs linkwright {own} as here, and has {has}; install it there"
                raise InputError("", "--dask", message)

    @property
    def workers(self) -> int:
        """How many steps can be done at the same time: the workers' threads."""
        return sum(self._client.nthreads().values())

    @property
    def shares(self) -> bool:
        """It is."""
        return True

    def __repr__(self) -> str:
        """Where, and how many."""
        return f"<Cluster: {self.workers} workers at {self.address}>"

    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """The results as they come."""
        from .station import step

        done: queue.SimpleQueue[tuple[int, Future[bytes]]] = queue.SimpleQueue()
        futures: list[Future[bytes]] = []
        try:
            with self._reached():
                self._prepare(work)
            for number, item in enumerate(items):
                with self._reached():
                    future = self._client.submit(step, self._name, packed(item), pure=False)
                future.add_done_callback(partial(_ended, done, number))
                futures.append(future)
            for _ in items:
                number, future = self._waited(done, pulse)
                yield number, unpacked(self._result(future))
        finally:
            left = [future for future in futures if not future.done()]
            if left and self._connected_still:
                with suppress(WorkersLost), self._reached():
                    self._client.cancel(left, force=True)

    @property
    def _connected_still(self) -> bool:
        return self._client.status == "running"

    @property
    def _gone(self) -> WorkersLost:
        return WorkersLost(f"the scheduler at {self.address} is gone; start it and its workers again")

    @contextmanager
    def _reached(self) -> Generator[None]:
        """While the scheduler is asked something: where it is not there, or goes meanwhile, the one line."""
        if not self._connected_still:
            raise self._gone
        try:
            yield
        except OSError:
            raise self._gone from None

    def _prepare(self, work: Work[Any, Any, Any]) -> None:
        """Tell the workers what the work is, those that join later as well."""
        from .station import Station

        if self._work is work:
            return
        self._forget()
        self._work, self._name = work, f"linkwright-{uuid.uuid4().hex}"
        self._client.register_plugin(Station(self._name, packed(work)), name=self._name)

    def _waited(self, done: queue.SimpleQueue[tuple[int, Future[bytes]]], pulse: Pulse) -> tuple[int, Future[bytes]]:
        """The next step that ended, and its number."""
        looked = met = time.monotonic()
        while True:
            pulse()
            try:
                return done.get(timeout=_BEAT)
            except queue.Empty:
                now = time.monotonic()
            if not self._connected_still:
                raise self._gone
            if now - looked >= _LOOK:
                looked = now
                with self._reached():
                    met = now if self._client.nthreads() else met
            if now - met > ALONE:
                raise WorkersLost(f"the scheduler at {self.address} has lost all its workers; start some again")

    def _result(self, future: Future[bytes]) -> bytes:
        from distributed import KilledWorker
        from distributed.client import FutureCancelledError
        from distributed.comm.core import CommClosedError

        try:
            return future.result()
        except KilledWorker:
            message = f"at {self.address} one step ended every worker that took it; have they enough memory?"
            raise WorkersLost(message) from None
        except CommClosedError:
            raise self._gone from None
        except FutureCancelledError:
            # A client that loses its scheduler cancels all that it waits for.
            dropped = WorkersLost(f"the scheduler at {self.address} dropped a step")
            raise dropped if self._connected_still else self._gone from None

    def _forget(self) -> None:
        if self._work is not None and self._connected_still:
            with suppress(WorkersLost), self._reached():
                self._client.unregister_worker_plugin(self._name)
        self._work = None

    def close(self) -> None:
        """Leave the cluster; its workers stay, and forget this work."""
        self._forget()
        self._leave()

    def _leave(self) -> None:
        self._client.close()
        self._quiet.close()
