// Temporal antialiasing in linear light.
//
//   c = YCoCg(picture);  n = sum over 3x3 of k(dx) k(dy) c,  k = (f, 1 - 2 f, f), f = pixel_filter
//   h = clamp(history at p + motion, min 3x3 c, max 3x3 c)
//   t = h + max(alpha, 1 / N) (n - h)
//
// in   motion, guide: depth, moments: N, picture: modulated colour, history (YCoCg)
// out  next history: t; out: the user's (H, W, 3) array, RGB(t)
// Schied et al. 2017, section 5; Karis, High-Quality Temporal Supersampling, 2014, but without a tone map: a mean of
// tone-mapped samples is darker than the tone-mapped mean.

#define NEARER 0.9999f     // of a depth: what is not nearer by so much is as near
#define HALF_PIXEL 0.5f    // from a pixel's centre, which has whole coordinates, to its edge
#define KNOWN (-1e20f)     // below any Y that light makes; history is below it before the first frame
#define LEAST_INSIDE 0.4f  // of a footprint's weight along an axis; a history's is at least a half
#define TAPS 4             // of Catmull and Rom's spline along an axis

typedef struct {
    floatv channel[3];  // Y, Co, Cg
} Tone;

// Of a picture.
INLINE Tone to_ycocg(const int4 size, Places places, __global const float *picture) {
    const floatv r = fetch(PLANE(size, picture, PICTURE_COLOR, 0, 0), places);
    const floatv g = 0.5f * fetch(PLANE(size, picture, PICTURE_COLOR, 0, 1), places);
    const floatv b = fetch(PLANE(size, picture, PICTURE_COLOR, 0, 2), places);
    const floatv rest = 0.25f * (r + b);
    Tone t;
    t.channel[0] = g + rest;
    t.channel[1] = 0.5f * (r - b);
    t.channel[2] = g - rest;
    return t;
}

// Motion, and the newest frame's share in the history: 1 / N, or 0 where nothing was hit.
typedef struct {
    floatv x, y, newest;
} Past;

INLINE floatv newest_share(const int4 size, Places places, __global const light_t *moments) {
#ifdef MOMENTS_LENGTH
    const floatv frames = fetch_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH), places);
    return where(frames > 0.0f, 1.0f / frames, (floatv)(0.0f));
#else
    return min(fetch_light(PLANE(size, moments, ILLUMINATION_INVERSE_COUNT, 0, 0), places), (floatv)(1.0f));
#endif
}

// Of the nearest surface in the 3x3 neighbourhood: a pixel beside an edge moves with the edge; with its own motion it
// would fetch, and keep, what the edge covered a frame ago. Nearly the same depth is the same: rounding shall not
// choose between the pixels of a wall.
INLINE Past past_of_foremost(const int4 size, int x, int y, __global const float *depth,
                             __global const float *motion, __global const light_t *moments) {
    const int here = at(size, x, y);
    const floatv own = load(depth + here);
    floatv limit = where(own > 0.0f, NEARER * own, (floatv)(INFINITY));
    intv column = x + LANES, row = (intv)(y);
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const floatv z = load(depth + here + dy * size.z + dx);  // 0 outside the image
            const intv nearer = (z > 0.0f) & (z < limit);
            limit = where(nearer, NEARER * z, limit);
            column = select(column, x + dx + LANES, nearer);
            row = select(row, (intv)(y + dy), nearer);
        }
    }
    column = min(column, (intv)(size.x - 1));
    const Places front = places_of(at_lanes(size, column, row));
    Past past;
    past.newest = newest_share(size, front, moments);
    if (front.adjacent) {
        const Color m = load_motion(size, FIRST(column), FIRST(row), motion);
        past.x = m.channel[0];
        past.y = m.channel[1];
    } else {
        const intv m = (column + row * size.x) * MOTION;
        past.x = gather(motion, m);
        past.y = gather(motion, m + 1);
    }
    return past;
}

// Weight at a distance from a tap; this interpolation keeps edges sharp that a bilinear one would soften a little more
// in every frame.
INLINE floatv catmull_rom(floatv distance) {
    const floatv d = min(fabs(distance), (floatv)(2.0f));
    return (d - 1.0f) * where(d < 1.0f, d * (1.5f * d - 1.0f) - 1.0f, -0.5f * (d - 2.0f) * (d - 2.0f));
}

