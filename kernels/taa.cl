// Temporal antialiasing after tone mapping, back to linear HDR at the end.
//
//   t = YCoCg(picture) / (1 + Y(picture)),  h = clamp(history at p + motion, min 3x3 t, max 3x3 t)
//   t := h + max(alpha, 1 / N) (t - h)
//
// in   motion, guide: depth, moments: N, picture: modulated colour, history (YCoCg, tone mapped)
// out  next history; out: the user's (H, W, 3) array, linear HDR
// Schied et al. 2017, section 5; Karis, High-Quality Temporal Supersampling, 2014. Tone mapping comes first so that one
// bright sample cannot outweigh its neighbours. It goes by Y, not by luminance: the clamp bounds Y, so the inverse
// cannot make a firefly of two colours.

#define NEARER 0.9999f        // of a depth: what is not nearer by so much is as near
#define LEAST_HEADROOM 1e-6f  // left of 1 below a tone: nothing brighter than 1e6 comes back
#define HALF_PIXEL 0.5f       // from a pixel's centre, which has whole coordinates, to its edge

typedef struct {
    floatv channel[3];  // Y, Co, Cg
} Tone;

// Of pixel `i` of the picture.
INLINE Tone tone_map(const int4 size, int i, __global const float *picture) {
    floatv c[3];
    UNROLLED_FOR(k, 3) c[k] = load(PLANE(size, picture, PICTURE_COLOR, 0, k) + i);
    Tone t;
    t.channel[0] = 0.25f * c[0] + 0.5f * c[1] + 0.25f * c[2];
    t.channel[1] = 0.5f * c[0] - 0.5f * c[2];
    t.channel[2] = -0.25f * c[0] + 0.5f * c[1] - 0.25f * c[2];
    const floatv scale = 1.0f / (1.0f + t.channel[0]);
    UNROLLED_FOR(k, 3) t.channel[k] *= scale;
    return t;
}

// Weights of the four taps around a fraction f; the interpolation keeps edges sharp that a bilinear one would soften
// a little more in every frame.
INLINE void catmull_rom(floatv f, floatv *w) {
    w[0] = f * (-0.5f + f * (1.0f - 0.5f * f));
    w[1] = 1.0f + f * f * (-2.5f + 1.5f * f);
    w[2] = f * (0.5f + f * (2.0f - 1.5f * f));
    w[3] = f * f * (-0.5f + 0.5f * f);
}

typedef struct {
    intv column, row;
} Position;

// The nearest surface in the 3x3 neighbourhood: a pixel beside an edge moves with the edge; with its own motion it
// would fetch, and keep, what the edge covered a frame ago. Nearly the same depth is the same: rounding shall not
// choose between the pixels of a wall.
INLINE Position foremost(const int4 size, int x, int y, __global const float *depth) {
    const int here = at(size, x, y);
    const floatv own = load(depth + here);
    floatv limit = where(own > 0.0f, NEARER * own, (floatv)(INFINITY));
    Position p;
    p.column = x + LANES;
    p.row = (intv)(y);
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const floatv z = load(depth + here + dy * size.z + dx);  // 0 outside the image
            const intv nearer = (z > 0.0f) & (z < limit);
            limit = where(nearer, NEARER * z, limit);
            p.column = select(p.column, x + dx + LANES, nearer);
            p.row = select(p.row, (intv)(y + dy), nearer);
        }
    }
    p.column = min(p.column, (intv)(size.x - 1));
    return p;
}

// The share of the newest frame in the history at these places: 1 / N, or 0 where nothing was hit.
INLINE floatv newest_share(const int4 size, intv places, __global const light_t *moments) {
#ifdef MOMENTS_LENGTH
    const floatv frames = gather_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH), places);
    return where(frames > 0.0f, 1.0f / frames, (floatv)(0.0f));
#else
    return min(gather_light(PLANE(size, moments, ILLUMINATION_INVERSE_COUNT, 0, 0), places), (floatv)(1.0f));
