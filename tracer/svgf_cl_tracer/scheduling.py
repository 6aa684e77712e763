"""Where independent work is done: in this process, or by the workers of a Dask cluster.

Both do it by the same function of a shot and an item (the number of a frame, or of a chunk of samples), and hand back
the results in the order of the items: what is made of them does not depend on where they come from.
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

from .errors import SceneError
from .fingerprint import tracer_version
from .shot import Shot

if TYPE_CHECKING:
    from distributed import Client, Future

Item = TypeVar("Item")
Result = TypeVar("Result")

# Seconds that a scheduler may take to answer.
PATIENCE = 5


class Map(Protocol):
    """Applies ``function(shot, item)`` to each of the items, and yields the results in their order."""

    def __call__(  # noqa: D102
        self, function: Callable[[Shot, Item], Result], shot: Shot, items: Iterable[Item], /
    ) -> Iterator[Result]: ...


def here(function: Callable[[Shot, Item], Result], shot: Shot, items: Iterable[Item], /) -> Iterator[Result]:
    """A `Map` that does one item after the other in this process, each when its result is asked for."""
    return (function(shot, item) for item in items)


@contextmanager
def scheduled(address: str | None) -> Iterator[Map]:
    """The `Map` on the cluster of the Dask scheduler at `address`, or `here` where there is none.

    Raises
    ------
    SceneError
        dask.distributed is not installed, no scheduler answers at `address`, or it has no worker.
    """
    if address is None:
        yield here
        return
    with _connected(address) as client:
        yield Cluster(client)


class Cluster:
    """A `Map` on the workers of a Dask cluster.

    A few tasks a worker are in flight at a time, however many items there are. What a worker was at when it died is
    done again by another.

    Parameters
    ----------
    client : distributed.Client
        Connected to a scheduler.
    """

    def __init__(self, client: Client) -> None:
        self._client = client
        self._sent: dict[Shot, Future[Any]] = {}

    def __call__(
        self, function: Callable[[Shot, Item], Result], shot: Shot, items: Iterable[Item], /
    ) -> Iterator[Result]:
        """Results in the order of `items`.

        Raises
        ------
        SceneError
            A worker has another version of the tracer, a task kills its workers, or the scheduler is gone.
        """
        from distributed import KilledWorker

        task, there, remaining = partial(_do, function, tracer_version()), self._send(shot), iter(items)
        pending: deque[Future[Any]] = deque()
        try:
            while True:
                # Workers come and go; while there is none, one task waits for the next.
                room = max(1, 2 * sum(self._client.nthreads().values())) - len(pending)
                items = islice(remaining, max(0, room))
                pending.extend(self._client.submit(task, there, item, pure=False) for item in items)
                if not pending:
                    return
                yield pending.popleft().result()
        except KilledWorker as error:
            raise SceneError(f"--scheduler: workers die of a task, for want of memory perhaps ({error})") from error
        except (CancelledError, OSError) as error:
            raise SceneError(f"--scheduler: the connection was lost ({error}); run again when it is back") from error
        finally:
            self._client.cancel(pending)

    def _send(self, shot: Shot) -> Future[Any]:
        """The shot on the cluster, sent once.

        Workers hand it on to each other. It is the result of a task, since Dask can make that again when every worker
        that has it dies; of scattered data it cannot.
        """
        if shot not in self._sent:
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", message="Sending large graph", category=UserWarning)
                self._sent[shot] = self._client.submit(pickle.loads, pickle.dumps(shot), pure=False)
        return self._sent[shot]


def _do(function: Callable[[Shot, Item], Result], expected: str, shot: Shot, item: Item) -> Result:
    """One task, on a worker."""
    if tracer_version() != expected:
        raise SceneError("--scheduler: expected workers with this version of svgf_cl and its libraries, found another")
    return function(shot, item)


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    try:
        import distributed
    except ModuleNotFoundError as error:
        raise SceneError(f"--scheduler needs Dask ({error}): pip install '.[dask]' in a clone of svgf_cl") from error
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
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise SceneError(f"--scheduler: expected a Dask scheduler at {address}, found none ({reason})") from error


def _check(identity: Mapping[str, Any], address: str) -> None:
    """Raise `SceneError` unless that is a scheduler with workers."""
    if identity["type"] != "Scheduler":
        raise SceneError(f"--scheduler: expected a Dask scheduler at {address}, found a {identity['type']}")
    if not identity["workers"]:
        raise SceneError(f"--scheduler: {address} has no worker yet; start one: dask worker {address}")
