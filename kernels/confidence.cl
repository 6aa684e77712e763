// The standard error of the result's luminance at each pixel.
//
//   3 sqrt(sum over signals Var) * l(albedo')
//
// in   albedo if the frame has it; illumination: the variance after the last level
// out  confidence: the standard error

// The levels treat their taps as independent, although they are not, and Var does not include the error of blurring.
// The factor corrects for both: the root of Var is about a third of the measured error.
#define CALIBRATION 3.0f

KERNEL standard_error(const int4 size,
#if HAS_ALBEDO
                      __global const float *restrict albedo,
#endif
                      __global const light_t *restrict illumination, __global float *restrict confidence) {
    const int x = first_column(), y = row();
    if (x >= size.x || y >= size.y) return;
    const int here = at(size, x, y);
    floatv variance = (floatv)(0.0f);
    UNROLLED_FOR(s, SIGNALS) {
        variance += load_variance(PLANE(size, illumination, ILLUMINATION_VARIANCE, s, 0) + here);
    }
    floatv error = CALIBRATION * sqrt(variance);
#if HAS_ALBEDO
    const Color texture = divisor(known_albedo(size, x, y, albedo));
    error *= luminance(texture.channel[0], texture.channel[1], texture.channel[2]);
#endif
    const floatv inside = where(x + LANES < size.x, error, (floatv)(0.0f));
    store(inside, SHARED_PLANE(size, confidence, CONFIDENCE_STANDARD_ERROR) + here);
}
