// Copies an image of 32-bit elements, bit for bit, between two layouts with any order, offset and strides.
//
//   to[y, x, k] = from[y, x, k]
//
// A work-item copies `run` pixels of a row: a whole row on a CPU, one pixel on a GPU, where neighbours work side by
// side.
// from_layout, to_layout   index of the first element; then the distance in elements to the next row, pixel and channel

__kernel void strided_copy(const int width, const int channels, const int run, const long4 from_layout,
                           const long4 to_layout, __global const uint *restrict from, __global uint *restrict to) {
    const int first = (int)get_global_id(0) * run, end = min(first + run, width);
    const long y = (long)get_global_id(1);
    from += from_layout.s0 + y * from_layout.s1 + first * from_layout.s2;
    to += to_layout.s0 + y * to_layout.s1 + first * to_layout.s2;
    for (int x = first; x < end; ++x) {
        for (int k = 0; k < channels; ++k) to[k * to_layout.s3] = from[k * from_layout.s3];
        from += from_layout.s2;
        to += to_layout.s2;
    }
}
