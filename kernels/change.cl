// Has the light changed? This tests the new frame against the prediction, over neighbourhoods of growing size, at every
// second pixel of every second row.
//
//   pass 1 averages the 2x2 pixels to the right and below; pass i = 2, 3, 4 averages 3x3 taps 2^(i-1) pixels apart; the
//   weights w = h w_z w_n depend on geometry alone
//     d, r, e, f := mean of d, r, e, f,   u := sum w^2 u / (sum w)^2
//     from d = D, r = l(D)^2, e = E, f = E^2, u = 1 at all pixels
//   from the widest pass down to i = 2, beginning with A = B = q = 0:
//     v = min(1, C u),   t^2 = (1 - v)^2 (e - B)^2 / (max(f - e^2, (1e-3 S)^2) v),   b = max(0, 1 - threshold^2 / t^2)
//     A += b (d - A),   B += b (e - B),   q = max(q (1 - b)^2, b^2 v)
//
// in   innovation: D, E;  prediction: S;  guide: depth, normal
// out  change: d, r, e, f, u;  correction: A, B, q, and R = r - l(d)^2 of pass 2
// u is the variance of a mean divided by that of a sample. The recursion ignores that taps of later passes are
// correlated; C corrects for this.

// C for passes 2, 3 and 4, measured with white noise on a plane.
#define CORRELATED_2 1.0f
#define CORRELATED_3 1.49f
#define CORRELATED_4 2.54f

// Means of one signal.
typedef struct {
    floatv color[3], square, residual, residual_square;
} Mean;

// Sums over the taps; all signals share the weights.
typedef struct {
    floatv weight, share;
    Mean of[SIGNALS];
} Means;

INLINE Means no_means(void) {
    Means m;
    m.weight = m.share = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) m.of[s].color[k] = (floatv)(0.0f);
        m.of[s].square = m.of[s].residual = m.of[s].residual_square = (floatv)(0.0f);
    }
    return m;
}

// Converts sums to means.
INLINE Means divided(Means m) {
    const floatv scale = where(m.weight > 0.0f, 1.0f / m.weight, (floatv)(0.0f));
    m.share *= scale * scale;
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) m.of[s].color[k] *= scale;
        m.of[s].square *= scale;
        m.of[s].residual *= scale;
        m.of[s].residual_square *= scale;
    }
    return m;
}

// Every second pixel, and the pixels to the right of these.
typedef struct {
    floatv side[2];
} Pairs;

INLINE Pairs pairs_of(floatv first, floatv next) {
    Pairs pairs;
#if VW == 1
    pairs.side[0] = first;
    pairs.side[1] = next;
#else
    pairs.side[0] = (floatv)(first.even, next.even);
    pairs.side[1] = (floatv)(first.odd, next.odd);
#endif
    return pairs;
}

INLINE Pairs load_pairs(__global const float *p) { return pairs_of(load(p), load(p + VW)); }
INLINE Pairs load_normal_pairs(__global const normal_t *p) { return pairs_of(load_normal(p), load_normal(p + VW)); }

INLINE void store_means(Means m, const int4 size, int here, __global float *change) {
    store(m.share, SHARED_PLANE(size, change, CHANGE_SHARE) + here);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) store(m.of[s].color[k], PLANE(size, change, CHANGE_COLOR, s, k) + here);
        store(m.of[s].square, PLANE(size, change, CHANGE_SQUARE, s, 0) + here);
        store(m.of[s].residual, PLANE(size, change, CHANGE_RESIDUAL, s, 0) + here);
        store(m.of[s].residual_square, PLANE(size, change, CHANGE_RESIDUAL_SQUARE, s, 0) + here);
    }
}

INLINE Means load_means(const int4 size, int here, __global const float *change) {
    Means m;
    m.weight = (floatv)(1.0f);
    m.share = load(SHARED_PLANE(size, change, CHANGE_SHARE) + here);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) m.of[s].color[k] = load(PLANE(size, change, CHANGE_COLOR, s, k) + here);
        m.of[s].square = load(PLANE(size, change, CHANGE_SQUARE, s, 0) + here);
        m.of[s].residual = load(PLANE(size, change, CHANGE_RESIDUAL, s, 0) + here);
        m.of[s].residual_square = load(PLANE(size, change, CHANGE_RESIDUAL_SQUARE, s, 0) + here);
    }
    return m;
}

