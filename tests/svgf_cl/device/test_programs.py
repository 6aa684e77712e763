"""Sources, options, the memory of built programs, and what a build error says."""

from __future__ import annotations

import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import DeviceError
from svgf_cl.device import programs

SQUARE = "kernel void square(global float *a) { a[get_global_id(0)] = SCALE * SCALE; }"


@pytest.fixture
def stage(monkeypatch):
    """A function that makes a text a source file, and returns its name."""

    def add(text: str) -> str:
        monkeypatch.setattr(programs, "source", lambda name: text)
        programs._build.cache_clear()
        return "invented"

    yield add
    programs._build.cache_clear()


def test_names_are_those_of_the_kernel_files():
    assert {"modulate", "temporal", "variance", "atrous"} <= set(programs.names())


def test_the_header_comes_first():
    source = programs.source("atrous")
    assert source.startswith('#line 1 "vectors.clh"\n')
    assert 0 < source.index("#define PLANE") < source.index('\n#line 1 "atrous.cl"\n') < source.index("KERNEL atrous")
    assert "#include" not in source


@pytest.mark.parametrize("name", programs.WITHOUT_HEADERS)
def test_what_needs_no_header_is_compiled_alone(name):
    assert programs.source(name).startswith(f'#line 1 "{name}.cl"\n')


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (3, "3"),
        (True, "1"),
        (np.int64(3), "3"),
        (1.0, "1.0f"),
        (-0.5, "-0.5f"),
        (1e-5, "1e-05f"),
        (np.float32(0.25), "0.25f"),
        ("float4", "float4"),
    ],
)
def test_macros(value, text):
    assert programs.options({"X": value})[-1] == f"-DX={text}"


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "two words", ""])
def test_macros_that_no_compiler_would_understand(value):
    with pytest.raises(ValueError, match="a macro"):
        programs.options({"X": value})


def test_options_guard_nan_and_do_not_depend_on_order():
    assert programs.options({"A": 1, "B": 2}) == programs.options({"B": 2, "A": 1})
    assert not any("fast" in option or "finite" in option or "unsafe" in option for option in programs.OPTIONS)


def test_a_float_is_a_float_on_the_device(queue, stage):
    # 0.1f * 0.1f in single precision differs from 0.1 * 0.1 in double precision, rounded.
    program = programs.build(queue.context, queue.device, stage(SQUARE), {"SCALE": 0.1})
    result = np.zeros(1, np.float32)
    target = cl.Buffer(queue.context, cl.mem_flags.WRITE_ONLY, result.nbytes)
    program.square(queue, (1,), None, target)
    cl.enqueue_copy(queue, result, target)
    assert result[0] == np.float32(0.1) * np.float32(0.1)


def test_a_program_is_built_once_even_by_two_threads(queue, stage):
    name = stage(SQUARE)
    with ThreadPoolExecutor(4) as pool:
        built = list(pool.map(lambda _: programs.build(queue.context, queue.device, name, {"SCALE": 2.0}), range(8)))
    assert len({id(program) for program in built}) == 1


def test_an_integer_and_a_float_are_two_programs(queue, stage):
    name = stage(SQUARE)
    built = [programs.build(queue.context, queue.device, name, {"SCALE": scale}) for scale in (1, 1.0)]
    assert built[0] is not built[1]


def test_drivers_notes_on_success_are_not_shown(queue, stage):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        programs.build(queue.context, queue.device, stage(f"#warning just saying\n{SQUARE}"), {"SCALE": 5})


def test_a_build_error_shows_device_options_and_the_line_in_the_file(queue, stage):
    text = programs.source("atrous") + "\n#line 77\nnonsense here;\n"
    macros = {
        "VW": 4,
        "SIGNALS": 1,
        "MOTION": 2,
        "HAS_ALBEDO": 0,
        "HAS_EMISSION": 0,
        "HAS_ID": 0,
        "TAA": 0,
        "FAST": 0,
        "RADIUS": 2,
    }
    with pytest.raises(DeviceError) as error:
        programs.build(queue.context, queue.device, stage(text), macros)
    message = str(error.value)
    for expected in (
        queue.device.name,
        queue.device.driver_version,
        "invented.cl",
        "-DVW=4",
        "-cl-std=CL1.2",
        "nonsense",
    ):
        assert expected in message
    assert "atrous.cl:77" in message


def test_an_unknown_stage(queue):
    with pytest.raises(FileNotFoundError, match="nothing"):
        programs.build(queue.context, queue.device, "nothing", {})


@pytest.mark.parametrize("kind", ["binary", "info"])
def test_a_damaged_cache_of_pyopencl_is_no_reason_not_to_build(kind, stage, queue, tmp_path, monkeypatch):
    if queue.device.platform.name == "rusticl":
        pytest.skip("rusticl 22.3 aborts on a damaged binary")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("pyopencl.characterize.has_src_build_cache", lambda device: False)  # PoCL's driver has its own
    name = stage(SQUARE)
    programs.build(cl.Context([queue.device]), queue.device, name, {"SCALE": 2.0})
    (file,) = tmp_path.rglob(kind)
    file.write_bytes(b"junk")
    context = cl.Context([queue.device])
    with pytest.warns(UserWarning, match="caching failed"):
        program = programs.build(context, queue.device, name, {"SCALE": 2.0})
    assert program.kernel_names == "square"
