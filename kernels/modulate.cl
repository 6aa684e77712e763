// First and last stage: the user's interleaved (H, W, C) arrays in and out of the planar layout.
//
//   demodulate   c = min(max((radiance - emission) / albedo', 0), MAX_LIGHT)
//                albedo'_k = max(min(albedo_k, 1), 0.04 max over channels of albedo, 0.02)
//   modulate     out = sum over signals c * albedo' + emission
//   standard_error   3 sqrt(sum over signals Var) * l(albedo')
//
// in   radiance of each signal; albedo, emission, id where the frame has them; normal, depth
// out  guide: normal, depth (both 0 on a miss), id, albedo (as a code);  illumination: c
// A single signal holds the emission, of two neither does. With TAA `out` is a picture, else the user's array.
// Texture never goes through the filter (Schied et al. 2017, section 3). The floors keep light that albedo does not
// hold, as a coat reflects it, from becoming a light that is many times too bright for its neighbours: a dielectric
// reflects some 0.04 of what comes in, whatever its colour. Modulate multiplies by the number that demodulate divided
// by.

#define MIN_ALBEDO 0.02f
#define MIN_CHANNEL 0.04f  // of the greatest channel
#define MAX_CHANNEL 1e10f  // of a radiance or a normal; the sun's disc has 2e9 cd/m2
#define MIN_DEPTH 1e-20f
#define MAX_DEPTH 1e20f     // some renderers write their greatest number where nothing was hit
#define MIN_NORMAL2 1e-12f  // square of a normal's length: any unit serves, and what is shorter points nowhere

// The radiance of each signal, by what is to be done with it.
#if SIGNALS == 2
#define EACH_RADIANCE(what) what(radiance_0), what(radiance_1)
#else
#define EACH_RADIANCE(what) what(radiance_0)
#endif
#define DECLARED(radiance) __global const float *restrict radiance
#define LOADED(radiance) known_color(load_color(size, x, y, radiance))

// Zero where any channel is NaN, infinite or beyond all that shines: clamped it would be a firefly for hundreds of
// frames.
INLINE Color known_color(Color c) {
    const intv good =
        (fabs(c.channel[0]) <= MAX_CHANNEL) & (fabs(c.channel[1]) <= MAX_CHANNEL) & (fabs(c.channel[2]) <= MAX_CHANNEL);
    UNROLLED_FOR(k, 3) c.channel[k] = where(good, c.channel[k], (floatv)(0.0f));
    return c;
}

#if HAS_ALBEDO
// White where it is NaN; what is above white is left to the light, lest another pixel's light be multiplied by it.
INLINE Color known_albedo(const int4 size, int x, int y, __global const float *albedo) {
    Color a = load_color(size, x, y, albedo);
    UNROLLED_FOR(k, 3) {
        a.channel[k] = where(a.channel[k] < 1.0f, max(a.channel[k], (floatv)(0.0f)), (floatv)(1.0f));
    }
    return a;
}

// What light is divided by, and multiplied by again.
INLINE Color divisor(Color albedo) {
    const floatv greatest = max(max(albedo.channel[0], albedo.channel[1]), albedo.channel[2]);
    const floatv least = max(MIN_CHANNEL * greatest, (floatv)(MIN_ALBEDO));
    UNROLLED_FOR(k, 3) albedo.channel[k] = max(albedo.channel[k], least);
    return albedo;
}
#endif

#if HAS_EMISSION
INLINE Color known_emission(const int4 size, int x, int y, __global const float *emission) {
    Color glow = known_color(load_color(size, x, y, emission));
    UNROLLED_FOR(k, 3) glow.channel[k] = max(glow.channel[k], (floatv)(0.0f));
    return glow;
}
#endif

// Light of signal `s`, red, green and blue, into its planes.
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

// Light of all signals together, red, green and blue.
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

#ifdef CONFIDENCE_STANDARD_ERROR
// The levels take what their taps hold for independent, which it is not, and know nothing of what they blur: measured,
// the root of the variance that is left is a third of the error.
#define CALIBRATION 3.0f

KERNEL standard_error(const int4 size,
#if HAS_ALBEDO
                      __global const float *restrict albedo,
#endif
                      __global const light_t *restrict illumination, __global float *restrict confidence) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    floatv variance = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        variance += load_variance(PLANE(size, illumination, ILLUMINATION_VARIANCE, s, 0) + here);
    }
    floatv error = CALIBRATION * sqrt(variance);
#if HAS_ALBEDO
    const Color texture = divisor(known_albedo(size, x, y, albedo));
    error *= luminance(texture.channel[0], texture.channel[1], texture.channel[2]);
#endif
    const floatv inside = where(x + LANES < size.x, error, (floatv)(0.0f));
    store(inside, SHARED_PLANE(size, confidence, CONFIDENCE_STANDARD_ERROR) + here);
}
#endif
