// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the bur feels: the contact's answers of one tick, as the forces use them.

#include <cstdint>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::force {

struct Touch {
    core::Pose deviceInTooth;                       ///< believed; not the reading when that is in doubt
    contact::Depth depth;                           ///< at the device's pose
    core::Pose proxyInTooth;                        ///< the device's pose under a law that knows no proxy
    contact::PatchSet patches;                      ///< at the proxy; empty when it does not touch, or there is none
    contact::SoftSet soft;                          ///< what yields at the proxy
    bool touching = false;                          ///< the proxy is held by the tooth
    cases::Tissue tissue = cases::Tissue::none;     ///< that carries most of the pressure
    std::uint16_t tooth = 0;                        ///< that tissue's
    std::uint16_t neighbour = 0;                    ///< of those around that the bur bears on most; 0: none
    bool isHeldOnly = false;                        ///< part of the force is held by what takes no cut
    core::Vec3 cutShare = core::Vec3::Zero();       ///< then: along which the rest pushes, 1 long when it is all
    double behindShare = 0.0;                       ///< of the force, that bears on shank, head or handle: 0 to 1
    core::Vec3 behindPointMm = core::Vec3::Zero();  ///< where that acts
    contact::Piece behind = contact::Piece::bur;    ///< which of them bears most; bur for none
    int passes = 0;                                 ///< constraint passes of the proxy
};

}  // namespace handpiece::force
