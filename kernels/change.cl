// Has the light changed? A test of the new frame against the prediction, over neighbourhoods of growing size, at every
// second pixel of every second row.
//
//   pass i = 1, 2, 3, 4 has 3x3 taps 2^(i-1) pixels apart, with weights w = h w_z w_n of geometry alone
//     d, r, e, f := mean of d, r, e, f,   u := sum w^2 u / (sum w)^2
//     from d = D, r = l(D)^2, e = E, f = E^2 + (1e-3 S)^2, u = 1 at all pixels
//   from the widest pass down to i = 2, beginning with A = B = q = 0:
//     t^2 = (e - B)^2 / ((f - e^2) min(1, C u)),   b = max(0, 1 - threshold^2 / t^2)
//     A += b (d - A),   B += b (e - B),   q = max(q (1 - b)^2, b^2 min(1, C u))
//
// in   innovation: depth, D, E;  prediction: S;  guide: depth, normal
// out  change: d, r, e, f, u;  correction: A, B, q, and R = r - l(d)^2 of pass 2
// u is how much smaller the variance of a mean is than that of a sample. The recursion does not know that taps of later
// passes are correlated: C makes up for it.

#define LEAST_SPREAD 1e-3f  // of E, relative to S: where there is no noise, a difference counts from here on

// What C is for passes 2, 3 and 4, measured on white noise on a plane.
#define CORRELATED_2 1.49f
#define CORRELATED_3 2.54f
#define CORRELATED_4 4.46f

// Of one signal.
typedef struct {
    floatv color[3], square, residual, residual_square;
} Mean;

// Over the taps, those of all signals with the same weight.
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

// Sums to means.
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

// log2 of the spline (1/4, 1/2, 1/4) in both directions.
INLINE float log2_spline(int dx, int dy) { return -2.0f - (float)(dx != 0) - (float)(dy != 0); }

// Where the exponential has levelled off nothing is left: even so faint, the square of light of 1e10 would show.
INLINE floatv tap_share(Facet f, int dx, int dy, floatv z, const floatv *normal) {
    const floatv w = weight(facet_exponent(f, depth_scale(f, dx, dy), log2_spline(dx, dy), z, normal));
    return where((z > 0.0f) & (w > FAINTEST), w, (floatv)(0.0f));
}

// Of every second pixel.
INLINE floatv load_second(__global const float *p) {
#if VW == 1
    return *p;
#else
    const floatv first = load(p), next = load(p + VW);
    return (floatv)(first.even, next.even);
#endif
}
INLINE floatv load_second_normal(__global const normal_t *p) {
#if VW == 1
    return load_normal(p);
#else
    const floatv first = load_normal(p), next = load_normal(p + VW);
    return (floatv)(first.even, next.even);
#endif
}

INLINE void add_innovation(Means *sum, floatv w, const int4 size, int tap, __global const float *innovation,
                           __global const float *prediction) {
    sum->weight += w;
    sum->share += w * w;
    UNROLLED_FOR(s, SIGNALS) {
        Mean *m = &sum->of[s];
        UNROLLED_FOR(k, 3) {
            const floatv off = load_second(PLANE(size, innovation, INNOVATION_COLOR, s, k) + tap);
            m->color[k] += w * off;
            if (k == LIGHT_LUMINANCE) m->square += w * off * off;
        }
        const floatv residual = load_second(PLANE(size, innovation, INNOVATION_RESIDUAL, s, 0) + tap);
        const floatv least = LEAST_SPREAD * load_second(PLANE(size, prediction, PREDICTION_TONE, s, 0) + tap);
        m->residual += w * residual;
        m->residual_square += w * (residual * residual + least * least);
    }
}

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

// The first pass: from all pixels to every second one, whose surface it keeps for the others.
KERNEL innovation_mean(const int4 size, const int4 coarse_size, const float sigma_depth, const float sigma_normal,
                       const float depth_slope_floor, __global const float *restrict guide,
                       __global const float *restrict innovation, __global const float *restrict prediction,
                       __global float *restrict facets, __global float *restrict change) {
    const int x = first_column(), y = row();
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y), centre = at(size, 2 * x, 2 * y);
    __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH) + centre;
    __global const float *known = SHARED_PLANE(size, innovation, INNOVATION_DEPTH) + centre;
    const floatv z = load_second(depth), own = load_second(known);
    Gradient g;
    g.x = slope(load_second(depth - 1), z, load_second(depth + 1));
    g.y = slope(load_second(depth - size.z), z, load_second(depth + size.z));
    floatv normal[3];
    UNROLLED_FOR(k, 3) normal[k] = load_second_normal(normal_plane(size, guide, k) + centre);

    store(own, SHARED_PLANE(coarse_size, facets, FACETS_DEPTH) + here);
    store(g.x, PLANE(coarse_size, facets, FACETS_GRADIENT, 0, 0) + here);
    store(g.y, PLANE(coarse_size, facets, FACETS_GRADIENT, 0, 1) + here);
    UNROLLED_FOR(k, 3) store(normal[k], PLANE(coarse_size, facets, FACETS_NORMAL, 0, k) + here);

    const Facet facet = facet_of(z, normal, g, 1.0f, sigma_depth, sigma_normal, depth_slope_floor);
    Means sum = no_means();
    for (int dy = -1; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            const int offset = dy * size.z + dx;
            floatv there[3];
            UNROLLED_FOR(k, 3) there[k] = load_second_normal(normal_plane(size, guide, k) + centre + offset);
            const floatv w = tap_share(facet, dx, dy, load_second(known + offset), there);
            add_innovation(&sum, where(own > 0.0f, w, (floatv)(0.0f)), size, centre + offset, innovation, prediction);
        }
    }
    store_means(divided(sum), coarse_size, here, change);
}

