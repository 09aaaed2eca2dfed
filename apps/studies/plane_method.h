// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The simplest tooth there is, for closed loops that are judged by formula. Private to this room and to tests.

#include "handpiece/tick/contact/method.h"

namespace handpiece::studies {

/// The solid below z = 0, touched by the bur's tip.
class PlaneMethod final : public contact::Method {
  public:
    explicit PlaneMethod(cases::Tissue tissue) : tissue_(tissue) {}
    [[nodiscard]] const char* name() const noexcept override { return "plane"; }
    [[nodiscard]] contact::Depth depth(const core::Pose& bur) noexcept override {
        const core::Vec3& p = bur.positionMm;
        return {-p.z(), core::Vec3::UnitZ(), core::Vec3(p.x(), p.y(), 0.0), tissue_, contact::Status::ok};
    }

  private:
    cases::Tissue tissue_;
};

}  // namespace handpiece::studies
