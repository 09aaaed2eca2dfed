// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/effects_glass.h"

#include "handpiece/senses/view/effects_solid.h"
#include "handpiece/senses/view/tooth_layer.h"

namespace handpiece::view {
namespace {

const char* const kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 viewProjection;
out vec3 at, normalOut;
void main() {
    at = position;
    normalOut = normal;
    gl_Position = viewProjection * vec4(position, 1.0);
}
)";
const char* const kFragment = R"(
in vec3 at, normalOut;
uniform vec3 eye, colour;
uniform vec4 clipPlane, mirrorPlane;
uniform float alpha;
out vec4 result;
void main() {
    if (dot(clipPlane, vec4(at, 1.0)) < 0.0 || dot(mirrorPlane, vec4(at, 1.0)) < 0.0) discard;
    float rim = 1.0 - abs(dot(normalize(normalOut), normalize(eye - at)));
    result = vec4(mix(colour, vec3(1.0), 0.25 * rim), alpha * (0.7 + 0.8 * rim * rim));
}
)";
/// Of what lies behind something solid.
constexpr float kHiddenShare = 0.6f;

struct Vertex {
    gl::Vec3f placeMm = gl::Vec3f::Zero(), normal = gl::Vec3f::Zero();
};

}  // namespace

GlassPass::GlassPass() : program_("glass", kVertex, kFragment) {}

void GlassPass::set(const std::vector<GlassSurface>& surfaces) {
    surfaces_.clear();
    box_ = {};
    for (const GlassSurface& surface : surfaces) {
        if (!surface.mesh || surface.mesh->triangles.empty()) continue;
        const geometry::TriangleMesh& mesh = *surface.mesh;
        std::vector<Vertex> vertices(mesh.vertices.size());
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            vertices[i].placeMm = mesh.vertices[i].cast<float>();
            box_.extend(mesh.vertices[i]);
        }
        for (const auto& t : mesh.triangles) {
            const gl::Vec3f a = vertices[t[0]].placeMm, b = vertices[t[1]].placeMm, c = vertices[t[2]].placeMm;
            const gl::Vec3f n = (b - a).cross(c - a);
            for (const auto corner : t)
                vertices[corner].normal += n;
        }
        Surface& made = surfaces_.emplace_back();
        made.array.bind();
        made.vertices.fill(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * sizeof(Vertex), GL_STATIC_DRAW);
        made.array.attach(
            made.vertices, sizeof(Vertex),
            {{0, 3, GL_FLOAT, false, offsetof(Vertex, placeMm)}, {1, 3, GL_FLOAT, false, offsetof(Vertex, normal)}});
        made.indices.fill(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles.data(),
                          mesh.triangles.size() * sizeof(mesh.triangles.front()), GL_STATIC_DRAW);
        made.array.attachIndices(made.indices);
        made.count = static_cast<GLsizei>(3 * mesh.triangles.size());
        made.srgb = gl::Vec3f(surface.colour[0], surface.colour[1], surface.colour[2]);
        made.alpha = surface.alpha;
    }
}

PixelRect GlassPass::touches(const PassContext& context) {
    if (surfaces_.empty()) return {};
    std::vector<core::Vec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.emplace_back((i & 1) != 0 ? box_.max.x() : box_.min.x(), (i & 2) != 0 ? box_.max.y() : box_.min.y(),
                             (i & 4) != 0 ? box_.max.z() : box_.min.z());
    return rectOf(context.eye, context.viewport, corners);
}

std::size_t GlassPass::draw(const PassContext& context) {
    std::size_t triangles = 0;
    program_.use();
    program_.set("viewProjection", context.eye.viewProjection());
    program_.set("eye", context.eye.positionMm);
    program_.set("clipPlane", planeOf(context.look.cutAway));
    program_.set("mirrorPlane", planeOf(context.eye.clip));
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    // What lies in the tooth's own surface counts as before it.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-2.0f, -8.0f);
    for (const Surface& surface : surfaces_) {
        surface.array.bind();
        program_.set("colour", surface.srgb);
        for (const bool isHidden : {true, false}) {
            glDepthFunc(isHidden ? GL_GEQUAL : GL_LESS);
            program_.set("alpha", isHidden ? kHiddenShare * surface.alpha : surface.alpha);
            glDrawElements(GL_TRIANGLES, surface.count, GL_UNSIGNED_INT, nullptr);
        }
        triangles += static_cast<std::size_t>(surface.count) / 3;
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    return triangles;
}

}  // namespace handpiece::view
