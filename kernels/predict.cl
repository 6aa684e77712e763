// The prediction of the Kalman filter: moves the state of the previous frame along motion, and compares the new frame
// with it.
//
//   p' = p + motion;  H, V, W, S, E, G = mean over the consistent taps, as in temporal.cl
//   D = c - H
//   E := 0.3 (phi - S) + 0.7 E,  phi = sqrt(l(c))
//
// in   motion, guide, illumination: c; of the previous frame: guide, state, filtered light (its luminance is G)
// out  prediction: H, V, W, S, G (W = 0 where nothing is known);
//      innovation: D, E (NOTHING_KNOWN where nothing is known)
// The root makes the noise of bright and dark samples similar.

#define RESIDUAL_GAIN 0.3f  // weight of the new value in the running residual

// The state of one signal, at a tap or as a mean over the taps.
typedef struct {
    floatv color[3], spread, count, tone, residual, luminance;
} State;

// Weighted sums over taps.
typedef struct {
    floatv weight;
    State state[SIGNALS];
} Sums;

// The buffers of the previous frame.
typedef struct {
    __global const float *guide;
    __global const light_t *state, *filtered;
} Previous;

INLINE Sums no_sums(void) {
    Sums sums;
    sums.weight = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3) sums.state[s].color[k] = (floatv)(0.0f);
        sums.state[s].spread = sums.state[s].count = sums.state[s].tone = sums.state[s].residual =
            sums.state[s].luminance = (floatv)(0.0f);
    }
    return sums;
}

INLINE Sums with_tap(Sums sums, floatv w, const int4 size, Places places, Previous previous) {
    __global const light_t *state = previous.state;
    sums.weight += w;
    UNROLLED_FOR(s, SIGNALS) {
        UNROLLED_FOR(k, 3)
            sums.state[s].color[k] += w * fetch_light(PLANE(size, state, ILLUMINATION_COLOR, s, k), places);
        sums.state[s].spread += w * fetch_variance(PLANE(size, state, ILLUMINATION_SPREAD, s, 0), places);
        sums.state[s].count += w * fetch_light(PLANE(size, state, ILLUMINATION_INVERSE_COUNT, s, 0), places);
        sums.state[s].tone += w * fetch_light(PLANE(size, state, ILLUMINATION_TONE, s, 0), places);
        sums.state[s].residual += w * fetch_light(PLANE(size, state, ILLUMINATION_RESIDUAL, s, 0), places);
        sums.state[s].luminance +=
            w * fetch_light(PLANE(size, previous.filtered, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE), places);
    }
    return sums;
}

INLINE State select_state(intv mask, State yes, State no) {
    UNROLLED_FOR(k, 3) yes.color[k] = where(mask, yes.color[k], no.color[k]);
    yes.spread = where(mask, yes.spread, no.spread);
    yes.count = where(mask, yes.count, no.count);
    yes.tone = where(mask, yes.tone, no.tone);
    yes.residual = where(mask, yes.residual, no.residual);
    yes.luminance = where(mask, yes.luminance, no.luminance);
    return yes;
}

INLINE Sums over_box(const int4 size, Expected e, Box box, float normal_threshold, Previous previous) {
    Sums sums = no_sums();
    for (int j = 0; j < box.rows; ++j) {
        for (int i = 0; i < box.columns; ++i) {
            const Places places = beside(box.corner, i + j * size.z);
            const Seen seen = read_seen(size, places, previous.guide);
            sums = with_tap(sums, footprint_weight(e, seen, box, i, j, normal_threshold), size, places, previous);
        }
    }
    return sums;
}

// Decides once for all loads; some compilers would decide for each load. This saves a seventh of the time on PoCL.
INLINE Sums footprint(const int4 size, Expected e, Box box, float normal_threshold, Previous previous) {
    Box together = box, apart = box;
    together.corner.adjacent = 1;
    apart.corner.adjacent = 0;
    if (box.corner.adjacent) return over_box(size, e, together, normal_threshold, previous);
    return over_box(size, e, apart, normal_threshold, previous);
}

INLINE Sums surroundings(const int4 size, Expected e, Nine nine, float normal_threshold, Previous previous) {
    Sums sums = no_sums();
    for (int j = 0; j < nine.box.rows; ++j) {
        for (int i = 0; i < nine.box.columns; ++i) {
            const Places places = beside(nine.box.corner, i + j * size.z);
            const Seen seen = read_seen(size, places, previous.guide);
            sums = with_tap(sums, nine_weight(e, seen, nine, i, j, normal_threshold), size, places, previous);
        }
    }
    return sums;
}

KERNEL predict(const int4 size, const int4 past_size, const float depth_threshold, const float normal_threshold,
               const float albedo_threshold, const int frame_number, const int past_x, const int past_y,
               __global const float *restrict motion, __global const float *restrict guide,
               __global const light_t *restrict illumination, __global const float *restrict previous_guide,
               __global const light_t *restrict previous_state, __global const light_t *restrict filtered,
               __global float *restrict prediction, __global float *restrict innovation) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const Expected e = expect(size, x, y, past_x, past_y, motion, guide, depth_threshold, albedo_threshold);
    const intv hit = load(SHARED_PLANE(size, guide, GUIDE_DEPTH) + here) > 0.0f;
    const Previous previous = {previous_guide, previous_state, filtered};

    Sums sums = no_sums();
    if (frame_number > 0) {  // after a cut, the previous frame belongs to another shot
        const Box footprints = box_of(past_size, e.x, e.y, e.left, e.top, hit, 2);
        sums = footprint(past_size, e, footprints, normal_threshold, previous);
        const intv lost = hit & (sums.weight <= ENOUGH);
        if (any_lane(lost)) {  // thin geometry
            const Nine around = nine_around(past_size, e, lost);
            const Sums nine = surroundings(past_size, e, around, normal_threshold, previous);
            sums.weight = where(lost, nine.weight, sums.weight);
            UNROLLED_FOR(s, SIGNALS) sums.state[s] = select_state(lost, nine.state[s], sums.state[s]);
        }
    }

    const intv known = hit & (sums.weight > ENOUGH);
    const floatv share = where(known, 1.0f / max(sums.weight, (floatv)(ENOUGH)), (floatv)(0.0f));
    UNROLLED_FOR(s, SIGNALS) {
        const State sum = sums.state[s];
        const floatv tone = share * sum.tone;
        floatv sample[3];
        UNROLLED_FOR(k, 3) {
            const floatv predicted = share * sum.color[k];
            store(predicted, PLANE(size, prediction, PREDICTION_COLOR, s, k) + here);
            sample[k] = load_light(PLANE(size, illumination, ILLUMINATION_COLOR, s, k) + here);
            store(sample[k] - predicted, PLANE(size, innovation, INNOVATION_COLOR, s, k) + here);
        }
        const floatv surprise = sqrt(sample[LIGHT_LUMINANCE]) - tone, before = share * sum.residual;
        const floatv residual = where(known, before + RESIDUAL_GAIN * (surprise - before), (floatv)(NOTHING_KNOWN));
        store(residual, PLANE(size, innovation, INNOVATION_RESIDUAL, s, 0) + here);
        store(share * sum.spread, PLANE(size, prediction, PREDICTION_SPREAD, s, 0) + here);
        store(share * sum.count, PLANE(size, prediction, PREDICTION_INVERSE_COUNT, s, 0) + here);
        store(tone, PLANE(size, prediction, PREDICTION_TONE, s, 0) + here);
        store(share * sum.luminance, PLANE(size, prediction, PREDICTION_LUMINANCE, s, 0) + here);
    }
}
