// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/hand_feel.h"

#include <utility>

#include "handpiece/tick/contact/field_method.h"

namespace handpiece::input {
namespace {

class FeelUncut final : public HandFeel {
  public:
    explicit FeelUncut(std::unique_ptr<contact::Method> method) : method_(std::move(method)) {}
    Clearance ofBur(const core::Pose& bur) override { return {-method_->depth(bur).depthMm, 0, true}; }
    double ofBodyMm(const core::Pose& /*bur*/) override { return kFarClearMm; }
    double ofSideMm(const core::Pose& /*bur*/) override { return kFarClearMm; }
    double inStrokeMm(const core::Pose& bur) override { return ofBur(bur).mm; }
    void beginStroke() override {}

  private:
    std::unique_ptr<contact::Method> method_;
};

}  // namespace

std::shared_ptr<HandFeel> feelUncut(std::shared_ptr<const tooth::ToothModel> tooth,
                                    std::shared_ptr<const instrument::Bur> bur) {
    if (tooth == nullptr || bur == nullptr) return {};
    return std::make_shared<FeelUncut>(contact::makeFieldMethod(std::move(tooth), std::move(bur)));
}

}  // namespace handpiece::input
