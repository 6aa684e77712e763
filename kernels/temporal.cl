// Temporal accumulation: the running mean of illumination and of its luminance's mean and variance along motion.
//
//   p' = p + motion;  history = mean over the consistent taps of the 2x2 footprint at p', else of the 3x3 around it;
//   taps of another albedo count 1/64
//   N = N_h + 1,  a = max(1 / N, alpha),  c = c_h + a (c - c_h)
//   d = l(c) - M_h,  M = M_h + a d,  V = (1 - a) (V_h + a d^2)
//
// in   motion, guide, illumination (of this frame); guide, colour history, moments (of the previous one)
// out  accumulated: c;  moments: N, M, V
// Schied et al. 2017, sections 4.1 and 4.2. M and V are the paper's raw moments rewritten (M = mu1, V = mu2 - mu1^2) so
// that nothing cancels for bright, steady pixels.

#define FAR 1e6f           // a motion out of every image, yet a safe integer
#define NOWHERE (1 << 24)  // a position beyond every image
#define SMOOTH 4           // pixels by which motion may differ within a vector that is read as a whole
#define ENOUGH 0.01f       // sum of weights of a footprint from which it is a history
#define OTHERS 0.015625f   // how much a tap of another albedo counts: alone it is a history still, as textures flicker

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
#if HAS_ALBEDO
    AlbedoRange albedo;
#endif
} Expected;

// The previous frame at a tap.
typedef struct {
    floatv depth, normal[3], length, color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS];
#if HAS_ID
    intv id;
#endif
#if HAS_ALBEDO
    intv albedo;
#endif
} Past;

// Weighted mean over the taps seen so far.
typedef struct {
    floatv color[SIGNALS][3], mean[SIGNALS], variance[SIGNALS], length, weight;
} History;

INLINE Expected expect(const int4 size, int x, int y, __global const float *motion, __global const float *guide,
                       float depth_threshold, float albedo_threshold) {
    const int here = at(size, x, y);
    const Color m = load_motion(size, x, y, motion);
    const floatv depth = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + here) + m.channel[2];
    const intv good = isfinite(m.channel[0]) & isfinite(m.channel[1]) & isfinite(m.channel[2]);
    Expected e;
    const floatv mx = where(good, clamp(m.channel[0], -FAR, FAR), (floatv)(FAR));
    const floatv my = where(good, clamp(m.channel[1], -FAR, FAR), (floatv)(FAR));
    e.left = x + LANES + to_int(floor(mx));
    e.top = y + to_int(floor(my));
    e.fx = mx - floor(mx);
    e.fy = my - floor(my);
    e.depth = depth;
    e.gradient = depth_gradient(SHARED_PLANE(size, guide, GUIDE_DEPTH), size.z, here);
    e.tolerance = depth_threshold * e.depth + fabs(e.gradient.x) + fabs(e.gradient.y);
    UNROLLED_FOR(k, 3) e.normal[k] = load_normal(normal_plane(size, guide, k) + here);
#if HAS_ID
    e.id = load_int((__global const int *)SHARED_PLANE(size, guide, GUIDE_ID) + here);
#endif
#if HAS_ALBEDO
    e.albedo = albedo_range(load_int(albedo_plane(size, guide) + here), albedo_threshold);
#else
    (void)albedo_threshold;
#endif
    return e;
}

// Where the taps of a vector's pixels lie. Motion is smooth nearly everywhere: the footprints of neighbours fit side by
// side in a box a little larger than one of them, which is read vector by vector; lanes whose footprint a tap is not in
// ignore it. Where motion is not smooth each lane gathers from a footprint of its own.
typedef struct {
    Places corner;      // top left of the box
    intv x, y;          // top left of a lane's footprint in it
    int columns, rows;  // of the box
} Box;

// The box of footprints `extent` pixels wide and high that begin at (left, top).
INLINE Box box_of(const int4 size, int x, int y, intv left, intv top, intv hit, int extent) {
    const intv used = hit & (left >= -extent) & (left <= size.x) & (top >= -extent) & (top <= size.y);
    const intv dx = left - x - LANES, dy = top - y;
    const intv most = (intv)(NOWHERE);
    const int least_x = LEAST(select(most, dx, used)), spread_x = GREATEST(select(-most, dx, used)) - least_x;
    const int least_y = LEAST(select(most, dy, used)), spread_y = GREATEST(select(-most, dy, used)) - least_y;
    Box box;
    box.corner.adjacent = spread_x <= SMOOTH && spread_y <= SMOOTH;
    box.columns = box.rows = extent;
    box.x = box.y = (intv)(0);
    if (box.corner.adjacent) {
        box.corner.lanes = at_lanes(size, x + least_x + LANES, (intv)(y + least_y));
        box.x = dx - least_x;
        box.y = dy - least_y;
        box.columns += spread_x;
        box.rows += spread_y;
    } else {
        box.corner.lanes = at_lanes(size, within(-extent, size.x, left), within(-extent, size.y, top));
    }
    return box;
}

