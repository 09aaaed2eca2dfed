// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/assessment_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "handpiece/app/report/advice.h"
#include "handpiece/app/report/page_png.h"
#include "handpiece/app/report/place_section.h"
#include "handpiece/app/report/section_outlines.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::report {
namespace {

using core::Vec3;
using simulation::LiveTooth;
using view::StandardView;

constexpr double kFacePixelMm = 0.03;
/// From so far an error is looked at; it fills about a third of the picture.
constexpr double kEyeMm = 20.0;
/// Of the tooth under the preparation is seen so much: the rest is roots.
constexpr double kUnderMm = 6.0;

/// One tooth in one state.
class Painter {
  public:
    /// Nothing under `lowestMm` need be seen.
    Painter(const LiveTooth& live, const view::Standing& standing, double lowestMm, const PictureSettings& settings)
        : live_(live),
          bounds_(live.model().outer.bounds()),
          standing_(standing),
          viewport_{settings.width, settings.height} {
        renderer_.setTooth(bounds_);
        bounds_.min.z() = std::max(bounds_.min.z(), lowestMm);
        look_.quality = view::Quality::rich;
        look_.palette = view::Palette::textbook;
        look_.bur = look_.turbine = look_.debris = look_.spray = false;
        look_.backgroundTop = look_.backgroundBottom = {236, 239, 243};
        moment_.burShown = false;
    }
    void show(const std::vector<surface::BrickUpdate>& bricks) { renderer_.updateBricks(bricks); }
    void colourDeviation() {
        look_.removedDepthColours = true;
        look_.deviationMostMm = kDeviationMostMm;
        // The colours of the legend, as far as light allows.
        look_.shadows = look_.wet = false;
    }
    [[nodiscard]] view::Camera standard(StandardView from) const {
        return view::standardView(from, bounds_, standing_, viewport_);
    }
    [[nodiscard]] Png picture(const view::Camera& camera) {
        view::Image image;
        constexpr int kMaxDrawings = 6;  // until it no longer gets finer
        for (int i = 0; i < kMaxDrawings; ++i)
            if (!renderer_.draw(camera, viewport_, look_, moment_, image).refining) break;
        return pagePng(image);
    }
    [[nodiscard]] Png section(StandardView from, const view::Plane& plane) {
        const measure::Section s = live_.withProbe([&](const measure::ToothProbe& probe) {
            return probe.section(plane.normal, plane.offsetMm, kFacePixelMm);
        });
        renderer_.setSectionFace(
            {plane, s.originMm, s.uAxis, s.vAxis, s.mmPerPixel, s.width, s.height, s.tissue, s.away});
        look_.cutAway = plane;
        look_.sectionGrid = true;
        Png png = picture(standard(from));
        look_.cutAway.reset();
        look_.sectionGrid = false;
        return png;
    }
    /// The eye turned to a place of the surface, with a needle that stands on it.
    [[nodiscard]] Png place(const Vec3& at, const Vec3& draw) {
        const double h = live_.model().field.settings().voxelMm;
        const Vec3 normal =
            live_.withProbe([&](const measure::ToothProbe& probe) { return outwardAt(probe, h, at, draw); });
        // Between the surface's own normal and where the hand comes from: into a cavity, not through its wall.
        Vec3 towards = 0.7 * normal + draw;
        towards = towards.norm() > 1e-6 ? Vec3(towards.normalized()) : draw;
        view::Camera camera = standard(StandardView::occlusal);
        camera.targetMm = at;
        camera.eyeMm = at + kEyeMm * towards;
        if (std::abs(camera.up.dot(towards)) > 0.95) camera.up = draw.unitOrthogonal();
        moment_.contact = look_.contactArrow = true;
        moment_.contactPointMm = at;
        moment_.contactNormal = normal;
        Png png = picture(camera);
        moment_.contact = look_.contactArrow = false;
        return png;
    }

