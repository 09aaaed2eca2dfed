// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/live_shares.h"

#include "handpiece/base/core/alone.h"

namespace handpiece::course {

LiveShares liveShares(const zones::Zones& zones, const zones::WholeVolumes& whole, const simulation::LiveTooth& tooth) {
    const core::Alone alone;
    tooth::ToothMirror mirror(tooth.modelShared());
    mirror.apply(tooth.state({}));
    const zones::ZoneVolumes gone{zones::removedVolumes(zones, mirror), whole};
    using zones::Zone;
    return {gone.targetMm3() > 0.0 ? gone.removedMm3(Zone::target) / gone.targetMm3() : 0.0,
            gone.removedMm3(Zone::leewaySide) + gone.removedMm3(Zone::leewayFloor), gone.removedMm3(Zone::container),
            gone.removedMm3(Zone::protectedZone)};
}

}  // namespace handpiece::course
