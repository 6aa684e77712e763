// The guidance of the a-trous levels: the luminance by which they compare light, and its variance where history is
// short.
//
//   l~ = sum h w l(H) / sum h w over 3x3 taps,  w = w_z w_n
//   G := l~ where nothing was known
//   first = l~ + G - l(H)
//   Var := 1/2 of the variance of l(H) over 7x7 taps, w = w_z w_n w_a, where W > 1/2
//
// in   guide;  state: H, W;  expected: G, Var
// out  illumination (the state): Var;  first, guidance: the luminance that a level adds to that of its own light
// Level i compares (l(c_i) + G) / 2. In the first level l(c_i) is H itself, so its smoothed form is used instead.

#define SHORT_HISTORY 0.5f      // W above this means fewer than two samples
#define SHARE_OF_VARIANCE 0.5f  // the rest of the variance over space is detail
#define REACH 3                 // 7x7 taps

typedef struct {
    floatv weight, first[SIGNALS], second[SIGNALS];  // sums of w, w (l - l(p)), w (l - l(p))^2
} Moments;

INLINE Moments neighbourhood(const int4 size, int here, Surface surface, const floatv *centre,
                             __global const float *guide, __global const light_t *state) {
    Moments sum;
    sum.weight = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) sum.first[s] = sum.second[s] = (floatv)(0.0f);
    ROLLED_FOR(dy, -REACH, REACH) {
        ROLLED_FOR(dx, -REACH, REACH) {
            const int tap = moved(here, dy * size.z + dx);
            floatv w = weight(surface_exponent(surface, depth_scale(surface.facet, dx, dy), 0.0f, size, tap, guide));
            // Even such a small weight would matter for the square of light of 1e10. A miss is marked by its depth
            // alone.
            const intv seen = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + tap) > 0.0f;
            w = where(seen & (w > FAINTEST), w, (floatv)(0.0f));
            sum.weight += w;
            UNROLLED_FOR(s, SIGNALS) {
                const floatv l = load_light(PLANE(size, state, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE) + tap);
                sum.first[s] += w * (l - centre[s]);
                sum.second[s] += w * (l - centre[s]) * (l - centre[s]);
            }
        }
    }
    return sum;
}

KERNEL guidance(const int4 size, const float sigma_depth, const float sigma_normal, const float depth_slope_floor,
                const float albedo_threshold, __global const float *restrict guide, __global const float *expected,
                __global const light_t *state, __global light_t *illumination, __global float *restrict first,
                __global float *guidance) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Surface surface =
        surface_at(size, here, 1.0f, sigma_depth, sigma_normal, albedo_threshold, depth_slope_floor, guide);
    __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH);
    const intv hit = load(depth + here) > 0.0f;

    floatv own[SIGNALS], smooth[SIGNALS], total = (floatv)(1.0f);
    UNROLLED_FOR(s, SIGNALS) {
        own[s] = smooth[s] = load_light(PLANE(size, state, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE) + here);
    }
#pragma unroll
    for (int dy = 0; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            if (dy == 0 && dx <= 0) continue;  // skip the other half of each pair, and the centre, whose weight is 1
            const floatv scale = depth_scale(surface.facet, dx, dy);
            const float log2_h = dx && dy ? -2.0f : -1.0f;
            UNROLLED_FOR(side, 2) {
                const int offset = dy * size.z + dx, tap = moved(here, side ? -offset : offset);
                const floatv z = load(depth + tap);
                floatv normal[3];
                load_normals(size, tap, guide, normal);
                floatv w = weight(facet_exponent(surface.facet, scale, log2_h, z, normal));
                w = where(z > 0.0f, w, (floatv)(0.0f));
                total += w;
                UNROLLED_FOR(s, SIGNALS) {
                    smooth[s] += w * load_light(PLANE(size, state, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE) + tap);
                }
            }
        }
    }
    const floatv share = 1.0f / total;
    floatv variance[SIGNALS];
    intv brief[SIGNALS], any_brief = (intv)(0);
    UNROLLED_FOR(s, SIGNALS) {
        smooth[s] *= share;
        const floatv past = load(PLANE(size, expected, EXPECTED_LUMINANCE, s, 0) + here);
        const floatv guess = where(hit, where(past < 0.0f, smooth[s], past), (floatv)(0.0f));
        store(guess, PLANE(size, guidance, GUIDANCE_LUMINANCE, s, 0) + here);
        store(where(hit, smooth[s] + guess - own[s], (floatv)(0.0f)),
              PLANE(size, first, GUIDANCE_LUMINANCE, s, 0) + here);
        const floatv count = load_light(PLANE(size, state, ILLUMINATION_INVERSE_COUNT, s, 0) + here);
        variance[s] = load(PLANE(size, expected, EXPECTED_VARIANCE, s, 0) + here);
        brief[s] = hit & (count > SHORT_HISTORY);
        any_brief |= brief[s];
    }
    if (any_lane(any_brief)) {
        const Moments sum = neighbourhood(size, here, surface, own, guide, state);
        const floatv scale = 1.0f / max(sum.weight, (floatv)(TINY));
        UNROLLED_FOR(s, SIGNALS) {
            const floatv off = sum.first[s] * scale;
            const floatv spatial = SHARE_OF_VARIANCE * max(sum.second[s] * scale - off * off, (floatv)(0.0f));
            variance[s] = where(brief[s], spatial, variance[s]);
        }
    }
    UNROLLED_FOR(s, SIGNALS) store_variance(variance[s], PLANE(size, illumination, ILLUMINATION_VARIANCE, s, 0) + here);
}
