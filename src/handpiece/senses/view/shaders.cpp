// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/shaders.h"

#include <string>

#include "handpiece/senses/view/instrument_shaders.h"

namespace handpiece::view {
namespace {

using gl::kFullScreenVertex;

constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in uint tissue;
layout(location = 3) in float removed;
#ifdef SCANNED
layout(location = 4) in vec4 scanned;
out vec4 scannedOut;
#endif
layout(location = 5) in float blood;
uniform mat4 viewProjection;
uniform int visibleTissues;
#ifdef CLIPPED
uniform vec4 clipPlane;
uniform vec4 endPlane;  // of a mirror, or before a proximal side
out float gl_ClipDistance[2];
#endif
out vec3 normalOut;
out vec2 removedOut;  // and blood
flat out float kind;
void main() {
    vec4 at = vec4(position, 1.0);
    // All corners of a triangle are of one tissue: one that is not to be seen goes out of the picture as a whole.
    bool shown = (visibleTissues >> int(tissue) & 1) != 0;
    gl_Position = shown ? viewProjection * at : vec4(0.0, 0.0, -2.0, 1.0);
#ifdef CLIPPED
    gl_ClipDistance[0] = dot(clipPlane, at);
    gl_ClipDistance[1] = dot(endPlane, at);
#endif
    normalOut = 0.5 * normal.xyz + 0.5;
    removedOut = vec2(removed, blood);
#ifdef SCANNED
    scannedOut = scanned;
#endif
    kind = float(tissue);
}
)";

constexpr const char* kSurfaceFragment = R"(
in vec3 normalOut;
in vec2 removedOut;
flat in float kind;
layout(location = 0) out vec4 surface;
#ifdef SCANNED
in vec4 scannedOut;
layout(location = 1) out vec4 scannedHere;
#endif
void main() {
    float k = kind;
#ifdef SCANNED
    scannedHere = scannedOut;
#endif
#ifdef CLIPPED
    if (!gl_FrontFacing) {
#ifdef SCANNED
        scannedHere = vec4(0.0);
#endif
        // What was cut through: scenery is filled with its own colour, gingiva and bone darker, another tooth in that
        // of its surface; the tooth that is worked on shows its walls.
        if (kind == 6.0 || kind == 7.0 || kind == 8.0) {
            surface = vec4(0.5, 0.5, 0.5, (kind * 2048.0 + (kind == 8.0 ? 0.0 : 1.0)) / 65535.0);
            return;
        }
        k = 29.0;
    }
#endif
    float depth = min(2047.0, floor(removedOut.x * 6553.5));
    if (k == 6.0 && removedOut.y > 0.004) {
        k = 27.0;
        depth = 64.0 * min(31.0, floor(depth / 33.0)) + floor(63.0 * min(1.0, removedOut.y));
    }
    surface = vec4(normalOut, (k * 2048.0 + depth) / 65535.0);
}
)";

// The face of a section: four corners made of the vertex's number.
constexpr const char* kCapVertex = R"(
uniform mat4 viewProjection;
uniform vec3 origin, uStep, vStep;
uniform vec2 size;
out vec2 at;
void main() {
    at = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * size;
    gl_Position = viewProjection * vec4(origin + (at.x - 0.5) * uStep + (at.y - 0.5) * vStep, 1.0);
}
)";

