# svgf_cl with its tracer on PoCL, the OpenCL implementation for CPUs that scripts/set_up installs on Debian, too.
#   docker build -t svgf_cl .
#   docker run --rm --read-only --tmpfs /tmp -v "$PWD:/work" --user "$(id -u):$(id -g)" svgf_cl denoise shot -o clean
FROM debian:12-slim

COPY . /svgf_cl
RUN /svgf_cl/scripts/set_up image /opt/svgf_cl && rm -rf /svgf_cl /var/lib/apt/lists/*

# HOME cannot be written, nor need it be: compiled kernels are kept in /tmp, or in a volume put there.
ENV HOME=/nonexistent \
    PATH=/opt/svgf_cl/bin:$PATH \
    XDG_CACHE_HOME=/tmp/cache
USER 1000:1000
WORKDIR /work
ENTRYPOINT ["svgf-cl"]
CMD ["--help"]
