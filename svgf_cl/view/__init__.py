"""``svgf-cl view``: a page on this machine that plays noisy, denoised and reference pictures beside each other."""