constexpr const char* kCapFragment = R"(
in vec2 at;
uniform sampler2D tissues;
uniform int visibleTissues;
uniform float mmPerPixel;
uniform int grid;
uniform vec2 gridOrigin;
layout(location = 0) out vec4 surface;
// A boundary's line, how much of a pixel it covers: `v` has the signed distances of the four around to the boundary
// [texels], `half` the line's half width in pixels. Between them distances are linear, and so the line is smooth.
float lineOver(vec4 v, vec2 f, vec2 dx, vec2 dy, float halfWide) {
    float here = mix(mix(v.x, v.y, f.x), mix(v.z, v.w, f.x), f.y);
    vec2 slope = vec2(mix(v.y - v.x, v.w - v.z, f.y), mix(v.z - v.x, v.w - v.y, f.x));
    return clamp(halfWide + 0.5 - abs(here) / max(1e-4, length(vec2(dot(slope, dx), dot(slope, dy)))), 0.0, 1.0);
}
void main() {
    vec2 dx = dFdx(at), dy = dFdy(at);
    vec2 q = at - 0.5;
    ivec2 low = ivec2(floor(q)), last = textureSize(tissues, 0) - 1;
    vec2 f = q - floor(q);
    int t[4];
    vec4 other, outside;
    float w[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 o = ivec2(i & 1, i >> 1);
        vec3 texel = texelFetch(tissues, clamp(low + o, ivec2(0), last), 0).rgb * 255.0;
        t[i] = int(texel.r + 0.5);
        other[i] = texel.g / 32.0;
        outside[i] = texel.b / 32.0;
        w[i] = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    }
    // The tissue that most of the four are of, each counting for as much as it lies off the boundary: between two
    // tissues that is on which side of it one is.
    int kind = 0;
    float most = -1.0;
    for (int i = 0; i < 4; ++i) {
        float sum = 0.0;
        for (int j = 0; j < 4; ++j) sum += t[j] == t[i] ? w[j] * other[j] : 0.0;
        if (sum > most) { most = sum; kind = t[i]; }
    }
    if (kind == 0 || (visibleTissues >> kind & 1) == 0) discard;
    for (int i = 0; i < 4; ++i) {
        other[i] *= t[i] == kind ? 1.0 : -1.0;
        outside[i] *= t[i] != 0 ? 1.0 : -1.0;
    }
    // Of the tooth's outline only the inner half is there to be drawn.
    float line = max(lineOver(other, f, dx, dy, 0.8), lineOver(outside, f, dx, dy, 1.4)), grey = 0.0;
    if (grid != 0) {
        vec2 perPixel = vec2(length(vec2(dx.x, dy.x)), length(vec2(dx.y, dy.y)));
        vec2 mm = (at - 0.5) * mmPerPixel + gridOrigin;
        vec2 away = abs(mm - round(mm)) / (perPixel * mmPerPixel);
        grey = clamp(1.0 - min(away.x, away.y), 0.0, 1.0);
    }
    surface = vec4(0.5, 0.5, 0.5,
                   (float(kind) * 2048.0 + 1024.0 + 32.0 * floor(31.0 * line + 0.5) + floor(31.0 * grey + 0.5)) / 65535.0);
}
)";

// Alchemy ambient occlusion (McGuire, Osman, Bukowski, Hennessy 2011) on a spiral, and what stands between a place and
// the lamp, found by walking towards it over the depths: a cavity's walls throw their shadow on its floor. At half the
// resolution.
constexpr const char* kOcclusionFragment = R"(
uniform sampler2D surface;
uniform sampler2D depth;
uniform mat3 toEye;
uniform vec4 unproject;   // x and y of a pixel per unit of depth: scale, shift
uniform vec2 depthTerms;  // p22, p23
uniform float radiusMm;
uniform float pixelsPerMm;  // at unit depth
uniform float mostPixels;
uniform int samples;
uniform float turns;
uniform vec3 lamp;      // as the eye has it
uniform int shadowSteps;
uniform float shadowMm;
layout(location = 0) out vec4 result;
float eyeDepth(ivec2 p) { return depthTerms.y / (2.0 * texelFetch(depth, p, 0).r - 1.0 + depthTerms.x); }
void main() {
    ivec2 last = textureSize(depth, 0) - 1;
    ivec2 p = min(2 * ivec2(gl_FragCoord.xy), last);
    float d = texelFetch(depth, p, 0).r;
    if (d >= 1.0) { result = vec4(1.0, 60000.0, 1.0, 0.0); return; }
    float z = depthTerms.y / (2.0 * d - 1.0 + depthTerms.x);
    vec3 c = vec3((vec2(p) + 0.5) * unproject.xy + unproject.zw, -1.0) * z;
    vec3 n = texelFetch(surface, p, 0).xyz * 2.0 - 1.0;
    float open = 1.0, lit = 1.0;
    if (dot(n, n) > 0.1) {
        n = toEye * normalize(n);
        float r2 = radiusMm * radiusMm;
        float reach = min(mostPixels, radiusMm * pixelsPerMm / z);
        // Sixteen directions to begin with, in a pattern of 4 x 4 that the blur takes away again.
        ivec2 q = ivec2(gl_FragCoord.xy) & 3;
        int index = ((q.x ^ q.y) & 1) * 8 + (q.x & 1) * 4 + ((q.x ^ q.y) & 2) * 1 + ((q.x >> 1) & 1);
        float phase = float(index) * 0.39269908;
        float sum = 0.0;
        for (int i = 0; i < samples; ++i) {
            float share = (float(i) + 0.5) / float(samples);
            float angle = share * turns + phase;
            vec2 step = vec2(cos(angle), sin(angle)) * (reach * share * share + 1.0);
            ivec2 s = clamp(p + ivec2(step), ivec2(0), last);
            float sz = eyeDepth(s);
            vec3 v = vec3((vec2(s) + 0.5) * unproject.xy + unproject.zw, -1.0) * sz - c;
            float vv = dot(v, v), vn = dot(v, n) - 0.0012 * z;
            float fall = max(0.0, 1.0 - vv / r2);
            sum += fall * fall * max(0.0, vn) * inversesqrt(vv + 1e-4);
        }
        open = max(0.0, 1.0 - 2.6 * sum / float(samples));
        float farMm = min(shadowMm, mostPixels * z / (pixelsPerMm * max(0.2, length(lamp.xy))));
        int steps = dot(n, lamp) > -0.2 ? shadowSteps : 0;  // turned away it is dark already
        for (int i = 0; i < steps; ++i) {
            float share = (float(i) + 0.25 + 0.0625 * float(index)) / float(steps);
            float t = farMm * share * (0.4 + 0.6 * share);
            vec3 q = c + 0.05 * n + t * lamp;
            ivec2 s = clamp(ivec2((q.xy / -q.z - unproject.zw) / unproject.xy), ivec2(0), last);
            if (max(abs(s.x - p.x), abs(s.y - p.y)) > int(mostPixels)) break;  // what is farther off is not drawn anew
            // Before that place by how much: far before it is something else, which one would see past.
            float over = -q.z - eyeDepth(s) - 0.02 * t - 0.0012 * z;
            float hides = smoothstep(0.0, 0.05 + 0.25 * t, over) * (1.0 - smoothstep(1.5, 3.5, over));
            lit = min(lit, 1.0 - hides * (1.0 - 0.6 * share * share));
        }
    }
    result = vec4(open, z, lit, 0.0);
}
)";

