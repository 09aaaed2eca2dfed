// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

double surfaceAreaMm2(const TriangleMesh& mesh) {
    double twice = 0.0;
    for (const Triangle& t : mesh.triangles) {
        const core::Vec3& a = mesh.vertices[t[0]];
        twice += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
    }
    return 0.5 * twice;
}

double enclosedVolumeMm3(const TriangleMesh& mesh) {
    if (mesh.vertices.empty()) return 0.0;
    // About a vertex of the mesh, so that a tooth far from the origin loses no digits.
    const core::Vec3 origin = mesh.vertices.front();
    double sixTimes = 0.0;
    for (const Triangle& t : mesh.triangles)
        sixTimes +=
            (mesh.vertices[t[0]] - origin).dot((mesh.vertices[t[1]] - origin).cross(mesh.vertices[t[2]] - origin));
    return sixTimes / 6.0;
}

TriangleMesh scaled(TriangleMesh mesh, double factor) {
    for (core::Vec3& v : mesh.vertices)
        v *= factor;
    return mesh;
}

TriangleMesh transformed(TriangleMesh mesh, const core::Pose& pose) {
    for (core::Vec3& v : mesh.vertices)
        v = pose.apply(v);
    return mesh;
}

}  // namespace handpiece::geometry
