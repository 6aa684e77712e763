// First and last pass: converts the user's interleaved (H, W, C) arrays to planes and back.
//
//   demodulate   c = min(max((radiance - emission) / albedo', 0), MAX_LIGHT)
//   modulate     out = sum over signals c * albedo' + emission
//
// in   radiance of each signal; albedo, emission, id if the frame has them; normal, depth
// out  guide: normal, depth (both 0 on a miss), id, albedo (as a code);  illumination: c
// A single signal contains the emission; of two signals, neither does. With TAA `out` is a picture, otherwise the
// user's array. Texture does not go through the filter (Schied et al. 2017, section 3): modulate multiplies by albedo',
// the number of divisor.clh by which demodulate divided.

#define MAX_CHANNEL 1e10f  // of a radiance or a normal; the sun's disc has 2e9 cd/m2
#define MIN_DEPTH 1e-20f
#define MIN_NORMAL2 1e-12f  // of the square of a normal's length: any unit works, and shorter normals count as none

// Applies the macro `what` to the radiance of each signal.
#if SIGNALS == 2
#define EACH_RADIANCE(what) what(radiance_0), what(radiance_1)
#else
#define EACH_RADIANCE(what) what(radiance_0)
#endif
#define DECLARED(radiance) __global const float *restrict radiance
#define LOADED(radiance) known_color(load_color(size, x, y, radiance))

// Returns zero if any channel is NaN, infinite or too large. Clamping it instead would leave a firefly for hundreds of
// frames.
INLINE Color known_color(Color c) {
    const intv good =
        (fabs(c.channel[0]) <= MAX_CHANNEL) & (fabs(c.channel[1]) <= MAX_CHANNEL) & (fabs(c.channel[2]) <= MAX_CHANNEL);
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

// Writes light of signal `s`, as red, green and blue, into its planes.
INLINE void put_light(Color c, const int4 size, int s, int here, intv inside, __global light_t *illumination) {
    UNROLLED_FOR(k, 3) c.channel[k] = where(inside, clamp(c.channel[k], 0.0f, MAX_LIGHT), (floatv)(0.0f));
    c.channel[LIGHT_LUMINANCE] = luminance(c.channel[0], c.channel[1], c.channel[2]);
    UNROLLED_FOR(k, 3) store_light(c.channel[k], PLANE(size, illumination, ILLUMINATION_COLOR, s, k) + here);
}

KERNEL demodulate(const int4 size, EACH_RADIANCE(DECLARED),
#if HAS_ALBEDO
                  __global const float *restrict albedo,
#endif
#if EMISSION_SIGNAL >= 0
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
    const intv hit = inside & (z > MIN_DEPTH) & (z < MAX_DEPTH) & (length2 > MIN_NORMAL2);
    const floatv to_unit = where(hit, 1.0f / sqrt(length2), (floatv)(0.0f));
    __global normal_t *unit = (__global normal_t *)SHARED_PLANE(size, guide, GUIDE_NORMAL) + here;
    UNROLLED_FOR(k, 3) store_normal(where(hit, n.channel[k] * to_unit, (floatv)(0.0f)), unit + k * size.w);
    store(where(hit, z, (floatv)(0.0f)), SHARED_PLANE(size, guide, GUIDE_DEPTH) + here);
#if HAS_ID
    store_int(load_int_pixels(size, x, y, id), (__global int *)SHARED_PLANE(size, guide, GUIDE_ID) + here);
#endif

    Color light[SIGNALS] = {EACH_RADIANCE(LOADED)};
#if EMISSION_SIGNAL >= 0
    const Color glow = known_emission(size, x, y, emission);
    UNROLLED_FOR(k, 3) light[EMISSION_SIGNAL].channel[k] -= glow.channel[k];
#endif
#if HAS_ALBEDO
    const Color seen = known_albedo(size, x, y, albedo);
    store_int(albedo_code(seen.channel), (__global int *)SHARED_PLANE(size, guide, GUIDE_ALBEDO) + here);
    const Color texture = divisor(seen);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) light[s].channel[k] /= texture.channel[k];
    }
#endif
    UNROLLED_FOR(s, SIGNALS) put_light(light[s], size, s, here, inside, illumination);
}

// Light of all signals together, as red, green and blue.
INLINE Color get_light(const int4 size, int here, __global const light_t *illumination) {
    Color c;
    UNROLLED_FOR(k, 3) {
        c.channel[k] = load_light(PLANE(size, illumination, ILLUMINATION_COLOR, 0, k) + here);
        UNROLLED_FOR(s, SIGNALS - 1) {
            c.channel[k] += load_light(PLANE(size, illumination, ILLUMINATION_COLOR, s + 1, k) + here);
        }
    }
    const floatv g = green(c.channel[LIGHT_RED], c.channel[LIGHT_LUMINANCE], c.channel[LIGHT_BLUE]);
    c.channel[1] = max(g, (floatv)(0.0f));
    return c;
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
    Color c = get_light(size, here, illumination);
#if HAS_ALBEDO
    const Color texture = divisor(known_albedo(size, x, y, albedo));
    UNROLLED_FOR(k, 3) c.channel[k] *= texture.channel[k];
#endif
#if HAS_EMISSION
    const Color glow = known_emission(size, x, y, emission);
    UNROLLED_FOR(k, 3) c.channel[k] += glow.channel[k];
#endif
#if TAA
    UNROLLED_FOR(k, 3) {
        const floatv inside = where(x + LANES < size.x, c.channel[k], (floatv)(0.0f));
        store(inside, PLANE(size, out, PICTURE_COLOR, 0, k) + here);
    }
#else
    store_color(c, size, x, y, out);
#endif
}
