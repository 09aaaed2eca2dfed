// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a target of one's own has in the editor beside its numbers: the work that it is taken from, what it is judged
/// as, and a brush on the picture.

#include <memory>
#include <optional>

#include "desktop/features/editor/editor_page.h"
#include "desktop/widgets/number_field.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/senses/view/renderer.h"

class QComboBox;
class QFormLayout;
class QLabel;
class QPointF;
class QPushButton;

namespace handpiece::desktop {

class SolidView;

class OwnTarget : public QObject {
    Q_OBJECT
  public:
    /// Its fields become rows of `form`; strokes are painted on `picture`. Both outlive it.
    OwnTarget(SolidView& picture, QFormLayout& form, EditorPage::Change change, QWidget* page);
    void show(const draft::Content& content);
    /// Whether the picture shows the tooth as it is painted on.
    void setPaintable(bool isPaintable) { isPaintable_ = isPaintable; }

    [[nodiscard]] static bool isPainted(const std::optional<preparation::Recipe>& recipe);
    /// One that has no shape yet.
    [[nodiscard]] static bool isBlank(const std::optional<preparation::Recipe>& recipe);
    [[nodiscard]] bool isPainting() const noexcept { return stroke_.has_value(); }
    /// Where the brush has been in the stroke that is being painted.
    [[nodiscard]] view::GlassSurface strokeGlass() const;

  signals:
    /// Work shall become what is asked for.
    void workRequested();
    void strokeGrew();

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    /// Where the pointer meets the tooth.
    [[nodiscard]] std::optional<core::Vec3> under(const QPointF& pointer);

    SolidView& picture_;
    EditorPage::Change change_;
    QPushButton* work_;
    QComboBox *like_, *brush_;
    QLabel *likeLabel_, *brushLabel_, *radiusLabel_;
    DecimalField* radius_;
    bool isPaintable_ = false, isPainted_ = false;
    std::shared_ptr<const cases::Case> tooth_, brushed_;    ///< brushed_: of the tree
    std::shared_ptr<const geometry::TriangleTree> canvas_;  ///< of its surface
    std::optional<preparation::BrushStroke> stroke_;        ///< while it is being painted
};

}  // namespace handpiece::desktop
