/* Opens and runs a plan, in the steps of docs/export.md, which are the same in any language. */
#include "plan.h"

#include <stdlib.h>
#include <string.h>

#include "files.h"

enum { FORMAT = 1, LONGEST_OPTIONS = 1024, LONGEST_LOG = 1 << 16, LONGEST_PATTERN = 16 };

typedef struct launch {
    cl_kernel kernels[TURNS]; /* one for each turn, with its own arguments, so that a frame only sets its number */
    int frame_number;         /* the index of this argument; -1 if the kernel has none */
    size_t global_size[2], local_size[2];
} launch;

void check(cl_int error, const char *what) {
    if (error) die("%s failed with OpenCL error %d", what, (int)error);
}

/* Makes a buffer for each element of a list, of its size, filled with zeros. */
static cl_mem *make_buffers(const plan *p, const json *list) {
    cl_mem *buffers = take(sizeof *buffers * json_count(list)), *next = buffers;
    const cl_uint zero = 0;
    for (const json *each = list->first; each; each = each->next, ++next) {
        cl_int error;
        *next = clCreateBuffer(p->context, CL_MEM_READ_WRITE, json_member_size(each, "bytes"), NULL, &error);
        check(error, "clCreateBuffer");
        check(
            clEnqueueFillBuffer(p->queue, *next, &zero, sizeof zero, 0, json_member_size(each, "bytes"), 0, NULL, NULL),
            "clEnqueueFillBuffer");
    }
    return buffers;
}

static void load_constants(const plan *p) {
    const cl_mem *next = p->constants;
    for (const json *each = json_member(p->json, "constants")->first; each; each = each->next, ++next) {
        const size_t bytes = json_member_size(each, "bytes");
        void *values = take(bytes);
        read_exactly(p->folder, json_text(json_member(each, "file")), values, bytes);
        check(clEnqueueWriteBuffer(p->queue, *next, CL_TRUE, 0, bytes, values, 0, NULL, NULL), "clEnqueueWriteBuffer");
        free(values);
    }
}

