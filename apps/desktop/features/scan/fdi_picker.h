// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth by its FDI number: typed, or chosen on the chart of the mouth.

#include <QWidget>

class QLabel;
class QLineEdit;

namespace handpiece::desktop {

/// [NAMENumber, NAMEName, NAMEChart] below the name given.
class FdiPicker : public QWidget {
    Q_OBJECT
  public:
    explicit FdiPicker(const QString& name, QWidget* parent = nullptr);
    /// 0: none.
    void setTooth(int fdi);
    [[nodiscard]] int tooth() const noexcept { return fdi_; }

  signals:
    void toothChosen(int fdi);

  private:
    void typed(const QString& text);
    void chart();

    int fdi_ = 0;
    QLineEdit* number_;
    QLabel* name_;
};

}  // namespace handpiece::desktop
