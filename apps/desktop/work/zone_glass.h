// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A task's zones as glass to be seen over a tooth. Meshes are made beside everything else; the tick knows nothing of
/// them.

#include <QColor>
#include <QObject>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "desktop/framework/job.h"
#include "handpiece/assess/preparation/zone_surfaces.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {

/// Lives on the window's thread. The newest wish counts: one that is being made is given up.
class ZoneGlass : public QObject {
    Q_OBJECT
  public:
    explicit ZoneGlass(QObject* parent = nullptr) : QObject(parent) {}
    /// Of this tooth. What is there stays until the new one is ready.
    void show(std::shared_ptr<const cases::Case> toothCase, const preparation::Recipe& recipe);
    /// While numbers are being dragged: coarser, and each is finished before the newest is begun, so that the glass
    /// goes along.
    void setCoarse(bool coarse) { isCoarse_ = coarse; }
    /// Away with it, until show().
    void hide();
    /// Which of them; as made: target and protected.
    void setZones(std::set<preparation::SeenZone> zones);
    [[nodiscard]] const std::set<preparation::SeenZone>& zones() const noexcept { return zones_; }
    [[nodiscard]] bool isBusy() const noexcept { return job_ != nullptr; }
    /// For ViewWidget::setGlass().
    [[nodiscard]] const std::vector<view::GlassSurface>& surfaces() const noexcept { return surfaces_; }
    /// What they were made of; null while nothing is shown.
    [[nodiscard]] const std::shared_ptr<const preparation::Laid>& laid() const noexcept { return laid_; }
    [[nodiscard]] const preparation::Recipe& recipe() const noexcept { return laidRecipe_; }
    /// As the glass and a legend have it.
    [[nodiscard]] static QColor colourOf(preparation::SeenZone zone);

  signals:
    /// surfaces() are others now: a picture of this tooth is to have them.
    void changed();
    /// The preparation does not lie on this tooth; nothing is shown.
    void refused(const handpiece::desktop::Problem& problem);

  private:
    struct Wish {
        std::shared_ptr<const cases::Case> toothCase;
        preparation::Recipe recipe;
    };
    void make();
    [[nodiscard]] bool isLaidTooth() const { return wish_ && wish_->toothCase == laidCase_; }

    std::set<preparation::SeenZone> zones_{preparation::SeenZone::target, preparation::SeenZone::protectedZone};
    std::optional<Wish> wish_;
    bool isCoarse_ = false;
    bool isStale_ = false;  ///< wish or zones are others than the job under way has
    std::unique_ptr<Job> job_;
    std::shared_ptr<const preparation::Laid> laid_;
    preparation::Recipe laidRecipe_;
    std::shared_ptr<const cases::Case> laidCase_;          ///< of the tree
    std::shared_ptr<const geometry::TriangleTree> whole_;  ///< of its surface: dear to make
    std::vector<view::GlassSurface> surfaces_;
};

}  // namespace handpiece::desktop
