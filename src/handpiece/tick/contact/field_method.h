// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Our contact: exact depth on the bur's medial axis against the triangles where the surface is uncut, the distance
/// field elsewhere; patches and constraints from the bur's surface rings in the field.

#include <memory>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

enum class DepthSource : std::uint8_t {
    exact,  ///< triangles of the uncut surface (the default)
    field,  ///< the distance field alone, as after a cut; sees no farther out than the field's band
};

class MedialSheets;
/// What the methods of several teeth can share of one bur.
[[nodiscard]] std::shared_ptr<const MedialSheets> makeMedialSheets(const instrument::Bur& bur);

struct FieldMethodSettings {
    DepthSource depthSource = DepthSource::exact;
    double reachMm = 5.0;  ///< farther apart than this is "beyond reach"
    /// For solids that are only kept out, of a tooth that is not cut: depth() alone, without the points of the solid's
    /// surface, which for a whole handpiece would be half a million.
    bool depthOnly = false;
    std::shared_ptr<const MedialSheets> sheets{};  ///< of this very bur; null: the method makes its own
};

[[nodiscard]] std::unique_ptr<Method> makeFieldMethod(std::shared_ptr<const tooth::ToothModel> tooth,
                                                      std::shared_ptr<const instrument::Bur> bur,
                                                      const FieldMethodSettings& settings = {});

/// On a tooth that is being cut: exact on the triangles where nothing near the bur has been cut, from the field where
/// something has. It reads the live field, so it belongs to the thread that cuts.
///
/// A field that has been cut sees no farther out than its band. When it sees nothing, or when what was nearest has been
/// cut away, the depth is Status::beyondReach and depthMm minus a distance that is surely free, not minus the reach.
/// Deeper in than the band and the bur's radius the depth is what the bricks' centres promise, at least.
[[nodiscard]] std::unique_ptr<Method> makeFieldMethod(std::shared_ptr<const tooth::ToothState> tooth,
                                                      std::shared_ptr<const instrument::Bur> bur,
                                                      const FieldMethodSettings& settings = {});

}  // namespace handpiece::contact
