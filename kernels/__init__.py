"""OpenCL C sources, one stage a file; installed as svgf_cl.kernels and built by svgf_cl.device.programs."""