constexpr const char* kOcclusionBlurFragment = R"(
uniform sampler2D occlusion;
layout(location = 0) out vec4 result;
void main() {
    ivec2 last = textureSize(occlusion, 0) - 1;
    ivec2 p = ivec2(gl_FragCoord.xy);
    float middle = texelFetch(occlusion, p, 0).g;
    vec2 sum = vec2(0.0);
    float weights = 1e-4;
    // A software renderer ends a loop early where none of its pixels goes on: in the background.
    int end = middle < 50000.0 ? 2 : -2;
    for (int y = -2; y < end; ++y)
        for (int x = -2; x < 2; ++x) {
            vec3 s = texelFetch(occlusion, clamp(p + ivec2(x, y), ivec2(0), last), 0).rgb;
            float w = max(0.0, 1.0 - abs(s.g - middle) * 3.0) + 1e-5;
            sum += s.rb * w;
            weights += w;
        }
    result = vec4(sum.x / weights, middle, sum.y / weights, 0.0);
}
)";

constexpr const char* kBackgroundFragment = R"(
in vec2 uv;
uniform vec3 top, bottom;
out vec4 colour;
void main() {
    vec3 c = mix(top, bottom, uv.y);
    vec2 m = uv - vec2(0.5, 0.45);
    c *= 1.0 + 0.22 * max(0.0, 1.0 - 2.6 * dot(m, m));
    // Half a step of noise: a dark gradient shows its steps otherwise.
    float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
    colour = vec4(c + (noise - 0.5) / 255.0, 1.0);
}
)";

