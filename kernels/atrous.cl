// One level of the edge-avoiding a-trous wavelet filter. Level i = 1, 2, ... has 5x5 or 3x3 taps that are 2^(i - 1)
// pixels apart; this distance is its step.
//
//   c = sum h w c / sum h w,   w = w_z w_n w_a w_l (SVGF)  or  w_z w_n w_a w_c (EAW)
//   w_z = exp(-|z - z'| / (step (sigma_depth |grad z . d| + slope_floor z |d|)))     w_n = exp(sigma_normal (n.n' - 1))
//   w_a = 1 if the albedos differ by at most albedo_threshold octaves in every channel, else 0
//
//   GUIDED_BY_VARIANCE 1, SVGF and Kalman:  Var = sum h^2 w^2 Var / (sum h w)^2
//     w_l = exp(-|l - l'| / (sigma_luminance sqrt(gauss3x3(Var)) + 1e-3 l + 1e-12)), in Kalman l = (l + guidance) / 2
//   GUIDED_BY_VARIANCE 0, EAW:
//     w_c = exp(-|c - c'|^2 / (sigma_color / step)^2)
//
// in   guide: normal, depth, albedo;  source: colour and, except for EAW, variance;  for Kalman guidance
// out  target: the same
// Schied et al. 2017, sections 4.3 and 4.4; Dammertz et al. 2010. All terms and h share one exponential. Offsets come
// in pairs +d and -d, which share the scale of w_z.

// Coefficients of the spline from the middle, as exponents. B3 has 3/8, 1/4, 1/16, where 3/8 = 1.5 / 4 is on a straight
// line of the fast weight. The linear spline has 1/2, 1/4.
#if RADIUS == 2
#define MIDDLE 0.375f
INLINE float log2_spline(int d) { return d == 0 ? (FAST ? -1.5f : -1.41503750f) : d == 1 ? -2.0f : -4.0f; }
#else
#define MIDDLE 0.5f
INLINE float log2_spline(int d) { return d == 0 ? -1.0f : -2.0f; }
#endif

// The inputs of a level.
typedef struct {
    int4 size;
    int step;
    float sigma;  // of the tolerance of light
    __global const float *guide;
    __global const light_t *source;
#if GUIDED_BY_PAST
    __global const float *guidance;
#endif
} Level;

// How light is compared: `light_at` computes the terms of a signal at a pixel, and `light_exponent` adds the exponent
// of w_l or w_c to the exponent `e` of a tap, for the tap's light as red, luminance and blue.
#if GUIDED_BY_VARIANCE
#define SIGMA_LIGHT sigma_luminance

typedef struct {
    floatv luminance, scale;
} Light;

// The terms by which light is compared, at pixel `i`.
INLINE floatv compared(Level level, int s, floatv luminance, int i) {
#if GUIDED_BY_PAST
    return 0.5f * (luminance + load(PLANE(level.size, level.guidance, GUIDANCE_LUMINANCE, s, 0) + i));
#else
    (void)level, (void)s, (void)i;
    return luminance;
#endif
}

INLINE Light light_at(Level level, int s, int here) {
    __global const float *depth = SHARED_PLANE(level.size, level.guide, GUIDE_DEPTH);
    __global const light_t *variance = PLANE(level.size, level.source, ILLUMINATION_VARIANCE, s, 0);
    const floatv own = load_light(PLANE(level.size, level.source, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE) + here);
    const floatv l = compared(level, s, own, here);
    Light light;
    light.luminance = l;
    light.scale = -NEPER / luminance_tolerance(level.sigma, smooth_variance(level.size, here, depth, variance), l);
    return light;
}

INLINE floatv light_exponent(floatv e, Light light, const floatv *color, Level level, int s, int tap) {
    return e + fabs(light.luminance - compared(level, s, color[LIGHT_LUMINANCE], tap)) * light.scale;
}
#else
#define SIGMA_LIGHT sigma_color
// A variance without channels: loops over its channels do nothing.
#define ILLUMINATION_VARIANCE 0
#define ILLUMINATION_VARIANCE_CHANNELS 0

typedef struct {
    floatv color[3];
    float scale;
} Light;

INLINE Light light_at(Level level, int s, int here) {
    const float sharpness = (float)level.step / level.sigma;
    Light light;
    load_colors(level.size, s, here, level.source, light.color);
    light.scale = -NEPER * (sharpness * sharpness);
    return light;
}

INLINE floatv light_exponent(floatv e, Light light, const floatv *color, Level level, int s, int tap) {
    (void)level, (void)s, (void)tap;
    floatv off[3];
    UNROLLED_FOR(k, 3) off[k] = light.color[k] - color[k];
    const floatv r = off[LIGHT_RED], b = off[LIGHT_BLUE], g = green(r, off[LIGHT_LUMINANCE], b);
    return e + (r * r + g * g + b * b) * light.scale;
}
#endif

