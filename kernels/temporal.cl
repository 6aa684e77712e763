// Temporal accumulation: the running mean of illumination and of its luminance's mean and variance along motion.
//
//   p' = p + motion;  history = mean over the consistent taps of the 2x2 footprint at p', else of the 3x3 around it
//   N = N_h + 1,  a = max(1 / N, alpha),  c = c_h + a (c - c_h)
//   d = l(c) - M_h,  M = M_h + a d,  V = (1 - a) (V_h + a d^2)
//
// in   motion, guide, illumination (of this frame); guide, colour history, moments (of the previous one)
// out  accumulated: c;  moments: N, then M and V of each signal
// Schied et al. 2017, sections 4.1 and 4.2. M and V are the paper's raw moments rewritten (M = mu1, V = mu2 - mu1^2) so
// that nothing cancels for bright, steady pixels.

#define MAX_LENGTH 1024.0f
#define FAR 1e6f  // a motion out of every image, yet a safe integer

// What a tap of the previous frame is held against. The position p' is kept as a whole pixel and a fraction of motion:
// added up in float32 a fraction would lose bits to the column's number.
typedef struct {
    intv left, top;
    floatv fx, fy;
    floatv depth;      // expected at p'
    floatv tolerance;  // of depth
    Gradient gradient;
    floatv normal[3];
#if HAS_ID
    intv id;
#endif
} Expected;

typedef struct {
    Places at;
    floatv weight;
} Tap;

// Weighted mean over the taps seen so far.
typedef struct {
    floatv color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS], length, weight;
} History;

INLINE Expected expect(const int4 size, int x, int y, __global const float *motion, __global const float *guide,
                       float depth_threshold) {
    const int here = at(size, x, y);
    const intv i = interleaved(size, x, y, MOTION);
    const floatv mx = gather(motion, i), my = gather(motion, i + 1);
    intv good = isfinite(mx) & isfinite(my);
#if MOTION == 3
    const floatv mz = gather(motion, i + 2);
    good &= isfinite(mz);
#else
    const floatv mz = (floatv)(0.0f);
#endif
    const floatv depth = load(guide + DEPTH * size.w + here) + mz;
    good &= isfinite(depth);
    Expected e;
    const floatv safe_x = where(good, clamp(mx, -FAR, FAR), (floatv)(FAR));
    const floatv safe_y = where(good, clamp(my, -FAR, FAR), (floatv)(FAR));
    e.left = x + LANES + to_int(floor(safe_x));
    e.top = y + to_int(floor(safe_y));
    e.fx = safe_x - floor(safe_x);
    e.fy = safe_y - floor(safe_y);
    e.depth = depth;
    e.gradient = depth_gradient(guide + DEPTH * size.w, size.z, here);
    e.tolerance = depth_threshold * e.depth + fabs(e.gradient.x) + fabs(e.gradient.y);
    UNROLLED_FOR(k, 3) e.normal[k] = load(guide + (NORMAL + k) * size.w + here);
#if HAS_ID
    e.id = load_int((__global const int *)guide + ID * size.w + here);
#endif
    return e;
}

// The tap (dx, dy) off the top left of the footprint, its weight 0 unless it shows the expected surface. Positions outside
// the image are moved into the halo, where nothing was hit.
INLINE Tap consistent_tap(const int4 size, Expected e, intv dx, intv dy, floatv weight,
                          __global const float *previous_guide, float normal_threshold) {
    Tap tap;
    tap.at = places(at_lanes(size, clamp(e.left + dx, -1, size.x), clamp(e.top + dy, -1, size.y)));
    const floatv z = fetch(previous_guide + DEPTH * size.w, tap.at);
    const floatv expected = e.depth + e.gradient.x * (to_float(dx) - e.fx) + e.gradient.y * (to_float(dy) - e.fy);
    floatv cosine = (floatv)(0.0f);
    UNROLLED_FOR(k, 3) cosine += e.normal[k] * fetch(previous_guide + (NORMAL + k) * size.w, tap.at);
    intv same = (z > 0.0f) & (fabs(z - expected) <= e.tolerance) & (cosine >= normal_threshold);
#if HAS_ID
    same &= fetch_int((__global const int *)previous_guide + ID * size.w, tap.at) == e.id;
#endif
    tap.weight = where(same, weight, (floatv)(0.0f));
    return tap;
}