constexpr const char* kLightFragment = R"(
in vec2 uv;
uniform sampler2D surface;
uniform sampler2D depth;
uniform sampler2D occlusion;
uniform sampler2D depthScale;
uniform mat4 toTooth;   // from NDC
uniform vec2 depthTerms;
uniform vec3 eye, lamp, sky, eyeRight;
uniform vec3 palette[32];   // linear
uniform vec4 material[32];  // wrap, gloss, sharpness of it, how far light goes under
uniform float wet;
uniform int natural;
uniform vec2 crown;         // where it begins and ends along z
uniform int hasDentine;     // 1: how far it lies is known; 2: there is none
uniform sampler2D dentineTiles;
uniform vec3 dentineLow, perDentine;
uniform int removedColours;
uniform float removedMost;
#ifdef SCANNED
uniform sampler2D scanned;
#endif
#ifdef SHADOWS
uniform sampler2DShadow shadowMap;
uniform mat4 toShadow;
#endif
out vec4 colour;
// From the dentine [mm], between the two layers that it lies in.
float overDentine(vec3 p) {
    vec3 q = clamp((p - dentineLow) * perDentine, vec3(0.0), vec3(22.999));
    float low = floor(q.z);
    vec2 a = vec2(mod(low, 6.0), floor(low / 6.0)), b = vec2(mod(low + 1.0, 6.0), floor((low + 1.0) / 6.0));
    const vec2 size = vec2(144.0, 96.0);
    return 2.55 * mix(texture(dentineTiles, (a * 24.0 + q.xy + 0.5) / size).r,
                      texture(dentineTiles, (b * 24.0 + q.xy + 0.5) / size).r, q.z - low);
}
#ifdef FINE
float hash(vec3 p) {
    p = fract(p * 0.3183099 + 0.1);
    p *= 17.0;
    return fract(p.x * p.y * p.z * (p.x + p.y + p.z));
}
float noise(vec3 x) {
    vec3 i = floor(x), f = fract(x);
    f = f * f * (3.0 - 2.0 * f);
    return mix(mix(mix(hash(i), hash(i + vec3(1, 0, 0)), f.x), mix(hash(i + vec3(0, 1, 0)), hash(i + vec3(1, 1, 0)), f.x), f.y),
               mix(mix(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), f.x), mix(hash(i + vec3(0, 1, 1)), hash(i + vec3(1, 1, 1)), f.x), f.y), f.z);
}
// Pits of attached gingiva, one or none in each cube of p, round, not in rows: how deep, and where the slope goes.
vec4 pit(vec3 p) {
    vec3 cube = floor(p);
    float one = hash(cube);
    vec3 d = p - cube - vec3(0.5) - 0.36 * (vec3(one, hash(cube + 17.0), hash(cube + 41.0)) - 0.5);
    float in2 = max(0.0, 1.0 - dot(d, d) / (0.32 * 0.32));
    float depth = 0.35 + 0.65 * fract(7.0 * one);
    return depth * vec4(-in2 * d * (4.0 / (0.32 * 0.32)), in2 * in2);
}
#endif
// Gingiva by how far under its margin it lies [mm], 0 where nobody knows: its free edge is smooth and pale, the attached
// part stippled like an orange, mucosa under it darker, redder, thin and wet.
void gum(float under, vec3 at, inout vec3 albedo, inout vec3 n, inout vec4 m) {
    if (under <= 0.0) return;
    float mucosa = smoothstep(6.2, 8.2, under);
    float attached = smoothstep(1.2, 2.2, under) * (1.0 - mucosa);
    albedo *= mix(vec3(1.0), vec3(1.06, 1.10, 1.08), attached);
    albedo *= mix(vec3(1.0), vec3(0.86, 0.60, 0.62), mucosa);
    m.y *= mix(1.0, 0.75, attached) * mix(1.0, 1.15, mucosa);
#ifdef FINE
    if (attached > 0.0) {
        // Two layers, turned against each other and the axes.
        const mat3 one = mat3(0.80, 0.36, -0.48, -0.60, 0.48, -0.64, 0.00, 0.80, 0.60),
                   two = mat3(0.36, 0.48, 0.80, -0.80, 0.60, 0.00, -0.48, -0.64, 0.60);
        vec4 a = pit(one * at * 1.25), b = pit(two * at * 1.55 + 0.37);
        vec3 slope = transpose(one) * a.xyz * 1.25 + transpose(two) * b.xyz * 1.55;
        slope -= dot(slope, n) * n;
        n = normalize(n + attached * 0.022 * slope);
        albedo *= 1.0 - 0.04 * attached * (a.w + b.w);
    }
#endif
}
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    float d = texelFetch(depth, p, 0).r;
    if (d >= 1.0) discard;
    vec4 g = texelFetch(surface, p, 0);
    float code = floor(g.w * 65535.0 + 0.5);
    int kind = int(code / 2048.0);
    vec3 n = g.xyz * 2.0 - 1.0;
    float low = code - float(kind) * 2048.0, blood = 0.0;
    if (kind == 27) {
        blood = mod(low, 64.0) / 63.0;
        low = 33.0 * floor(low / 64.0);
        kind = 6;
    }
    vec3 albedo = palette[kind];
    if (dot(n, n) < 0.1) {  // a section's face: as a drawing
        vec3 face = albedo * (low == 1.0 ? 0.55 : 0.92);
        if (low >= 1024.0) {
            face = mix(face, palette[30] * 0.92, mod(low, 32.0) / 31.0);
            face = mix(face, palette[31] * 0.92, floor((low - 1024.0) / 32.0) / 31.0);
        }
        colour = vec4(pow(face, vec3(1.0 / 2.2)), 1.0);
        return;
    }
    n = normalize(n);
    vec4 h = toTooth * vec4(2.0 * uv - 1.0, 2.0 * d - 1.0, 1.0);
    vec3 at = h.xyz / h.w;
    vec3 v = normalize(eye - at);
    if (kind == 29) n = dot(n, v) < 0.0 ? -n : n;
    float nv = clamp(dot(n, v), 0.0, 1.0);

    float eyeDepth = depthTerms.y / (2.0 * d - 1.0 + depthTerms.x);
    vec3 across = (toTooth[0].xyz - at * toTooth[0].w) / h.w, upwards = (toTooth[1].xyz - at * toTooth[1].w) / h.w;
    float pixelMm = 2.0 * length(across) / float(textureSize(surface, 0).x);
    across = normalize(across);
    upwards = normalize(upwards);
    float open = 1.0, lit = 1.0;
    {
        // From half resolution, without mixing near and far.
        float z = eyeDepth;
        vec2 q = 0.5 * gl_FragCoord.xy - 0.25;
        ivec2 low = max(ivec2(floor(q)), ivec2(0)), last = textureSize(occlusion, 0) - 1;
        vec2 f = fract(q);
        vec2 sum = vec2(0.0);
        float weights = 0.0;
        for (int i = 0; i < 4; ++i) {
            ivec2 o = ivec2(i & 1, i >> 1);
            vec3 s = texelFetch(occlusion, min(low + o, last), 0).rgb;
            float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y) + 0.01;
            w *= max(0.0, 1.0 - abs(s.g - z) * 2.0) + 1e-4;
            sum += s.rb * w;
            weights += w;
        }
        open = sum.x / weights;
        lit = sum.y / weights;
    }

    vec4 m = material[kind];
    bool isTooth = kind == 1 || kind == 8;
    if (natural != 0) {
        if (isTooth) {
            // Enamel is clear: where it is thin dentine shines through it, where it is thick and nothing lies behind it
            // is greyer and bluer. Where no dentine is known, by the height in the crown.
            float up = kind == 8 ? min(1.0, (code - 16384.0) / 2000.0)
                                 : clamp((at.z - crown.x) / (crown.y - crown.x), 0.0, 1.0);
            float mm = kind == 1 && hasDentine == 2 ? 2.55 : kind == 1 && hasDentine == 1 ? overDentine(at)
                                                    : 0.12 + 0.95 * smoothstep(0.0, 0.55, up) + 0.5 * smoothstep(0.75, 1.0, up);
            albedo *= mix(vec3(1.0), vec3(0.93, 0.77, 0.53), exp2(-2.4 * mm));
            float clear = smoothstep(1.1, 2.0, mm) * (0.30 + 0.70 * (1.0 - nv));
            albedo *= mix(vec3(1.0), vec3(0.84, 0.89, 0.94), clear);
            // What stays in fissures.
            float deep = clamp(1.0 - open, 0.0, 1.0);
            albedo *= mix(vec3(1.0), vec3(0.70, 0.52, 0.33), smoothstep(0.22, 0.85, deep) * 0.9);
        }
        // A white spot is opaque: dentine shines through less, not at all at its tips.
        float upward = clamp((at.z - crown.x) / (crown.y - crown.x), 0.0, 1.0);
        if (kind == 10) albedo *= mix(vec3(0.96, 0.90, 0.80), vec3(1.0), smoothstep(0.0, 0.65, upward));
#ifdef FINE
        // Gum is blotched and caries grained in two sizes, other tissues in one.
        bool isCaries = kind == 4 || (kind >= 11 && kind <= 16);
        vec3 sizes = kind == 6 ? vec3(0.9, 0.9, 5.0) : isCaries ? vec3(9.0, 9.0, 3.0) : vec3(1.6, 3.2, 0.0);
        float grain = noise(at * sizes.xxy);
        if (kind == 6 || isCaries) grain = mix(noise(at * sizes.z), grain, kind == 6 ? 0.6 : 0.5);
        // The firmer, the less it crumbles.
        float coarse = kind == 4 ? 0.75 : isCaries ? 0.6 - 0.09 * float(kind - 11) : 0.07;
        if (isTooth || kind == 2 || kind == 5 || isCaries) albedo *= 1.0 + coarse * (grain - 0.5);
#else
        float grain = 0.5;
#endif
        if (kind == 6) {
            albedo *= mix(vec3(0.93, 0.82, 0.84), vec3(1.05, 1.06, 1.04), grain);
            gum(low * 0.01, at, albedo, n, m);
        }
    }