  private:
    const LiveTooth& live_;
    core::Box bounds_;
    view::Standing standing_;
    view::Viewport viewport_;
    view::Renderer renderer_;
    view::Look look_;
    view::Moment moment_;
};

std::vector<surface::BrickUpdate> surfaceOf(LiveTooth& live) {
    std::vector<surface::BrickUpdate> bricks = live.uncutSurface();
    live.settle();
    for (surface::BrickUpdate& update : live.takeNews())
        bricks.push_back(std::move(update));
    return bricks;
}

/// The same triangles with the deviation from the ideal in place of removed depths.
std::vector<surface::BrickUpdate> withDeviation(std::vector<surface::BrickUpdate> bricks, const zones::Zones& zones,
                                                const geometry::TriangleTree& whole) {
    core::parallelFor(bricks.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!bricks[i].mesh) continue;
            auto values = std::make_shared<std::vector<float>>();
            for (const surface::SurfaceVertex& v : bricks[i].mesh->vertices) {
                const Vec3 p(static_cast<double>(v.positionMm[0]), static_cast<double>(v.positionMm[1]),
                             static_cast<double>(v.positionMm[2]));
                const double d = std::clamp(toIdealMm(zones, whole, p), -kDeviationMostMm, kDeviationMostMm);
                values->push_back(static_cast<float>(d + kDeviationMostMm));
            }
            bricks[i].removedDepthMm = std::move(values);
        }
    });
    return bricks;
}

/// Where sections go through: the middle of what was cut or was to be, on the tooth's axis where nothing was.
Vec3 middleOf(const tooth::ToothModel& whole, const tooth::StateDelta& own, const tooth::StateDelta* ideal) {
    const field::FieldView view = whole.field.view();
    core::Box box;
    for (const tooth::StateDelta* state : {&own, ideal}) {
        if (state == nullptr) continue;
        for (const tooth::StateDelta::Brick& brick : state->bricks) {
            if (brick.uncut || tooth::toothOf(brick.id) != 0) continue;
            const auto at = field::brickAt(view.bricks, tooth::denseOf(brick.id));
            const double edge = field::kBrickCells * view.voxelMm;
            box.extend(Vec3(view.originMm[0], view.originMm[1], view.originMm[2]) +
                       edge * Vec3(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5));
        }
        if (!box.isEmpty()) break;
    }
    return box.isEmpty() ? whole.outer.bounds().centre() : box.centre();
}

}  // namespace