// The first pass: from all pixels to every second one; it also stores the surfaces of these for the later passes.
KERNEL innovation_mean(const int4 size, const int4 coarse_size, const float sigma_depth, const float sigma_normal,
                       const float depth_slope_floor, __global const float *restrict guide,
                       __global const float *restrict innovation, __global float *restrict facets,
                       __global float *restrict change) {
    const int x = first_column(), y = row();
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y), centre = at(size, 2 * x, 2 * y);
    __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH) + centre;
    const Pairs z = load_pairs(depth), left = load_pairs(depth - 2);
    const Pairs above = load_pairs(depth - size.z), below = load_pairs(depth + size.z);
    Gradient g;
    g.x = slope(left.side[1], z.side[0], z.side[1]);
    g.y = slope(above.side[0], z.side[0], below.side[0]);
    floatv normal[3];
    UNROLLED_FOR(k, 3) normal[k] = load_normal_pairs(normal_plane(size, guide, k) + centre).side[0];
    Pairs residual[SIGNALS][2];
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(dy, 2) {
            residual[s][dy] =
                load_pairs(PLANE(size, innovation, INNOVATION_RESIDUAL, s, 0) + moved(centre, dy * size.z));
        }
    }
    const intv known = (z.side[0] > 0.0f) & is_known(residual[0][0].side[0]);

    store(where(known, z.side[0], (floatv)(0.0f)), SHARED_PLANE(coarse_size, facets, FACETS_DEPTH) + here);
    store(g.x, PLANE(coarse_size, facets, FACETS_GRADIENT, 0, 0) + here);
    store(g.y, PLANE(coarse_size, facets, FACETS_GRADIENT, 0, 1) + here);
    UNROLLED_FOR(k, 3) store(normal[k], PLANE(coarse_size, facets, FACETS_NORMAL, 0, k) + here);

    const Facet facet = facet_of(z.side[0], normal, g, 1.0f, sigma_depth, sigma_normal, depth_slope_floor);
    Means sum = no_means();
    UNROLLED_FOR(dy, 2) {
        const int tap = moved(centre, dy * size.z);
        Pairs there[3];
        UNROLLED_FOR(k, 3) there[k] = load_normal_pairs(normal_plane(size, guide, k) + tap);
        floatv w[2];
        UNROLLED_FOR(dx, 2) {
            floatv n[3];
            UNROLLED_FOR(k, 3) n[k] = there[k].side[dx];
            const floatv depth_there = dy ? below.side[dx] : z.side[dx];
            w[dx] = (dx == 0 && dy == 0) ? (floatv)(1.0f)
                                         : tap_share(facet, depth_scale(facet, dx, dy), 0.0f, depth_there, n);
            w[dx] = where(known & is_known(residual[0][dy].side[dx]), w[dx], (floatv)(0.0f));
            sum.weight += w[dx];
            sum.share += w[dx] * w[dx];
        }
        UNROLLED_FOR(s, SIGNALS) {
            Mean *m = &sum.of[s];
            UNROLLED_FOR(k, 3) {
                const Pairs off = load_pairs(PLANE(size, innovation, INNOVATION_COLOR, s, k) + tap);
                UNROLLED_FOR(dx, 2) {
                    m->color[k] += w[dx] * off.side[dx];
                    if (k == LIGHT_LUMINANCE) m->square += w[dx] * off.side[dx] * off.side[dx];
                }
            }
            UNROLLED_FOR(dx, 2) {
                const floatv off = residual[s][dy].side[dx];
                m->residual += w[dx] * off;
                m->residual_square += w[dx] * off * off;
            }
        }
    }
    store_means(divided(sum), coarse_size, here, change);
}

INLINE void load_facet_normals(const int4 size, int i, __global const float *facets, floatv *normal) {
    THREE_PLANES(float, planes, size, PLANE(size, facets, FACETS_NORMAL, 0, 0));
    UNROLLED_FOR(k, 3) normal[k] = load(planes[k] + i);
}

INLINE void add_means(Means *sum, floatv w, const int4 size, int tap, __global const float *finer) {
    sum->weight += w;
    sum->share += w * w * load(SHARED_PLANE(size, finer, CHANGE_SHARE) + tap);
    UNROLLED_FOR(s, SIGNALS) {
        Mean *m = &sum->of[s];
        THREE_PLANES(float, planes, size, PLANE(size, finer, CHANGE_COLOR, s, 0));
        UNROLLED_FOR(k, 3) m->color[k] += w * load(planes[k] + tap);
        m->square += w * load(PLANE(size, finer, CHANGE_SQUARE, s, 0) + tap);
        m->residual += w * load(PLANE(size, finer, CHANGE_RESIDUAL, s, 0) + tap);
        m->residual_square += w * load(PLANE(size, finer, CHANGE_RESIDUAL_SQUARE, s, 0) + tap);
    }
}

