// The update of the Kalman filter: corrects the prediction by the change of light, and blends it with new light.
//
//   A, B, q, R at p: mean of the one, two or four coarse pixels around it, weighted bilinearly and by geometry; if none
//   of these is on the same surface, from the 7x7 pixels around p instead
//   q += 4 l(A)^2 / (R / (1 + min(W, 1)) + 1e-5 l(H)^2)
//   H += A,  S += B,  E -= B,  W += q,  G += l(A)
//   a = max(alpha, W / (1 + W)),  d = l(c) - l(H)
//   H += a (c - H),  S += a (phi - S),  E *= 1 - a,  V = (1 - a) (V + a d^2),  W = a^2 + (1 - a)^2 W
//   Var = W (V + W R / (1 + min(W, 1)))
//
// in   guide;  prediction, innovation;  facets, correction
// out  state: H, V, W, S, E;  expected: G (-1 where nothing is known), Var
// W is the variance of H, in units of that of a sample: about 1 / N after N samples.

#define DOUBT_OF_CHANGE 4.0f
#define RELATIVE_DOUBT 1e-5f  // as a share of light, however constant it was
#define MOST_DOUBT 1e3f       // largest W; above this, the new sample alone counts
#define ENOUGH_AROUND 1e-3f   // least sum of the weights of the coarse pixels
#define UNKNOWN (-1.0f)
#define DIRECT_REACH 3  // 7x7 taps

// The state of one signal.
typedef struct {
    floatv color[3], residual, doubt, spread;
} Correction;

typedef struct {
    floatv weight;
    Correction of[SIGNALS];
} Corrections;

INLINE Corrections no_corrections(void) {
    Corrections c;
    c.weight = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) c.of[s].color[k] = (floatv)(0.0f);
        c.of[s].residual = c.of[s].doubt = c.of[s].spread = (floatv)(0.0f);
    }
    return c;
}

// The coarse values to the left and to the right of each of this work-item's pixels; at every second pixel they are
// equal.
typedef struct {
    floatv side[2];
} Beside;

INLINE Beside load_beside(__global const float *coarse, int x) {
    Beside b;
#if VW == 1
    b.side[0] = coarse[0];
    b.side[1] = coarse[x & 1];
#else
    (void)x;
    const floatv v = load(coarse);
#if VW == 4
    b.side[0] = v.s0011;
    b.side[1] = v.s0112;
#elif VW == 8
    b.side[0] = v.s00112233;
    b.side[1] = v.s01122334;
#else
    b.side[0] = v.s0011223344556677;
    b.side[1] = v.s0112233445566778;
#endif
#endif
    return b;
}

INLINE Corrections interpolated(const int4 coarse_size, int x, int y, Facet facet, __global const float *facets,
                                __global const float *correction) {
    Corrections sum = no_corrections();
    const floatv between = to_float((x + LANES) & 1);  // where the coarse pixels to the left and to the right differ
    const float log2_h = (y & 1) ? -2.0f : -1.0f;
    for (int j = 0; j <= (y & 1); ++j) {
        const int dy = (y & 1) ? 2 * j - 1 : 0;
        const int i = at(coarse_size, x / 2, (y + dy) / 2);
        const Beside depth = load_beside(SHARED_PLANE(coarse_size, facets, FACETS_DEPTH) + i, x);
        Beside normal[3], color[SIGNALS][3], residual[SIGNALS], doubt[SIGNALS], spread[SIGNALS];
        UNROLLED_FOR(k, 3) normal[k] = load_beside(PLANE(coarse_size, facets, FACETS_NORMAL, 0, k) + i, x);
        UNROLLED_FOR(s, SIGNALS) {
            UNROLLED_FOR(k, 3) color[s][k] = load_beside(PLANE(coarse_size, correction, CORRECTION_COLOR, s, k) + i, x);
            residual[s] = load_beside(PLANE(coarse_size, correction, CORRECTION_RESIDUAL, s, 0) + i, x);
            doubt[s] = load_beside(PLANE(coarse_size, correction, CORRECTION_DOUBT, s, 0) + i, x);
            spread[s] = load_beside(PLANE(coarse_size, correction, CORRECTION_SPREAD, s, 0) + i, x);
        }
        UNROLLED_FOR(r, 2) {
            floatv there[3];
            UNROLLED_FOR(k, 3) there[k] = normal[k].side[r];
            const floatv along = facet.along_x * between * (float)(2 * r - 1) + facet.along_y * (float)dy;
            const floatv scale = -NEPER / (fabs(along) + facet.least);
            const floatv e = facet_exponent(facet, scale, log2_h, depth.side[r], there);
            const floatv w = where(depth.side[r] > 0.0f, weight(e), (floatv)(0.0f));
            sum.weight += w;
            UNROLLED_FOR(s, SIGNALS) {
                UNROLLED_FOR(k, 3) sum.of[s].color[k] += w * color[s][k].side[r];
                sum.of[s].residual += w * residual[s].side[r];
                sum.of[s].doubt += w * doubt[s].side[r];
                sum.of[s].spread += w * spread[s].side[r];
            }
        }
    }
    return sum;
}

