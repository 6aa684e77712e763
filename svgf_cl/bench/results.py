"""The results of a benchmark run, stored as JSON in pytest-benchmark's schema, so that its tools can read them too."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields
from datetime import datetime, timezone
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest_benchmark
from pytest_benchmark.plugin import pytest_benchmark_generate_machine_info
from pytest_benchmark.stats import Stats

from svgf_cl import __version__
from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.errors import SvgfError
from svgf_cl.io.atomic import read_json, write_text


@dataclass(frozen=True)
class DeviceRecord:
    """A device that was timed: its driver's description, its limits, and the filter's error on it.

    Parameters
    ----------
    selector : str
        The value of ``PYOPENCL_CTX`` that chooses it.
    platform, version, device, driver : str
    compute_units : int
    tuning : str
        Its tuning: the default, or the one that ``svgf-cl tune`` stored.
    rms, largest : float
        Error against the float64 oracle, relative to the picture's mean.
    ceilings : Ceilings, optional
        The limits measured in the same run; None if they were left out.
    """

    selector: str
    platform: str
    version: str
    device: str
    driver: str
    compute_units: int
    tuning: str
    rms: float
    largest: float
    ceilings: Ceilings | None = None

    @property
    def label(self) -> str:
        """Implementation and device, for headings."""
        return f"{self.platform}: {self.device}"

    def as_json(self) -> dict[str, Any]:
        """Return all fields, including those of the ceilings, in one dict."""
        own = asdict(self)
        return own | (own.pop("ceilings") or {})

    @classmethod
    def from_json(cls, facts: dict[str, Any]) -> DeviceRecord:
        """Return the record that `as_json` wrote."""
        limits = {each.name: facts[each.name] for each in fields(Ceilings) if each.name in facts}
        own = {name: value for name, value in facts.items() if name not in limits}
        return cls(**own, ceilings=Ceilings(**limits) if limits else None)


@dataclass(frozen=True)
class Result:
    """The samples of one benchmark by one clock on one device.

    Parameters
    ----------
    name : str
        Such as ``svgf.atrous.3.1280x720``.
    device : str
        `DeviceRecord.selector`, or the name of another program that was timed.
    clock : str
        "event" is the device's time, from OpenCL events; "host" is the caller's; "cpu" is the time of all threads
        together.
    seconds : tuple of float
    facts : dict
        Its row, kernel, level, width, height, signals, iterations and cores. With the clock "event" also the numbers
        for its roofline: bytes moved, bytes loaded, flops, bound in s, and which limit binds.
    """

    name: str
    device: str
    clock: str
    seconds: tuple[float, ...]
    facts: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def stats(self) -> Stats:
        """Median, quartiles and other statistics."""
        stats = Stats()
        for value in self.seconds:
            stats.update(value)
        return stats

    @property
    def median(self) -> float:
        """Median of the samples, in seconds."""
        return float(self.stats.median)

    @property
    def roofline(self) -> float | None:
        """Least possible time over the fastest sample: 1 is the limit; None if there is no bound."""
        return self.facts["bound"] / min(self.seconds) if "bound" in self.facts else None

    def as_json(self) -> dict[str, Any]:
        """Return the benchmark as pytest-benchmark writes it."""
        stats = self.stats.as_dict() | {"data": self.seconds, "iterations": 1}
        return {
            "group": f"{self.device} {self.clock}",
            "name": self.name,
            "fullname": f"{self.name}[{self.device}-{self.clock}]",
            "params": {"device": self.device, "clock": self.clock},
            "param": f"{self.device}-{self.clock}",
            "extra_info": self.facts,
            "options": {},
            "stats": stats,
        }


@dataclass(frozen=True)
class Run:
    """All results of one run.

    Parameters
    ----------
    devices : tuple of DeviceRecord
    results : tuple of Result
    left_out : tuple of str
        The cases that could not be timed, and why.
    machine, commit : dict
        The host, and the git revision of svgf_cl, as in pytest-benchmark.
    date : str
        ISO 8601, UTC.
    """

    devices: tuple[DeviceRecord, ...]
    results: tuple[Result, ...]
    left_out: tuple[str, ...]
    machine: dict[str, Any]
    commit: dict[str, Any]
    date: str

    @classmethod
    def now(cls, devices: tuple[DeviceRecord, ...], results: tuple[Result, ...], left_out: tuple[str, ...]) -> Run:
        """Return a run that ends now, on this machine, with this source."""
        date = datetime.now(timezone.utc).isoformat(timespec="seconds")
        return cls(devices, results, left_out, pytest_benchmark_generate_machine_info(), commit_info(), date)

    @property
    def revision(self) -> str:
        """Version and git revision of svgf_cl, for headings."""
        dirty = " with changes" if self.commit["dirty"] else ""
        return f"{self.commit['version']} (git {self.commit['id'][:12]}{dirty})"

    @property
    def has_ceilings(self) -> bool:
        """Whether the devices' limits were measured."""
        return any(device.ceilings for device in self.devices)

    @property
    def platforms(self) -> dict[str, str]:
        """OpenCL implementations by `Result.device`; any other program stands for itself."""
        known = {device.selector: device.platform for device in self.devices}
        return known | {result.device: result.device for result in self.results if result.device not in known}

    def of(self, device: DeviceRecord, **facts: Any) -> Iterator[Result]:
        """Yield the results on a device whose clock and facts are as given, in order."""
        for result in self.results:
            known = result.facts | {"clock": result.clock}
            if result.device == device.selector and all(known.get(name) == value for name, value in facts.items()):
                yield result

    @property
    def text(self) -> str:
        """The run as JSON."""
        document = {
            "machine_info": self.machine | {"opencl": [device.as_json() for device in self.devices]},
            "commit_info": self.commit,
            "benchmarks": [result.as_json() for result in self.results],
            "left_out": self.left_out,
            "datetime": self.date,
            "version": pytest_benchmark.__version__,
        }
        return json.dumps(document, indent=1)

    def write(self, path: Path) -> None:
        """Write the run as JSON, completely or not at all."""
        write_text(path, self.text)

    @classmethod
    def read(cls, path: Path) -> Run:
        """Read a file that `write` wrote; raise `SvgfError` for any other file."""
        try:
            document = read_json(path)
            devices = tuple(DeviceRecord.from_json(device) for device in document["machine_info"].pop("opencl"))
            results = tuple(
                Result(
                    b["name"], b["params"]["device"], b["params"]["clock"], tuple(b["stats"]["data"]), b["extra_info"]
                )
                for b in document["benchmarks"]
            )
            left_out = tuple(document["left_out"])
            return cls(
                devices, results, left_out, document["machine_info"], document["commit_info"], document["datetime"]
            )
        except OSError as error:
            raise SvgfError(f"{path}: cannot be read ({error.strerror})") from error
        except (ValueError, KeyError, TypeError) as error:
            raise SvgfError(
                f"{path}: expected the results.json of 'svgf-cl bench', got something else ({error})"
            ) from error


def commit_info() -> dict[str, Any]:
    """Return the version and git revision of this source, from any current folder; "unknown" if it is no checkout."""
    source = Path(__file__).parent
    command = ["git", "-C", str(source), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    described = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    revision, _, dirty = described.partition("-")
    return {"project": "svgf_cl", "version": __version__, "id": revision or "unknown", "dirty": dirty == "dirty"}
