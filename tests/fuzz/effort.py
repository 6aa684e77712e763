"""How long to search: seconds a test and the same each time, or as many random examples as FUZZ_EXAMPLES says."""

from __future__ import annotations

import os

from hypothesis import Phase, settings

EXAMPLES = os.environ.get("FUZZ_EXAMPLES")


def effort(examples: int = 20) -> settings:
    """The search of a test: so many examples where nothing else is asked for; fewer where most of them build kernels.

    No deadline, as building takes long. Shrinking a failure takes minutes: only the long search does it.
    """
    if EXAMPLES:
        return settings(deadline=None, max_examples=int(EXAMPLES), print_blob=True)
    phases = [Phase.explicit, Phase.generate]
    return settings(deadline=None, max_examples=examples, derandomize=True, phases=phases)
