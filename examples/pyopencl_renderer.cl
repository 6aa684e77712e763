// A path tracer with one bounce in one kernel: balls on a tiled floor under a square lamp and a bright sky. It writes
// all fields for the denoiser into one image of 16 channels, and ids into another image.

#define BALLS 5
#define FLOOR BALLS                          // the number of the floor, after those of the balls
#define MISS (BALLS + 1)                     // the number of the sky
#define LAMP ((float3)(-1.0f, 5.0f, -4.0f))  // the lamp's middle; it shines downwards
#define LAMP_SIDE 2.0f
#define LAMP_RADIANCE 20.0f
#define FOCAL_LENGTH 1.2f  // in heights of the image
#define TILT 0.3f          // how far the picture is shifted down, as by a shift lens
#define EPSILON 1e-3f

typedef struct {
    float3 eye;   // the camera looks along -z
    float3 ball;  // middle of ball 0; the others rest
} Moment;

typedef struct {
    float distance;
    int what;
    float3 point, normal;
} Hit;

__constant float4 REST[BALLS] = {  // middle and radius
    (float4)(0.0f, 0.0f, 0.0f, 0.5f), (float4)(-1.6f, 0.8f, -5.0f, 0.8f), (float4)(0.3f, 0.6f, -6.2f, 0.6f),
    (float4)(1.9f, 1.0f, -5.4f, 1.0f), (float4)(-0.3f, 0.25f, -3.4f, 0.25f)};
__constant float3 PAINT[BALLS] = {(float3)(0.8f, 0.75f, 0.2f), (float3)(0.75f, 0.2f, 0.15f), (float3)(0.7f, 0.7f, 0.7f),
                                  (float3)(0.2f, 0.35f, 0.7f), (float3)(0.25f, 0.6f, 0.25f)};

// A random number in 0..1 (PCG, Jarzynski and Olano 2020).
float next(uint *state) {
    *state = *state * 747796405u + 2891336453u;
    const uint word = ((*state >> ((*state >> 28) + 4u)) ^ *state) * 277803737u;
    return (float)(((word >> 22) ^ word) >> 8) * 0x1p-24f;
}

Hit trace(Moment now, float3 origin, float3 towards) {
    Hit hit = {INFINITY, MISS, (float3)(0.0f), (float3)(0.0f)};
    if (towards.y < 0.0f) {
        hit.distance = -origin.y / towards.y;
        hit.what = FLOOR;
        hit.normal = (float3)(0.0f, 1.0f, 0.0f);
    }
    for (int i = 0; i < BALLS; ++i) {
        const float3 middle = i ? REST[i].xyz : now.ball, offset = origin - middle;
        const float b = dot(offset, towards), root = b * b - dot(offset, offset) + REST[i].w * REST[i].w;
        const float t = -b - sqrt(max(root, 0.0f));
        if (root > 0.0f && t > EPSILON && t < hit.distance) {
            hit.distance = t;
            hit.what = i;
            hit.normal = (offset + t * towards) / REST[i].w;
        }
    }
    hit.point = origin + (hit.what == MISS ? 0.0f : hit.distance) * towards + EPSILON * hit.normal;
    return hit;
}

float3 sky(float3 towards) { return mix((float3)(0.4f, 0.4f, 0.37f), (float3)(0.12f, 0.22f, 0.45f), sqrt(towards.y)); }

float3 albedo(Hit hit) {
    if (hit.what == MISS) return (float3)(1.0f);
    if (hit.what < BALLS) return PAINT[hit.what];
    const int dark = ((int)floor(2.0f * hit.point.x) + (int)floor(2.0f * hit.point.z)) & 1;
    return dark ? (float3)(0.15f, 0.15f, 0.17f) : (float3)(0.7f, 0.66f, 0.6f);
}

