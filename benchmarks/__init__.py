"""Programs that measure svgf_cl; run them from the root of a clone."""
