"""A dask cluster: a scheduler somewhere, and workers that have this program installed.

dask's client is an executor of `concurrent.futures`, and dask itself gives a step to another worker when one is killed.
Work and items are sent packed, so that a worker needs nothing but the same version of this program.
"""

from __future__ import annotations

import logging
import time
import uuid
from collections.abc import Generator
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from linkwright.core.executors.shared import packed
from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError

from .executor import Work, WorkersLost
from .shared import BEAT, Begin, Shared

if TYPE_CHECKING:
    from distributed import Client

ANSWER = 5.0
"""Seconds within which a scheduler must answer, and within which it must have a worker."""
ALONE = 30.0
"""Seconds after which a scheduler that has lost all its workers is given up."""
_LOOK = 2.0
"""Seconds between two looks at whether any worker is left."""


class Cluster(Shared):
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
        self._work: Work[Any, Any, Any] | None = None
        self._name = ""
        self._executor: Any = None
        self._looked = self._met = 0.0
        with ExitStack() as undo:
            self._quieten(undo)
            undo.callback(self._client.close)
            self._check(patience)
            self._undo = undo.pop_all()

    def _connected(self, patience: float) -> Client:
        try:
            from distributed import Client
            from distributed.comm.addressing import get_address_host
        except ImportError:
            raise InputError("", "--dask", not_installed("a cluster", "dask", "cluster")) from None
        try:
            # A client of an address that cannot be read says so, and once more in a traceback when it is collected.
            get_address_host(self.address)
            return Client(self.address, timeout=patience, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            message = f"no dask scheduler answers at {self.address} ({reason}); write --dask tcp://HOST:8786"
            raise InputError("", "--dask", message) from None

    def _quieten(self, undo: ExitStack) -> None:
        """Let what dask's client logs pass while it is connected. What it makes of a scheduler that is gone, tracebacks
        of its tasks among it, adds nothing to the one line that is said of that here."""

        def connected(_: logging.LogRecord) -> bool:
            return self._running

        for name, logger in list(logging.root.manager.loggerDict.items()):
            if isinstance(logger, logging.Logger) and name.split(".")[0] == "distributed":
                logger.addFilter(connected)
                undo.callback(logger.removeFilter, connected)

    def _check(self, patience: float) -> None:
        """See that there are workers and that they can do what is asked of them."""
        from .station import installed

        until = time.monotonic() + patience
        while not self._client.nthreads():
            if time.monotonic() > until:
                message = f"the scheduler at {self.address} has no workers; start some: dask worker {self.address}"
                raise InputError("", "--dask", message)
            time.sleep(BEAT)
        local_version = installed()
        for worker, worker_version in self._client.run(installed, on_error="return").items():
            if worker_version != local_version:
                has = worker_version if isinstance(worker_version, str) and worker_version else "none"
                message = (
                    f"the worker {worker} needs linkwright {local_version} as here, and has {has}; install it there"
                )
                raise InputError("", "--dask", message)

    @property
    def workers(self) -> int:
        """How many steps can be done at the same time: the workers' threads."""
        return sum(self._client.nthreads().values())

    def __repr__(self) -> str:
        """Where, and how many."""
        return f"<Cluster: {self.workers} workers at {self.address}>"

    def _open(self, work: Work[Any, Any, Any], steps: int) -> list[Begin]:
        """The scheduler takes all steps at once; its workers know the work, those that join later as well."""
        from .station import Station

        with self._reached():
            if self._work is not work:
                self._forget()
                self._work, self._name = work, f"linkwright-{uuid.uuid4().hex}"
                self._client.register_plugin(Station(self._name, packed(work)), name=self._name)
            self._executor = self._client.get_executor(pure=False)
        self._looked = self._met = time.monotonic()
        return [self._begin] * steps

    def _begin(self, item: bytes) -> Future[bytes]:
        from .station import step

        with self._reached():
            return self._executor.submit(step, self._name, item)

    def _error(self, future: Future[bytes], number: int, tries: int) -> BaseException | None:
        from distributed import KilledWorker
        from distributed.comm.core import CommClosedError

        del number, tries
        try:
            error = future.exception()
        except CancelledError:
            # A client that loses its scheduler cancels all that it waits for.
            dropped = WorkersLost(f"the scheduler at {self.address} dropped a step")
            return dropped if self._running else self._gone
        if isinstance(error, KilledWorker):
            return WorkersLost(f"at {self.address} one step ended every worker that took it; have they enough memory?")
        return self._gone if isinstance(error, CommClosedError) else error

    def _look(self) -> None:
        """See that the scheduler is there, and every now and then that it has workers."""
        now = time.monotonic()
        with self._reached():
            if now - self._looked >= _LOOK:
                self._looked = now
                self._met = now if self._client.nthreads() else self._met
        if now - self._met > ALONE:
            raise WorkersLost(f"the scheduler at {self.address} has lost all its workers; start some again")

    def _give_up(self) -> None:
        with suppress(WorkersLost), self._reached():
            self._executor.shutdown(wait=False)

    @property
    def _running(self) -> bool:
        return self._client.status == "running"

    @property
    def _gone(self) -> WorkersLost:
        return WorkersLost(f"the scheduler at {self.address} is gone; start it and its workers again")

    @contextmanager
    def _reached(self) -> Generator[None]:
        """While the scheduler is asked something: where it is not there, or goes meanwhile, the one line."""
        if not self._running:
            raise self._gone
        try:
            yield
        except OSError:
            raise self._gone from None

    def _forget(self) -> None:
        if self._work is not None:
            with suppress(WorkersLost), self._reached():
                self._client.unregister_worker_plugin(self._name)
        self._work = None

    def close(self) -> None:
        """Leave the cluster; its workers stay, and forget this work."""
        self._forget()
        self._undo.close()
