// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/senses/view/effects.h"
#include "handpiece/senses/view/effects_solid.h"

namespace handpiece::view {

using core::Vec3;

namespace {

constexpr double kShaftPx = 3.2, kNeedlePx = 1.6, kDiscPx = 11.0;  // radii, in a picture 800 pixels high
constexpr double kShortestMm = 0.1;
constexpr int kAround = 24;

/// Lengths are millimetres of the tooth; thickness is pixels, so that an arrow is seen from any distance.
class ArrowPass : public Pass {
  public:
    PixelRect touches(const PassContext& context) override {
        contact_ = {};
        force_ = {};
        const Moment& moment = context.moment;
        const Vec3 from = moment.contact ? moment.contactPointMm : moment.burInTooth.positionMm;
        const double px = mmPerPixel(context.camera, context.viewport, from) * context.viewport.height / 800.0;
        if (!(px > 0.0) || !from.allFinite()) return {};
        if (context.look.contactArrow && moment.contact && moment.contactNormal.norm() > 0.5) {
            const Vec3 normal = moment.contactNormal.normalized(), side = normal.unitOrthogonal();
            const double high = 1.2 * px;
            contact_.addRings({{from, normal, 0.0, side},
                               {from, normal, kDiscPx * px, side},
                               {from + high * normal, normal, kDiscPx * px, side},
                               {from + high * normal, normal, 0.0, side}},
                              kAround);
            addArrow(contact_, from, normal, kContactArrowMm, kNeedlePx * px);
        }
        const double lengthMm = kForceArrowMmPerN * moment.forceN.norm();
        if (context.look.forceArrow && lengthMm > kShortestMm)
            addArrow(force_, from, moment.forceN.normalized(), lengthMm, kShaftPx * px);
        PixelRect rect;
        for (const Solid* solid : {&contact_, &force_})
            if (!solid->indices.empty()) rect = rect.joined(rectOf(context.eye, context.viewport, *solid));
        return rect;
    }

    std::size_t draw(const PassContext& context) override {
        // Sky blue and orange of Okabe & Ito: told apart with any colour vision.
        return drawer_.draw(context, contact_, {0.34f, 0.71f, 0.91f}, 0.0f, 0.3f) +
               drawer_.draw(context, force_, {0.93f, 0.52f, 0.05f}, 0.0f, 0.3f);
    }

  private:
    static void addArrow(Solid& solid, const Vec3& from, const Vec3& along, double lengthMm, double radiusMm) {
        const Vec3 side = along.unitOrthogonal();
        const double head = std::min(7.5 * radiusMm, 0.6 * lengthMm);
        const Vec3 neck = from + (lengthMm - head) * along;
        solid.addRings({{from, along, 0.0, side},
                        {from, along, radiusMm, side},
                        {neck, along, radiusMm, side},
                        {neck, along, 0.36 * head, side},
                        {from + lengthMm * along, along, 0.0, side}},
                       kAround);
    }

    SolidDrawer drawer_;
    Solid contact_, force_;
};

}  // namespace

std::unique_ptr<Pass> makeArrowPass() {
    return std::make_unique<ArrowPass>();
}

}  // namespace handpiece::view
