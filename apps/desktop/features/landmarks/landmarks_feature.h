// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Landmarks over the picture: shown, found by shape, set and moved by a teacher, undone, kept in the case.

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
    [[nodiscard]] bool isFinding() const noexcept { return finding_ != nullptr; }
    [[nodiscard]] bool isPlacing() const noexcept { return placing_.has_value(); }
    /// What to do with moved landmarks that are not saved; tests put their own answer here.
    std::function<Questions::Unsaved()> askUnsaved;

  protected:
    /// Presses in the picture while a landmark is being set.
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    using Marks = std::vector<cases::Landmark>;
    [[nodiscard]] bool mayMove() const;
    [[nodiscard]] QString noteNow() const;
    void refreshPanel();
    void showMarks();
    /// To go back to.
    void remember();
    void find();
    void takeFound(const Marks& found);
    void setPlacing(bool isPlacing);
    bool placeAt(const QPointF& pixel);
    void drawPlaced();
    void undo();
    void deleteChosen();
    [[nodiscard]] const geometry::TriangleTree& surface();
    [[nodiscard]] bool isAsInCase() const;
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
    QString foundNote_;
    Marks expected_;  ///< of such a tooth; known once the panel is shown
    /// The one that is being set by clicks: what stood before, and where was clicked.
    struct Placing {
        cases::LandmarkKind kind = cases::LandmarkKind::cuspTip;
        std::string name;
        Marks before;
        std::vector<core::Vec3> placesMm;
    };
    std::optional<Placing> placing_;
    std::unique_ptr<Job> job_;      ///< that saves
    std::unique_ptr<Job> finding_;  ///< that looks for them
    double findingDone_ = 0.0;
};

}  // namespace handpiece::desktop
