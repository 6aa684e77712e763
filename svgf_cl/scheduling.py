"""Where independent work is done: in this process, or by the workers of a Dask cluster.

Both do it by the same function of what all items share (a shot) and an item (the number of a frame, or a chunk), and
hand back the results in the order of the items: what is made of them does not depend on where they come from.
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

# Seconds that a scheduler may take to answer.
PATIENCE = 5


class Map(Protocol):
    """Applies ``function(shared, item)`` to each of the items, and yields the results in their order."""

    def __call__(  # noqa: D102
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /
    ) -> Iterator[Result]: ...


def here(function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /) -> Iterator[Result]:
    """A `Map` that does one item after the other in this process, each when its result is asked for."""
    return (function(shared, item) for item in items)


@contextmanager
def scheduled(address: str | None, version: Callable[[], str]) -> Iterator[Map]:
    """The `Map` on the cluster of the Dask scheduler at `address`, or `here` where there is none.

    Parameters
    ----------
    address : str, optional
    version : callable
        Names the version of the code that a process has, of all that results depend on: workers with another one than
        this process are refused.

    Raises
    ------
    SchedulerError
        dask.distributed is not installed, no scheduler answers at `address`, or it has no worker.
    """
    if address is None:
        yield here
        return
    with _connected(address) as client:
        yield Cluster(client, version)


class Cluster:
    """A `Map` on the workers of a Dask cluster.

    A few tasks a worker are in flight at a time, however many items there are. What a worker was at when it died is
    done again by another.

    Parameters
    ----------
    client : distributed.Client
        Connected to a scheduler.
    version : callable
        As for `scheduled`.
    """

    def __init__(self, client: Client, version: Callable[[], str]) -> None:
        self._client = client
        self._version = version
        self._sent: dict[int, tuple[object, Future[Any]]] = {}  # by identity: what is kept here has its own

    def __call__(
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item], /
    ) -> Iterator[Result]:
        """Results in the order of `items`.

        Raises
        ------
        SchedulerError
            A worker has another version or lacks a package, a task kills its workers, or the scheduler is gone.
        """
        from distributed import KilledWorker

        task = self._load(partial(_do, function, self._version, self._version()))
        there, remaining = self._send(shared), iter(items)
        pending: deque[Future[Any]] = deque()
        try:
            while True:
                # Workers come and go; while there is none, one task waits for the next.
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
        """What all items share, on the cluster, sent once; workers hand it on to each other."""
        if id(shared) not in self._sent:
            self._sent[id(shared)] = shared, self._load(shared)
        return self._sent[id(shared)][1]

    def _load(self, thing: object) -> Future[Any]:
        """A thing on the cluster.

        It is the result of a task, since Dask can make that again when every worker that has it dies; of scattered data
        it cannot. And a worker that lacks a package of the thing fails in the task, and says so: of functions that Dask
        unpickles itself, it would try again for ever.
        """
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Sending large graph", category=UserWarning)
            return self._client.submit(pickle.loads, pickle.dumps(thing), pure=False)


def _do(
    function: Callable[[Shared, Item], Result], version: Callable[[], str], expected: str, shared: Shared, item: Item
) -> Result:
    """One task, on a worker."""
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
    # A client that cannot connect would not let the process end for a while: ask before there is one.
    _check(asyncio.run(_identity(address)), address)
    with distributed.Client(address, timeout=PATIENCE, set_as_default=False) as client:
        yield client


async def _identity(address: str) -> dict[str, Any]:
    """What the Dask server at `address` says of itself."""
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
    """Raise `SchedulerError` unless that is a scheduler with workers."""
    if identity["type"] != "Scheduler":
        raise SchedulerError(f"--scheduler: expected a Dask scheduler at {address}, found a {identity['type']}")
    if not identity["workers"]:
        raise SchedulerError(f"--scheduler: {address} has no worker yet; start one: dask worker {address}")
