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
#define NOWHERE -1e6f  // a position outside every image, yet a safe integer

// What a tap of the previous frame is held against.
typedef struct {
    floatv x, y;       // p'
    floatv depth;      // expected at p'
    floatv tolerance;  // of depth
    Gradient gradient;
    floatv normal[3];
#if HAS_ID
    intv id;
#endif
} Expected;

typedef struct {
    intv index;
    floatv weight;
} Tap;

typedef struct {
    floatv color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS], length, weight;
} History;

inline Expected expect(const int4 size, int x, int y, __global const float *motion, __global const float *guide,
                       float depth_threshold) {
    const int here = at(size, x, y);
    const intv i = interleaved(size, x, y, MOTION);
    floatv mx = gather(motion, i), my = gather(motion, i + 1);
    intv good = isfinite(mx) & isfinite(my);
#if MOTION == 3
    floatv mz = gather(motion, i + 2);
    good &= isfinite(mz);
#else
    const floatv mz = (floatv)(0.0f);
#endif
    Expected e;
    e.x = where(good, clamp(to_float(x + LANES) + mx, NOWHERE, -NOWHERE), (floatv)(NOWHERE));
    e.y = where(good, clamp(to_float((intv)(y)) + my, NOWHERE, -NOWHERE), (floatv)(NOWHERE));
    e.depth = load(guide + DEPTH * size.w + here) + mz;
    e.gradient = depth_gradient(guide + DEPTH * size.w, size.z, here);
    e.tolerance = depth_threshold * e.depth + fabs(e.gradient.x) + fabs(e.gradient.y);
    for (int k = 0; k < 3; ++k) e.normal[k] = load(guide + (NORMAL + k) * size.w + here);
#if HAS_ID
    e.id = load_int((__global const int *)guide + ID * size.w + here);
#endif
    return e;
}

// The tap at integer position (x, y), its weight 0 unless it shows the expected surface. Positions outside the image are
// moved into the halo, where nothing was hit.
inline Tap consistent_tap(const int4 size, Expected e, intv x, intv y, floatv weight, __global const float *previous_guide,
                          float normal_threshold) {
    Tap tap;
    tap.index = at_lanes(size, clamp(x, -1, size.x), clamp(y, -1, size.y));
    const floatv z = gather(previous_guide + DEPTH * size.w, tap.index);
    const floatv expected = e.depth + e.gradient.x * (to_float(x) - e.x) + e.gradient.y * (to_float(y) - e.y);
    floatv cosine = (floatv)(0.0f);
    for (int k = 0; k < 3; ++k) cosine += e.normal[k] * gather(previous_guide + (NORMAL + k) * size.w, tap.index);
    intv same = (z > 0.0f) & (fabs(z - expected) <= e.tolerance) & (cosine >= normal_threshold);
#if HAS_ID
    same &= gather_int((__global const int *)previous_guide + ID * size.w, tap.index) == e.id;
#endif
    tap.weight = where(same, weight, (floatv)(0.0f));
    return tap;
}

// Weighted mean over the taps; V of a mixture is the mean of V plus the spread of M. Zero where no tap counts.
inline History mean_of(const int4 size, const Tap *taps, int count, __global const float *history,
                       __global const float *moments) {
    History h;
    h.weight = (floatv)(0.0f);
    for (int t = 0; t < count; ++t) h.weight += taps[t].weight;
    const floatv scale = where(h.weight > 0.0f, 1.0f / h.weight, (floatv)(0.0f));
    h.length = (floatv)(0.0f);
    for (int t = 0; t < count; ++t)
        h.length += taps[t].weight * scale * gather(moments + LENGTH * size.w, taps[t].index);
    for (int s = 0; s < SIGNALS; ++s) {
        __global const float *mean = moments + (MOMENTS + 2 * s) * size.w, *variance = mean + size.w;
        h.mean[s] = h.variance[s] = (floatv)(0.0f);
        for (int k = 0; k < 3; ++k) h.color[s][k] = (floatv)(0.0f);
        for (int t = 0; t < count; ++t) {
            const floatv w = taps[t].weight * scale;
            for (int k = 0; k < 3; ++k) h.color[s][k] += w * gather(history + (3 * s + k) * size.w, taps[t].index);
            h.mean[s] += w * gather(mean, taps[t].index);
        }
        for (int t = 0; t < count; ++t) {
            const floatv off = gather(mean, taps[t].index) - h.mean[s];
            h.variance[s] += taps[t].weight * scale * (gather(variance, taps[t].index) + off * off);
        }
    }
    return h;
}

inline History select_history(intv mask, History yes, History no) {
    yes.weight = where(mask, yes.weight, no.weight);
    yes.length = where(mask, yes.length, no.length);
    for (int s = 0; s < SIGNALS; ++s) {
        for (int k = 0; k < 3; ++k) yes.color[s][k] = where(mask, yes.color[s][k], no.color[s][k]);
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
    if (x >= size.x) return;
    const int here = at(size, x, y);
    const Expected e = expect(size, x, y, motion, guide, depth_threshold);
    const intv hit = load(guide + DEPTH * size.w + here) > 0.0f;

    const floatv left = floor(e.x), top = floor(e.y);
    const floatv fx = e.x - left, fy = e.y - top;
    Tap bilinear[4];
    for (int t = 0; t < 4; ++t) {
        const floatv w = (t & 1 ? fx : 1.0f - fx) * (t & 2 ? fy : 1.0f - fy);
        bilinear[t] = consistent_tap(size, e, to_int(left) + (t & 1), to_int(top) + (t >> 1), w, previous_guide,
                                     normal_threshold);
    }
    History h = mean_of(size, bilinear, 4, history, previous_moments);

    const intv lost = hit & (h.weight <= 0.01f);
    if (any_lane(lost)) {  // thin geometry: look around
        const intv nx = to_int(floor(e.x + 0.5f)), ny = to_int(floor(e.y + 0.5f));
        Tap around[9];
        for (int t = 0; t < 9; ++t)
            around[t] = consistent_tap(size, e, nx + (t % 3 - 1), ny + (t / 3 - 1), (floatv)(1.0f), previous_guide,
                                       normal_threshold);
        h = select_history(lost, mean_of(size, around, 9, history, previous_moments), h);
    }

    const intv known = hit & (h.weight > 0.01f);
    const floatv length = where(known, min(h.length + 1.0f, (floatv)(MAX_LENGTH)), where(hit, (floatv)(1.0f), (floatv)(0.0f)));
    const floatv newest = 1.0f / max(length, (floatv)(1.0f));
    const floatv a_color = max(newest, (floatv)(alpha_color)), a_moments = max(newest, (floatv)(alpha_moments));
    store(length, moments + LENGTH * size.w + here);
    for (int s = 0; s < SIGNALS; ++s) {
        floatv c[3];
        for (int k = 0; k < 3; ++k) {
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
