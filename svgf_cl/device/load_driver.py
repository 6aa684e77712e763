"""Loads an OpenCL driver as a loader does: ``python load_driver.py LIBRARY PREFIX`` prints why it cannot be used.

It imports nothing of svgf_cl, so that it starts quickly.
"""

from __future__ import annotations

import ctypes
import json
import sys

# The function that a loader asks a driver for (cl_khr_icd).
LISTING = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p)


def fault(library: str) -> str:
    """Return why a driver cannot be used, worded to follow its name; empty if it lists a platform."""
    try:
        find = ctypes.CDLL(library).clGetExtensionFunctionAddress
    except OSError as error:
        return f"cannot be loaded: {error}"
    except AttributeError:
        return "is no OpenCL driver: it lacks clGetExtensionFunctionAddress"
    find.argtypes, find.restype = [ctypes.c_char_p], ctypes.c_void_p
    address = find(b"clIcdGetPlatformIDsKHR")
    if not address:
        return "is no driver for a loader: it lacks clIcdGetPlatformIDsKHR"
    count = ctypes.c_uint32()
    code = LISTING(address)(0, None, ctypes.addressof(count))
    return "" if code == 0 and count.value else f"offers no platform: it answers {code} (CL/cl.h says what that is)"


if __name__ == "__main__":
    print(f"\n{sys.argv[2]}{json.dumps(fault(sys.argv[1]))}", flush=True)
