// SPDX-License-Identifier: Apache-2.0
// One's own law of force, selectable by name in every run: a cushion, soft at the first touch and stiffer the farther
// the hand goes in.
//
//   own_force_law run --force cushion --tooth molar --motion press --out cushion
#include <algorithm>

#include "cli/cli.h"

namespace {

using namespace handpiece;

class CushionLaw final : public force::ForceLaw {
  public:
    // Runs in the tick: no allocation, no lock, no file. The proxy lies on the surface where the hand would like to go
    // on; friction, fading in and the device's limits are added by ForceModel.
    [[nodiscard]] core::Vec3 pushN(const force::LawInput& input) noexcept override {
        const core::Vec3 out = input.touch.proxyInTooth.positionMm - input.touch.deviceInTooth.positionMm;
        const double inMm = out.norm();
        if (!input.touch.touching || inMm < 1e-9) return core::Vec3::Zero();
        const double share = std::min(1.0, inMm / kSoftMm);  // of the tissue's stiffness
        return share * force::couplingOf(input).stiffnessNPerMm * out;
    }

  private:
    static constexpr double kSoftMm = 1.0;
};

}  // namespace

int main(int argc, char** argv) {
    return cli::run(argc, argv, {}, {{"cushion", [] { return std::make_unique<CushionLaw>(); }}});
}