#ifdef SCANNED
    // As the scanner saw it: all that was done to the tissue's colour above is in it already. Between a vertex that was
    // scanned and one that was cut it fades.
    vec4 seen = texelFetch(scanned, p, 0);
    if (seen.a > 0.0) albedo = mix(albedo, pow(seen.rgb / seen.a, vec3(2.2)), seen.a);
#endif
    if (removedColours != 0 && kind != 6 && kind != 7 && kind != 8 && kind != 29)
        albedo = texture(depthScale, vec2(low * 0.01 / removedMost, 0.5)).rgb;

    if (blood > 0.0) {
        // A film lets what is under it through, red; thick it is nearly black, and always wet.
        float over = smoothstep(0.0, 0.10, blood);
        albedo = mix(albedo, mix(vec3(0.30, 0.006, 0.008), vec3(0.085, 0.002, 0.003), smoothstep(0.1, 0.8, blood)), over);
        m = mix(m, vec4(0.12, 0.75, 1.7, 0.15), over);
    }

    // Light goes into tissue and comes out beside: red farther than blue.
    float nl = dot(n, lamp);
    vec3 wrap = m.x * vec3(1.25, 1.0, 0.8);
    vec3 key = max(vec3(0.0), (nl + wrap) / (1.0 + wrap));
