// Measures a device's limits for the roofline: copies of memory, loads from the nearest cache, and multiply-adds.
//
//   copy       target[i] = source[i] for all i, `repeats` times;  item g copies the vectors g * first + k * step,
//              k < count
//   load       CHAINS sums of vectors from as many streams, `count` times; each load begins `offset` floats after the
//              begin of a vector
//   multiply   CHAINS independent sums a := a * b + c per lane, `count` times
//
// in   source;  out  target
// An item on a CPU copies neighbouring vectors (step 1), an item on a GPU every step-th one: each is the fastest there.
// No `restrict`: a compiler that knows that source and target do not overlap might copy only once.
//
// Streams are 33 cache lines apart, so that all fit into the nearest cache, each in different sets of it.
//
// Macros set by the host: VW 1 | 4 | 8 | 16 (floats of a vector), CHAINS.

#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if VW == 1
typedef float floatv;
#define SUM(v) (v)
#define LOAD(p) (*(p))
#else
typedef CAT(float, VW) floatv;
#define SUM(v) (v).s0
#define LOAD(p) CAT(vload, VW)(0, p)
#endif

#define STREAM (33 * 16)  // floats from one stream to the next
#define VECTORS 16        // vectors of a stream that are loaded in turn

__kernel void copy(const int first, const int step, const int count, const int repeats, __global const floatv *source,
                   __global floatv *target) {
    const int begin = (int)get_global_id(0) * first;
    for (int r = 0; r < repeats; ++r) {
        for (int k = 0; k < count; ++k) target[begin + k * step] = source[begin + k * step];
    }
}

__kernel void load(const int count, const int offset, __global const float *source, __global float *target) {
    floatv sums[CHAINS];
#pragma unroll
    for (int i = 0; i < CHAINS; ++i) sums[i] = (floatv)(0.0f);
    for (int k = 0; k < count; ++k) {
        __global const float *p = source + VW * ((int)get_local_id(0) + k % VECTORS) + offset;
#pragma unroll
        for (int i = 0; i < CHAINS; ++i) sums[i] += LOAD(p + i * STREAM);
    }
    floatv sum = (floatv)(0.0f);
#pragma unroll
    for (int i = 0; i < CHAINS; ++i) sum += sums[i];
    target[get_global_id(0)] = SUM(sum);
}

__kernel void multiply(const int count, const float b, const float c, __global float *target) {
    floatv a[CHAINS];
#pragma unroll
    for (int i = 0; i < CHAINS; ++i) a[i] = (floatv)((float)i);
    for (int k = 0; k < count; ++k) {
#pragma unroll
        for (int i = 0; i < CHAINS; ++i) a[i] = mad(a[i], (floatv)(b), (floatv)(c));
    }
    floatv sum = (floatv)(0.0f);
#pragma unroll
    for (int i = 0; i < CHAINS; ++i) sum += a[i];
    target[get_global_id(0)] = SUM(sum);
}
