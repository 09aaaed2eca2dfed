// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What bur and turbine look like: metal, and glass where they would hide what is worked at. Private to this room.

namespace handpiece::view {

inline constexpr const char* kInstrumentVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
uniform mat4 viewProjection, burInTooth;
out vec3 at, normalOut, local;
void main() {
    vec4 p = burInTooth * vec4(position, 1.0);
    at = p.xyz;
    local = position;
    normalOut = mat3(burInTooth) * normal.xyz;
    gl_Position = viewProjection * p;
}
)";

inline constexpr const char* kInstrumentFragment = R"(
in vec3 at, normalOut, local;
uniform vec3 eye, lamp, eyeUp, eyeRight;
#ifdef GLASS
uniform float goneMm, wholeMm;
#ifdef BUR
uniform vec3 tip, toEye;  // the bur's, and from there
uniform float eyeMm, siteMm, glassFrom, glassOver;
uniform float heldFrom, heldShare;  // where the shank goes into the head, and how much of that is drawn
#else
uniform float share[32], shareFrom, shareStep;  // of the handpiece, along its handle
#endif
#endif
#ifdef BUR
uniform mat4 burInTooth;
uniform int finish;     // 0 diamond, 1 carbide, 2 steel, 3 plain
uniform float headLength, headRadius;
uniform float blur;     // 0 the bur stands, 1 it turns faster than one can see
uniform float turn;     // of the bur about its axis
float hash(vec3 p) {
    p = fract(p * 0.3183099 + 0.1);
    p *= 17.0;
    return fract(p.x * p.y * p.z * (p.x + p.y + p.z));
}
#endif
uniform vec4 mirrorPlane;
out vec4 colour;
// What polished steel sees: a lamp, a window, a bright ceiling, a dark floor.
vec3 room(vec3 r, float rough) {
    float up = dot(r, eyeUp);
    vec3 c = mix(vec3(0.05, 0.055, 0.065), vec3(0.50, 0.54, 0.60), smoothstep(-0.35 - rough, 0.65 + rough, up));
    c += vec3(0.55, 0.60, 0.66) * smoothstep(0.55 - rough, 0.85 + rough, dot(r, eyeRight));
    c += vec3(0.25, 0.24, 0.23) * smoothstep(0.6 - rough, 0.9 + rough, -dot(r, eyeRight));
    c -= vec3(0.16) * (1.0 - smoothstep(0.0, 0.22 + rough, abs(up + 0.12)));
    float l = max(0.0, dot(r, lamp));
    c += vec3(1.0, 0.97, 0.92) * exp(mix(90.0, 10.0, rough) * (l - 1.0)) * mix(2.2, 0.7, rough);
    return max(c, vec3(0.0));
}
void main() {
    if (dot(mirrorPlane, vec4(at, 1.0)) < 0.0) discard;
    vec3 n = normalize(normalOut), v = normalize(eye - at);
    if (dot(n, v) < 0.0) n = -n;
    float nv = clamp(dot(n, v), 0.0, 1.0);
    vec3 tint = vec3(0.80, 0.82, 0.85);
    float rough = 0.22;
    float groove = 1.0;
#ifdef BUR
    rough = 0.08;
    tint = vec3(0.86, 0.86, 0.87);
    if (local.z < headLength + 0.05) {
        if (finish == 0) {
            // Diamond: grains that glitter while it stands, and a smooth grey blur when it runs.
            float cs = cos(turn), sn = sin(turn);
            vec3 q = vec3(cs * local.x - sn * local.y, sn * local.x + cs * local.y, local.z);
            // Grains lie across the axes, each somewhere in its cell, in a darker bond.
            q = 13.0 * vec3(0.8 * q.x + 0.6 * q.z, q.y + 0.3 * q.x, 0.8 * q.z - 0.6 * q.x);
            vec3 cell = floor(q);
            float g = hash(cell), g2 = hash(cell + 7.3), g3 = hash(cell + 3.1);
            vec3 from = q - cell - 0.5 - 0.36 * (vec3(g, g2, g3) - 0.5);
            float stone = smoothstep(0.30, 0.10, dot(from, from));
            float grain = 1.0 - blur;
            n = normalize(n + grain * (0.25 + 0.65 * stone) * (vec3(g3, g, g2) - 0.5));
            rough = 0.45;
            tint = mix(vec3(0.62, 0.60, 0.57), mix(vec3(0.40, 0.39, 0.38), vec3(0.62 + 0.46 * g2), stone), grain * 0.75);
            // Running, the grains of each height draw a ring.
            tint *= 1.0 + blur * 0.22 * (hash(vec3(0.0, 0.0, floor(local.z * 22.0))) - 0.5);
        } else if (finish != 3) {
            // Blades wound about the axis, steep in front, hollow behind; running, their edges draw a bright veil.
            float blades = finish == 1 ? 8.0 : 6.0;
            float angle = atan(local.y, local.x) + turn;
            float way = fract(blades * angle * 0.15915494 + 0.35 * local.z / max(0.2, headRadius));
            float stands = 1.0 - blur;
            vec3 across = normalize(cross(vec3(burInTooth[2]), normalOut) + 1e-5);
            n = normalize(n + stands * across * mix(-0.85, 0.75, smoothstep(0.05, 0.6, way)));
            groove = mix(1.0, mix(0.22, 1.0, smoothstep(0.0, 0.55, way)), stands);
            groove += stands * 0.5 * smoothstep(0.84, 0.9, way) * (1.0 - smoothstep(0.95, 1.0, way));
            float ring = hash(vec3(0.0, 0.0, floor(local.z * 30.0)));
            groove *= mix(1.0, 0.72 + 0.20 * ring, blur);
            rough = mix(finish == 1 ? 0.16 : 0.12, 0.34, blur);
            tint = finish == 1 ? vec3(0.70, 0.71, 0.74) : vec3(0.82, 0.82, 0.83);
        }
    }
#endif
    vec3 r = reflect(-v, n);
    float diffuse = 0.5 + 0.5 * dot(n, lamp);
    vec3 c = groove * tint * (room(r, rough) * 0.85 + 0.22 * diffuse * diffuse);
    float rim = 1.0 - nv, rim2 = rim * rim;
    c += rim2 * rim2 * rim * vec3(0.25);
    c = c * (1.0 + c * 0.10) / (1.0 + 0.25 * c);
    // As pow(c, 1 / 2.2) to a step of 255, at a part of its cost.
    c = clamp(c, 0.0, 1.0);
    vec3 root = sqrt(c);
    c = 0.9549 * root + 0.0956 * sqrt(root) - 0.0511 * c;
#ifdef GLASS
    // What is so near to the eye that it would fill the picture is gone; on a short way, or a veil lies over the work.
    float there = smoothstep(goneMm + 0.42 * (wholeMm - goneMm), goneMm + 0.58 * (wholeMm - goneMm), 1.0 / gl_FragCoord.w);
#ifdef BUR
    // What lies over the place that is worked at too, the more the higher it lies.
    vec3 w = at - tip;
    float high = dot(w, toEye);
    float away = length(w - high * toEye) * eyeMm / max(0.05 * eyeMm, eyeMm - high);
    float site = siteMm * clamp((high - glassFrom) / glassOver, 0.0, 1.0) + 0.01;
    float solid = smoothstep(0.6 * site, site, away);
    // Of the bur an outline stays: where it stands is to be seen.
    vec3 glass = mix(vec3(0.80, 0.90, 0.97), c, 0.35);
    float share = 1.0 / (gl_FragCoord.w * eyeMm);  // what is near to the eye is large: its edges are drawn faintly
    float edge = 0.03 + 0.60 * rim2 * sqrt(rim) * min(1.0, share * share);
    // Light that the glass throws back is seen whatever lies behind.
    float spark = clamp(2.0 * (c.g - 0.82), 0.0, 0.35);
    float veil = mix(max(edge, spark), 1.0, solid);
    // A shank that nothing holds would float: it ends with the head.
    there *= mix(1.0 - smoothstep(heldFrom, heldFrom + 2.5, local.z), 1.0, heldShare);
    if (there < 0.01) discard;
    colour = there * vec4(mix(glass, c, solid) * veil, veil);
#else
    // Of the handpiece nothing: its rims would lie over the work like a bell jar.
    float slice = clamp((local.x - shareFrom) / shareStep - 0.5, 0.0, 30.999);
    int first = int(slice);
    // Bright metal that is half there is milk: it ends on a short way.
    float solid = smoothstep(0.36, 0.64, mix(share[first], share[first + 1], slice - float(first)));
    colour = there * solid * vec4(c, 1.0);
    // What is not seen hides nothing either: depth is written.
    if (colour.a < 0.01) discard;
#endif
#else
    colour = vec4(c, 1.0);
#endif
}
)";

}  // namespace handpiece::view
