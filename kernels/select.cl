// SBF's choice: at each pixel, the scale of the bilateral filter with the least risk, smoothed over the surface.
//
//   i* = argmin sum w risk_i,  w = w_z w_n w_a over 7x7 taps;  c = c_i*
//
// in   guide;  candidate_1, ...: colour and risk of each scale
// out  target: colour
// Li et al. 2012, section 3.3: the estimated risk of a single pixel is too noisy for the choice.

#define SCALES 4
#define REACH 3  // 7x7 taps

KERNEL select_scale(const int4 size, const float sigma_depth, const float sigma_normal, const float albedo_threshold,
                    const float depth_slope_floor, __global const float *restrict guide,
                    __global const float *restrict candidate_1, __global const float *restrict candidate_2,
                    __global const float *restrict candidate_3, __global const float *restrict candidate_4,
                    __global light_t *restrict target) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    __global const float *const candidates[SCALES] = {candidate_1, candidate_2, candidate_3, candidate_4};
    const Surface surface =
        surface_at(size, here, 1.0f, sigma_depth, sigma_normal, albedo_threshold, depth_slope_floor, guide);

    floatv risk[SCALES][SIGNALS];
    UNROLLED_FOR(i, SCALES) {
        UNROLLED_FOR(s, SIGNALS) risk[i][s] = load(PLANE(size, candidates[i], CANDIDATE_RISK, s, 0) + here);
    }
    ROLLED_FOR(dy, -REACH, REACH) {
        ROLLED_FOR(dx, -REACH, REACH) {
            if (dx == 0 && dy == 0) continue;
            const int tap = moved(here, dy * size.z + dx);
            floatv w = weight(surface_exponent(surface, depth_scale(surface.facet, dx, dy), 0.0f, size, tap, guide));
            w = where(w > FAINTEST, w, (floatv)(0.0f));
            UNROLLED_FOR(i, SCALES) {
                UNROLLED_FOR(s, SIGNALS) {
                    risk[i][s] += w * load(PLANE(size, candidates[i], CANDIDATE_RISK, s, 0) + tap);
                }
            }
        }
    }
    UNROLLED_FOR(s, SIGNALS) {
        floatv color[3], least = risk[0][s];
        UNROLLED_FOR(i, SCALES) {
            const intv better = i == 0 ? (intv)(-1) : risk[i][s] < least;
            least = where(better, risk[i][s], least);
            __global const light_t *const planes =
                (__global const light_t *)SHARED_PLANE(size, candidates[i], CANDIDATE_COLOR) + here;
            UNROLLED_FOR(k, 3) {
                const floatv c = load_light(planes + (CANDIDATE_COLOR_CHANNELS * s + k) * size.w);
                color[k] = i == 0 ? c : where(better, c, color[k]);
            }
        }
        UNROLLED_FOR(k, 3) store_light(color[k], PLANE(size, target, ILLUMINATION_COLOR, s, k) + here);
    }
}