INLINE Past read_past(const int4 size, Places places, __global const float *guide, __global const light_t *history,
                      __global const light_t *moments) {
    Past p;
    p.depth = fetch(SHARED_PLANE(size, guide, GUIDE_DEPTH), places);
    UNROLLED_FOR(k, 3) p.normal[k] = fetch_normal(normal_plane(size, guide, k), places);
#if HAS_ID
    p.id = fetch_int((__global const int *)SHARED_PLANE(size, guide, GUIDE_ID), places);
#endif
#if HAS_ALBEDO
    p.albedo = fetch_int(albedo_plane(size, guide), places);
#endif
    p.length = fetch_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH), places);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) p.color[s][k] = fetch_light(PLANE(size, history, ILLUMINATION_COLOR, s, k), places);
        p.mean[s] = fetch_light(PLANE(size, moments, MOMENTS_MEAN, s, 0), places);
        p.variance[s] = fetch_variance(PLANE(size, moments, MOMENTS_VARIANCE, s, 0), places);
    }
    return p;
}

// Whether a tap that lies (dx, dy) off p' shows the expected surface.
INLINE intv consistent(Expected e, Past tap, floatv dx, floatv dy, float normal_threshold) {
    const floatv expected = e.depth + e.gradient.x * dx + e.gradient.y * dy;
    floatv cosine = (floatv)(0.0f);
    UNROLLED_FOR(k, 3) cosine += e.normal[k] * tap.normal[k];
    intv same = (tap.depth > 0.0f) & (fabs(tap.depth - expected) <= e.tolerance);
    same &= cosine >= normal_threshold * (UNIT * UNIT);
#if HAS_ID
    same &= tap.id == e.id;
#endif
    return same;
}

// What a tap counts that would count `most`: light is not mixed between albedos where it can be helped.
INLINE floatv tap_weight(Expected e, Past tap, floatv dx, floatv dy, float normal_threshold, floatv most) {
#if HAS_ALBEDO
    most = where(in_range(e.albedo, tap.albedo), most, OTHERS * most);
#endif
    return where(consistent(e, tap, dx, dy, normal_threshold), most, (floatv)(0.0f));
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
INLINE History footprint(const int4 size, Expected e, Box box, float normal_threshold, __global const float *guide,
                         __global const light_t *history, __global const light_t *moments) {
    History h = no_history();
    for (int j = 0; j < box.rows; ++j) {
        for (int i = 0; i < box.columns; ++i) {
            const Past tap = read_past(size, beside(box.corner, i + j * size.z), guide, history, moments);
            const floatv dx = to_float(i - box.x) - e.fx, dy = to_float(j - box.y) - e.fy;
            const floatv bilinear = max(1.0f - fabs(dx), (floatv)(0.0f)) * max(1.0f - fabs(dy), (floatv)(0.0f));
            add_past(&h, tap, tap_weight(e, tap, dx, dy, normal_threshold, bilinear));
        }
    }
    return h;
}

// Mean over the nine pixels around the nearest one, which lies (nx, ny) off the footprint's top left.
INLINE History surroundings(const int4 size, Expected e, floatv nx, floatv ny, Box box, float normal_threshold,
                            __global const float *guide, __global const light_t *history,
                            __global const light_t *moments) {
    History h = no_history();
    for (int j = 0; j < box.rows; ++j) {
        for (int i = 0; i < box.columns; ++i) {
            const Past tap = read_past(size, beside(box.corner, i + j * size.z), guide, history, moments);
            const intv across = i - box.x, down = j - box.y;
            const intv near = (across >= 0) & (across < 3) & (down >= 0) & (down < 3);
            const floatv dx = to_float(across - 1) + nx - e.fx, dy = to_float(down - 1) + ny - e.fy;
            const floatv most = where(near, (floatv)(1.0f), (floatv)(0.0f));
            add_past(&h, tap, tap_weight(e, tap, dx, dy, normal_threshold, most));
        }
    }
    return h;
}

// `accumulated` may lie where `illumination` does: a pixel of either is touched by its own work-item alone.
KERNEL temporal(const int4 size, const float alpha_color, const float alpha_moments, const float depth_threshold,
                const float normal_threshold, const float albedo_threshold, const int frame_number,
                __global const float *restrict motion, __global const float *restrict guide,
                __global const light_t *illumination, __global const float *restrict previous_guide,
                __global const light_t *restrict history, __global const light_t *restrict previous_moments,
                __global light_t *accumulated, __global light_t *restrict moments) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Expected e = expect(size, x, y, motion, guide, depth_threshold, albedo_threshold);
    const intv hit = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + here) > 0.0f;

    History h = no_history();
    if (frame_number > 0) {  // after a cut the previous frame is of another shot
        const Box footprints = box_of(size, x, y, e.left, e.top, hit, 2);
        h = footprint(size, e, footprints, normal_threshold, previous_guide, history, previous_moments);
    }
    const intv lost = hit & (h.weight <= ENOUGH);
    if (frame_number > 0 && any_lane(lost)) {  // thin geometry
        const floatv nx = floor(e.fx + 0.5f), ny = floor(e.fy + 0.5f);
        const Box around = box_of(size, x, y, e.left + to_int(nx) - 1, e.top + to_int(ny) - 1, lost, 3);
        const History nine =
            surroundings(size, e, nx, ny, around, normal_threshold, previous_guide, history, previous_moments);
        h = select_history(lost, nine, h);
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
