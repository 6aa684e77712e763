"""A farm that ends a task by SIGTERM ends it as Ctrl-C would."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from svgf_cl.cli.signals import terminated_like_interrupted


def test_sigterm_interrupts_inside_and_is_as_before_behind() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt), terminated_like_interrupted():
        os.kill(os.getpid(), signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is before


def test_another_thread_leaves_signals_alone() -> None:
    seen = []

    def work() -> None:
        with terminated_like_interrupted():
            seen.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [signal.getsignal(signal.SIGTERM)]
