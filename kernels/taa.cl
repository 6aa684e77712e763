// Temporal antialiasing in linear light.
//
//   c = YCoCg(picture);  n = sum over 3x3 of k(dx) k(dy) c,  k = (f, 1 - 2 f, f),  f = pixel_filter
//   h = clamp(history at p + motion, min 3x3 c, max 3x3 c)
//   t = h + max(alpha, 1 / max 3x3 N) (n - h)
//
// in   motion, guide: depth, moments: N, picture: modulated colour, history (YCoCg)
// out  next history: t; out: RGB(t), not below 0, the user's (H, W, 3) array
// Schied et al. 2017, section 5; Karis, High-Quality Temporal Supersampling, 2014. Light is not tone-mapped, because
// the mean over time of tone-mapped light would be too dark.

#define NEARER 0.9999f   // a surface must be nearer than this share of a depth to count as nearer
#define HALF_PIXEL 0.5f  // from a pixel's centre, at whole coordinates, to its edge
#define KNOWN (-1e20f)   // history before the first frame is below this; light never is
#define TAPS 4           // taps of Catmull and Rom's spline along an axis

typedef struct {
    floatv channel[3];
} YCoCg;

INLINE YCoCg ycocg(floatv r, floatv g, floatv b) {
    const floatv half_green = 0.5f * g, rest = 0.25f * (r + b);
    YCoCg c;
    c.channel[0] = half_green + rest;
    c.channel[1] = 0.5f * (r - b);
    c.channel[2] = half_green - rest;
    return c;
}

// The share of the newest frame for the longest history of the 3x3 neighbourhood; 0 at a miss. Where a surface has just
// come into view, the whole neighbourhood is new. Beside an edge, jittered rays make single pixels new again and again.
INLINE floatv newest_share(const int4 size, int here, __global const light_t *moments) {
    floatv least = (floatv)(INFINITY);
    UNROLLED_FOR(j, 3) {
        UNROLLED_FOR(i, 3) {
            const int tap = moved(here, (j - 1) * size.z + i - 1);
#ifdef MOMENTS_LENGTH
            const floatv share =
                1.0f / load_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH) + tap);  // infinite for 0
#else
            const floatv inverse = load_light(PLANE(size, moments, ILLUMINATION_INVERSE_COUNT, 0, 0) + tap);
            const floatv share = where(inverse > 0.0f, inverse, (floatv)(INFINITY));
#endif
            least = min(least, share);
        }
    }
    return where(isfinite(least), min(least, (floatv)(1.0f)), (floatv)(0.0f));
}

// The nearest surface in the 3x3 neighbourhood, as a distance in a plane. A pixel beside an edge moves with the edge;
// with its own motion, it would fetch and keep what the edge covered in the previous frame. Nearly equal depths count
// as equal, so that rounding does not choose between the pixels of a wall.
INLINE intv foremost(const int4 size, __global const float *depth) {
    const floatv own = load(depth);
    floatv limit = where(own > 0.0f, NEARER * own, (floatv)(INFINITY));
    intv front = (intv)(0);
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const floatv z = load(depth + dx + dy * size.z);  // 0 outside the image
            const intv nearer = (z > 0.0f) & (z < limit);
            limit = where(nearer, NEARER * z, limit);
            front = select(front, (intv)(dx + dy * size.z), nearer);
        }
    }
    return front;
}

// The motion of the surface at `front`, which is at most one pixel away from each pixel.
INLINE Color motion_of(const int4 size, int x, int y, intv front, __global const float *motion) {
    if (places_of(LANES + front).adjacent) {
        const int down = (FIRST(front) > 1) - (FIRST(front) < -1);
        return load_motion(size, x + FIRST(front) - down * size.z, y + down, motion);
    }
    const intv none = (intv)(0), down = select(none, none + 1, front > 1) - select(none, none + 1, front < -1);
    const intv column = min(x + LANES + front - down * size.z, (intv)(size.x - 1));
    const intv i = (column + (y + down) * size.x) * MOTION;
    Color m;
    m.channel[2] = (floatv)(0.0f);
    UNROLLED_FOR(k, MOTION) m.channel[k] = gather(motion, i + k);
    return m;
}

