// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where one looks from and what one sees.

#include <QWidget>
#include <array>
#include <vector>

#include "desktop/widgets/detail.h"
#include "handpiece/app/exercise/permissions.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QToolButton;

namespace handpiece::desktop {

/// Standard views as small teeth, and the look [viewBar].
class ViewBar : public QWidget {
    Q_OBJECT
  public:
    explicit ViewBar(QWidget* parent = nullptr);

    /// Tells nobody. What this bar has no control for is kept and given back in lookChanged.
    void setLook(const view::Look& look);
    [[nodiscard]] const view::Look& look() const { return look_; }
    /// The tissues with a box; all others have none.
    void setPresent(const std::vector<cases::Tissue>& tissues);
    /// Whether the case has lips and cheeks.
    void setCheeksThere(bool there);
    /// Whether something in the case has the colours of a scan.
    void setScanColoursThere(bool there);
    void setPermissions(const exercise::Permissions& permissions);
    void setDetail(Detail detail);

  signals:
    void viewChosen(view::StandardView view);
    void fitRequested();
    void lookChanged(const view::Look& look);

  private:
    [[nodiscard]] static QString scanColoursTip();
    void tell();
    void showLook();
    void makeTissueBoxes();

    view::Look look_;
    std::vector<cases::Tissue> present_;
    exercise::Permissions permissions_;
    std::array<QToolButton*, 6> views_{};
    QToolButton* fit_;
    QComboBox *palette_, *quality_, *shown_, *stereo_;
    QCheckBox *removed_, *wet_, *scanColours_, *debris_, *spray_, *shadows_, *scaleBar_, *contact_, *force_, *turbine_,
        *cheeks_;
    QLabel *stereoName_, *qualityName_, *tissuesName_;
    QGridLayout* tissueGrid_;
    std::vector<std::pair<cases::Tissue, QCheckBox*>> tissueBoxes_;
    Detail detail_ = Detail::practice;
};

}  // namespace handpiece::desktop
