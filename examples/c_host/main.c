/* Denoises raw frames with a plan that `svgf-cl export` wrote, with nothing but OpenCL.

   svgf_host PLAN FRAMES OUT [CUT ...]

   Reads FRAMES/0001.color.raw and so on, a file for each input of the plan, until a number is missing; writes
   OUT/0001.raw and so on. CUT is the number of a frame that follows on a camera cut. OPENCL_PLATFORM chooses a platform
   by a part of its name; else the first GPU of any platform is taken, or the first device. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files.h"
#include "plan.h"

enum { MOST_PLATFORMS = 64, LONGEST_NAME = 256 };

static cl_device_id find_device(void) {
    const char *wanted = getenv("OPENCL_PLATFORM");
    cl_platform_id platforms[MOST_PLATFORMS];
    cl_device_id device;
    cl_uint count = 0;
    clGetPlatformIDs(MOST_PLATFORMS, platforms, &count);
    for (int any = 0; any < 2; ++any) {
        for (cl_uint i = 0; i < count && i < MOST_PLATFORMS; ++i) {
            char name[LONGEST_NAME] = "";
            clGetPlatformInfo(platforms[i], CL_PLATFORM_NAME, sizeof name, name, NULL);
            if (wanted && !strstr(name, wanted)) continue;
            const cl_device_type type = any ? CL_DEVICE_TYPE_ALL : CL_DEVICE_TYPE_GPU;
            if (!clGetDeviceIDs(platforms[i], type, 1, &device, NULL)) return device;
        }
    }
    die("no OpenCL device found%s%s", wanted ? " on a platform named " : "", wanted ? wanted : "");
    return NULL;
}

/* The name of the file of an input. */
static const char *name_of(char *name, int number, const json *input) {
    snprintf(name, LONGEST_NAME, "%04d.%s.raw", number, json_text(json_member(input, "name")));
    return name;
}

static int is_among(int number, char **texts, int count) {
    int is_found = 0;
    for (int i = 0; i < count; ++i) {
        char *end;
        const long read = strtol(texts[i], &end, 10);
        if (*end || read < 1) die("CUT: expected the number of a frame, got %s", texts[i]);
        is_found |= read == number;
    }
    return is_found;
}

int main(int argc, char **argv) {
    if (argc < 4) die("usage: svgf_host PLAN FRAMES OUT [CUT ...]");
    plan p = plan_open(argv[1], find_device());
    const json *arrays = json_member(p.json, "arrays"); /* the inputs, then the output */
    const size_t inputs = json_count(arrays) - 1, size = json_member_size(json_element(arrays, inputs), "bytes");
    void *staging = take(size); /* no input is larger than the output, which has three floats per pixel */
    char name[LONGEST_NAME];
    int number = 1;
    for (; has_file(argv[2], name_of(name, number, arrays->first)); ++number) {
        const int is_cut = is_among(number, argv + 4, argc - 4);
        for (size_t i = 0; i < inputs; ++i) {
            const json *input = json_element(arrays, i);
            const size_t bytes = json_member_size(input, "bytes");
            name_of(name, number, input);
            read_exactly(argv[2], name, staging, bytes);
            check(clEnqueueWriteBuffer(p.queue, p.arrays[i], CL_TRUE, 0, bytes, staging, 0, NULL, NULL), "an upload");
        }
        plan_run(&p, is_cut);
        check(clEnqueueReadBuffer(p.queue, p.arrays[inputs], CL_TRUE, 0, size, staging, 0, NULL, NULL), "the download");
        snprintf(name, sizeof name, "%04d.raw", number);
        write_file(argv[3], name, staging, size);
    }
    free(staging);
    plan_close(&p);
    if (number == 1) die("%s: expected a file %s, found none", argv[2], name);
    return 0;
}