// Catmull and Rom's weights of the taps around the position `first` + f, where f is a fraction; taps outside the image
// have no weight. Bilinear weights would soften edges a little more in every frame.
INLINE void catmull_rom(floatv f, intv first, int count, floatv *w) {
    const floatv outside = (floatv)(0.0f);
    w[0] = where(first > 0, f * (-0.5f + f * (1.0f - 0.5f * f)), outside);
    w[1] = where(first >= 0, 1.0f + f * f * (-2.5f + 1.5f * f), outside);
    w[2] = where(first < count - 1, f * (0.5f + f * (2.0f - 1.5f * f)), outside);
    w[3] = where(first < count - 2, f * f * (-0.5f + 0.5f * f), outside);
    // the sum is at least a half, even half a pixel outside the image
    const floatv scale = 1.0f / (w[0] + w[1] + w[2] + w[3]);
    UNROLLED_FOR(i, TAPS) w[i] *= scale;
}

// The weights of the taps around a position in the history.
INLINE YCoCg weighted(const int4 size, const floatv *across, const floatv *down, __global const float *place) {
    YCoCg sum;
    UNROLLED_FOR(k, 3) {
        sum.channel[k] = (floatv)(0.0f);
        UNROLLED_FOR(j, TAPS) {
            __global const float *row = PLANE(size, place, PICTURE_COLOR, 0, k) + (j - 1) * size.z - 1;
            floatv along = (floatv)(0.0f);
            UNROLLED_FOR(i, TAPS) along += across[i] * load(row + i);
            sum.channel[k] += down[j] * along;
        }
    }
    return sum;
}

// The history at p + (mx, my) + (past_x, past_y), for pixels that are `seen`.
INLINE YCoCg read_history(const int4 size, int x, int y, intv seen, floatv mx, floatv my, int past_x, int past_y,
                          __global const float *history) {
    const intv whole_x = select((intv)(0), to_int(floor(mx)) + past_x, seen);
    const intv whole_y = select((intv)(0), to_int(floor(my)) + past_y, seen);
    const intv shift = whole_x + whole_y * size.z;
    const floatv fx = mx - floor(mx), fy = my - floor(my);
    const int here = at(size, x, y);
    YCoCg h;
    if (!any_lane((fx > 0.0f) | (fy > 0.0f))) {  // one tap has all the weight
        const Places places = places_of(here + LANES + shift);
        UNROLLED_FOR(k, 3) h.channel[k] = fetch(PLANE(size, history, PICTURE_COLOR, 0, k), places);
        return h;
    }
    floatv across[TAPS], down[TAPS];
    catmull_rom(fx, x + LANES + whole_x, size.x, across);
    catmull_rom(fy, y + whole_y, size.y, down);
    UNROLLED_FOR(k, 3) h.channel[k] = (floatv)(0.0f);
    // Motion is smooth nearly everywhere: a vector has one or two shifts, and all lanes with the same shift load
    // together.
    while (any_lane(seen)) {
        const int next = GREATEST(select((intv)(INT_MIN), shift, seen));
        const YCoCg there = weighted(size, across, down, history + here + next);
        UNROLLED_FOR(k, 3) h.channel[k] = where(shift == next, there.channel[k], h.channel[k]);
        seen &= shift != next;
    }
    return h;
}

// The colours of the pixels at `picture`.
INLINE YCoCg load_ycocg(const int4 size, __global const float *picture) {
    floatv c[3];
    UNROLLED_FOR(k, 3) c[k] = load(PLANE(size, picture, PICTURE_COLOR, 0, k));
    return ycocg(c[0], c[1], c[2]);
}

// Minimum and maximum over the 3x3 neighbourhood; a tap outside the image is replaced by its neighbour inside.
INLINE void extent(const int4 size, int x, int y, __global const float *picture, YCoCg *low, YCoCg *high) {
    const intv leftmost = x + LANES == 0, rightmost = x + LANES == size.x - 1;
    *low = *high = load_ycocg(size, picture + at(size, x, y));
    UNROLLED_FOR(j, 3) {
        __global const float *p = picture + at(size, x, clamp(y + j - 1, 0, size.y - 1));
        const YCoCg middle = load_ycocg(size, p), left = load_ycocg(size, p - 1), right = load_ycocg(size, p + 1);
        UNROLLED_FOR(k, 3) {
            const floatv m = middle.channel[k];
            const floatv l = where(leftmost, m, left.channel[k]), r = where(rightmost, m, right.channel[k]);
            low->channel[k] = min(min(low->channel[k], m), min(l, r));
            high->channel[k] = max(max(high->channel[k], m), max(l, r));
        }
    }
}