typedef struct {
    Surface surface;
    Light light[SIGNALS];
} Centre;

// Sums of one signal over the taps.
typedef struct {
    floatv color[3], variance, weight;
} Sum;

// `log2_h`: exponent of the tap's spline coefficient.
INLINE void add_light(Sum *sums, Level level, Centre centre, floatv scale, float log2_h, int tap) {
    const floatv e = surface_exponent(centre.surface, scale, log2_h, level.size, tap, level.guide);
    UNROLLED_FOR(s, SIGNALS) {
        floatv color[3];
        load_colors(level.size, s, tap, level.source, color);
        const floatv w = weight(light_exponent(e, centre.light[s], color, level, s, tap));
        UNROLLED_FOR(k, 3) sums[s].color[k] += w * color[k];
        UNROLLED_FOR(k, ILLUMINATION_VARIANCE_CHANNELS) {
            const floatv variance = load_variance(PLANE(level.size, level.source, ILLUMINATION_VARIANCE, s, k) + tap);
            sums[s].variance += w * w * variance;
        }
        sums[s].weight += w;
    }
}

// Row of the image for this work-item: y, y + step, y + 2 step, ... in turn. The next work-items then read four of the
// five tap rows again, while these are in the cache: the wider levels take a third less time. Dolp et al. 2024 permute
// pixels in the same way.
INLINE int interleaved_row(int height, int step) {
    const int rows = (height + step - 1) / step, first = row() / rows;
    return row() < rows * step ? first + (row() - first * rows) * step : height;
}

KERNEL atrous(const int4 size, const int step, const float sigma_depth, const float sigma_normal,
              const float albedo_threshold, const float depth_slope_floor, const float SIGMA_LIGHT,
              __global const float *restrict guide, __global const light_t *restrict source,
#if GUIDED_BY_PAST
              __global const float *restrict guidance,
#endif
              __global light_t *restrict target) {
    const int x = first_column(), y = interleaved_row(size.y, step);
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    Level level;
    level.size = size;
    level.step = step;
    level.sigma = SIGMA_LIGHT;
    level.guide = guide;
    level.source = source;
#if GUIDED_BY_PAST
    level.guidance = guidance;
#endif

    Centre centre;
    centre.surface =
        surface_at(size, here, (float)step, sigma_depth, sigma_normal, albedo_threshold, depth_slope_floor, guide);
    const float h = MIDDLE * MIDDLE;
    Sum sums[SIGNALS];
    UNROLLED_FOR(s, SIGNALS) {
        centre.light[s] = light_at(level, s, here);
        UNROLLED_FOR(k, 3) sums[s].color[k] = h * load_light(PLANE(size, source, ILLUMINATION_COLOR, s, k) + here);
        UNROLLED_FOR(k, ILLUMINATION_VARIANCE_CHANNELS) {
            sums[s].variance = h * h * load_variance(PLANE(size, source, ILLUMINATION_VARIANCE, s, k) + here);
        }
        sums[s].weight = (floatv)(h);
    }

    // All rows unrolled together take a tenth less time on PoCL, but a sixth more with many taps of few operations. On
    // GPUs a loop needs up to twice as many registers, for the addresses of all its taps.
#if VW == 1 || !(FAST && RADIUS == 2)
#pragma unroll
#endif
    for (int dy = 0; dy <= RADIUS; ++dy) {
#pragma unroll
        for (int dx = -RADIUS; dx <= RADIUS; ++dx) {
            if (dy == 0 && dx <= 0) continue;  // skip the other half of each pair, and the centre
            const floatv scale = depth_scale(centre.surface.facet, dx, dy);
            const float log2_h = log2_spline(dx < 0 ? -dx : dx) + log2_spline(dy);
            const int offset = step * (dy * size.z + dx);
            add_light(sums, level, centre, scale, log2_h, moved(here, offset));
            add_light(sums, level, centre, scale, log2_h, moved(here, -offset));
        }
    }

    UNROLLED_FOR(s, SIGNALS) {
        const floatv scale = 1.0f / sums[s].weight;
        UNROLLED_FOR(k, 3) store_light(sums[s].color[k] * scale, PLANE(size, target, ILLUMINATION_COLOR, s, k) + here);
        UNROLLED_FOR(k, ILLUMINATION_VARIANCE_CHANNELS) {
            store_variance(sums[s].variance * scale * scale, PLANE(size, target, ILLUMINATION_VARIANCE, s, k) + here);
        }
    }
}
