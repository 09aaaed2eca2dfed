// SPDX-License-Identifier: Apache-2.0
// The draw column of Table II: pictures of the paper's teeth, each drawn anew.
#include <algorithm>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/view/renderer.h"
#include "studies/reproduce.h"

namespace handpiece::studies {
namespace {

constexpr view::Viewport kPicture{1280, 800};
/// Enough that nothing of the picture before can be kept.
constexpr double kTurnRad = 0.02;

}  // namespace

DrawTiming timeDraw(const Reproduction& r, const std::vector<geometry::TriangleMesh>& meshes) {
    DrawTiming timing;
    std::optional<view::Renderer> renderer;
    try {
        renderer.emplace();
    } catch (const core::Error& e) {
        timing.missing = e.what();
        return timing;
    }
    timing.renderer = renderer->description();
    view::Look look;
    look.quality = view::Quality::fine;
    look.bur = look.turbine = false;
    view::Moment moment;
    moment.burShown = false;
    view::Image image;
    const std::size_t count = r.quick ? 5 : 21;
    for (const geometry::TriangleMesh& mesh : meshes) {
        r.step("drawing");
        renderer->setTooth(mesh.bounds());
        renderer->setMesh(mesh, cases::Tissue::enamel);
        view::Camera camera = view::standardView(view::StandardView::oblique, mesh.bounds(), 1, kPicture);
        std::vector<double> ms;
        for (std::size_t i = 0; i < count; ++i) {
            camera = view::orbited(camera, kTurnRad, 0.0);
            const view::FrameReport report = renderer->draw(camera, kPicture, look, moment, image);
            ms.push_back(report.drawMs + report.readMs);
        }
        std::sort(ms.begin(), ms.end());
        timing.ms.push_back(ms[ms.size() / 2]);
    }
    return timing;
}

}  // namespace handpiece::studies
