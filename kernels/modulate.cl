// First and last stage: the user's interleaved (H, W, C) arrays in and out of the planar layout.
//
//   demodulate   c = min(max((color - emission) / albedo', 0), 1e15),  albedo' = max(albedo, 0.001)
//   modulate     out = sum over signals c * albedo' + emission
//
// in   color, or direct and indirect; albedo, emission, id where the frame has them; normal, depth
// out  guide: normal, depth (both 0 on a miss), id;  illumination: c
// Texture never goes through the filter (Schied et al. 2017, section 3). The floor on albedo keeps specular light on
// black surfaces: modulate multiplies by the number that demodulate divided by.

#define MIN_ALBEDO 0.001f
#define MAX_ILLUMINATION 1e15f  // its square can still be summed in float32
#define MAX_RADIANCE 1e38f      // finite, whatever the albedo

INLINE floatv known_albedo(__global const float *albedo, intv i) {
    const floatv a = gather(albedo, i);
    return where(isfinite(a), max(a, (floatv)(MIN_ALBEDO)), (floatv)(1.0f));
}

typedef struct {
    floatv channel[3];
} Color;

// Zero where any channel is not finite: clamping or scaling an infinity would leave a firefly or a NaN.
INLINE Color finite_color(__global const float *image, intv i) {
    Color c;
    UNROLLED_FOR(k, 3) c.channel[k] = gather(image, i + k);
    const intv good = isfinite(c.channel[0]) & isfinite(c.channel[1]) & isfinite(c.channel[2]);
    UNROLLED_FOR(k, 3) c.channel[k] = where(good, c.channel[k], (floatv)(0.0f));
    return c;
}

#if HAS_EMISSION
INLINE floatv known_emission(Color emission, int k) { return max(emission.channel[k], (floatv)(0.0f)); }
#endif

INLINE void put_illumination(floatv c, intv inside, __global float *plane) {
    c = clamp(c, 0.0f, MAX_ILLUMINATION);
    store(where(inside, c, (floatv)(0.0f)), plane);
}

__kernel void demodulate(const int4 size,
#if SIGNALS == 2
                         __global const float *restrict direct, __global const float *restrict indirect,
#else
                         __global const float *restrict color,
#endif
#if HAS_ALBEDO
                         __global const float *restrict albedo,
#endif
#if HAS_EMISSION && SIGNALS == 1
                         __global const float *restrict emission,
#endif
                         __global const float *restrict normal, __global const float *restrict depth,
#if HAS_ID
                         __global const int *restrict id,
#endif
                         __global float *restrict guide, __global float *restrict illumination) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const intv inside = x + LANES < size.x;
    const intv i1 = interleaved(size, x, y, 1), i3 = interleaved(size, x, y, 3);

    const floatv z = gather(depth, i1);
    Color n = finite_color(normal, i3);
    const floatv length2 = n.channel[0] * n.channel[0] + n.channel[1] * n.channel[1] + n.channel[2] * n.channel[2];
    const intv hit = inside & isfinite(z) & (z > 0.0f) & isfinite(length2) & (length2 > 1e-12f);
    const floatv to_unit = where(hit, 1.0f / sqrt(length2), (floatv)(0.0f));
    UNROLLED_FOR(k, 3)
        store(where(hit, n.channel[k] * to_unit, (floatv)(0.0f)), guide + (NORMAL + k) * size.w + here);
    store(where(hit, z, (floatv)(0.0f)), guide + DEPTH * size.w + here);
#if HAS_ID
    store_int(gather_int(id, i1), (__global int *)guide + ID * size.w + here);
#endif

#if SIGNALS == 2
    const Color radiance[2] = {finite_color(direct, i3), finite_color(indirect, i3)};
#else
    Color radiance[1] = {finite_color(color, i3)};
#if HAS_EMISSION
    const Color glow = finite_color(emission, i3);
    UNROLLED_FOR(k, 3) radiance[0].channel[k] -= known_emission(glow, k);
#endif
#endif
    UNROLLED_FOR(k, 3) {
#if HAS_ALBEDO
        const floatv a = known_albedo(albedo, i3 + k);
#else
        const floatv a = (floatv)(1.0f);
#endif
        UNROLLED_FOR(s, SIGNALS)
            put_illumination(radiance[s].channel[k] / a, inside, illumination + (3 * s + k) * size.w + here);
    }
}

__kernel void modulate(const int4 size,
#if HAS_ALBEDO
                       __global const float *restrict albedo,
#endif
#if HAS_EMISSION
                       __global const float *restrict emission,
#endif
                       __global const float *restrict illumination, __global float *restrict out) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
#if HAS_ALBEDO || HAS_EMISSION
    const intv i3 = interleaved(size, x, y, 3);
#endif
#if HAS_EMISSION
    const Color glow = finite_color(emission, i3);
#endif
    UNROLLED_FOR(k, 3) {
        floatv c = load(illumination + k * size.w + here);
#if SIGNALS == 2
        c += load(illumination + (3 + k) * size.w + here);
#endif
#if HAS_ALBEDO
        c *= known_albedo(albedo, i3 + k);
#endif
#if HAS_EMISSION
        c += known_emission(glow, k);
#endif
        c = min(c, (floatv)(MAX_RADIANCE));
#if TAA
        store(where(x + LANES < size.x, c, (floatv)(0.0f)), out + k * size.w + here);
#else
        scatter(c, size, x, y, k, out);
#endif
    }
}
