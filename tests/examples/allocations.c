/* Counts what the host in C allocates: linked with -Wl,--wrap for each function below. Prints the number so far
   whenever a picture is read, which is once a frame. */
#include <CL/cl.h>
#include <stdio.h>
#include <stdlib.h>

static unsigned count;

void *__real_malloc(size_t bytes);
void *__wrap_malloc(size_t bytes) { return ++count, __real_malloc(bytes); }

void *__real_calloc(size_t number, size_t bytes);
void *__wrap_calloc(size_t number, size_t bytes) { return ++count, __real_calloc(number, bytes); }

void *__real_realloc(void *memory, size_t bytes);
void *__wrap_realloc(void *memory, size_t bytes) { return ++count, __real_realloc(memory, bytes); }

cl_mem __real_clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void *host, cl_int *error);
cl_mem __wrap_clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void *host, cl_int *error) {
    return ++count, __real_clCreateBuffer(context, flags, bytes, host, error);
}

cl_kernel __real_clCreateKernel(cl_program program, const char *name, cl_int *error);
cl_kernel __wrap_clCreateKernel(cl_program program, const char *name, cl_int *error) {
    return ++count, __real_clCreateKernel(program, name, error);
}

cl_int __real_clEnqueueReadBuffer(cl_command_queue queue, cl_mem from, cl_bool blocks, size_t offset, size_t bytes,
                                  void *to, cl_uint events, const cl_event *before, cl_event *event);
cl_int __wrap_clEnqueueReadBuffer(cl_command_queue queue, cl_mem from, cl_bool blocks, size_t offset, size_t bytes,
                                  void *to, cl_uint events, const cl_event *before, cl_event *event) {
    fprintf(stderr, "allocations: %u\n", count);
    return __real_clEnqueueReadBuffer(queue, from, blocks, offset, bytes, to, events, before, event);
}