#endif
}

KERNEL taa(const int4 size, const float alpha_taa, __global const float *restrict motion,
           __global const float *restrict guide, __global const light_t *restrict moments,
           __global const float *restrict picture, __global const float *restrict history,
           __global float *restrict next_history, __global float *restrict out) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Position front = foremost(size, x, y, SHARED_PLANE(size, guide, GUIDE_DEPTH));
    const intv m = (front.column + front.row * size.x) * MOTION;
    const floatv mx = gather(motion, m), my = gather(motion, m + 1);
    const floatv newest = newest_share(size, at_lanes(size, front.column, front.row), moments);
    const floatv px = to_float(x + LANES) + mx, py = to_float((intv)(y)) + my;
    const float right = (float)size.x - HALF_PIXEL, bottom = (float)size.y - HALF_PIXEL;
    const intv seen = (px >= -HALF_PIXEL) & (px < right) & (py >= -HALF_PIXEL) & (py < bottom);  // false for NaN

    const Tone now = tone_map(size, here, picture);
    Tone low = now, high = now;
    for (int dy = -1; dy <= 1; ++dy) {
        if (y + dy < 0 || y + dy >= size.y) continue;
        for (int dx = -1; dx <= 1; ++dx) {
            const Tone t = tone_map(size, here + dy * size.z + dx, picture);
            const intv inside = (x + dx + LANES >= 0) & (x + dx + LANES < size.x);
            UNROLLED_FOR(k, 3) {
                low.channel[k] = where(inside, min(low.channel[k], t.channel[k]), low.channel[k]);
                high.channel[k] = where(inside, max(high.channel[k], t.channel[k]), high.channel[k]);
            }
        }
    }

    const floatv sx = where(seen, mx, (floatv)(0.0f)), sy = where(seen, my, (floatv)(0.0f));
    const intv left = x - 1 + LANES + to_int(floor(sx)), top = y - 1 + to_int(floor(sy));
    floatv wx[4], wy[4];
    catmull_rom(sx - floor(sx), wx);
    catmull_rom(sy - floor(sy), wy);
    Tone h;
    UNROLLED_FOR(k, 3) h.channel[k] = (floatv)(0.0f);
    UNROLLED_FOR(j, 4) {
        UNROLLED_FOR(i, 4) {
            const intv tx = within(0, size.x - 1, left + i), ty = within(0, size.y - 1, top + j);
            const Places tap = places_of(at_lanes(size, tx, ty));
            UNROLLED_FOR(k, 3) {
                h.channel[k] += wx[i] * wy[j] * fetch(PLANE(size, history, PICTURE_COLOR, 0, k), tap);
            }
        }
    }

    // Before the first frame the history is NaN.
    const floatv share = max((floatv)(alpha_taa), newest);
    const floatv alpha = where(seen & isfinite(h.channel[0]), share, (floatv)(1.0f));
    Tone t;
    UNROLLED_FOR(k, 3) {
        const floatv kept = clamp(h.channel[k], low.channel[k], high.channel[k]);
        t.channel[k] = where(alpha < 1.0f, kept + alpha * (now.channel[k] - kept), now.channel[k]);
        const floatv next = where(x + LANES < size.x, t.channel[k], (floatv)(0.0f));
        store(next, PLANE(size, next_history, PICTURE_COLOR, 0, k) + here);
    }
    const floatv base = t.channel[0] - t.channel[2];
    const floatv rgb[3] = {base + t.channel[1], t.channel[0] + t.channel[2], base - t.channel[1]};
    const floatv scale = 1.0f / max(1.0f - t.channel[0], (floatv)(LEAST_HEADROOM));
    Color c;
    UNROLLED_FOR(k, 3) c.channel[k] = max(rgb[k] * scale, (floatv)(0.0f));
    store_color(c, size, x, y, out);
}