// Irradiance divided by pi from a random point of the lamp.
float3 lamplight(Moment now, Hit hit, uint *state) {
    const float3 on_lamp = LAMP + LAMP_SIDE * ((float3)(next(state), 0.5f, next(state)) - 0.5f);
    const float3 way = on_lamp - hit.point, towards = normalize(way);
    const float cosines = max(dot(hit.normal, towards), 0.0f) * max(towards.y, 0.0f);
    if (cosines <= 0.0f || trace(now, hit.point, towards).distance < length(way)) return (float3)(0.0f);
    return (float3)(LAMP_RADIANCE * LAMP_SIDE * LAMP_SIDE * M_1_PI_F) * cosines / dot(way, way);
}

// A direction above a surface, with a density proportional to its cosine.
float3 scatter(float3 normal, uint *state) {
    const float z = 2.0f * next(state) - 1.0f, turn = 2.0f * M_PI_F * next(state), r = sqrt(max(1.0f - z * z, 0.0f));
    return normalize(normal + 0.999f * (float3)(r * cos(turn), r * sin(turn), z));
}

// Radiance that leaves a surface: light of the lamp, and light from other directions with one bounce.
float3 shade(Moment now, Hit hit, uint *state) {
    const float3 towards = scatter(hit.normal, state);
    const Hit other = trace(now, hit.point, towards);
    const float3 around = other.what == MISS ? sky(towards) : albedo(other) * lamplight(now, other, state);
    return albedo(hit) * (lamplight(now, hit, state) + around);
}

// x and y of the pixel in which a point is seen at a moment, and the point's depth.
float3 project(Moment seen, float3 point, float2 size) {
    const float3 p = point - seen.eye;
    const float depth = -p.z, focal = FOCAL_LENGTH * size.y;
    return (float3)(0.5f * (size.x - 1.0f) + focal * p.x / depth, 0.5f * (size.y - 1.0f) - focal * (p.y / depth + TILT),
                    depth);
}

// aovs  (H, W, 16): 0-3 radiance and alpha, 4-6 normal, 7 depth, 8-10 motion, 11-13 albedo
// ids   (H, W): 0 where nothing was hit
__kernel void render(const float4 eye, const float4 ball, const float4 last_eye, const float4 last_ball,
                     const int samples, const uint seed, __global float *aovs, __global uint *ids) {
    const int x = (int)get_global_id(0), y = (int)get_global_id(1), width = (int)get_global_size(0);
    const float2 size = (float2)((float)width, (float)get_global_size(1));
    const int pixel = y * width + x;
    const Moment now = {eye.xyz, ball.xyz}, last = {last_eye.xyz, last_ball.xyz};

    const float2 place = ((float2)((float)x, (float)y) - 0.5f * (size - 1.0f)) / (FOCAL_LENGTH * size.y);
    const float3 towards = normalize((float3)(place.x, -place.y - TILT, -1.0f));
    const Hit hit = trace(now, now.eye, towards);
    __global float *aov = aovs + 16 * pixel;

    uint state = (seed * 0x9e3779b9u) ^ ((uint)pixel * 0x85ebca6bu);
    next(&state);
    float3 light = (float3)(0.0f);
    if (hit.what == MISS)
        light = sky(towards);
    else {
        for (int i = 0; i < samples; ++i) light += shade(now, hit, &state) / (float)samples;
    }
    vstore4((float4)(light, hit.what == MISS ? 0.0f : 1.0f), 0, aov);
    vstore3(hit.normal, 0, aov + 4);
    vstore3(albedo(hit), 0, aov + 11);
    ids[pixel] = hit.what == MISS ? 0u : (uint)hit.what + 1u;

    // The position of this point in the previous frame minus its position now; the sky is too far away to move.
    const float3 here = project(now, hit.point, size);
    const float3 before = hit.what ? hit.point : hit.point + last.ball - now.ball;
    aov[7] = hit.what == MISS ? INFINITY : here.z;
    vstore3(hit.what == MISS ? (float3)(0.0f) : project(last, before, size) - here, 0, aov + 8);
}