INLINE void load_facet_normals(const int4 size, int i, __global const float *facets, floatv *normal) {
    UNROLLED_FOR(k, 3) normal[k] = load(PLANE(size, facets, FACETS_NORMAL, 0, k) + i);
}

// One of the later passes: mean over taps `step` of these pixels apart.
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
    Means sum = no_means();
    for (int dy = -1; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            const int tap = here + step * (dy * size.z + dx);
            floatv there[3];
            load_facet_normals(size, tap, facets, there);
            floatv w = tap_share(facet, dx, dy, load(depth + tap), there);
            w = where(own > 0.0f, w, (floatv)(0.0f));
            sum.weight += w;
            sum.share += w * w * load(SHARED_PLANE(size, finer, CHANGE_SHARE) + tap);
            UNROLLED_FOR(s, SIGNALS) {
                Mean *m = &sum.of[s];
                UNROLLED_FOR(k, 3) m->color[k] += w * load(PLANE(size, finer, CHANGE_COLOR, s, k) + tap);
                m->square += w * load(PLANE(size, finer, CHANGE_SQUARE, s, 0) + tap);
                m->residual += w * load(PLANE(size, finer, CHANGE_RESIDUAL, s, 0) + tap);
                m->residual_square += w * load(PLANE(size, finer, CHANGE_RESIDUAL_SQUARE, s, 0) + tap);
            }
        }
    }
    return divided(sum);
}

KERNEL coarser_mean(const int4 size, const int4 coarse_size, const int step, const float sigma_depth,
                    const float sigma_normal, const float depth_slope_floor, __global const float *restrict facets,
                    __global const float *restrict finer, __global float *restrict change) {
    const int x = first_column(), y = row();
    (void)size;
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y);
    const Means m =
        mean_over(coarse_size, here, step, sigma_depth, sigma_normal, depth_slope_floor, facets, finer);
    store_means(m, coarse_size, here, change);
}

// Of one signal: A, B and q.
typedef struct {
    floatv color[3], residual, doubt;
} Correction;

// Takes up what is left of the change at a finer scale.
INLINE void add_change(Correction *c, Mean m, floatv share, float threshold) {
    const floatv off = m.residual - c->residual;
    const floatv noise = max(m.residual_square - m.residual * m.residual, (floatv)(0.0f)) * share;
    const floatv significance = off * off / max(noise, (floatv)(TINY));
    const floatv b = max(1.0f - threshold * threshold / max(significance, (floatv)(TINY)), (floatv)(0.0f));
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
                  __global const float *restrict facets, __global const float *restrict change_2,
                  __global const float *restrict change_3, __global float *restrict correction) {
    const int x = first_column(), y = row();
    (void)size;
    if (x >= coarse_size.x || y >= coarse_size.y) return;
    const int here = at(coarse_size, x, y);
    const Means widest =
        mean_over(coarse_size, here, step, sigma_depth, sigma_normal, depth_slope_floor, facets, change_3);
    const Means wide = load_means(coarse_size, here, change_3), near = load_means(coarse_size, here, change_2);
    const floatv one = (floatv)(1.0f);
    UNROLLED_FOR(s, SIGNALS) {
        Correction c;
        UNROLLED_FOR(k, 3) c.color[k] = (floatv)(0.0f);
        c.residual = c.doubt = (floatv)(0.0f);
        add_change(&c, widest.of[s], min(CORRELATED_4 * widest.share, one), change_threshold);
        add_change(&c, wide.of[s], min(CORRELATED_3 * wide.share, one), change_threshold);
        add_change(&c, near.of[s], min(CORRELATED_2 * near.share, one), change_threshold);
        UNROLLED_FOR(k, 3) store(c.color[k], PLANE(coarse_size, correction, CORRECTION_COLOR, s, k) + here);
        store(c.residual, PLANE(coarse_size, correction, CORRECTION_RESIDUAL, s, 0) + here);
        store(c.doubt, PLANE(coarse_size, correction, CORRECTION_DOUBT, s, 0) + here);
        store(variance_over_space(near.of[s]), PLANE(coarse_size, correction, CORRECTION_SPREAD, s, 0) + here);
    }
}
