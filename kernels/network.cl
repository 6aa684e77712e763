// LBF's network: computes the parameters of the bilateral filter from statistics of each pixel's neighbourhood.
//
//   statistics of l (divided by its mean in 7x7), z (divided by z), n and albedo (octaves), over the hits of 3x3 and of
//   7x7 pixels:  deviation, mean |f' - f|, mean f' - f (of n its length);  then the length of the gradient
//   sqrt(Var) and sqrt(gauss3x3(Var)), divided by the mean of l;  1 / N
//   x = statistic / (|statistic| + halfway), 1 / N as it is
//   h = W_1 x + b_1;  p = 2^clamp(W_2 h / (1 + |h|) + b_2)
//
// in   guide;  source: colour, variance;  moments: N;  network: W_1 by columns, b_1, W_2 by columns, b_2
// out  parameters: p, each in octaves of weight (bilateral.cl); 0 at a miss
// Kalantari et al. 2015, section 4. No statistic depends on the scene's scale or on exposure.

#define NEAR 1  // 3x3 taps
#define WIDE 3  // 7x7 taps

// The features in the order of their statistics, and the number of statistics of each.
enum { LIGHT = 0, DEPTH = 1, NORMAL = 2, ALBEDO = 3, FEATURES = 4 };
#define STATISTICS 7
#define CHANNELS_OF(feature) ((feature) == NORMAL ? 3 : 1)

// The value of a statistic that becomes 1/2: for light, depth, normal and albedo; and for noise.
#define HALFWAY_OF(feature) ((feature) == LIGHT ? 0.3f : (feature) == DEPTH ? 0.01f : (feature) == NORMAL ? 0.1f : 0.5f)
#define HALFWAY_NOISE 1.0f
#define LEAST_POWER -24.0f  // smallest exponent of a parameter, which is a power of two
#define GREATEST_POWER 10.0f
// limit for a difference of two values: its statistic is 1 already, and its square is still finite
#define MOST_APART 1e15f
#define BLACK 1e-12f  // added to the mean of light before it is a divisor

// The values of a feature.
typedef struct {
    int4 size;
    __global const float *guide;
    __global const light_t *luminance;
} Planes;

// The hidden layer of one signal, before softsign.
typedef struct {
    floatv hidden[HIDDEN];
    __global const float *network;
} Layer;

INLINE void see(Layer *layer, int input, floatv x) {
    UNROLLED_FOR(j, HIDDEN) layer->hidden[j] += layer->network[input * HIDDEN + j] * x;
}

INLINE floatv squashed(floatv value, float halfway) { return value / (fabs(value) + halfway); }

INLINE floatv depth_at(Planes planes, int i) { return load(SHARED_PLANE(planes.size, planes.guide, GUIDE_DEPTH) + i); }

// Channel `k` of a feature; albedo is in octaves, as the mean of its channels.
INLINE floatv feature_at(Planes planes, int feature, int k, int i) {
    if (feature == LIGHT) return load_light(planes.luminance + i);
    if (feature == DEPTH) return depth_at(planes, i);
    if (feature == NORMAL) return load_normal(normal_plane(planes.size, planes.guide, k) + i) * (1.0f / UNIT);
#if HAS_ALBEDO
    const intv code = load_int(albedo_plane(planes.size, planes.guide) + i);
    intv octaves = (intv)(0);
    UNROLLED_FOR(field, 3) octaves += (code >> (field * FIELD_BITS)) & GREATEST_FIELD;
    return to_float(octaves) * (1.0f / (3.0f * STEPS));
#else
    return (floatv)(0.0f);
#endif
}

// The difference of two values of a feature; `scale` is 1 divided by the unit of the feature. It is scaled before it is
// squared, because the square of a depth may exceed a float.
INLINE floatv apart(floatv there, floatv here, floatv scale) {
    return clamp((there - here) * scale, -MOST_APART, MOST_APART);
}

// Sums over one neighbourhood: differences of each channel from the pixel's own, their squares and magnitudes.
typedef struct {
    floatv first[3], second, absolute, taps;
} Sums;

INLINE void see_sums(Layer *layer, int input, Sums sums, int feature) {
    const floatv share = 1.0f / sums.taps;
    floatv squared_mean = (floatv)(0.0f);
    UNROLLED_FOR(k, CHANNELS_OF(feature)) squared_mean += (sums.first[k] * share) * (sums.first[k] * share);
    const floatv deviation = sqrt(max(sums.second * share - squared_mean, (floatv)(0.0f)));
    const floatv mean = feature == NORMAL ? sqrt(squared_mean) : sums.first[0] * share;
    see(layer, input, squashed(deviation, HALFWAY_OF(feature)));
    see(layer, input + 1, squashed(sums.absolute * share, HALFWAY_OF(feature)));
    see(layer, input + 2, squashed(mean, HALFWAY_OF(feature)));
}

// Square of half of a feature's difference between two taps, if both are hits.
INLINE floatv squared_slope(Planes planes, int feature, int behind, int ahead, floatv scale) {
    floatv squares = (floatv)(0.0f);
    UNROLLED_FOR(k, CHANNELS_OF(feature)) {
        const floatv slope =
            0.5f * apart(feature_at(planes, feature, k, ahead), feature_at(planes, feature, k, behind), scale);
        squares += slope * slope;
    }
    const intv seen = min(depth_at(planes, behind), depth_at(planes, ahead)) > 0.0f;
    return where(seen, squares, (floatv)(0.0f));
}

