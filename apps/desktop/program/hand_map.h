// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Eye, pointer, hand and tooth as they are now, for scripts that hold the window to what it promises.

#include <QJsonObject>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>

#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::desktop {

class Host;

/// Asked with every widget map, on the window's thread: what it tells is at most a poll (33 ms) old. docs/walk.md lists
/// the names.
class HandMap {
  public:
    explicit HandMap(Host& host) : host_(host) {}
    [[nodiscard]] QJsonObject now();

  private:
    /// What a state of the tooth cannot have changed without.
    using Place = std::tuple<std::uint64_t, std::size_t, std::size_t, const void*>;
    void addWork(QJsonObject& told);
    void addHand(QJsonObject& told) const;
    void addEye(QJsonObject& told) const;
    void addHash(QJsonObject& told);

    Host& host_;
    Place seen_{}, hashed_{};  ///< at the last asking; of which the hash is
    std::string hash_;
};

/// As `camera`, `viewport` and `toothMm` of the map.
[[nodiscard]] QJsonObject eyeObject(const view::Camera& eye, const view::Viewport& viewport, const core::Box& toothMm);

}  // namespace handpiece::desktop
