"""Runs independent tasks in this process, or on the workers of a Dask cluster.

Both ways call the same function with a shared argument (a shot) and an item (the number of a frame, or a chunk), and
return the results in the order of the items. So the results do not depend on where the tasks run.
"""

from __future__ import annotations

import asyncio
import pickle
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from svgf_cl.errors import SchedulerError, install_extra, one_line

if TYPE_CHECKING:
    from distributed import Client, Future

Shared = TypeVar("Shared")
Item = TypeVar("Item")
Result = TypeVar("Result")

# Most seconds that a scheduler may take to answer.
PATIENCE = 5


class Map(Protocol):
    """Applies ``function(shared, item)`` to each of the items, and yields the results in their order."""

    def __call__(  # noqa: D102
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /
    ) -> Iterator[Result]: ...


def here(function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /) -> Iterator[Result]:
    """Apply a function in this process, to one item after the other, each when its result is needed; a `Map`."""
    return (function(shared, item) for item in items)


@contextmanager
def scheduled(address: str | None, version: Callable[[], str]) -> Iterator[Map]:
    """Yield the `Map` on the cluster of the Dask scheduler at `address`, or `here` if there is no address.

    Parameters
    ----------
    address : str, optional
    version : callable
        Returns the version of all code that affects the results. Workers whose version differs from this process's are
        refused.

    Raises
    ------
    SchedulerError
        If dask.distributed is not installed, no scheduler answers at `address`, or it has no worker.
    """
    if address is None:
        yield here
        return
    with _connected(address) as client:
        yield Cluster(client, version)


class Cluster:
    """A `Map` on the workers of a Dask cluster.

    A few tasks for each worker are in flight at a time, however many items there are. If a worker dies, another one
    repeats its task.

    Parameters
    ----------
    client : distributed.Client
        A client that is connected to a scheduler.
    version : callable
        As in `scheduled`.
    """

    def __init__(self, client: Client, version: Callable[[], str]) -> None:
        self._client = client
        self._version = version
        self._sent: dict[int, tuple[object, Future[Any]]] = {}  # by id(), which is unique while the object is kept here

    def __call__(
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /
    ) -> Iterator[Result]:
        """Yield the results in the order of `items`.

        Raises
        ------
        SchedulerError
            If a worker has another version or lacks a package, a task kills its workers, or the scheduler is gone.
        """
        from distributed import KilledWorker

        task = self._load(partial(_do, function, self._version, self._version()))
        there, remaining = self._send(shared), iter(items)
        pending: deque[Future[Any]] = deque()
        try:
            while True:
                # Workers come and go; while there is none, one task waits for a new worker.
                room = max(1, 2 * sum(self._client.nthreads().values())) - len(pending)
                items = islice(remaining, max(0, room))
                pending.extend(self._client.submit(partial.__call__, task, there, item, pure=False) for item in items)
                if not pending:
                    return
                yield pending.popleft().result()
        except KilledWorker as error:
            raise SchedulerError(
                f"--scheduler: workers die while they work on a task, perhaps because they need more memory ({error})"
            ) from error
        except ImportError as error:
            raise SchedulerError(
                f"--scheduler: a worker lacks a package ({one_line(error)}); install it there"
            ) from error
        except (CancelledError, OSError) as error:
            raise SchedulerError(
                f"--scheduler: the connection was lost ({error}); run the command again when the scheduler is back"
            ) from error
        finally:
            self._client.cancel(pending)

    def _send(self, shared: object) -> Future[Any]:
        """Send the shared argument to the cluster once; workers pass it on to each other."""
        if id(shared) not in self._sent:
            self._sent[id(shared)] = shared, self._load(shared)
        return self._sent[id(shared)][1]

    def _load(self, thing: object) -> Future[Any]:
        """Return an object on the cluster, as the result of a task that unpickles it.

        Dask can repeat a task if every worker with its result dies; it cannot do this for scattered data. And if a
        worker lacks a package that the object needs, the task fails with an error; if Dask unpickled the object itself,
        it would try again forever.
        """
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Sending large graph", category=UserWarning)
            return self._client.submit(pickle.loads, pickle.dumps(thing), pure=False)


def _do(
    function: Callable[[Shared, Item], Result], version: Callable[[], str], expected: str, shared: Shared, item: Item
) -> Result:
    """Run one task on a worker."""
    if version() != expected:
        raise SchedulerError(
            "--scheduler: expected workers with this version of svgf_cl and its libraries, found another version"
        )
    return function(shared, item)


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    try:
        import distributed
    except ModuleNotFoundError as error:
        raise SchedulerError(f"--scheduler needs Dask ({error}): {install_extra('dask')}") from error
    # A client that cannot connect would delay the end of the process, so test the address first.
    _check(asyncio.run(_identity(address)), address)
    with distributed.Client(address, timeout=PATIENCE, set_as_default=False) as client:
        yield client


async def _identity(address: str) -> dict[str, Any]:
    """Return the description that the Dask server at `address` gives of itself."""
    from distributed import rpc

    try:
        async with rpc(address, timeout=PATIENCE) as server:
            identity: dict[str, Any] = await asyncio.wait_for(server.identity(), PATIENCE)
            return identity
    # An address can be wrong in many ways, and anything may answer there.
    except Exception as error:
        reason = one_line(f"{type(error).__name__}: {error}")
        raise SchedulerError(f"--scheduler: expected a Dask scheduler at {address}, found none ({reason})") from error


def _check(identity: Mapping[str, Any], address: str) -> None:
    """Raise `SchedulerError` unless the server is a scheduler with workers."""
    if identity["type"] != "Scheduler":
        raise SchedulerError(f"--scheduler: expected a Dask scheduler at {address}, found a {identity['type']}")
    if not identity["workers"]:
        raise SchedulerError(f"--scheduler: {address} has no worker yet; start one: dask worker {address}")
