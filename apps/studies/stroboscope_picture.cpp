// SPDX-License-Identifier: Apache-2.0
#include "studies/stroboscope_picture.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/base/core/error.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::studies {
namespace {

using core::Vec3;
using Rgb = std::array<int, 3>;

constexpr view::Viewport kSize{1120, 840};
constexpr double kSectionPixelMm = 0.02;
const Vec3 kTowardsEye(0.6, -1.0, 0.8);
constexpr int kDifferent = 10;                               // of a channel, from the picture without a bur
constexpr int kShare = 45, kEdgeShare = 85;                  // of a hundred, that a later exposure covers
constexpr Rgb kTouchColour{198, 40, 40}, kEdge{24, 28, 34};  // red, as in the projections
constexpr int kTint = 55;

view::SectionFace faceOf(const measure::Section& section, const view::Plane& plane) {
    view::SectionFace face;
    face.plane = plane;
    face.originMm = section.originMm;
    face.uAxis = section.uAxis;
    face.vAxis = section.vAxis;
    face.mmPerPixel = section.mmPerPixel;
    face.width = section.width;
    face.height = section.height;
    face.tissue = section.tissue;
    face.away = section.away;
    return face;
}

view::Camera cameraOn(const Stroboscope& shot) {
    core::Box seen;
    for (const Vec3& tip : shot.tipsMm)
        seen.extend(tip);
    const Vec3 around(1.3 * shot.upMm, 0.4 * shot.upMm, 0.8 * shot.upMm);
    const Vec3 low = seen.min - around, high = seen.max + around;
    seen.extend(low);
    seen.extend(high);
    view::Camera camera;
    camera.targetMm = seen.centre();
    camera.eyeMm = camera.targetMm + 60.0 * kTowardsEye.normalized();
    return view::fitted(camera, seen, kSize);
}

/// Where the exposure shows the bur.
std::vector<bool> burIn(const view::Image& exposure, const view::Image& empty) {
    std::vector<bool> is(exposure.rgba.size() / 4);
    for (std::size_t i = 0; i < is.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            is[i] = is[i] || std::abs(exposure.rgba[4 * i + c] - empty.rgba[4 * i + c]) > kDifferent;
    return is;
}

/// The exposure over those before it, as on one film; the bur's outline stronger, so that each place can be told.
void expose(view::Image& film, const view::Image& exposure, const view::Image& empty, bool touching) {
    const std::vector<bool> bur = burIn(exposure, empty);
    const auto width = static_cast<std::size_t>(film.width), height = static_cast<std::size_t>(film.height);
    for (std::size_t y = 1; y + 1 < height; ++y)
        for (std::size_t x = 1; x + 1 < width; ++x) {
            const std::size_t i = y * width + x;
            if (!bur[i]) continue;
            const bool isEdge = !bur[i - 1] || !bur[i + 1] || !bur[i - width] || !bur[i + width];
            for (std::size_t c = 0; c < 3; ++c) {
                int colour = exposure.rgba[4 * i + c];
                if (touching) colour += (kTouchColour[c] - colour) * kTint / 100;
                if (isEdge) colour = touching ? kTouchColour[c] : kEdge[c];
                const int before = film.rgba[4 * i + c];
                film.rgba[4 * i + c] =
                    static_cast<std::uint8_t>(before + (colour - before) * (isEdge ? kEdgeShare : kShare) / 100);
            }
        }
}

}  // namespace

std::string writeStroboscope(const std::shared_ptr<const tooth::ToothModel>& uncut, const tooth::StateDelta& state,
                             const instrument::Bur& bur, const Stroboscope& shot, const std::filesystem::path& file) {
    if (shot.tipsMm.empty()) throw core::Error("a stroboscope needs a place of the bur", "stroboscope");
    std::optional<view::Renderer> renderer;
    try {
        renderer.emplace();
    } catch (const core::Error& e) {
        return e.what();
    }
    simulation::LiveTooth live(uncut, state);
    renderer->setTooth(uncut->outer.bounds());
    renderer->updateBricks(live.uncutSurface(), true);
    renderer->updateBricks(live.takeNews());
    renderer->setBur(bur.mesh(), bur.lengthMm(), bur.maxRadiusMm());
    const view::Plane plane{-Vec3::UnitY(), -shot.tipsMm.front().y()};
    renderer->setSectionFace(faceOf(live.withProbe([&](const measure::ToothProbe& probe) {
        return probe.section(plane.normal, plane.offsetMm, kSectionPixelMm);
    }),
                                    plane));
    view::Look look;
    look.quality = view::Quality::fine;
    look.cutAway = plane;
    look.scaleBar = true;
    look.turbine = look.debris = look.spray = look.shadows = look.wet = false;
    look.backgroundTop = look.backgroundBottom = {236, 239, 243};
    const view::Camera camera = cameraOn(shot);
    view::Moment moment;
    const auto drawn = [&] {
        constexpr int kMaxRefinements = 8;
        view::Image image;
        for (int i = 0; i < kMaxRefinements && (renderer->draw(camera, kSize, look, moment, image).refining || i == 0);
             ++i) {
        }
        return image;
    };
    moment.burShown = look.bur = false;
    const view::Image empty = drawn();
    view::Image film = empty;
    moment.burShown = look.bur = true;
    for (std::size_t i = 0; i < shot.tipsMm.size(); ++i) {
        moment.burInTooth.positionMm = shot.tipsMm[i];
        expose(film, drawn(), empty, shot.touching[i]);
    }
    view::writePng(film, file);
    return {};
}

}  // namespace handpiece::studies
