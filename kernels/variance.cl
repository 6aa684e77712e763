// Variance of luminance: over time if the history is long enough, otherwise estimated over space.
//
//   N >= 3.5:  Var = V
//   else:    M~ = sum w M / sum w,  Var = 4 / N * sum w (V + (M - M~)^2) / sum w,  over 7x7,  w = w_z w_n w_a
//
// in   guide; moments: N, M, V
// out  illumination: its variance plane(s)
// Schied et al. 2017, section 4.2; the weights are those of the a-trous filter without luminance.

// From this length of the history on, the temporal estimate is used. With 3.5, a resampled length of 4 does not fail
// because of rounding.
#define LONG_HISTORY 4.0f
#define NEARLY_LONG 3.5f
#define REACH 3  // 7x7 taps

typedef struct {
    floatv weight, first[SIGNALS], second[SIGNALS];  // sums of w, w (M - M(p)), w (V + (M - M(p))^2)
} Moments;

INLINE void add_moments(Moments *sum, floatv w, const int4 size, int tap, const floatv *centre,
                        __global const light_t *moments) {
    sum->weight += w;
    UNROLLED_FOR(s, SIGNALS) {
        const floatv off = load_light(PLANE(size, moments, MOMENTS_MEAN, s, 0) + tap) - centre[s];
        sum->first[s] += w * off;
        sum->second[s] += w * (load_variance(PLANE(size, moments, MOMENTS_VARIANCE, s, 0) + tap) + off * off);
    }
}

// Sums over the neighbourhood, relative to the centre's own mean. The centre is one of the samples, so the variance is
// never much smaller than the shift, and the difference loses no digits.
INLINE Moments neighbourhood(const int4 size, int here, Surface surface, const floatv *centre,
                             __global const float *guide, __global const light_t *moments) {
    Moments sum;
    sum.weight = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) sum.first[s] = sum.second[s] = (floatv)(0.0f);
    ROLLED_FOR(dy, -REACH, REACH) {
        ROLLED_FOR(dx, -REACH, REACH) {
            const int tap = moved(here, dy * size.z + dx);
            floatv w = weight(surface_exponent(surface, depth_scale(surface.facet, dx, dy), 0.0f, size, tap, guide));
            // even such a small weight would matter for the square of light of 1e10
            w = where(w > FAINTEST, w, (floatv)(0.0f));
            if (dx == 0 && dy == 0) w = (floatv)(1.0f);
            add_moments(&sum, w, size, tap, centre, moments);
        }
    }
    return sum;
}

KERNEL variance(const int4 size, const float sigma_depth, const float sigma_normal, const float albedo_threshold,
                const float depth_slope_floor, __global const float *restrict guide,
                __global const light_t *restrict moments, __global light_t *restrict illumination) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const floatv frames = load_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH) + here);
    const intv brief = (frames > 0.0f) & (frames < NEARLY_LONG);
    floatv centre[SIGNALS], result[SIGNALS];
    UNROLLED_FOR(s, SIGNALS) {
        centre[s] = load_light(PLANE(size, moments, MOMENTS_MEAN, s, 0) + here);
        result[s] = load_variance(PLANE(size, moments, MOMENTS_VARIANCE, s, 0) + here);
    }
    if (any_lane(brief)) {
        const Surface surface =
            surface_at(size, here, 1.0f, sigma_depth, sigma_normal, albedo_threshold, depth_slope_floor, guide);
        const Moments sum = neighbourhood(size, here, surface, centre, guide, moments);
        const floatv boost = LONG_HISTORY / max(frames, (floatv)(1.0f));
        UNROLLED_FOR(s, SIGNALS) {
            const floatv off = sum.first[s] / sum.weight;
            const floatv spatial = max(sum.second[s] / sum.weight - off * off, (floatv)(0.0f));
            result[s] = where(brief, boost * spatial, result[s]);
        }
    }
    UNROLLED_FOR(s, SIGNALS) {
        const floatv known = where(frames > 0.0f, result[s], (floatv)(0.0f));
        store_variance(known, PLANE(size, illumination, ILLUMINATION_VARIANCE, s, 0) + here);
    }
}
