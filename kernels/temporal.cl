// Temporal accumulation: means of light over time, along motion, and mean and variance of its luminance.
//
//   p' = p + motion;  history = mean over the consistent taps of the 2x2 footprint at p', else of the 3x3 around it;
//   taps of another albedo count 1/64
//   N = N_h + 1,  a = max(1 / N, alpha),  c = c_h + a (c - c_h)
//   d = l(c) - M_h,  M = M_h + a d,  V = (1 - a) (V_h + a d^2)
//
// in   motion, guide, illumination (of this frame); guide, colour history, moments (of the previous one)
// out  accumulated: c;  moments: N, M, V
// Schied et al. 2017, sections 4.1 and 4.2. M and V are the paper's raw moments in another form (M = mu1, V = mu2 -
// mu1^2) that loses no digits for bright, steady pixels.

// The previous frame's light at a tap.
typedef struct {
    floatv length, color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS];
} Past;

// Weighted mean over the taps seen so far.
typedef struct {
    floatv color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS], length, weight;
} History;

// The buffers of the previous frame.
typedef struct {
    __global const float *guide;
    __global const light_t *history, *moments;
} Previous;

INLINE Past read_past(const int4 size, Places places, Previous previous) {
    Past p;
    p.length = fetch_light(SHARED_PLANE(size, previous.moments, MOMENTS_LENGTH), places);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) p.color[s][k] = fetch_light(PLANE(size, previous.history, ILLUMINATION_COLOR, s, k), places);
        p.mean[s] = fetch_light(PLANE(size, previous.moments, MOMENTS_MEAN, s, 0), places);
        p.variance[s] = fetch_variance(PLANE(size, previous.moments, MOMENTS_VARIANCE, s, 0), places);
    }
    return p;
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

// Adds one tap. The variance of a mixture is the mean of the variances plus the variance of the means.
INLINE void add_past(History *h, Past tap, floatv w) {
    h->weight += w;
    const floatv share = where(h->weight > 0.0f, w / h->weight, (floatv)(0.0f));
    h->length += share * (tap.length - h->length);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) h->color[s][k] += share * (tap.color[s][k] - h->color[s][k]);
        const floatv off = tap.mean[s] - h->mean[s];
        h->mean[s] += share * off;
        h->variance[s] += share * (tap.variance[s] - h->variance[s] + (1.0f - share) * off * off);
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

// Mean over the 2x2 footprint, with bilinear weights.
INLINE History footprint(const int4 size, Expected e, Box box, float normal_threshold, Previous previous) {
    History h = no_history();
    for (int j = 0; j < box.rows; ++j) {
        for (int i = 0; i < box.columns; ++i) {
            const Places places = beside(box.corner, i + j * size.z);
            const Seen seen = read_seen(size, places, previous.guide);
            const Past tap = read_past(size, places, previous);
            add_past(&h, tap, footprint_weight(e, seen, box, i, j, normal_threshold));
        }
    }
    return h;
}

// Mean over the nine pixels around the nearest one.
INLINE History surroundings(const int4 size, Expected e, Nine nine, float normal_threshold, Previous previous) {
    History h = no_history();
    for (int j = 0; j < nine.box.rows; ++j) {
        for (int i = 0; i < nine.box.columns; ++i) {
            const Places places = beside(nine.box.corner, i + j * size.z);
            const Seen seen = read_seen(size, places, previous.guide);
            const Past tap = read_past(size, places, previous);
            add_past(&h, tap, nine_weight(e, seen, nine, i, j, normal_threshold));
        }
    }
    return h;
}

// `accumulated` may be in the memory of `illumination`: each pixel is accessed by its own work-item only.
KERNEL temporal(const int4 size, const int4 past_size, const float alpha_color, const float alpha_moments,
                const float depth_threshold, const float normal_threshold, const float albedo_threshold,
                const int frame_number, const int past_x, const int past_y, __global const float *restrict motion,
                __global const float *restrict guide, __global const light_t *illumination,
                __global const float *restrict previous_guide, __global const light_t *restrict history,
                __global const light_t *restrict previous_moments, __global light_t *accumulated,
                __global light_t *restrict moments) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Expected e = expect(size, x, y, past_x, past_y, motion, guide, depth_threshold, albedo_threshold);
    const intv hit = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + here) > 0.0f;
    const Previous previous = {previous_guide, history, previous_moments};

    History h = no_history();
    if (frame_number > 0) {  // after a cut, the previous frame belongs to another shot
        const Box footprints = box_of(past_size, e.x, e.y, e.left, e.top, hit, 2);
        h = footprint(past_size, e, footprints, normal_threshold, previous);
    }
    const intv lost = hit & (h.weight <= ENOUGH);
    if (frame_number > 0 && any_lane(lost)) {  // thin geometry
        const Nine around = nine_around(past_size, e, lost);
        h = select_history(lost, surroundings(past_size, e, around, normal_threshold, previous), h);
    }

    const intv known = hit & (h.weight > ENOUGH);
    const floatv fresh = where(hit, (floatv)(1.0f), (floatv)(0.0f));
    const floatv frames = where(known, min(h.length + 1.0f, (floatv)(MAX_LENGTH)), fresh);
    const floatv newest = 1.0f / max(frames, (floatv)(1.0f));
    const floatv a_color = max(newest, (floatv)(alpha_color)), a_moments = max(newest, (floatv)(alpha_moments));
    store_light(frames, SHARED_PLANE(size, moments, MOMENTS_LENGTH) + here);
    UNROLLED_FOR(s, SIGNALS) {
        floatv c[3];
        UNROLLED_FOR(k, 3) {
            c[k] = load_light(PLANE(size, illumination, ILLUMINATION_COLOR, s, k) + here);
            const floatv blended = h.color[s][k] + a_color * (c[k] - h.color[s][k]);
            store_light(where(known, blended, c[k]), PLANE(size, accumulated, ILLUMINATION_COLOR, s, k) + here);
        }
        const floatv l = c[LIGHT_LUMINANCE], d = l - h.mean[s];
        const floatv mean = where(known, h.mean[s] + a_moments * d, l);
        const floatv variance = where(known, (1.0f - a_moments) * (h.variance[s] + a_moments * d * d), (floatv)(0.0f));
        store_light(mean, PLANE(size, moments, MOMENTS_MEAN, s, 0) + here);
        store_variance(variance, PLANE(size, moments, MOMENTS_VARIANCE, s, 0) + here);
    }
}