AssessmentPictures assessmentPictures(const tasks::Task& task, const tooth::Teeth& teeth, const tooth::StateDelta& own,
                                      const score::Assessment& assessment, const rubric::Rubric& rubric,
                                      const PictureSettings& settings, const core::Progress& progress) {
    AssessmentPictures pictures;
    const std::shared_ptr<const tooth::ToothModel>& whole = teeth.front();
    std::optional<preparation::Laid> laid;
    std::optional<tooth::StateDelta> idealState;
    if (task.preparation) {
        laid = preparation::layOn(task.toothCase, *task.preparation);
        idealState = zones::idealState(*laid->zones, whole);
    }
    core::report(progress, 0.1);
    const auto live = std::make_unique<LiveTooth>(whole, own, core::part(progress, 0.1, 0.4));
    const Vec3 middle = middleOf(*whole, own, idealState ? &*idealState : nullptr);
    const view::Standing standing = view::standingOf(task.toothCase.fdiNumber, task.toothCase.buccalSign);
    const int buccal = standing.buccalSign < 0 ? -1 : 1;
    const std::vector<StandardView> views = {StandardView::occlusal, StandardView::buccal, StandardView::lingual,
                                             StandardView::mesial, StandardView::distal};
    const std::vector<std::pair<StandardView, view::Plane>> sections = {
        {StandardView::mesial, {Vec3::UnitX(), middle.x()}},
        {StandardView::buccal, {buccal * Vec3::UnitY(), buccal * middle.y()}}};
    const auto nameOf = [](StandardView view) {
        for (const auto& [one, name] : view::standardViews())
            if (one == view) return std::string(name);
        return std::string();
    };
    for (const StandardView view : views)
        pictures.views.push_back({nameOf(view), {}, {}, {}, {}});
    for (const auto& [view, plane] : sections)
        pictures.views.push_back({"section-" + nameOf(view), {}, {}, {}, {}});
    const double lowest = middle.z() - kUnderMm;
    const Vec3 draw = laid ? laid->draw : Vec3(Vec3::UnitZ());

    // Outlines need no OpenGL.
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const view::Plane& plane = sections[i].second;
        const Vec3 up = standing.up(), right = up.cross(plane.normal);
        SectionOutlines outlines;
        outlines.box = whole->outer.bounds();
        outlines.originMm = plane.offsetMm * plane.normal;
        outlines.right = right;
        outlines.up = up;
        (standing.isUpper ? outlines.highestMm : outlines.lowestMm) = up.z() * lowest;
        outlines.before = [&](const Vec3& p) { return whole->tree.signedDistance(p); };
        if (laid) outlines.ideal = [&](const Vec3& p) { return toIdealMm(*laid->zones, whole->tree, p); };
        pictures.views[views.size() + i].outlines = live->withProbe([&](const measure::ToothProbe& probe) {
            outlines.own = [&](const Vec3& p) {
                return std::max(whole->tree.signedDistance(p), probe.signedDistanceMm(p));
            };
            return outlinesSvg(outlines);
        });
    }
    core::report(progress, 0.5);
    try {
        const std::vector<surface::BrickUpdate> bricks = surfaceOf(*live);
        {
            Painter artist(*live, standing, lowest, settings);
            artist.show(bricks);
            for (std::size_t i = 0; i < views.size(); ++i)
                pictures.views[i].own = artist.picture(artist.standard(views[i]));
            for (std::size_t i = 0; i < sections.size(); ++i)
                pictures.views[views.size() + i].own = artist.section(sections[i].first, sections[i].second);
            if (costsUndone(assessment) && !assessment.completeness->evidence.empty() &&
                assessment.completeness->evidence.front().placeMm)
                pictures.undone = artist.place(*assessment.completeness->evidence.front().placeMm, draw);
            std::size_t shown = 0;
            for (const std::size_t i : costliest(assessment)) {
                if (shown++ == kFirstErrors) break;
                const score::CriterionScore& criterion = assessment.criteria[i];
                // Those of teeth beside lie in these, which are not drawn.
                if (criterion.measure.rfind("adjacent-", 0) == 0) continue;
                const rubric::Criterion* asks = rubric.criterion(criterion.id);
                const Off off = asks && criterion.value ? offOf(wantedOf(*asks, rubric), *criterion.value) : Off::no;
                if (const measures::Evidence* e = placeOf(criterion, off); e != nullptr && e->placeMm)
                    pictures.places[criterion.id] = artist.place(*e->placeMm, draw);
            }
        }
        core::report(progress, 0.7);
        if (laid) {
            Painter coloured(*live, standing, lowest, settings);
            coloured.colourDeviation();
            coloured.show(withDeviation(bricks, *laid->zones, whole->tree));
            for (std::size_t i = 0; i < views.size(); ++i)
                pictures.views[i].deviation = coloured.picture(coloured.standard(views[i]));
            core::report(progress, 0.8);
            const auto ideal = std::make_unique<LiveTooth>(whole, *idealState, core::part(progress, 0.8, 0.9));
            Painter artist(*ideal, standing, lowest, settings);
            artist.show(surfaceOf(*ideal));
            for (std::size_t i = 0; i < views.size(); ++i)
                pictures.views[i].ideal = artist.picture(artist.standard(views[i]));
            for (std::size_t i = 0; i < sections.size(); ++i)
                pictures.views[views.size() + i].ideal = artist.section(sections[i].first, sections[i].second);
        }
    } catch (const core::Error& error) {
        if (error.problem() == "cancelled") throw;
        // A page without pictures is still a page: it says why.
        pictures.missing = config::words()("report.no-pictures", error.problem());
    }
    core::report(progress, 1.0);
    return pictures;
}

}  // namespace handpiece::report
