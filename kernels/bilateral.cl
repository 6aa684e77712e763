// Cross-bilateral filter: a mean of light over a square window, weighted by distance and by similarity of surfaces.
//
//   SBF, LEARNED 0:  w = w_a exp(-D_z / (2 gamma_depth^2) - D_n / (2 gamma_normal^2)),  and for scales i = 1, 2, ...
//     c_i = sum g_i w c / sum g_i w,  g_i = exp(-|d|^2 / (2 sigma^2)) within 2 sigma,  sigma = 2^(i - 1)
//     risk_i = (l(c_i) - l(c))^2 + 2 v / sum g_i w,  v = Var s / (1 - s)
//     s = min(max(1 / max(N, 2), alpha_color / (2 - alpha_color)), MOST_OF_A_FRAME)
//   LBF, LEARNED 1:  c = sum w c / sum w,  w = w_a 2^-(p_1 |d|^2 + p_2 D_z + p_3 D_n + p_4 D_l)
//     D_l = (l - l')^2 / (sqrt(gauss3x3(Var)) + 1e-3 l + 1e-12)^2
//
// in   guide;  source: colour, variance;  SBF: moments: N;  LBF: parameters: p
// out  SBF: candidate_1, ...: colour and risk of each scale;  LBF: target: colour
// Li et al. 2012, equation 3 and section 3.2. The risk is Stein's unbiased estimate of the squared error of luminance,
// without the term -v that all scales share. The middle tap has w = 1, so its share is 1 / sum g_i w. v is the variance
// of the accumulated mean. LBF: Kalantari et al. 2015. D_z and D_n are those of features.clh.

// Sums of one signal at one scale.
typedef struct {
    floatv color[3], weight;
} Sum;

INLINE void add_tap(Sum *sum, floatv w, const floatv *color) {
    UNROLLED_FOR(k, 3) sum->color[k] += w * color[k];
    sum->weight += w;
}

// 2^e, and exactly 0 where it has levelled off or the tap is a miss.
INLINE floatv tap_weight(Distance d, floatv e) {
    const floatv w = weight(e);
    return where(d.alike & (w > FAINTEST), w, (floatv)(0.0f));
}

#if LEARNED
KERNEL bilateral(const int4 size, const float albedo_threshold, const float depth_slope_floor,
                 __global const float *restrict guide, __global const light_t *restrict source,
                 __global const float *restrict parameters, __global light_t *restrict target) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Features features = features_at(size, here, albedo_threshold, depth_slope_floor, guide);
    __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH);

    Sum sums[SIGNALS];
    floatv p[SIGNALS][PARAMETERS_EXPONENTS_CHANNELS], own[SIGNALS], sharpness[SIGNALS];
    UNROLLED_FOR(s, SIGNALS) {
        load_colors(size, s, here, source, sums[s].color);
        sums[s].weight = (floatv)(1.0f);
        own[s] = sums[s].color[LIGHT_LUMINANCE];
        const floatv noise = smooth_variance(size, here, depth, PLANE(size, source, ILLUMINATION_VARIANCE, s, 0));
        sharpness[s] = 1.0f / luminance_tolerance(1.0f, noise, own[s]);
        UNROLLED_FOR(k, PARAMETERS_EXPONENTS_CHANNELS) {
            p[s][k] = OCTAVE * load(PLANE(size, parameters, PARAMETERS_EXPONENTS, s, k) + here);
        }
    }
    ROLLED_FOR(dy, -WINDOW, WINDOW) {
        ROLLED_FOR(dx, -WINDOW, WINDOW) {
            if (dx == 0 && dy == 0) continue;
            const int tap = moved(here, dy * size.z + dx);
            const Distance d = distance_to(features, size, tap, guide);
            const float squared_distance = (float)(dx * dx + dy * dy);
            UNROLLED_FOR(s, SIGNALS) {
                floatv color[3];
                load_colors(size, s, tap, source, color);
                const floatv off = (own[s] - color[LIGHT_LUMINANCE]) * sharpness[s];
                const floatv surface = p[s][0] * squared_distance + p[s][1] * d.depth + p[s][2] * d.normal;
                add_tap(&sums[s], tap_weight(d, ONE - surface - p[s][3] * (off * off)), color);
            }
        }
    }
    UNROLLED_FOR(s, SIGNALS) {
        const floatv share = 1.0f / sums[s].weight;
        UNROLLED_FOR(k, 3) store_light(sums[s].color[k] * share, PLANE(size, target, ILLUMINATION_COLOR, s, k) + here);
    }
}
#else
#define SCALES 4
#define MOST_OF_A_FRAME 0.9f            // without accumulation, nothing is known of the variance over time
#define REACH_OF(scale) (2 << (scale))  // twice the standard deviation, in pixels

