// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Work that a crash left: it is offered once, and can be brought back or given up later.

#include <vector>

#include "desktop/framework/feature.h"
#include "desktop/work/session_shelf.h"

namespace handpiece::desktop {

class RecoveryFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { recover };
    explicit RecoveryFeature(const FeatureContext& context);

  private:
    void greet();
    void choose();
    [[nodiscard]] bool hasRoomFor(const Crashed& crashed);
    void recover(const Crashed& crashed);

    CommandSet<Command> commands_;
    std::vector<Crashed> crashed_;
};

}  // namespace handpiece::desktop