#ifdef SHADOWS
    vec4 s = toShadow * vec4(at + n * 0.06, 1.0);
    float sum = 0.0;
    vec2 texel = 1.6 / vec2(textureSize(shadowMap, 0));
    for (int i = 0; i < 16; ++i) {
        vec2 o = vec2(float(i & 3), float(i >> 2)) - 1.5;
        sum += texture(shadowMap, vec3(s.xy + o * texel, s.z));
    }
    lit = min(lit, sum / 16.0);
#endif
    key *= mix(vec3(0.16, 0.12, 0.10) * m.w + 0.04, vec3(1.0), lit);
    float skyward = 0.5 + 0.5 * dot(n, sky);
    vec3 side = normalize(0.85 * eyeRight + 0.25 * sky + 0.35 * v);
    float fill = max(0.0, 0.25 + 0.75 * dot(n, side));
    // Light that goes to and fro in a hollow takes up the colour of its walls.
    vec3 a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
    // Half of it: a fissure is to be read.
    vec3 openColour = mix(vec3(open), max(vec3(open), ((open * a + b) * open + c) * open), 0.5);
    vec3 keyOpen = mix(vec3(1.0), openColour, 0.7);
    vec3 light = key * keyOpen * vec3(1.62, 1.56, 1.46) +
                 (mix(vec3(0.17, 0.15, 0.15), vec3(0.42, 0.46, 0.52), skyward) + fill * vec3(0.20, 0.23, 0.28)) * openColour;
    vec3 sum3 = albedo * light * 0.44;
    // Seen along the surface, enamel lets light of the other side through.
    float rim = (1.0 - nv) * (1.0 - nv);
    sum3 += albedo * m.w * rim * rim * vec3(0.10, 0.13, 0.17) * open;

    vec3 half3 = normalize(lamp + v);
    float nh = dot(n, half3);
    float fresnel = 0.04 + 0.96 * rim * rim * (1.0 - nv);
    vec3 r = reflect(-v, n);
    float gloss = m.y * mix(0.45, 1.0, wet);
    float sharp = m.z * mix(0.35, 1.0, wet);
    // Where the surface turns within a pixel a spark is as wide as the turn, and so much the fainter (after Tokuyoshi &
    // Kaplanyan 2019): the floor of a fissure is no row of dots.
    float turn = 0.0, edge = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 o = (i & 2) * ivec2(i & 1, 1 - (i & 1)) - ivec2(i & 1, 1 - (i & 1));
        ivec2 q = clamp(p + o, ivec2(0), textureSize(surface, 0) - 1);
        vec3 beside = texelFetch(surface, q, 0).xyz * 2.0 - 1.0;
        float isThere = abs(dot(beside, beside) - 1.0) < 0.5 ? 0.25 : 0.0;  // no background, no section's face
        turn += isThere * dot(beside - n, beside - n);
        float away = depthTerms.y / (2.0 * texelFetch(depth, q, 0).r - 1.0 + depthTerms.x) - eyeDepth;
        if (abs(away) < 10.0 * pixelMm) edge += 2.0 * isThere * dot(beside - n, float(o.x) * across + float(o.y) * upwards);
    }
    // Two faces that the lamp lights alike differ by the edge between them: outward it catches the light, inward it is
    // a line that no light reaches.
    sum3 *= 1.0 + 0.15 * smoothstep(0.12, 0.5, edge) - 0.4 * open * smoothstep(0.12, 0.5, -edge);
    vec2 lobe = sharp * vec2(14.0, 110.0), width = 1.0 / (1.0 + turn * lobe);
    lobe *= width;
    float spark = width.x * exp(lobe.x * (nh - 1.0)) * 0.16 + wet * width.y * exp(lobe.y * (nh - 1.0)) * 0.95;
    float window = smoothstep(0.72, 0.93, dot(r, side)) * 0.30;
    float above = smoothstep(-0.3, 0.9, dot(r, sky));
    float shade = clamp(open * 1.3 - 0.2, 0.0, 1.0);
    sum3 += gloss * shade * (spark * max(0.0, min(1.0, 4.0 * nl + 0.2)) * lit * vec3(1.0, 0.98, 0.94) +
             fresnel * (window + above * 0.38 + 0.05) * vec3(0.86, 0.94, 1.0) * (0.55 + 0.9 * wet));
    // As film takes it (K. Narkowicz's fit of ACES, 2016), by the brightness, so that hues stay: brighter than white rolls
    // off, and enamel under the lamp lies well below that.
    float bright = dot(sum3, vec3(0.2126, 0.7152, 0.0722)) + 1e-4;
    sum3 *= (2.51 * bright + 0.03) / (bright * (2.43 * bright + 0.59) + 0.14);
    // As pow(sum3, 1 / 2.2) to a step of 255, at a part of its cost.
    sum3 = clamp(sum3, 0.0, 1.0);
    vec3 root = sqrt(sum3);
    colour = vec4(0.9549 * root + 0.0956 * sqrt(root) - 0.0511 * sum3, 1.0);
}
)";

