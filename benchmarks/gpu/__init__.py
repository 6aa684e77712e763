"""One run of everything on a GPU, into one folder; and what can be said of GPUs on paper. See docs/gpu.md."""