static cl_program build(const plan *p, const char *name) {
    char options[LONGEST_OPTIONS] = "", *source = read_text(p->folder, name);
    const char *sources = source;
    for (const json *each = json_member(p->json, "build_options")->first; each; each = each->next) {
        if (strlen(options) + strlen(json_text(each)) + 2 > sizeof options) die("plan.json: too many build_options");
        strcat(strcat(options, json_text(each)), " ");
    }
    cl_int error;
    cl_program program = clCreateProgramWithSource(p->context, 1, &sources, NULL, &error);
    check(error, "clCreateProgramWithSource");
    if (clBuildProgram(program, 1, &p->device, options, NULL, NULL)) {
        static char log[LONGEST_LOG];
        clGetProgramBuildInfo(program, p->device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
        die("%s does not build:\n%s", name, log);
    }
    free(source);
    return program;
}

/* Sets an argument for one turn. Returns whether it is the frame's number, which every frame sets anew. */
static int set_argument(const plan *p, cl_kernel kernel, cl_uint index, const json *argument, size_t turn) {
    const char *kind = json_text(json_member(argument, "kind"));
    cl_float single;
    cl_int whole[4];
    const void *value = whole;
    size_t size = sizeof(cl_mem);
    if (strcmp(kind, "frame_number") == 0) return 1;
    if (strcmp(kind, "memory") == 0) {
        value = &p->memory[json_element_size(json_member(argument, "memory"), turn)];
    } else if (strcmp(kind, "array") == 0) {
        value = &p->arrays[json_member_size(argument, "array")];
    } else if (strcmp(kind, "constant") == 0) {
        value = &p->constants[json_member_size(argument, "constant")];
    } else if (strcmp(kind, "float") == 0) {
        single = (cl_float)json_member(argument, "value")->number;
        value = &single, size = sizeof single;
    } else if (strcmp(kind, "int") == 0) {
        whole[0] = (cl_int)json_member(argument, "value")->number;
        size = sizeof whole[0];
    } else if (strcmp(kind, "int4") == 0) {
        for (size_t i = 0; i < 4; ++i) whole[i] = (cl_int)json_element(json_member(argument, "value"), i)->number;
        size = sizeof whole;
    } else {
        die("plan.json: expected an argument of a known kind, got %s", kind);
    }
    check(clSetKernelArg(kernel, index, size, value), "clSetKernelArg");
    return 0;
}

static void prepare(const plan *p, launch *made, const json *described, cl_program program) {
    const char *name = json_text(json_member(described, "kernel"));
    made->frame_number = -1;
    for (size_t turn = 0; turn < TURNS; ++turn) {
        cl_int error, index = 0;
        made->kernels[turn] = clCreateKernel(program, name, &error);
        check(error, name);
        for (const json *each = json_member(described, "arguments")->first; each; each = each->next, ++index)
            if (set_argument(p, made->kernels[turn], (cl_uint)index, each, turn)) made->frame_number = index;
    }
    /* Reduce the work-group to what the device can run of this kernel, then round the work-items up to a multiple. */
    size_t most, *local = made->local_size;
    check(clGetKernelWorkGroupInfo(made->kernels[0], p->device, CL_KERNEL_WORK_GROUP_SIZE, sizeof most, &most, NULL),
          "clGetKernelWorkGroupInfo");
    for (size_t i = 0; i < 2; ++i) {
        const size_t asked = json_element_size(json_member(described, "local_size"), i);
        const size_t items = json_element_size(json_member(described, "work_items"), i);
        local[i] = asked < most ? asked : most;
        most /= local[i];
        made->global_size[i] = (items + local[i] - 1) / local[i] * local[i];
    }
}

plan plan_open(const char *folder, cl_device_id device) {
    plan p = {.folder = folder, .device = device, .text = read_text(folder, "plan.json")};
    const char *where;
    p.json = json_read(p.text, &where);
    if (!p.json) die("%s/plan.json: expected JSON, got something else at byte %ld", folder, (long)(where - p.text));
    if (json_member_size(p.json, "format") != FORMAT) die("%s/plan.json: expected format %d", folder, FORMAT);
    cl_int error;
    p.context = clCreateContext(NULL, 1, &p.device, NULL, NULL, &error);
    check(error, "clCreateContext");
    p.queue = clCreateCommandQueue(p.context, p.device, 0, &error);
    check(error, "clCreateCommandQueue");
    p.memory = make_buffers(&p, json_member(p.json, "memory"));
    p.arrays = make_buffers(&p, json_member(p.json, "arrays"));
    p.constants = make_buffers(&p, json_member(p.json, "constants"));
    load_constants(&p);
    const json *names = json_member(p.json, "programs"), *launches = json_member(p.json, "launches");
    cl_program *programs = take(sizeof *programs * json_count(names));
    size_t count = 0;
    for (const json *each = names->first; each; each = each->next) programs[count++] = build(&p, json_text(each));
    launch *next = p.launches = take(sizeof *p.launches * json_count(launches));
    for (const json *each = launches->first; each; each = each->next)
        prepare(&p, next++, each, programs[json_member_size(each, "program")]);
    while (count) clReleaseProgram(programs[--count]); /* kernels keep their programs */
    free(programs);
    return p;
}

static void forget_past(const plan *p, size_t turn) {
    for (const json *each = json_member(p->json, "cut")->first; each; each = each->next) {
        const json *pattern = json_member(each, "pattern");
        const size_t piece = json_element_size(json_member(each, "memory"), turn), length = json_count(pattern);
        unsigned char bytes[LONGEST_PATTERN];
        if (length > sizeof bytes) die("plan.json: expected a pattern of at most %d bytes", LONGEST_PATTERN);
        for (size_t i = 0; i < length; ++i) bytes[i] = (unsigned char)json_element(pattern, i)->number;
        check(clEnqueueFillBuffer(p->queue, p->memory[piece], bytes, length, json_member_size(each, "offset"),
                                  json_member_size(each, "bytes"), 0, NULL, NULL),
              "clEnqueueFillBuffer");
    }
}

void plan_run(plan *p, int is_cut) {
    const size_t turn = p->frames % TURNS, count = json_count(json_member(p->json, "launches"));
    if (is_cut || !p->frames) {
        forget_past(p, turn);
        p->since_cut = 0;
    }
    for (const launch *each = p->launches; each < p->launches + count; ++each) {
        const cl_kernel kernel = each->kernels[turn];
        if (each->frame_number >= 0)
            check(clSetKernelArg(kernel, (cl_uint)each->frame_number, sizeof(cl_int), &p->since_cut), "clSetKernelArg");
        check(clEnqueueNDRangeKernel(p->queue, kernel, 2, NULL, each->global_size, each->local_size, 0, NULL, NULL),
              "clEnqueueNDRangeKernel");
    }
    ++p->frames;
    ++p->since_cut;
}

static void release_buffers(cl_mem *buffers, const json *list) {
    for (size_t i = json_count(list); i > 0; --i) clReleaseMemObject(buffers[i - 1]);
    free(buffers);
}

void plan_close(plan *p) {
    clFinish(p->queue);
    for (size_t i = json_count(json_member(p->json, "launches")); i > 0; --i)
        for (size_t turn = 0; turn < TURNS; ++turn) clReleaseKernel(p->launches[i - 1].kernels[turn]);
    free(p->launches);
    release_buffers(p->memory, json_member(p->json, "memory"));
    release_buffers(p->arrays, json_member(p->json, "arrays"));
    release_buffers(p->constants, json_member(p->json, "constants"));
    clReleaseCommandQueue(p->queue);
    clReleaseContext(p->context);
    json_free(p->json);
    free(p->text);
}
