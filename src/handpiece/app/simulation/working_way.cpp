// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/working_way.h"

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>

#include "handpiece/base/config/outside_json.h"

namespace handpiece::simulation {

std::string workingWayJson(const WorkingWay& way) {
    return fmt::format(R"({{"position": {}, "mirror_only": {}, "finger_rest": {}{}{}}})", way.hour, way.mirrorOnly,
                       way.fingerRest, way.depthStop ? fmt::format(R"(, "depth_stop": {})", *way.depthStop) : "",
                       way.perPassMm ? fmt::format(R"(, "depth_per_pass_mm": {})", *way.perPassMm) : "");
}

WorkingWay workingWayFromJson(const std::string& text) {
    const auto json = config::outsideJson<nlohmann::json>(text);
    if (!json.is_object()) return {};
    const auto says = [&](const char* key) {
        return json.contains(key) && json[key].is_boolean() && json[key].get<bool>();
    };
    WorkingWay way{0, says("mirror_only"), says("finger_rest"), {}, {}};
    if (json.contains("depth_stop") && json["depth_stop"].is_boolean()) way.depthStop = json["depth_stop"].get<bool>();
    if (json.contains("depth_per_pass_mm") && json["depth_per_pass_mm"].is_number())
        if (const auto mm = json["depth_per_pass_mm"].get<double>(); mm > 0.0 && mm < 100.0) way.perPassMm = mm;
    if (json.contains("position") && json["position"].is_number_integer())
        if (const auto hour = json["position"].get<std::int64_t>(); hour >= 1 && hour <= 12)
            way.hour = static_cast<int>(hour);
    return way;
}

}  // namespace handpiece::simulation
