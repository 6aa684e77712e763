/* A plan that `svgf-cl export` wrote, ready to run on a device. Any error ends the program with a message. */
#ifndef PLAN_H
#define PLAN_H

#include <CL/cl.h>

#include "json.h"

enum { TURNS = 2 }; /* frames after which all memory is where it was */

typedef struct plan {
    const char *folder;
    char *text; /* of plan.json */
    json *json;
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_mem *memory, *arrays, *constants; /* a buffer for each element of the lists of these names */
    struct launch *launches;
    unsigned frames, since_cut; /* how many frames were run, in all and since the last cut */
} plan;

/* Ends the program where an OpenCL function, named by `what`, returned an error. */
void check(cl_int error, const char *what);

/* Builds all kernels and takes all memory. */
plan plan_open(const char *folder, cl_device_id device);

/* Puts the passes of the next frame on the queue; its inputs are in p->arrays, and its output comes there. */
void plan_run(plan *p, int is_cut);

/* Waits for what is on the queue, and gives all back. */
void plan_close(plan *p);

#endif
