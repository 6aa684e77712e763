"""The probe on a real device, on one that cannot be used, and what it remembers."""

from __future__ import annotations

import pytest

from svgf_cl.device import apart, probe

KEY = "some device"


@pytest.fixture
def memory(monkeypatch, tmp_path):
    """An empty cache folder."""
    folder = tmp_path / "cache"
    monkeypatch.setattr(probe, "cache_folder", lambda: folder)
    monkeypatch.setattr(probe, "_heard", {})
    return folder


@pytest.fixture
def answers(monkeypatch):
    """The answers that the next probes give, first first; probing more often fails."""
    given: list[str | apart.NoAnswerError] = []

    def give(key: str) -> str:
        answer = given.pop(0)
        if isinstance(answer, apart.NoAnswerError):
            raise answer
        return answer

    monkeypatch.setattr(probe, "_run_apart", give)
    monkeypatch.setattr(probe, "key", lambda device: KEY)
    return given


def test_working_device(queue, memory):
    assert probe.run(queue.device) == ""
    assert probe.reason(queue.device) == ""
    assert probe.key(queue.device) in (memory / probe.STORE).read_text()


def test_wrong_numbers(queue, monkeypatch):
    monkeypatch.setattr(probe, "KERNEL", probe.KERNEL.replace("sqrt", ""))
    assert probe.run(queue.device) == "computes wrong numbers"


def test_broken_compiler(queue, monkeypatch):
    monkeypatch.setattr(probe, "KERNEL", "#error no such CPU")
    reason = probe.run(queue.device)
    assert "no such CPU" in reason
    assert "\n" not in reason


def test_a_device_that_only_this_process_lists(queue):
    with pytest.raises(apart.NoAnswerError, match="does not list"):
        probe._run_apart("no such device")


def test_answers_are_remembered(memory, answers):
    answers += ["broken", "never asked"]
    assert probe.reason(None) == probe.reason(None) == "broken"


def test_no_answer_is_remembered_only_by_this_process(memory, answers, monkeypatch):
    answers += [apart.NoAnswerError("hangs"), "", "never asked"]
    assert probe.reason(None) == probe.reason(None) == "hangs"
    monkeypatch.setattr(probe, "_heard", {})  # another process
    assert probe.reason(None) == probe.reason(None) == ""


def test_refresh_doubts_no_answer_too(memory, answers):
    answers += [apart.NoAnswerError("hangs"), "", "never asked"]
    assert probe.reason(None) == "hangs"
    assert probe.reason(None, refresh=True) == probe.reason(None) == ""


def test_refresh_doubts_only_what_is_broken(memory, answers):
    answers += ["broken", "", "never asked"]
    assert probe.reason(None) == "broken"
    assert probe.reason(None, refresh=True) == ""
    assert probe.reason(None, refresh=True) == ""


def test_a_new_driver_is_probed_anew(queue):
    class Updated:
        name = queue.device.name
        platform = queue.device.platform
        driver_version = queue.device.driver_version + ".1"

    assert probe.key(Updated) != probe.key(queue.device)


@pytest.mark.parametrize(
    "damaged",
    [b'{"some dev', b"", b"5", b"null", b"[1, 2]", b"\xff\xfe", b'{"some device": 5}', b"[" * 99999],
    ids=lambda damaged: repr(damaged[:20]),
)
def test_a_damaged_memory_is_written_anew(memory, answers, damaged):
    memory.mkdir()
    (memory / probe.STORE).write_bytes(damaged)
    answers += ["", "never asked"]
    assert probe.reason(None) == probe.reason(None) == ""


def test_a_memory_that_cannot_be_written_is_not_silent_and_asks_once_a_process(memory, answers, untold):
    memory.write_text("a file where the folder should be")
    answers += ["", "never asked"]
    with pytest.warns(UserWarning, match=r"cache/probes.json: cannot be written .* each run tests devices"):
        assert probe.reason(None) == ""
    assert probe.reason(None) == ""
