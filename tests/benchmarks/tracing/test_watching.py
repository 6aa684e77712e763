"""A watched function is called as ever, and is itself again afterwards."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from benchmarks.tracing.watching import watched


def test_the_watcher_is_called_in_its_place() -> None:
    module, seen = SimpleNamespace(double=lambda number, *, plus=0: 2 * number + plus), []

    def watcher(real: Callable[..., int], number: int, **options: int) -> int:
        seen.append(number)
        return real(number, **options)

    with watched(module, "double", watcher):
        assert module.double(4, plus=1) == 9
    assert module.double(5) == 10
    assert seen == [4]


def test_a_method_keeps_its_object() -> None:
    class Counter:
        count = 0

        def add(self, number: int) -> None:
            self.count += number

    counter, real = Counter(), Counter.add
    with watched(Counter, "add", lambda add, each, number: add(each, 10 * number)):
        counter.add(3)
    assert counter.count == 30
    assert Counter.add is real


def test_an_error_leaves_no_watcher_behind() -> None:
    module = SimpleNamespace(broken=lambda: 1 / 0)
    real = module.broken
    with pytest.raises(ZeroDivisionError), watched(module, "broken", lambda function: function()):
        module.broken()
    assert module.broken is real