INLINE Corrections scaled(Corrections c, floatv scale) {
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) c.of[s].color[k] *= scale;
        c.of[s].residual *= scale;
        c.of[s].doubt *= scale;
        c.of[s].spread *= scale;
    }
    return c;
}

// The test of change.cl at one scale, over the 7x7 pixels around each: for objects too thin for the coarse grid.
INLINE Corrections direct(const int4 size, int here, Facet facet, float threshold, __global const float *guide,
                          __global const float *innovation, __global const float *prediction) {
    Corrections sum = no_corrections();
    floatv squares = (floatv)(0.0f), residual_square[SIGNALS];
    UNROLLED_FOR(s, SIGNALS) residual_square[s] = (floatv)(0.0f);
    ROLLED_FOR(dy, -DIRECT_REACH, DIRECT_REACH) {
        ROLLED_FOR(dx, -DIRECT_REACH, DIRECT_REACH) {
            const int tap = moved(here, dy * size.z + dx);
            floatv normal[3];
            load_normals(size, tap, guide, normal);
            const floatv z = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + tap);
            const intv known = is_known(load(PLANE(size, innovation, INNOVATION_RESIDUAL, 0, 0) + tap));
            floatv w = tap_share(facet, depth_scale(facet, dx, dy), 0.0f, z, normal);
            w = where(known, w, (floatv)(0.0f));
            sum.weight += w;
            squares += w * w;
            UNROLLED_FOR(s, SIGNALS) {
                Correction *c = &sum.of[s];
                THREE_PLANES(float, planes, size, PLANE(size, innovation, INNOVATION_COLOR, s, 0));
                UNROLLED_FOR(k, 3) {
                    const floatv off = load(planes[k] + tap);
                    c->color[k] += w * off;
                    if (k == LIGHT_LUMINANCE) c->spread += w * off * off;
                }
                const floatv residual = load(PLANE(size, innovation, INNOVATION_RESIDUAL, s, 0) + tap);
                c->residual += w * residual;
                residual_square[s] += w * residual * residual;
            }
        }
    }
    const floatv scale = 1.0f / max(sum.weight, (floatv)(ENOUGH_AROUND));
    const floatv share = squares * scale * scale;
    UNROLLED_FOR(s, SIGNALS) {
        Correction *c = &sum.of[s];
        UNROLLED_FOR(k, 3) c->color[k] *= scale;
        c->residual *= scale;
        c->spread = max(c->spread * scale - c->color[LIGHT_LUMINANCE] * c->color[LIGHT_LUMINANCE], (floatv)(0.0f));
        const floatv least = LEAST_SPREAD * load(PLANE(size, prediction, PREDICTION_TONE, s, 0) + here);
        const floatv variance = max(residual_square[s] * scale - c->residual * c->residual, least * least);
        const floatv b = believed(c->residual, variance, share, threshold);
        UNROLLED_FOR(k, 3) c->color[k] *= b;
        c->residual *= b;
        c->doubt = b * b * share;
    }
    return sum;
}

INLINE Correction select_correction(intv mask, Correction yes, Correction no) {
    UNROLLED_FOR(k, 3) yes.color[k] = where(mask, yes.color[k], no.color[k]);
    yes.residual = where(mask, yes.residual, no.residual);
    yes.doubt = where(mask, yes.doubt, no.doubt);
    yes.spread = where(mask, yes.spread, no.spread);
    return yes;
}

