// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How deep one stroke of the mouse's hand goes.

#include <QWidget>
#include <optional>

#include "desktop/widgets/number_field.h"

class QCheckBox;

namespace handpiece::desktop {

class PassRow : public QWidget {
    Q_OBJECT
  public:
    explicit PassRow(QWidget* parent = nullptr);
    /// None: as deep as the load takes it.
    [[nodiscard]] std::optional<double> depthMm() const;
    void setDepth(std::optional<double> depthMm);  ///< tells nobody

  signals:
    void changed(std::optional<double> depthMm);

  private:
    QCheckBox* on_;
    DecimalField* depth_;
};

}  // namespace handpiece::desktop