// One of the later passes: a mean over taps that are `step` coarse pixels apart.
INLINE Means mean_over(const int4 size, int here, int step, float sigma_depth, float sigma_normal, float slope_floor,
                       __global const float *facets, __global const float *finer) {
    __global const float *depth = SHARED_PLANE(size, facets, FACETS_DEPTH);
    const floatv own = load(depth + here);
    Gradient g;
    g.x = load(PLANE(size, facets, FACETS_GRADIENT, 0, 0) + here);
    g.y = load(PLANE(size, facets, FACETS_GRADIENT, 0, 1) + here);
    floatv normal[3];
    load_facet_normals(size, here, facets, normal);
    const Facet facet = facet_of(own, normal, g, 2.0f * (float)step, sigma_depth, sigma_normal, slope_floor);
    Means sum = load_means(size, here, finer);
#pragma unroll
    for (int dy = 0; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            if (dy == 0 && dx <= 0) continue;  // skip the other half of each pair, and the centre, whose weight is 1
            const floatv scale = depth_scale(facet, dx, dy);
            const float log2_h = dx && dy ? -2.0f : -1.0f;  // of the spline (1/2, 1, 1/2) along both axes
            const int offset = step * (dy * size.z + dx);
            UNROLLED_FOR(side, 2) {
                const int tap = moved(here, side ? -offset : offset);
                floatv there[3];
                load_facet_normals(size, tap, facets, there);
                const floatv w = tap_share(facet, scale, log2_h, load(depth + tap), there);
                add_means(&sum, w, size, tap, finer);
            }
        }
    }
    sum.weight = where(own > 0.0f, sum.weight, (floatv)(0.0f));
    return divided(sum);
}

KERNEL coarser_mean(const int4 size, const int4 coarse_size, const int step, const float sigma_depth,
                    const float sigma_normal, const float depth_slope_floor, __global const float *restrict facets,
                    __global const float *restrict finer, __global float *restrict change) {
    const int x = first_column(), y = row();
    (void)size;
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y);
    const Means m = mean_over(coarse_size, here, step, sigma_depth, sigma_normal, depth_slope_floor, facets, finer);
    store_means(m, coarse_size, here, change);
}

// The correction of one signal: A, B and q.
typedef struct {
    floatv color[3], residual, doubt;
} Correction;

// Adds the part of the change that is found at a finer scale.
INLINE void add_change(Correction *c, Mean m, floatv share, floatv least, float threshold) {
    const floatv off = m.residual - c->residual;
    const floatv variance = max(m.residual_square - m.residual * m.residual, least);
    const floatv b = believed(off, variance, share, threshold);
    UNROLLED_FOR(k, 3) c->color[k] += b * (m.color[k] - c->color[k]);
    c->residual += b * off;
    c->doubt = max(c->doubt * (1.0f - b) * (1.0f - b), b * b * share);
}

INLINE floatv variance_over_space(Mean m) {
    return max(m.square - m.color[LIGHT_LUMINANCE] * m.color[LIGHT_LUMINANCE], (floatv)(0.0f));
}

// The last pass, and the test at all scales.
KERNEL detect(const int4 size, const int4 coarse_size, const int step, const float sigma_depth,
              const float sigma_normal, const float depth_slope_floor, const float change_threshold,
              __global const float *restrict prediction, __global const float *restrict near,
              __global const float *restrict facets, __global const float *restrict finer,
              __global float *restrict correction) {
    const int x = first_column(), y = row();
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y);
    const Means widest =
        mean_over(coarse_size, here, step, sigma_depth, sigma_normal, depth_slope_floor, facets, finer);
    const Means wide = load_means(coarse_size, here, finer), nearest = load_means(coarse_size, here, near);
    const floatv one = (floatv)(1.0f);
    UNROLLED_FOR(s, SIGNALS) {
        Correction c;
        UNROLLED_FOR(k, 3) c.color[k] = (floatv)(0.0f);
        c.residual = c.doubt = (floatv)(0.0f);
        const floatv tone = load_pairs(PLANE(size, prediction, PREDICTION_TONE, s, 0) + at(size, 2 * x, 2 * y)).side[0];
        const floatv least = (LEAST_SPREAD * tone) * (LEAST_SPREAD * tone);
        add_change(&c, widest.of[s], min(CORRELATED_4 * widest.share, one), least, change_threshold);
        add_change(&c, wide.of[s], min(CORRELATED_3 * wide.share, one), least, change_threshold);
        add_change(&c, nearest.of[s], min(CORRELATED_2 * nearest.share, one), least, change_threshold);
        UNROLLED_FOR(k, 3) store(c.color[k], PLANE(coarse_size, correction, CORRECTION_COLOR, s, k) + here);
        store(c.residual, PLANE(coarse_size, correction, CORRECTION_RESIDUAL, s, 0) + here);
        store(c.doubt, PLANE(coarse_size, correction, CORRECTION_DOUBT, s, 0) + here);
        store(variance_over_space(nearest.of[s]), PLANE(coarse_size, correction, CORRECTION_SPREAD, s, 0) + here);
    }
}
