"""Checks the arguments of `Denoiser` before it uses them."""

from __future__ import annotations

import math
import operator
import warnings
from collections.abc import Callable

import pyopencl as cl

from svgf_cl.device import devices
from svgf_cl.device.layout import Layout
from svgf_cl.device.process import check_process
from svgf_cl.device.tuning import Tuning, best_tuning
from svgf_cl.errors import SvgfError, shown
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import Shape
from svgf_cl.io import cache

# A function that gets the label and the event of every pass as soon as the pass is on the queue.
AfterPass = Callable[[str, cl.Event], None]


def check_filter(settings: Filter) -> Filter:
    """Return the settings; raise `SvgfError` if they are not a filter's settings."""
    if not isinstance(settings, Filter):
        kinds = " or ".join(f"{kind.__name__}(...)" for kind in FILTERS.values())
        raise SvgfError(f"Denoiser: expected settings={kinds}, got {shown(settings)}")
    return settings


def check_hook(after_pass: AfterPass | None) -> AfterPass | None:
    """Return the function or None; raise `SvgfError` for anything else."""
    if after_pass is not None and not callable(after_pass):
        raise SvgfError(f"Denoiser: expected after_pass=function(label, event), got {shown(after_pass)}")
    return after_pass


def check_inputs(inputs: Inputs) -> Inputs:
    """Return the inputs; raise `SvgfError` if they are not an `Inputs`."""
    if not isinstance(inputs, Inputs):
        raise SvgfError(f"Denoiser: expected Inputs(...) or Inputs.of(frame), got {shown(inputs)}")
    return inputs


def check_queue(queue: cl.CommandQueue | None) -> cl.CommandQueue:
    """Return the queue, or for None a new one on the default device.

    Raises
    ------
    SvgfError
        If it is no queue, is dead, or may run the passes out of order.
    """
    check_process()
    cache.tell()
    if queue is None:
        return devices.default_queue()
    if not isinstance(queue, cl.CommandQueue):
        raise SvgfError(f"Denoiser: expected queue=pyopencl.CommandQueue(...), got {shown(queue)}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", cl.CommandQueueUsedAfterExit)
            _ = queue.int_ptr
        _ = queue.context.devices  # on Intel's runtime a queue does not keep its context alive
    except (cl.CommandQueueUsedAfterExit, cl.Error) as error:
        raise SvgfError(
            "Denoiser: expected a queue that is in use, before the end of its 'with' and with a Context that is kept "
            f"alive; got a dead one ({error})"
        ) from error
    if queue.properties & cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE:
        raise SvgfError("Denoiser: expected an in-order queue, got one with OUT_OF_ORDER_EXEC_MODE_ENABLE")
    return queue


def held(queue: cl.CommandQueue) -> cl.CommandQueue:
    """Return a second handle of a queue.

    The owner's handle is dead after its ``with`` block, and drivers crash on a dead one.
    """
    return cl.CommandQueue.from_int_ptr(queue.int_ptr)


def check_tuning(tuning: Tuning | None, device: cl.Device) -> Tuning:
    """Return the tuning, or for None the best known one; raise `SvgfError` if the device cannot use it."""
    if tuning is None:
        return best_tuning(device)
    if not isinstance(tuning, Tuning):
        raise SvgfError(f"Denoiser: expected tuning=Tuning(...), got {shown(tuning)}")
    tuning.check(device)
    return tuning


def check_shape(shape: Shape) -> Shape:
    """Return (height, width) as plain integers; raise `SvgfError` unless both are whole numbers of at least 1."""
    try:
        height, width = (operator.index(side) for side in shape if not isinstance(side, bool))
    except (TypeError, ValueError) as error:
        raise SvgfError(f"Denoiser: expected shape (height, width), got {shown(shape)}") from error
    if height < 1 or width < 1:
        raise SvgfError(f"Denoiser: expected a shape of at least 1 x 1 pixel, got {shown(shape)}")
    return height, width


def layout_of(shape: Shape, tuning: Tuning, settings: Filter) -> Layout:
    """Return the layout of an image.

    Raises
    ------
    SvgfError
        If the kernels' indices cannot reach every element of the filter's largest buffer.
    """
    layout, planes = Layout(*shape, tuning.row_alignment), settings.pipeline(Inputs.every()).widest
    if not layout.indexable(planes):
        side = math.isqrt(2**31 // planes) // 1000 * 1000
        raise SvgfError(
            f"Denoiser: expected an image of at most about {side} x {side} pixels, got {shown(shape)}; work in "
            "tiles, as svgf_cl.denoiser_for(shape, inputs) does"
        )
    return layout