// Weights of the taps at `first` + 0, 1, ... along an axis for `position` there; 0 outside the image.
// Of history, at (mx, my) from the pixels.
INLINE Tone read_history(const int4 size, int x, int y, intv seen, floatv mx, floatv my,
                         __global const float *history) {
    const floatv whole_x = floor(mx), whole_y = floor(my);
    const floatv fx = mx - whole_x, fy = my - whole_y;
    // Whole pixels need one tap.
    const int extent = any_lane((fx > 0.0f) | (fy > 0.0f)) ? TAPS : 1, before = extent > 1;
    const intv left = x + LANES + to_int(whole_x) - before, top = y + to_int(whole_y) - before;
    const Box box = box_of(size, x, y, left, top, seen, extent);
    const floatv at_x = fx + to_float(box.x + before), at_y = fy + to_float(box.y + before);
    const intv column = left - box.x, row = top - box.y;

    floatv across[TAPS + SMOOTH], total_x = (floatv)(0.0f), total_y = (floatv)(0.0f);
    for (int i = 0; i < box.columns; ++i) {
        const intv inside = (column + i >= 0) & (column + i < size.x);
        across[i] = where(inside, catmull_rom((float)i - at_x), (floatv)(0.0f));
        total_x += across[i];
    }
    Tone h;
    UNROLLED_FOR(k, 3) h.channel[k] = (floatv)(0.0f);
    for (int j = 0; j < box.rows; ++j) {
        const intv inside = (row + j >= 0) & (row + j < size.y);
        const floatv down = where(inside, catmull_rom((float)j - at_y), (floatv)(0.0f));
        total_y += down;
        floatv sum[3];
        UNROLLED_FOR(k, 3) sum[k] = (floatv)(0.0f);
        for (int i = 0; i < box.columns; ++i) {
            const Places tap = beside(box.corner, i + j * size.z);
            UNROLLED_FOR(k, 3) sum[k] += across[i] * fetch(PLANE(size, history, PICTURE_COLOR, 0, k), tap);
        }
        UNROLLED_FOR(k, 3) h.channel[k] += down * sum[k];
    }
    const floatv scale = 1.0f / (max(total_x, (floatv)(LEAST_INSIDE)) * max(total_y, (floatv)(LEAST_INSIDE)));
    UNROLLED_FOR(k, 3) h.channel[k] *= scale;
    return h;
}

// What the 3x3 neighbourhood holds: its extent, and its mean with the pixel filter's weights.
typedef struct {
    Tone low, high, mean;
} Around;

INLINE Around look_around(const int4 size, int x, int y, float pixel_filter, __global const float *picture) {
    Places column[3];
    floatv across[3];
    floatv total = (floatv)(0.0f);
    UNROLLED_FOR(i, 3) {
        const intv wanted = x + i - 1 + LANES, found = within(0, size.x - 1, wanted);
        column[i] = places_of(found);
        across[i] = where(wanted == found, (floatv)(i == 1 ? 1.0f - 2.0f * pixel_filter : pixel_filter), (floatv)(0.0f));
        total += across[i];
    }
    Around a;
    float total_y = 0.0f;
    UNROLLED_FOR(j, 3) {
        const int found = clamp(y + j - 1, 0, size.y - 1);
        const float down = found != y + j - 1 ? 0.0f : j == 1 ? 1.0f - 2.0f * pixel_filter : pixel_filter;
        total_y += down;
        UNROLLED_FOR(i, 3) {
            const Tone t = to_ycocg(size, beside(column[i], at(size, 0, found)), picture);
            const floatv w = down * across[i];
            UNROLLED_FOR(k, 3) {
                a.low.channel[k] = i + j > 0 ? min(a.low.channel[k], t.channel[k]) : t.channel[k];
                a.high.channel[k] = i + j > 0 ? max(a.high.channel[k], t.channel[k]) : t.channel[k];
                a.mean.channel[k] = i + j > 0 ? a.mean.channel[k] + w * t.channel[k] : w * t.channel[k];
            }
        }
    }
    const floatv scale = 1.0f / (total * total_y);
    UNROLLED_FOR(k, 3) a.mean.channel[k] *= scale;
    return a;
}

KERNEL taa(const int4 size, const float alpha_taa, const float pixel_filter, __global const float *restrict motion,
           __global const float *restrict guide, __global const light_t *restrict moments,
           __global const float *restrict picture, __global const float *restrict history,
           __global float *restrict next_history, __global float *restrict out) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Past past = past_of_foremost(size, x, y, SHARED_PLANE(size, guide, GUIDE_DEPTH), motion, moments);
    const floatv px = to_float(x + LANES) + past.x, py = to_float((intv)(y)) + past.y;
    const float right = (float)size.x - HALF_PIXEL, bottom = (float)size.y - HALF_PIXEL;
    const intv seen = (px >= -HALF_PIXEL) & (px < right) & (py >= -HALF_PIXEL) & (py < bottom);  // false for NaN
    const floatv mx = where(seen, past.x, (floatv)(0.0f)), my = where(seen, past.y, (floatv)(0.0f));
    const Tone h = read_history(size, x, y, seen, mx, my, history);
    const Around around = look_around(size, x, y, pixel_filter, picture);

    const intv known = seen & (h.channel[0] > KNOWN);
    const floatv alpha = where(known, max((floatv)(alpha_taa), past.newest), (floatv)(1.0f));
    Tone t;
    UNROLLED_FOR(k, 3) {
        const floatv now = around.mean.channel[k];
        const floatv kept = clamp(h.channel[k], around.low.channel[k], around.high.channel[k]);
        t.channel[k] = where(alpha < 1.0f, kept + alpha * (now - kept), now);
        const floatv next = where(x + LANES < size.x, t.channel[k], (floatv)(0.0f));
        store(next, PLANE(size, next_history, PICTURE_COLOR, 0, k) + here);
    }
    const floatv base = t.channel[0] - t.channel[2];
    Color c;
    c.channel[0] = max(base + t.channel[1], (floatv)(0.0f));
    c.channel[1] = max(t.channel[0] + t.channel[2], (floatv)(0.0f));
    c.channel[2] = max(base - t.channel[1], (floatv)(0.0f));
    store_color(c, size, x, y, out);
}
