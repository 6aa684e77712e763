// One level of the edge-avoiding a-trous wavelet filter; level i has step 2^i between its taps, 5x5 or 3x3 of them.
//
//   c = sum h w c / sum h w,   Var = sum h^2 w^2 Var / (sum h w)^2,   w = w_z w_n w_l
//   w_z = exp(-|z - z'| / (step (sigma_depth |grad z . d| + slope_floor z |d|)))     w_n = exp(sigma_normal (n.n' - 1))
//   w_l = exp(-|l - l'| / (sigma_luminance sqrt(gauss3x3(Var)) + 1e-3 l + 1e-12))
//
// in   guide: normal, depth;  source: colour and variance
// out  target: colour and variance
// Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010. The three terms and h share one exponential; offsets come
// in pairs +d and -d that share the scale of w_z.

// Coefficients of the spline from the middle, as exponents: B3 has 3/8, 1/4, 1/16, of which 3/8 = 1.5 / 4 lies on a straight
// line of the fast weight; the linear one has 1/2, 1/4.
#if RADIUS == 2
#define MIDDLE 0.375f
INLINE float log2_spline(int d) { return d == 0 ? (FAST ? -1.5f : -1.41503750f) : d == 1 ? -2.0f : -4.0f; }
#else
#define MIDDLE 0.5f
INLINE float log2_spline(int d) { return d == 0 ? -1.0f : -2.0f; }
#endif

typedef struct {
    Surface surface;
    floatv luminance[SIGNALS], luminance_scale[SIGNALS];
} Centre;

typedef struct {
    floatv color[SIGNALS][3], variance[SIGNALS], weight[SIGNALS];
} Sum;

// 3x3 Gaussian of the variance over hits, a miss has no variance to give.
INLINE floatv smooth_variance(const int4 size, int here, __global const float *depth, __global const light_t *variance) {
    floatv sum = (floatv)(0.0f), weight = (floatv)(1e-30f);
#pragma unroll
    for (int dy = -1; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            const int tap = here + dy * size.z + dx;
            const float gauss = (dx ? 0.25f : 0.5f) * (dy ? 0.25f : 0.5f);
            const floatv w = where(load(depth + tap) > 0.0f, (floatv)(gauss), (floatv)(0.0f));
            sum += w * load_variance(variance + tap);
            weight += w;
        }
    }
    return sum / weight;
}

// `log2_h`: of the tap's spline coefficient.
INLINE void add_tap(Sum *sum, Centre centre, floatv depth_scale, float log2_h, const int4 size, int tap,
                    __global const float *guide, __global const light_t *source) {
    const floatv e = surface_exponent(centre.surface, depth_scale, log2_h, size, tap, guide);
    UNROLLED_FOR(s, SIGNALS) {
        __global const light_t *color = source + 3 * s * size.w + tap;
        const floatv l = load_light(color + LUMINANCE * size.w);
        const floatv w = weight(e + fabs(centre.luminance[s] - l) * centre.luminance_scale[s]);
        sum->color[s][RED] += w * load_light(color + RED * size.w);
        sum->color[s][LUMINANCE] += w * l;
        sum->color[s][BLUE] += w * load_light(color + BLUE * size.w);
        sum->variance[s] += w * w * load_variance(source + (VARIANCE + s) * size.w + tap);
        sum->weight[s] += w;
    }
}

// Row of the image for this work-item: y, y + step, y + 2 step, ... in turn. What comes next then reads four of the five tap
// rows again, while they are in the cache: a third less time for the wider levels. Dolp et al. 2024 permute pixels so.
INLINE int interleaved_row(int height, int step) {
    const int rows = (height + step - 1) / step, first = row() / rows;
    return row() < rows * step ? first + (row() - first * rows) * step : height;
}

KERNEL atrous(const int4 size, const int step, const float sigma_depth, const float sigma_normal,
              const float sigma_luminance, const float depth_slope_floor, __global const float *restrict guide,
              __global const light_t *restrict source, __global light_t *restrict target) {
    const int x = first_column(), y = interleaved_row(size.y, step);
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);

    Centre centre;
    centre.surface = surface_at(size, here, (float)step, sigma_depth, sigma_normal, depth_slope_floor, guide);
    Sum sum;
    UNROLLED_FOR(s, SIGNALS) {
        __global const light_t *variance = source + (VARIANCE + s) * size.w;
        const floatv l = load_light(source + (3 * s + LUMINANCE) * size.w + here);
        const floatv deviation = sqrt(smooth_variance(size, here, guide + DEPTH * size.w, variance));
        centre.luminance[s] = l;
        centre.luminance_scale[s] = -NEPER / (sigma_luminance * deviation + 1e-3f * l + 1e-12f);
        const float h = MIDDLE * MIDDLE;
        UNROLLED_FOR(k, 3) sum.color[s][k] = h * load_light(source + (3 * s + k) * size.w + here);
        sum.variance[s] = h * h * load_variance(variance + here);
        sum.weight[s] = (floatv)(h);
    }

    // Unrolled, all rows at once take a tenth less time on PoCL; but a sixth more where there are many taps of few operations.
#if !(FAST && RADIUS == 2)
#pragma unroll
#endif
    for (int dy = 0; dy <= RADIUS; ++dy) {
#pragma unroll
        for (int dx = -RADIUS; dx <= RADIUS; ++dx) {
            if (dy == 0 && dx <= 0) continue;  // the other half of each pair, and the centre
            const floatv scale = depth_scale(centre.surface, dx, dy);
            const float log2_h = log2_spline(dx < 0 ? -dx : dx) + log2_spline(dy);
            const int offset = step * (dy * size.z + dx);
            add_tap(&sum, centre, scale, log2_h, size, here + offset, guide, source);
            add_tap(&sum, centre, scale, log2_h, size, here - offset, guide, source);
        }
    }

    UNROLLED_FOR(s, SIGNALS) {
        const floatv scale = 1.0f / sum.weight[s];
        UNROLLED_FOR(k, 3) store_light(sum.color[s][k] * scale, target + (3 * s + k) * size.w + here);
        store_variance(sum.variance[s] * scale * scale, target + (VARIANCE + s) * size.w + here);
    }
}
