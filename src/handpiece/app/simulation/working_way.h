// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From where and how somebody works, as `working way` events tell it (docs/session-format.md).

#include <optional>
#include <string>

namespace handpiece::simulation {

struct WorkingWay {
    int hour = 0;  ///< of the operator's clock, 1 to 12; 0: none was chosen
    bool mirrorOnly = false, fingerRest = false;
    std::optional<bool> depthStop{};    ///< on or off; none: of a program that did not tell
    std::optional<double> perPassMm{};  ///< how deep one stroke of a mouse's hand goes; none: as the load takes it
};

[[nodiscard]] std::string workingWayJson(const WorkingWay& way);
/// What a file's text does not say is not so; never throws over it.
[[nodiscard]] WorkingWay workingWayFromJson(const std::string& text);

}  // namespace handpiece::simulation
