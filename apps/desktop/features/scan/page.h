// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the wizard's pages have in common.

#include <QWidget>

#include "desktop/features/scan/scan_model.h"

namespace handpiece::desktop {

/// One step: shows the model and decides in it.
class ScanPage : public QWidget {
    Q_OBJECT
  public:
    ScanPage(ScanModel& model, QWidget* parent) : QWidget(parent), model_(model) {}
    [[nodiscard]] virtual QString title() const = 0;
    [[nodiscard]] virtual ScanModel::Depth depth() const = 0;
    /// What is still missing before the next step; empty: nothing.
    [[nodiscard]] virtual QString missing() const { return {}; }

  protected:
    [[nodiscard]] ScanModel& model() const noexcept { return model_; }
    /// A decision: the job as it is now, changed.
    template <class Change>
    void decide(Change change, const QString& merge = {}) {
        scan_case::ScanJob job = model_.job();
        change(job);
        model_.decide(job, merge);
    }

  private:
    ScanModel& model_;
};

}  // namespace handpiece::desktop
