// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/effects_solid.h"

#include <cmath>
#include <numbers>

namespace handpiece::view {

using core::Vec3;

namespace {

const char* const kVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
uniform mat4 viewProjection;
uniform mat3 turn;
uniform mat4 view;
out vec3 eyePlace, eyeNormal;
void main() {
    eyePlace = (view * vec4(place, 1.0)).xyz;
    eyeNormal = turn * normal;
    gl_Position = viewProjection * vec4(place, 1.0);
}
)";
// Metal shows a made-up room: bright above, a dark band at the horizon, a floor; paint scatters.
const char* const kFragment = R"(
in vec3 eyePlace, eyeNormal;
uniform vec3 light;
uniform vec3 colour;
uniform float metal, alpha;
out vec4 result;
void main() {
    vec3 v = normalize(-eyePlace);
    vec3 n = normalize(eyeNormal);
    n = dot(n, v) < 0.0 ? -n : n;
    vec3 h = normalize(light + v);
    float facing = max(dot(n, v), 0.0);
    float diffuse = 0.38 + 0.62 * max(0.5 * dot(n, light) + 0.5, 0.0);
    float shine = pow(max(dot(n, h), 0.0), 40.0);
    vec3 painted = colour * diffuse + 0.25 * shine;
    vec3 r = reflect(-v, n);
    float room = mix(0.20, 0.50, smoothstep(-0.9, -0.15, r.y));
    room = mix(room, 0.16, smoothstep(-0.15, 0.05, r.y));
    room = mix(room, 0.88, smoothstep(0.08, 0.55, r.y));
    room = mix(room, 0.62, smoothstep(0.7, 1.0, r.y));
    vec3 polished = colour * room + vec3(0.75 * pow(max(dot(n, h), 0.0), 90.0)) + 0.12 * pow(1.0 - facing, 4.0);
    result = vec4(mix(painted, polished, metal), alpha);
}
)";

constexpr double kEdgeCos = 0.766;  // of 40 degrees

}  // namespace

void Solid::addRings(const std::vector<Ring>& rings, int around) {
    // Slope of each stretch, outwards and along; a ring between two that turn sharply is there twice, once for each.
    const auto slope = [&](std::size_t i) {
        const Ring &a = rings[i], &b = rings[i + 1];
        const double along = (b.centreMm - a.centreMm).dot((a.along + b.along).normalized());
        const core::Vec2 n(along, a.radiusMm - b.radiusMm);
        return n.norm() > 1e-12 ? core::Vec2(n.normalized()) : core::Vec2(1.0, 0.0);
    };
    const auto n = static_cast<std::uint32_t>(around);
    const auto addRing = [&](const Ring& ring, const core::Vec2& out) {
        const Vec3 other = ring.along.cross(ring.side);
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (std::uint32_t j = 0; j < n; ++j) {
            const double angle = 2.0 * std::numbers::pi * j / n;
            const Vec3 radial = std::cos(angle) * ring.side + std::sin(angle) * other;
            vertices.push_back({(ring.centreMm + ring.radiusMm * radial).cast<float>(),
                                (out.x() * radial + out.y() * ring.along).normalized().cast<float>()});
        }
        return first;
    };
    for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
        core::Vec2 start = slope(i), end = start;
        if (i > 0 && slope(i - 1).dot(start) > kEdgeCos) start = (slope(i - 1) + start).normalized();
        if (i + 2 < rings.size() && slope(i + 1).dot(end) > kEdgeCos) end = (slope(i + 1) + end).normalized();
        const std::uint32_t a = addRing(rings[i], start), b = addRing(rings[i + 1], end);
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t k = (j + 1) % n;
            for (const std::uint32_t index : {a + j, a + k, b + k, a + j, b + k, b + j})
                indices.push_back(index);
        }
    }
}

PixelRect rectOf(const Eye& eye, const Viewport& viewport, const std::vector<Vec3>& pointsMm) {
    PixelRect rect;
    const gl::Mat4f m = eye.viewProjection();
    bool first = true;
    for (const Vec3& p : pointsMm) {
        const gl::Vec4f c =
            m * gl::Vec4f(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 1.0f);
        if (c.w() < 0.05f) return {0, 0, viewport.width, viewport.height};
        // Far outside is clamped: only whether and where it is inside matters.
        const double x = 0.5 * (std::clamp(static_cast<double>(c.x() / c.w()), -3.0, 3.0) + 1.0) * viewport.width;
        const double y = 0.5 * (std::clamp(static_cast<double>(c.y() / c.w()), -3.0, 3.0) + 1.0) * viewport.height;
        const PixelRect one{static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)),
                            static_cast<int>(std::ceil(x)) + 1, static_cast<int>(std::ceil(y)) + 1};
        rect = first ? one : rect.joined(one);
        first = false;
    }
    return first ? PixelRect{} : rect.grown(2).common({0, 0, viewport.width, viewport.height});
}

PixelRect rectOf(const Eye& eye, const Viewport& viewport, const Solid& solid) {
    std::vector<Vec3> points;
    points.reserve(solid.vertices.size());
    for (const Solid::Vertex& v : solid.vertices)
        points.push_back(v.placeMm.cast<double>());
    return rectOf(eye, viewport, points);
}

SolidDrawer::SolidDrawer() : program_("solid", kVertex, kFragment) {}

std::size_t SolidDrawer::draw(const PassContext& context, const Solid& solid, const gl::Vec3f& srgb, float metal,
                              float hiddenAlpha) {
    if (solid.indices.empty()) return 0;
    array_.bind();
    vertices_.fill(GL_ARRAY_BUFFER, solid.vertices.data(), solid.vertices.size() * sizeof(Solid::Vertex),
                   GL_STREAM_DRAW);
    array_.attach(vertices_, sizeof(Solid::Vertex),
                  {{0, 3, GL_FLOAT, false, offsetof(Solid::Vertex, placeMm)},
                   {1, 3, GL_FLOAT, false, offsetof(Solid::Vertex, normal)}});
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, solid.indices.data(), solid.indices.size() * sizeof(std::uint32_t),
                  GL_STREAM_DRAW);
    array_.attachIndices(indices_);
    const gl::Mat3f turn = context.eye.view.topLeftCorner<3, 3>();
    program_.use();
    program_.set("viewProjection", context.eye.viewProjection());
    program_.set("view", context.eye.view);
    program_.set("turn", turn);
    program_.set("light", gl::Vec3f((turn * context.lightDirection).normalized()));
    program_.set("colour", srgb);
    program_.set("metal", metal);
    const auto count = static_cast<GLsizei>(solid.indices.size());
    if (hiddenAlpha > 0.0f) {
        program_.set("alpha", hiddenAlpha);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_GREATER);
        glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
    }
    program_.set("alpha", 1.0f);
    glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr);
    return solid.indices.size() / 3;
}

}  // namespace handpiece::view
