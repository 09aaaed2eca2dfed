// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/artist.h"

#include <utility>

namespace handpiece::report {
namespace {

constexpr double kSectionPixelMm = 0.03;
/// Of a tooth beside it only what the picture has room for would be seen: a fragment.
std::vector<surface::BrickUpdate> ofTheTooth(std::vector<surface::BrickUpdate> bricks) {
    std::erase_if(bricks, [](const surface::BrickUpdate& one) { return tooth::toothOf(one.id) != 0; });
    return bricks;
}
/// Until it no longer gets finer.
constexpr int kMostDrawings = 8;

}  // namespace

Artist::Artist(const simulation::SessionPlayer& player, const view::Viewport& viewport)
    : bounds_(player.station().tooth->outer.bounds()),
      standing_(view::standingOf(player.toothCase().fdiNumber, player.toothCase().buccalSign)),
      viewport_(viewport) {
    renderer_.setTooth(bounds_);
    renderer_.updateBricks(ofTheTooth(player.tooth()->uncutSurface()), true);
    look_.quality = view::Quality::fine;
    look_.palette = view::Palette::textbook;
    look_.bur = look_.turbine = look_.debris = look_.spray = false;
    look_.scaleBar = true;
    look_.backgroundTop = look_.backgroundBottom = {236, 239, 243};
    moment_.burShown = false;
}

void Artist::cut(std::vector<surface::BrickUpdate> news) {
    renderer_.updateBricks(ofTheTooth(std::move(news)));
}

view::Image Artist::picture(view::StandardView from, view::ToothShown shown) {
    look_.tooth = shown;
    return drawn(view::standardView(from, bounds_, standing_, viewport_));
}

view::Image Artist::pictureFrom(const std::optional<cases::View>& from) {
    if (!from) return picture(view::StandardView::occlusal, view::ToothShown::now);
    look_.tooth = view::ToothShown::now;
    view::Camera camera = view::standardView(view::StandardView::occlusal, bounds_, standing_, viewport_);
    const double farMm = (camera.eyeMm - camera.targetMm).norm();
    camera.targetMm = from->targetMm;
    camera.eyeMm = from->targetMm + farMm * (from->eyeMm - from->targetMm).normalized();
    camera.up = from->up;
    return drawn(camera);
}

view::Image Artist::section(const simulation::LiveTooth& tooth, const core::Vec3& atMm) {
    const core::Vec3 normal = core::Vec3::UnitX();
    const double offset = normal.dot(atMm);
    const measure::Section s = tooth.withProbe(
        [&](const measure::ToothProbe& probe) { return probe.section(normal, offset, kSectionPixelMm); });
    renderer_.setSectionFace(
        {{normal, offset}, s.originMm, s.uAxis, s.vAxis, s.mmPerPixel, s.width, s.height, s.tissue, s.away});
    look_.tooth = view::ToothShown::now;
    look_.cutAway = view::Plane{normal, offset};
    look_.sectionGrid = true;
    view::Image image = drawn(view::standardView(view::StandardView::mesial, bounds_, standing_, viewport_));
    look_.cutAway.reset();
    look_.sectionGrid = false;
    return image;
}

view::Image Artist::drawn(const view::Camera& camera) {
    view::Image image;
    for (int i = 0; i < kMostDrawings && (renderer_.draw(camera, viewport_, look_, moment_, image).refining || i == 0);
         ++i) {
    }
    return image;
}

}  // namespace handpiece::report
