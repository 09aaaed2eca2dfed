// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Step 2: which tissues, and by hand what the machine did not see.

#include "desktop/features/scan/page.h"
#include "desktop/features/scan/slice_view.h"
#include "desktop/widgets/number_field.h"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QLabel;
class QListWidget;
class QPushButton;
class QStackedWidget;

namespace handpiece::desktop {

class FdiPicker;
class HistogramView;
class SolidView;

/// Decisions as a person sees them: a stroke of the brush is one, not its balls.
struct DecisionRow {
    enum class Kind { tooth, marks, cut, lesion };
    Kind kind;
    std::size_t first = 0, count = 1;  ///< in the list of its kind
    QString text;
};
[[nodiscard]] std::vector<DecisionRow> decisionRows(const segmentation::Settings& settings);

class TissuePage : public ScanPage {
    Q_OBJECT
  public:
    explicit TissuePage(ScanModel& model, QWidget* parent = nullptr);
    [[nodiscard]] QString title() const override { return tr("Tissues"); }
    [[nodiscard]] ScanModel::Depth depth() const override { return ScanModel::Depth::preview; }
    [[nodiscard]] QString missing() const override;

    void setTool(SliceTool tool);
    [[nodiscard]] const core::Vec3& cross() const noexcept { return crossMm_; }

  private:
    [[nodiscard]] QWidget* makeTools();
    void showScan();
    void showJob();
    void showPreview();
    void setCross(const core::Vec3& mm);
    void addCut(const core::Vec3& from, const core::Vec3& to, const core::Vec3& sliceNormal);
    void removeChosen();
    void flipChosen();
    void takeTool();

    SliceView *axial_, *coronal_, *sagittal_;
    SolidView* solid_;
    HistogramView* histogram_;
    QButtonGroup* tools_;
    QStackedWidget* options_;
    QComboBox* brushTissue_;
    DecimalField *brushRadius_, *lesionRadius_;
    QListWidget* decisions_;
    QPushButton *remove_, *flip_, *automatic_;
    QCheckBox *damp_, *caries_, *fill_;
    QLabel *volumes_, *notes_;
    FdiPicker* tooth_;
    core::Vec3 crossMm_ = core::Vec3::Zero();
    float black_ = 0, white_ = 1;
    bool showing_ = false;
};

}  // namespace handpiece::desktop