// The statistics of a feature over the taps that are at most `reach` away.
INLINE void see_neighbourhood(Layer *layer, int input, int feature, Planes planes, int here, floatv scale, int reach) {
    const int channels = CHANNELS_OF(feature);
    floatv own[3];
    UNROLLED_FOR(k, channels) own[k] = feature_at(planes, feature, k, here);
    Sums sums;
    UNROLLED_FOR(k, 3) sums.first[k] = (floatv)(0.0f);
    sums.second = sums.absolute = (floatv)(0.0f);
    sums.taps = (floatv)(TINY);
    ROLLED_FOR(dy, -reach, reach) {
        ROLLED_FOR(dx, -reach, reach) {
            const int tap = moved(here, dy * planes.size.z + dx);
            const floatv seen = where(depth_at(planes, tap) > 0.0f, (floatv)(1.0f), (floatv)(0.0f));
            sums.taps += seen;
            UNROLLED_FOR(k, channels) {
                const floatv difference = seen * apart(feature_at(planes, feature, k, tap), own[k], scale);
                sums.first[k] += difference;
                sums.second += difference * difference;
                sums.absolute += fabs(difference);
            }
        }
    }
    see_sums(layer, input, sums, feature);
}

INLINE void see_feature(Layer *layer, int feature, Planes planes, int here, floatv scale) {
    const int input = feature * STATISTICS;
    // With a loop, each statistic is multiplied by its weights at once. Without it, LLVM multiplies where the sums are
    // needed, at the end, and keeps all weights until then: more than the scalar registers of AMD's GPUs hold.
    ROLLED_FOR(wide, 0, 1) {
        see_neighbourhood(layer, input + 3 * wide, feature, planes, here, scale, wide ? WIDE : NEAR);
    }
    const floatv gradient =
        squared_slope(planes, feature, here - 1, here + 1, scale) +
        squared_slope(planes, feature, moved(here, -planes.size.z), moved(here, planes.size.z), scale);
    see(layer, input + STATISTICS - 1, squashed(sqrt(gradient), HALFWAY_OF(feature)));
}

// Mean luminance of the larger neighbourhood.
INLINE floatv mean_light(Planes planes, int here) {
    floatv sum = (floatv)(0.0f), taps = (floatv)(TINY);
    ROLLED_FOR(dy, -WIDE, WIDE) {
        ROLLED_FOR(dx, -WIDE, WIDE) {
            const int tap = moved(here, dy * planes.size.z + dx);
            const floatv seen = where(depth_at(planes, tap) > 0.0f, (floatv)(1.0f), (floatv)(0.0f));
            sum += seen * load_light(planes.luminance + tap);
            taps += seen;
        }
    }
    return sum / taps;
}

// The second layer: computes the parameters from the hidden layer.
INLINE void put_parameters(Layer layer, const int4 size, int s, int here, intv hit, __global float *parameters) {
    UNROLLED_FOR(j, HIDDEN) {
        const floatv h = layer.hidden[j] + layer.network[INPUTS * HIDDEN + j];
        layer.hidden[j] = h / (1.0f + fabs(h));
    }
    __global const float *second = layer.network + (INPUTS + 1) * HIDDEN;
    ROLLED_FOR(k, 0, PARAMETERS_EXPONENTS_CHANNELS - 1) {
        floatv power = (floatv)(second[HIDDEN * PARAMETERS_EXPONENTS_CHANNELS + k]);
        UNROLLED_FOR(j, HIDDEN) power += second[j * PARAMETERS_EXPONENTS_CHANNELS + k] * layer.hidden[j];
        const floatv made = weight(ONE + OCTAVE * clamp(power, LEAST_POWER, GREATEST_POWER));
        store(where(hit, made, (floatv)(0.0f)), PLANE(size, parameters, PARAMETERS_EXPONENTS, s, k) + here);
    }
}

KERNEL network(const int4 size, __global const float *restrict network, __global const float *restrict guide,
               __global const light_t *restrict source, __global const light_t *restrict moments,
               __global float *restrict parameters) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    __global const float *depth = SHARED_PLANE(size, guide, GUIDE_DEPTH);
    const floatv z = load(depth + here), frames = load_light(SHARED_PLANE(size, moments, MOMENTS_LENGTH) + here);
    UNROLLED_FOR(s, SIGNALS) {
        Planes planes;
        planes.size = size;
        planes.guide = guide;
        planes.luminance = PLANE(size, source, ILLUMINATION_COLOR, s, LIGHT_LUMINANCE);
        Layer layer;
        layer.network = network;
        UNROLLED_FOR(j, HIDDEN) layer.hidden[j] = (floatv)(0.0f);

        const floatv by_light = 1.0f / (mean_light(planes, here) + BLACK);
        see_feature(&layer, LIGHT, planes, here, by_light);
        see_feature(&layer, DEPTH, planes, here, 1.0f / max(z, (floatv)(TINY)));
        see_feature(&layer, NORMAL, planes, here, (floatv)(1.0f));
#if HAS_ALBEDO
        see_feature(&layer, ALBEDO, planes, here, (floatv)(1.0f));  // without albedo, all its statistics are 0
#endif
        __global const light_t *variance = PLANE(size, source, ILLUMINATION_VARIANCE, s, 0);
        const floatv own = load_variance(variance + here), around = smooth_variance(size, here, depth, variance);
        see(&layer, FEATURES * STATISTICS, squashed(sqrt(own) * by_light, HALFWAY_NOISE));
        see(&layer, FEATURES * STATISTICS + 1, squashed(sqrt(around) * by_light, HALFWAY_NOISE));
        see(&layer, FEATURES * STATISTICS + 2, 1.0f / max(frames, (floatv)(1.0f)));
        put_parameters(layer, size, s, here, z > 0.0f, parameters);
    }
}
