// Copies an image of 32-bit elements, bit for bit, between two layouts of any order, offset and strides.
//
//   to[y, x, k] = from[y, x, k]
//
// from_layout, to_layout   number of the first element; then how many elements on the next row, pixel and channel lie

__kernel void strided_copy(const int channels, const long4 from_layout, const long4 to_layout,
                           __global const uint *restrict from, __global uint *restrict to) {
    const long x = (long)get_global_id(0), y = (long)get_global_id(1);
    const long source = from_layout.s0 + y * from_layout.s1 + x * from_layout.s2;
    const long target = to_layout.s0 + y * to_layout.s1 + x * to_layout.s2;
    for (int k = 0; k < channels; ++k) to[target + k * to_layout.s3] = from[source + k * from_layout.s3];
}