// The weighted mean over the 3x3 neighbourhood; a tap outside the image has no weight.
INLINE YCoCg filtered(const int4 size, int x, int y, float pixel_filter, __global const float *picture) {
    const float middle = 1.0f - 2.0f * pixel_filter;
    const floatv left = where(x + LANES > 0, (floatv)(pixel_filter), (floatv)(0.0f));
    const floatv right = where(x + LANES < size.x - 1, (floatv)(pixel_filter), (floatv)(0.0f));
    const float down[3] = {y > 0 ? pixel_filter : 0.0f, middle, y < size.y - 1 ? pixel_filter : 0.0f};
    const floatv scale = 1.0f / ((left + middle + right) * (down[0] + middle + down[2]));
    floatv c[3];
    UNROLLED_FOR(k, 3) {
        c[k] = (floatv)(0.0f);
        UNROLLED_FOR(j, 3) {
            __global const float *p = PLANE(size, picture, PICTURE_COLOR, 0, k) + at(size, x, y + j - 1);
            c[k] += down[j] * (left * load(p - 1) + middle * load(p) + right * load(p + 1));
        }
        c[k] *= scale;
    }
    return ycocg(c[0], c[1], c[2]);
}

KERNEL taa(const int4 size, const int4 past_size, const float alpha_taa, const float pixel_filter, const int past_x,
           const int past_y, __global const float *restrict motion, __global const float *restrict guide,
           __global const light_t *restrict moments, __global const float *restrict picture,
           __global const float *restrict history, __global float *restrict next_history,
           __global float *restrict out) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const intv front = foremost(size, SHARED_PLANE(size, guide, GUIDE_DEPTH) + here);
    const Color m = motion_of(size, x, y, front, motion);
    // Motion is compared with the distances to the image's edges, which are exact; a position p' would be rounded.
    const floatv left = -HALF_PIXEL - to_float(x + past_x + LANES), right = left + (float)past_size.x;
    const float top = -HALF_PIXEL - (float)(y + past_y), bottom = top + (float)past_size.y;
    intv seen = (m.channel[0] >= left) & (m.channel[0] < right);  // false for NaN
    seen &= (m.channel[1] >= top) & (m.channel[1] < bottom);
    seen &= fabs(m.channel[2]) <= MAX_DEPTH;
    const floatv mx = where(seen, m.channel[0], (floatv)(0.0f)), my = where(seen, m.channel[1], (floatv)(0.0f));
    const YCoCg h = read_history(past_size, x, y, seen, mx, my, past_x, past_y, history);

    YCoCg low, high;
    extent(size, x, y, picture, &low, &high);
    YCoCg now = load_ycocg(size, picture + here);
    if (pixel_filter > 0.0f) now = filtered(size, x, y, pixel_filter, picture);

    const intv known = seen & (h.channel[0] > KNOWN);
    const floatv share = max((floatv)(alpha_taa), newest_share(size, here, moments));
    const floatv alpha = where(known, share, (floatv)(1.0f));
    YCoCg t;
    UNROLLED_FOR(k, 3) {
        const floatv kept = clamp(h.channel[k], low.channel[k], high.channel[k]);
        t.channel[k] = where(alpha < 1.0f, kept + alpha * (now.channel[k] - kept), now.channel[k]);
        const floatv next = where(x + LANES < size.x, t.channel[k], (floatv)(0.0f));
        store(next, PLANE(size, next_history, PICTURE_COLOR, 0, k) + here);
    }
    const floatv base = t.channel[0] - t.channel[2];
    const floatv rgb[3] = {base + t.channel[1], t.channel[0] + t.channel[2], base - t.channel[1]};
    Color c;
    UNROLLED_FOR(k, 3) c.channel[k] = max(rgb[k], (floatv)(0.0f));
    store_color(c, size, x, y, out);
}
