// First and last stage: the user's interleaved (H, W, C) arrays in and out of the planar layout.
//
//   demodulate   c = min(max((color - emission) / albedo', 0), MAX_LIGHT),  albedo' = clamp(albedo, 0.001, 1)
//   modulate     out = sum over signals c * albedo' + emission
//
// in   color, or direct and indirect; albedo, emission, id where the frame has them; normal, depth
// out  guide: normal, depth (both 0 on a miss), id;  illumination: c
// Texture never goes through the filter (Schied et al. 2017, section 3). The floor on albedo keeps specular light on
// black surfaces: modulate multiplies by the number that demodulate divided by.

#define MIN_ALBEDO 0.001f
#define MAX_CHANNEL 1e10f  // of a radiance or a normal; the sun's disc has 2e9 cd/m2
#define MIN_DEPTH 1e-20f
#define MAX_DEPTH 1e20f  // some renderers write their greatest number where nothing was hit

// White where it is NaN; what is above white is left to the light, lest another pixel's light be multiplied by it.
INLINE floatv known_albedo(floatv a) { return where(a < 1.0f, max(a, (floatv)(MIN_ALBEDO)), (floatv)(1.0f)); }

// Zero where any channel is NaN, infinite or beyond all that shines: clamped it would be a firefly for hundreds of frames.
INLINE Color known_color(Color c) {
    const intv good = (fabs(c.channel[0]) <= MAX_CHANNEL) & (fabs(c.channel[1]) <= MAX_CHANNEL) &
                      (fabs(c.channel[2]) <= MAX_CHANNEL);
    UNROLLED_FOR(k, 3) c.channel[k] = where(good, c.channel[k], (floatv)(0.0f));
    return c;
}

#if HAS_EMISSION
INLINE Color known_emission(const int4 size, int x, int y, __global const float *emission) {
    Color glow = known_color(load_color(size, x, y, emission));
    UNROLLED_FOR(k, 3) glow.channel[k] = max(glow.channel[k], (floatv)(0.0f));
    return glow;
}
#endif

INLINE void put_illumination(Color c, intv inside, const int4 size, __global light_t *planes) {
    UNROLLED_FOR(k, 3) c.channel[k] = where(inside, clamp(c.channel[k], 0.0f, MAX_LIGHT), (floatv)(0.0f));
    c.channel[LUMINANCE] = luminance(c.channel[0], c.channel[1], c.channel[2]);
    UNROLLED_FOR(k, 3) store_light(c.channel[k], planes + k * size.w);
}

KERNEL demodulate(const int4 size,
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
                  __global float *restrict guide, __global light_t *restrict illumination) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const intv inside = x + LANES < size.x;

    const floatv z = load_pixels(size, x, y, depth);
    const Color n = known_color(load_color(size, x, y, normal));
    const floatv length2 = n.channel[0] * n.channel[0] + n.channel[1] * n.channel[1] + n.channel[2] * n.channel[2];
    const intv hit = inside & (z > MIN_DEPTH) & (z < MAX_DEPTH) & (length2 > 1e-12f);
    const floatv to_unit = where(hit, 1.0f / sqrt(length2), (floatv)(0.0f));
    __global normal_t *unit = (__global normal_t *)(guide + NORMAL * size.w) + here;
    UNROLLED_FOR(k, 3) store_normal(where(hit, n.channel[k] * to_unit, (floatv)(0.0f)), unit + k * size.w);
    store(where(hit, z, (floatv)(0.0f)), guide + DEPTH * size.w + here);
#if HAS_ID
    store_int(load_int_pixels(size, x, y, id), (__global int *)guide + ID * size.w + here);
#endif

#if SIGNALS == 2
    Color light[2] = {known_color(load_color(size, x, y, direct)), known_color(load_color(size, x, y, indirect))};
#else
    Color light[1] = {known_color(load_color(size, x, y, color))};
#if HAS_EMISSION
    const Color glow = known_emission(size, x, y, emission);
    UNROLLED_FOR(k, 3) light[0].channel[k] -= glow.channel[k];
#endif
#endif
#if HAS_ALBEDO
    const Color reflected = load_color(size, x, y, albedo);
    UNROLLED_FOR(k, 3) {
        const floatv a = known_albedo(reflected.channel[k]);
        UNROLLED_FOR(s, SIGNALS) light[s].channel[k] /= a;
    }
#endif
    UNROLLED_FOR(s, SIGNALS) put_illumination(light[s], inside, size, illumination + 3 * s * size.w + here);
}

KERNEL modulate(const int4 size,
#if HAS_ALBEDO
                __global const float *restrict albedo,
#endif
#if HAS_EMISSION
                __global const float *restrict emission,
#endif
                __global const light_t *restrict illumination, __global float *restrict out) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    Color c;
    UNROLLED_FOR(k, 3) {
        c.channel[k] = load_light(illumination + k * size.w + here);
#if SIGNALS == 2
        c.channel[k] += load_light(illumination + (3 + k) * size.w + here);
#endif
    }
    c.channel[1] = max(green(c.channel[RED], c.channel[LUMINANCE], c.channel[BLUE]), (floatv)(0.0f));
#if HAS_ALBEDO
    const Color reflected = load_color(size, x, y, albedo);
    UNROLLED_FOR(k, 3) c.channel[k] *= known_albedo(reflected.channel[k]);
#endif
#if HAS_EMISSION
    const Color glow = known_emission(size, x, y, emission);
    UNROLLED_FOR(k, 3) c.channel[k] += glow.channel[k];
#endif
#if TAA
    UNROLLED_FOR(k, 3) store(where(x + LANES < size.x, c.channel[k], (floatv)(0.0f)), out + k * size.w + here);
#else
    store_color(c, size, x, y, out);
#endif
}