KERNEL update(const int4 size, const int4 coarse_size, const float sigma_depth, const float sigma_normal,
              const float depth_slope_floor, const float change_threshold, const float alpha_color,
              __global const float *restrict guide, __global const float *restrict innovation,
              __global const float *prediction, __global const float *restrict facets,
              __global const float *restrict correction, __global light_t *state, __global float *restrict expected) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const intv hit = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + here) > 0.0f;
    const intv known = hit & is_known(load(PLANE(size, innovation, INNOVATION_RESIDUAL, 0, 0) + here));
    Corrections changed = no_corrections();
    if (any_lane(known)) {
        __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH);
        floatv normal[3];
        load_normals(size, here, guide, normal);
        const Facet facet = facet_of(load(depth + here), normal, depth_gradient(depth, size.z, here), 1.0f, sigma_depth,
                                     sigma_normal, depth_slope_floor);
        changed = interpolated(coarse_size, x, y, facet, facets, correction);
        changed = scaled(changed, 1.0f / max(changed.weight, (floatv)(ENOUGH_AROUND)));
        const intv alone = known & (changed.weight <= ENOUGH_AROUND);
        if (any_lane(alone)) {
            const Corrections own = direct(size, here, facet, change_threshold, guide, innovation, prediction);
            UNROLLED_FOR(s, SIGNALS) changed.of[s] = select_correction(alone, own.of[s], changed.of[s]);
        }
    }
    UNROLLED_FOR(s, SIGNALS) {
        const Correction c = changed.of[s];
        const floatv before = load(PLANE(size, prediction, PREDICTION_INVERSE_COUNT, s, 0) + here);
        const floatv mean = load(PLANE(size, prediction, PREDICTION_COLOR, s, LIGHT_LUMINANCE) + here);
        const floatv spread = c.spread / (1.0f + min(before, (floatv)(1.0f)));
        const floatv change = c.color[LIGHT_LUMINANCE];
        const floatv doubt =
            c.doubt + DOUBT_OF_CHANGE * change * change / (spread + RELATIVE_DOUBT * mean * mean + TINY);
        const floatv count = min(max(before, (floatv)(1.0f / MAX_LENGTH)) + doubt, (floatv)(MOST_DOUBT));
        const floatv a = where(known, max(count / (1.0f + count), (floatv)(alpha_color)), (floatv)(1.0f));
        const floatv kept = 1.0f - a;

        floatv sample[3], corrected[3];
        UNROLLED_FOR(k, 3) {
            const floatv predicted = load(PLANE(size, prediction, PREDICTION_COLOR, s, k) + here);
            const floatv innovated = predicted + load(PLANE(size, innovation, INNOVATION_COLOR, s, k) + here);
            sample[k] = max(innovated, (floatv)(0.0f));  // c, apart from the rounding of c - H
            corrected[k] = max(predicted + c.color[k], (floatv)(0.0f));
            const floatv blended = corrected[k] + a * (sample[k] - corrected[k]);
            store_light(where(known, blended, sample[k]), PLANE(size, state, ILLUMINATION_COLOR, s, k) + here);
        }
        const floatv off = sample[LIGHT_LUMINANCE] - corrected[LIGHT_LUMINANCE];
        const floatv tone = load(PLANE(size, prediction, PREDICTION_TONE, s, 0) + here) + c.residual;
        const floatv residual = load(PLANE(size, innovation, INNOVATION_RESIDUAL, s, 0) + here) - c.residual;
        const floatv spread_before = load(PLANE(size, prediction, PREDICTION_SPREAD, s, 0) + here);
        const floatv luminance_before = load(PLANE(size, prediction, PREDICTION_LUMINANCE, s, 0) + here);
        const floatv phi = sqrt(sample[LIGHT_LUMINANCE]);
        const floatv spread_now = where(known, kept * (spread_before + a * off * off), (floatv)(0.0f));
        const floatv count_now = where(known, a * a + kept * kept * count, where(hit, (floatv)(1.0f), (floatv)(0.0f)));
        const floatv variance = count_now * (spread_now + where(known, count_now * spread, (floatv)(0.0f)));
        store(variance, PLANE(size, expected, EXPECTED_VARIANCE, s, 0) + here);
        store_variance(spread_now, PLANE(size, state, ILLUMINATION_SPREAD, s, 0) + here);
        store_light(count_now, PLANE(size, state, ILLUMINATION_INVERSE_COUNT, s, 0) + here);
        store_light(where(known, tone + a * (phi - tone), phi), PLANE(size, state, ILLUMINATION_TONE, s, 0) + here);
        store_light(where(known, kept * residual, (floatv)(0.0f)),
                    PLANE(size, state, ILLUMINATION_RESIDUAL, s, 0) + here);
        const floatv guess = max(luminance_before + change, (floatv)(0.0f));
        store(where(known, guess, (floatv)(UNKNOWN)), PLANE(size, expected, EXPECTED_LUMINANCE, s, 0) + here);
    }
}
