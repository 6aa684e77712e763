/* A plan that `svgf-cl export` wrote, ready to run on a device. Any error ends the program with a message. */
#ifndef PLAN_H
#define PLAN_H

#include <CL/cl.h>

#include "json.h"

enum { TURNS = 2 }; /* the number of frames after which the two buffers of each pair are in the same places */

typedef struct plan {
    const char *folder;
    char *text; /* of plan.json */
    json *json;
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_mem *memory, *arrays, *constants; /* a buffer for each element of the lists of these names */
    struct launch *launches;
    unsigned frames, since_cut; /* the number of frames, in total and since the last cut */
} plan;

/* Ends the program if an OpenCL function, whose name is `what`, returned an error. */
void check(cl_int error, const char *what);

/* Builds all kernels and allocates all memory. */
plan plan_open(const char *folder, cl_device_id device);

/* Puts the passes of the next frame on the queue. They read their inputs from p->arrays, and write the output there. */
void plan_run(plan *p, int is_cut);

/* Waits for the queue, and frees everything. */
void plan_close(plan *p);

#endif
