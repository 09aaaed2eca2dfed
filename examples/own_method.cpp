// SPDX-License-Identifier: Apache-2.0
// One's own contact method, selectable by name in every command: the tooth as a flat table at its highest point.
//
//   own_method run --method mine --tooth molar --motion press --out mine
#include <algorithm>
#include <cmath>

#include "cli/cli.h"

namespace {

using namespace handpiece;

class TableMethod final : public contact::Method {
  public:
    TableMethod(const tooth::ToothModel& tooth, std::shared_ptr<const instrument::Bur> bur)
        : topMm_(tooth.outer.bounds().max.z()), bur_(std::move(bur)) {}

    [[nodiscard]] const char* name() const noexcept override { return "mine"; }

    // Runs in the tick: no allocation, no lock, no file. The bur is a union of balls turned about its axis, so its
    // lowest point is that of one of them. constraints() and patches() follow from depth() by themselves.
    [[nodiscard]] contact::Depth depth(const core::Pose& burInTooth) noexcept override {
        contact::Depth result;
        if (!burInTooth.isValid()) {
            result.status = contact::Status::invalidPose;
            return result;
        }
        const core::Vec3 axis = burInTooth.orientation * core::Vec3::UnitZ();
        const double across = std::sqrt(std::max(0.0, 1.0 - axis.z() * axis.z()));
        double lowest = std::numeric_limits<double>::infinity();
        for (const instrument::MedialCurve& curve : bur_->medialAxis())
            for (const instrument::MedialBall& ball : curve.balls)
                lowest = std::min(lowest, ball.zMm * axis.z() - ball.rhoMm * across - ball.radiusMm);
        result.depthMm = topMm_ - (burInTooth.positionMm.z() + lowest);
        result.normal = core::Vec3::UnitZ();
        result.toothPointMm = {burInTooth.positionMm.x(), burInTooth.positionMm.y(), topMm_};
        result.tissue = cases::Tissue::enamel;
        result.status = contact::Status::ok;
        return result;
    }

  private:
    double topMm_;
    std::shared_ptr<const instrument::Bur> bur_;
};

}  // namespace

int main(int argc, char** argv) {
    return cli::run(
        argc, argv,
        {{"mine", [](auto tooth, auto bur) { return std::make_unique<TableMethod>(*tooth, std::move(bur)); }}});
}