// After FXAA (Lottes 2009), the short way: along an edge, by the brightness around it.
constexpr const char* kSmoothFragment = R"(
in vec2 uv;
uniform sampler2D picture;
uniform vec2 pixel;
out vec4 colour;
void main() {
    const vec3 weights = vec3(0.299, 0.587, 0.114);
    ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(picture, 0) - 1;
    vec3 middle = texelFetch(picture, p, 0).rgb;
    float m = dot(middle, weights);
    float nw = dot(texelFetch(picture, max(p - 1, ivec2(0)), 0).rgb, weights);
    float ne = dot(texelFetch(picture, clamp(p + ivec2(1, -1), ivec2(0), last), 0).rgb, weights);
    float sw = dot(texelFetch(picture, clamp(p + ivec2(-1, 1), ivec2(0), last), 0).rgb, weights);
    float se = dot(texelFetch(picture, min(p + 1, last), 0).rgb, weights);
    float low = min(m, min(min(nw, ne), min(sw, se))), high = max(m, max(max(nw, ne), max(sw, se)));
    vec2 along = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
    float reduce = max((nw + ne + sw + se) * 0.03125, 0.0078125);
    along = clamp(along / (min(abs(along.x), abs(along.y)) + reduce), -6.0, 6.0) * pixel;
    vec3 near = 0.5 * (texture(picture, uv - along / 6.0).rgb + texture(picture, uv + along / 6.0).rgb);
    vec3 far = 0.5 * near + 0.25 * (texture(picture, uv - 0.5 * along).rgb + texture(picture, uv + 0.5 * along).rgb);
    float f = dot(far, weights);
    vec3 result = f < low || f > high ? near : far;
    colour = vec4(high - low < max(0.0153, high * 0.0313) ? middle : result, 1.0);
}
)";