// Colour and risk of a scale.
INLINE void put_candidate(Sum sum, const int4 size, int s, int here, floatv own, floatv noise,
                          __global float *candidate) {
    const floatv share = 1.0f / sum.weight;
    __global light_t *color = (__global light_t *)SHARED_PLANE(size, candidate, CANDIDATE_COLOR) + here;
    UNROLLED_FOR(k, 3) store_light(sum.color[k] * share, color + (CANDIDATE_COLOR_CHANNELS * s + k) * size.w);
    const floatv off = sum.color[LIGHT_LUMINANCE] * share - own;
    store(off * off + 2.0f * noise * share, PLANE(size, candidate, CANDIDATE_RISK, s, 0) + here);
}

// `gaussian`: the weights of each scale along an axis, for distances of 0 to WINDOW pixels.
KERNEL bilateral(const int4 size, const float gamma_depth, const float gamma_normal, const float albedo_threshold,
                 const float depth_slope_floor, const float alpha_color, __global const float *restrict gaussian,
                 __global const float *restrict guide, __global const light_t *restrict source,
                 __global const light_t *restrict moments, __global float *restrict candidate_1,
                 __global float *restrict candidate_2, __global float *restrict candidate_3,
                 __global float *restrict candidate_4) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Features features = features_at(size, here, albedo_threshold, depth_slope_floor, guide);
    const float by_depth = 0.5f * NEPER / (gamma_depth * gamma_depth);
    const float by_normal = 0.5f * NEPER / (gamma_normal * gamma_normal);

    Sum sums[SCALES][SIGNALS];
    floatv own[SIGNALS];
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(i, SCALES) {
            load_colors(size, s, here, source, sums[i][s].color);
            sums[i][s].weight = (floatv)(1.0f);
        }
        own[s] = sums[0][s].color[LIGHT_LUMINANCE];
    }
    ROLLED_FOR(dy, -WINDOW, WINDOW) {
        const int rows = max(dy, -dy);
        ROLLED_FOR(dx, -WINDOW, WINDOW) {
            if (dx == 0 && dy == 0) continue;
            const int columns = max(dx, -dx), tap = moved(here, dy * size.z + dx);
            const Distance d = distance_to(features, size, tap, guide);
            const floatv w = tap_weight(d, ONE - by_depth * d.depth - by_normal * d.normal);
            UNROLLED_FOR(s, SIGNALS) {
                floatv color[3];
                load_colors(size, s, tap, source, color);
                UNROLLED_FOR(i, SCALES) {
                    if (max(rows, columns) <= REACH_OF(i)) {
                        const __global float *along = gaussian + i * (WINDOW + 1);
                        add_tap(&sums[i][s], along[rows] * along[columns] * w, color);
                    }
                }
            }
        }
    }
    const floatv frames = load_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH) + here);
    const floatv newest = max(1.0f / max(frames, (floatv)(2.0f)), (floatv)(alpha_color / (2.0f - alpha_color)));
    const floatv s_mean = min(newest, (floatv)(MOST_OF_A_FRAME));
    const floatv of_mean = s_mean / (1.0f - s_mean);
    UNROLLED_FOR(s, SIGNALS) {
        const floatv noise = of_mean * load_variance(PLANE(size, source, ILLUMINATION_VARIANCE, s, 0) + here);
        put_candidate(sums[0][s], size, s, here, own[s], noise, candidate_1);
        put_candidate(sums[1][s], size, s, here, own[s], noise, candidate_2);
        put_candidate(sums[2][s], size, s, here, own[s], noise, candidate_3);
        put_candidate(sums[3][s], size, s, here, own[s], noise, candidate_4);
    }
}
#endif
