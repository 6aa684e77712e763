// One level of the edge-avoiding a-trous wavelet filter; level i has step 2^i between its 5x5 taps.
//
//   c = sum h w c / sum h w,   Var = sum h^2 w^2 Var / (sum h w)^2,   w = w_z w_n w_l
//   w_z = exp(-|z - z'| / (step (sigma_depth |grad z . d| + slope_floor z |d|)))     w_n = max(0, n.n')^sigma_normal
//   w_l = exp(-|l - l'| / (sigma_luminance sqrt(gauss3x3(Var)) + 1e-3 l + 1e-12))
//
// in   guide: normal, depth;  source: colour and variance
// out  target: colour and variance
// Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010. Offsets come in pairs +d and -d that share the scale of
// w_z, and w_z and w_l share one exponential.

typedef struct {
    floatv z, normal[3], luminance[SIGNALS], luminance_scale[SIGNALS];
} Centre;

typedef struct {
    floatv color[SIGNALS][3], variance[SIGNALS], weight[SIGNALS];
} Sum;

INLINE floatv luminance_at(const int4 size, int signal, int i, __global const float *source) {
    __global const float *color = source + 3 * signal * size.w + i;
    return luminance(load(color), load(color + size.w), load(color + 2 * size.w));
}

// 3x3 Gaussian of the variance over hits, a miss has no variance to give.
INLINE floatv smooth_variance(const int4 size, int here, __global const float *depth, __global const float *variance) {
    floatv sum = (floatv)(0.0f), weight = (floatv)(1e-30f);
#pragma unroll
    for (int dy = -1; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            const int tap = here + dy * size.z + dx;
            const float gauss = (dx ? 0.25f : 0.5f) * (dy ? 0.25f : 0.5f);
            const floatv w = where(load(depth + tap) > 0.0f, (floatv)(gauss), (floatv)(0.0f));
            sum += w * load(variance + tap);
            weight += w;
        }
    }
    return sum / weight;
}

INLINE void add_tap(Sum *sum, Centre centre, floatv depth_scale, float h, const int4 size, int tap,
                    __global const float *guide, __global const float *source) {
    floatv cosine = centre.normal[0] * load(guide + NORMAL * size.w + tap);
    cosine += centre.normal[1] * load(guide + (NORMAL + 1) * size.w + tap);
    cosine += centre.normal[2] * load(guide + (NORMAL + 2) * size.w + tap);
    const floatv surface = h * normal_weight(cosine);
    const floatv off_surface = fabs(centre.z - load(guide + DEPTH * size.w + tap)) * depth_scale;
    UNROLLED_FOR(s, SIGNALS) {
        __global const float *color = source + 3 * s * size.w + tap;
        const floatv r = load(color), g = load(color + size.w), b = load(color + 2 * size.w);
        const floatv off_luminance = fabs(centre.luminance[s] - luminance(r, g, b)) * centre.luminance_scale[s];
        const floatv w = surface * exp_minus(off_surface + off_luminance);
        sum->color[s][0] += w * r;
        sum->color[s][1] += w * g;
        sum->color[s][2] += w * b;
        sum->variance[s] += w * w * load(source + (VARIANCE + s) * size.w + tap);
        sum->weight[s] += w;
    }
}

__kernel void atrous(const int4 size, const int step, const float sigma_depth, const float sigma_luminance,
                     const float depth_slope_floor, __global const float *restrict guide,
                     __global const float *restrict source, __global float *restrict target) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    const float spline[3] = {0.375f, 0.25f, 0.0625f};
    __global const float *depth = guide + DEPTH * size.w;

    Centre centre;
    centre.z = load(depth + here);
    UNROLLED_FOR(k, 3) centre.normal[k] = load(guide + (NORMAL + k) * size.w + here);
    Sum sum;
    UNROLLED_FOR(s, SIGNALS) {
        const floatv l = luminance_at(size, s, here, source);
        const floatv deviation = sqrt(smooth_variance(size, here, depth, source + (VARIANCE + s) * size.w));
        centre.luminance[s] = l;
        centre.luminance_scale[s] = 1.0f / (sigma_luminance * deviation + 1e-3f * l + 1e-12f);
        const float h = spline[0] * spline[0];
        UNROLLED_FOR(k, 3) sum.color[s][k] = h * load(source + (3 * s + k) * size.w + here);
        sum.variance[s] = h * h * load(source + (VARIANCE + s) * size.w + here);
        sum.weight[s] = (floatv)(h);
    }

    const Gradient g = depth_gradient(depth, size.z, here);
    // Rows stay a loop: unrolled as well, a level is a tenth faster on PoCL, but takes 8 s to compile in place of 0.5 s.
    for (int dy = 0; dy <= 2; ++dy) {
#pragma unroll
        for (int dx = -2; dx <= 2; ++dx) {
            if (dy == 0 && dx <= 0) continue;  // the other half of each pair, and the centre
            const floatv scale = depth_scale(g, centre.z, sigma_depth, depth_slope_floor, (float)dx, (float)dy) / (float)step;
            const float h = spline[dx < 0 ? -dx : dx] * spline[dy];
            const int offset = step * (dy * size.z + dx);
            add_tap(&sum, centre, scale, h, size, here + offset, guide, source);
            add_tap(&sum, centre, scale, h, size, here - offset, guide, source);
        }
    }

    UNROLLED_FOR(s, SIGNALS) {
        const floatv scale = 1.0f / sum.weight[s];
        UNROLLED_FOR(k, 3) store(sum.color[s][k] * scale, target + (3 * s + k) * size.w + here);
        store(sum.variance[s] * scale * scale, target + (VARIANCE + s) * size.w + here);
    }
}