// Shadow and nearness of the bur, as two capsules: multiplied into what is there. However deep it is as bright as
// under clouds and as blue, so that enamel in it is grey: brown is what caries is.
constexpr const char* kBurShadowFragment = R"(
in vec2 uv;
uniform sampler2D depth;
uniform mat4 toTooth;
uniform vec3 lamp;
uniform vec3 begin[2], end[2];
uniform float radius[2];
uniform float reach;
out vec4 colour;
float distanceTo(vec3 p, vec3 a, vec3 b) {
    vec3 ab = b - a;
    return length(p - a - ab * clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0));
}
void main() {
    float d = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r;
    if (d >= 1.0) discard;
    vec4 h = toTooth * vec4(2.0 * uv - 1.0, 2.0 * d - 1.0, 1.0);
    vec3 p = h.xyz / h.w;
    float light = 1.0;
    for (int i = 0; i < 2; ++i) {
        // Where the ray to the lamp comes nearest to the axis.
        vec3 ab = end[i] - begin[i], w = p - begin[i];
        float aa = dot(ab, ab), bl = dot(ab, lamp), bw = dot(ab, w), lw = dot(lamp, w);
        float denominator = max(1e-5, aa - bl * bl);
        float along = clamp((bw - bl * lw) / denominator, 0.0, 1.0);
        float t = max(0.0, dot(begin[i] + along * ab - p, lamp));
        along = clamp(dot(p + t * lamp - begin[i], ab) / aa, 0.0, 1.0);
        float away = length(p + t * lamp - begin[i] - along * ab) - radius[i];
        float soft = 0.16 + 0.17 * t;
        float dark = 1.0 - smoothstep(-soft, soft, away);
        light = min(light, 1.0 - dark * clamp(1.0 - t / reach, 0.0, 1.0) * smoothstep(0.0, 0.12, t));
    }
    float gap = max(0.0, distanceTo(p, begin[0], end[0]) - radius[0]);
    float nearness = 1.0 - 0.8 * exp(-gap * 3.2);
    colour = vec4(mix(vec3(0.60, 0.64, 0.71), vec3(1.0), min(light, nearness)), 1.0);
}
)";

constexpr const char* kGhostVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
uniform mat4 viewProjection;
out vec3 at, normalOut;
void main() {
    at = position;
    normalOut = normal.xyz;
    gl_Position = viewProjection * vec4(position, 1.0);
}
)";
constexpr const char* kGhostFragment = R"(
in vec3 at, normalOut;
uniform vec3 eye, lamp;
uniform vec4 clipPlane;
uniform vec4 mirrorPlane;
out vec4 colour;
void main() {
    if (dot(clipPlane, vec4(at, 1.0)) < 0.0 || dot(mirrorPlane, vec4(at, 1.0)) < 0.0) discard;
    vec3 n = normalize(normalOut), v = normalize(eye - at);
    float rim = 1.0 - abs(dot(n, v));
    float spark = exp(90.0 * (dot(n, normalize(lamp + v)) - 1.0));
    colour = vec4(mix(vec3(0.45, 0.72, 0.95), vec3(1.0), spark), clamp(0.30 + 0.5 * rim * rim + 0.6 * spark, 0.0, 0.9));
}
)";

std::string with(const char* define, const char* text) {
    return std::string("#define ") + define + "\n" + text;
}

}  // namespace

ScannedShaders::ScannedShaders()
    : surface("scanned surface", with("SCANNED", kSurfaceVertex), with("SCANNED", kSurfaceFragment)),
      clippedSurface("clipped scanned surface", with("SCANNED", with("CLIPPED", kSurfaceVertex).c_str()),
                     with("SCANNED", with("CLIPPED", kSurfaceFragment).c_str())),
      light("light of a scan", kFullScreenVertex, with("SCANNED", kLightFragment)),
      fineLight("fine light of a scan", kFullScreenVertex, with("SCANNED", with("FINE", kLightFragment).c_str())),
      shadowedLight("light of a scan with shadows", kFullScreenVertex,
                    with("SCANNED", with("FINE", with("SHADOWS", kLightFragment).c_str()).c_str())) {}

Shaders::Shaders()
    : surface("surface", kSurfaceVertex, kSurfaceFragment),
      clippedSurface("clipped surface", with("CLIPPED", kSurfaceVertex), with("CLIPPED", kSurfaceFragment)),
      cap("section", kCapVertex, kCapFragment),
      occlusion("occlusion", kFullScreenVertex, kOcclusionFragment),
      occlusionBlur("occlusion blur", kFullScreenVertex, kOcclusionBlurFragment),
      background("background", kFullScreenVertex, kBackgroundFragment),
      light("light", kFullScreenVertex, kLightFragment),
      fineLight("fine light", kFullScreenVertex, with("FINE", kLightFragment)),
      shadowedLight("light with shadows", kFullScreenVertex, with("FINE", with("SHADOWS", kLightFragment).c_str())),
      smooth("smooth", kFullScreenVertex, kSmoothFragment),
      burShadow("bur shadow", kFullScreenVertex, kBurShadowFragment),
      bur("bur", kInstrumentVertex, with("BUR", kInstrumentFragment)),
      glassBur("bur as glass", kInstrumentVertex, with("GLASS", with("BUR", kInstrumentFragment).c_str())),
      turbine("turbine", kInstrumentVertex, kInstrumentFragment),
      glassTurbine("turbine as glass", kInstrumentVertex, with("GLASS", kInstrumentFragment)),
      ghost("ghost", kGhostVertex, kGhostFragment) {}

}  // namespace handpiece::view
