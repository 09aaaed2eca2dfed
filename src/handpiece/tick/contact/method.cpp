// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

void Method::patches(const core::Pose& burInTooth, PatchSet& out) noexcept {
    out = PatchSet{};
    const Depth d = depth(burInTooth);
    out.status = d.status;
    if (d.depthMm < -kContactMarginMm || d.status != Status::ok) return;
    out.patches.pushBack({d.toothPointMm, d.normal, 0.0, d.depthMm > 0.0 ? d.depthMm : 0.0, 1.0, d.tissue});
    out.tissueShare[static_cast<std::size_t>(d.tissue)] = 1.0;
}

Status Method::constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept {
    out.clear();
    const Depth d = depth(burInTooth);
    if (d.status != Status::ok) return d.status;
    if (-d.depthMm <= reachMm) out.pushBack({d.normal, -d.depthMm, d.toothPointMm, d.tissue});
    return Status::ok;
}

void Method::bearing(const core::Pose&, const core::Vec3&, double, double, Bearing& out) noexcept {
    out = Bearing{};
    for (core::Vec3& t : out.tangentMm)
        t.setZero();
}

}  // namespace handpiece::contact