INLINE History no_history(void) {
    History h;
    h.weight = h.length = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) h.color[s][k] = (floatv)(0.0f);
        h.mean[s] = h.variance[s] = (floatv)(0.0f);
    }
    return h;
}

// Mixes in one tap. The variance of a mixture is the mean of the variances plus the spread of the means.
INLINE void add_tap(History *h, const int4 size, Tap tap, __global const float *history, __global const float *moments) {
    h->weight += tap.weight;
    const floatv share = where(h->weight > 0.0f, tap.weight / h->weight, (floatv)(0.0f));
    h->length += share * (fetch(moments + LENGTH * size.w, tap.at) - h->length);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3)
            h->color[s][k] += share * (fetch(history + (3 * s + k) * size.w, tap.at) - h->color[s][k]);
        __global const float *mean = moments + (MOMENTS + 2 * s) * size.w, *variance = mean + size.w;
        const floatv off = fetch(mean, tap.at) - h->mean[s];
        h->mean[s] += share * off;
        h->variance[s] += share * (fetch(variance, tap.at) - h->variance[s] + (1.0f - share) * off * off);
    }
}

INLINE History select_history(intv mask, History yes, History no) {
    yes.weight = where(mask, yes.weight, no.weight);
    yes.length = where(mask, yes.length, no.length);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) yes.color[s][k] = where(mask, yes.color[s][k], no.color[s][k]);
        yes.mean[s] = where(mask, yes.mean[s], no.mean[s]);
        yes.variance[s] = where(mask, yes.variance[s], no.variance[s]);
    }
    return yes;
}

__kernel void temporal(const int4 size, const float alpha_color, const float alpha_moments, const float depth_threshold,
                       const float normal_threshold, __global const float *restrict motion,
                       __global const float *restrict guide, __global const float *restrict illumination,
                       __global const float *restrict previous_guide, __global const float *restrict history,
                       __global const float *restrict previous_moments, __global float *restrict accumulated,
                       __global float *restrict moments) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Expected e = expect(size, x, y, motion, guide, depth_threshold);
    const intv hit = load(guide + DEPTH * size.w + here) > 0.0f;

    History h = no_history();
    UNROLLED_FOR(t, 4) {
        const floatv w = (t & 1 ? e.fx : 1.0f - e.fx) * (t & 2 ? e.fy : 1.0f - e.fy);
        const Tap tap = consistent_tap(size, e, (intv)(t & 1), (intv)(t >> 1), w, previous_guide, normal_threshold);
        add_tap(&h, size, tap, history, previous_moments);
    }

    const intv lost = hit & (h.weight <= 0.01f);
    if (any_lane(lost)) {  // thin geometry: look around
        const intv nx = to_int(floor(e.fx + 0.5f)), ny = to_int(floor(e.fy + 0.5f));
        History around = no_history();
        for (int t = 0; t < 9; ++t) {
            const Tap tap = consistent_tap(size, e, nx + (t % 3 - 1), ny + (t / 3 - 1), (floatv)(1.0f), previous_guide,
                                           normal_threshold);
            add_tap(&around, size, tap, history, previous_moments);
        }
        h = select_history(lost, around, h);
    }

    const intv known = hit & (h.weight > 0.01f);
    const floatv length = where(known, min(h.length + 1.0f, (floatv)(MAX_LENGTH)), where(hit, (floatv)(1.0f), (floatv)(0.0f)));
    const floatv newest = 1.0f / max(length, (floatv)(1.0f));
    const floatv a_color = max(newest, (floatv)(alpha_color)), a_moments = max(newest, (floatv)(alpha_moments));
    store(length, moments + LENGTH * size.w + here);
    UNROLLED_FOR(s, SIGNALS) {
        floatv c[3];
        UNROLLED_FOR(k, 3) {
            const int plane = (3 * s + k) * size.w;
            c[k] = load(illumination + plane + here);
            const floatv blended = h.color[s][k] + a_color * (c[k] - h.color[s][k]);
            store(where(known, blended, c[k]), accumulated + plane + here);
        }
        const floatv l = luminance(c[0], c[1], c[2]), d = l - h.mean[s];
        const floatv mean = where(known, h.mean[s] + a_moments * d, l);
        const floatv variance = where(known, (1.0f - a_moments) * (h.variance[s] + a_moments * d * d), (floatv)(0.0f));
        store(mean, moments + (MOMENTS + 2 * s) * size.w + here);
        store(variance, moments + (MOMENTS + 2 * s + 1) * size.w + here);
    }
}
