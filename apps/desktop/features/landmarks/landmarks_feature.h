// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Landmarks over the picture: shown, moved by a teacher, undone, kept in the case.

#include <memory>
#include <optional>
#include <vector>

#include "desktop/framework/feature.h"
#include "desktop/framework/job.h"
#include "desktop/picture/measuring.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"

namespace handpiece::desktop {

class LandmarksPanel;

class LandmarksFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { show, move };
    explicit LandmarksFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

    /// As they are now, saved or not.
    [[nodiscard]] const std::vector<cases::Landmark>& marks() const noexcept { return marks_; }
    [[nodiscard]] bool isUnsaved() const noexcept { return unsaved_; }
    /// What to do with moved landmarks that are not saved; tests put their own answer here.
    std::function<Questions::Unsaved()> askUnsaved;

  private:
    using Marks = std::vector<cases::Landmark>;
    [[nodiscard]] bool mayMove() const;
    [[nodiscard]] QString noteNow() const;
    void refreshPanel();
    void showMarks();
    void drag(const LandmarkPoint& at, const core::Vec3& toMm);
    void reset();
    void save(std::function<void()> then = {});
    [[nodiscard]] std::filesystem::path ownPlace() const;

    CommandSet<Command> commands_;
    LandmarksPanel* panel_;
    std::shared_ptr<const cases::Case> toothCase_;
    std::unique_ptr<geometry::TriangleTree> surface_;  ///< of it, once something is moved
    Marks marks_, before_;                             ///< before the drag under way
    std::vector<Marks> undone_;                        ///< the states before each move, the newest last
    std::vector<std::size_t> shown_;                   ///< which of marks_ the picture has
    bool dragging_ = false, unsaved_ = false;
    std::unique_ptr<Job> job_;
};

}  // namespace handpiece::desktop
