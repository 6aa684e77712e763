"""What runs beside the caller comes in order, is bounded, ends with it, and loses nothing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

from svgf_cl import FileError
from svgf_cl.cli import plain_warnings
from svgf_cl.io.exr import read_image
from svgf_cl.io.overlap import in_order

SECONDS = 20  # that no test takes unless it hangs


class Source:
    """Numbers up to `length`, then perhaps an error; it counts what was taken and says when it is closed."""

    def __init__(self, length: int, error: BaseException | None = None) -> None:
        self.length, self.error, self.taken, self.closed = length, error, 0, False
        self.threads: set[int] = set()

    def __iter__(self) -> Iterator[int]:
        try:
            for number in range(self.length):
                self.taken += 1
                self.threads.add(threading.get_ident())
                yield number
            if self.error:
                raise self.error
        finally:
            self.closed = True


def doubled(items: Iterable[int], count: int) -> Iterator[int]:
    return in_order(lambda number: 2 * number, items, count)


@pytest.mark.parametrize("count", [1, 3, 50])
@pytest.mark.parametrize("length", [0, 1, 20])
def test_all_items_come_in_order(length: int, count: int) -> None:
    assert list(doubled(Source(length), count)) == list(range(0, 2 * length, 2))


@pytest.mark.parametrize("count", [1, 4])
def test_no_more_items_are_taken_than_asked_for(count: int) -> None:
    source = Source(50)
    items = doubled(source, count)
    assert source.taken == 0
    for number in range(10):
        assert next(items) == 2 * number
        assert source.taken <= number + 1 + count
    items.close()
    assert source.threads == {threading.get_ident()}


def test_the_next_call_is_made_while_the_caller_has_a_result() -> None:
    made = [threading.Event() for _ in range(3)]
    items = in_order(lambda number: made[number].set(), range(3), 1)
    next(items)
    assert made[1].wait(SECONDS)
    assert not made[2].is_set()
    items.close()


@pytest.mark.parametrize("error", [FileError("frame 3 is damaged"), KeyboardInterrupt(), MemoryError()])
@pytest.mark.parametrize("count", [1, 8])
def test_an_error_comes_in_its_place(error: BaseException, count: int) -> None:
    def fails_at_three(number: int) -> int:
        if number == 3:
            raise error
        return number

    got: list[int] = []
    with pytest.raises(type(error)):
        got.extend(in_order(fails_at_three, range(9), count))
    assert got == [0, 1, 2]


def test_what_was_taken_is_done_where_the_items_end_by_an_error() -> None:
    done: list[int] = []
    with pytest.raises(FileError):
        list(in_order(done.append, Source(3, FileError("frame 3 is damaged")), 2))
    assert sorted(done) == [0, 1, 2]


def test_a_caller_that_stops_early_leaves_no_thread() -> None:
    before, source = threading.active_count(), Source(1000)

    def stopped() -> None:
        for _ in doubled(source, 4):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stopped()
    assert threading.active_count() == before
    assert source.taken < 10


def test_calls_of_a_function_overlap() -> None:
    """Three that wait for each other end."""
    barrier = threading.Barrier(3)
    assert len(list(in_order(lambda _: barrier.wait(SECONDS), range(9), 3))) == 9


def test_warnings_of_a_thread_reach_the_user(capsys: pytest.CaptureFixture[str]) -> None:
    with plain_warnings("svgf-cl"):
        warnings.simplefilter("always")
        list(in_order(lambda number: warnings.warn(f"frame {number} is odd", stacklevel=1), [1], 1))
    assert "svgf-cl: warning: frame 1 is odd\n" in capsys.readouterr().err


WRITE_FOR_EVER = """
import itertools, signal, sys
from pathlib import Path
import numpy as np
from svgf_cl.io.exr import write_channels
from svgf_cl.io.overlap import in_order
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background processes ignore it
planes = {"R": np.random.default_rng(0).random((400, 600), np.float32)}
def write(number):
    write_channels(Path(sys.argv[1], f"frame.{number:04d}.exr"), planes)
    return number
for number in in_order(write, itertools.count(), 2):
    print(number, flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="Ctrl-C is sent as a signal")
def test_ctrl_c_ends_at_once_and_leaves_whole_files_alone(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", WRITE_FOR_EVER, tmp_path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout
        for line in child.stdout:
            if line.strip() == "5":
                child.send_signal(signal.SIGINT)
                break
        _, said = child.communicate(timeout=SECONDS)
    assert child.returncode == -signal.SIGINT
    assert said.rstrip().endswith("KeyboardInterrupt")
    left = sorted(tmp_path.iterdir())
    assert len(left) >= 5
    for number, path in enumerate(left):
        assert path.name == f"frame.{number:04d}.exr"
        assert read_image(path).planes["R"].shape == (400, 600)
