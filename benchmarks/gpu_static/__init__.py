"""What compilers for GPUs make of the kernels, held to limits on machines without a GPU."""
