// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The one dialog for errors: what, where, what to do.

#include <QDialog>

#include "desktop/framework/problem.h"

class QDialogButtonBox;
class QPushButton;

namespace handpiece::desktop {

/// [errorDialog]. Not modal to the tick: work goes on behind it.
class ErrorDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ErrorDialog(const Problem& problem, QWidget* parent = nullptr);
    [[nodiscard]] const Problem& problem() const noexcept { return problem_; }
    /// All of it as plain text, as the copy button gives it.
    [[nodiscard]] QString text() const;
    /// Another button beside the two, which closes the dialog.
    QPushButton* addRemedy(const char* objectName, const QString& text, const QString& tip);

  private:
    Problem problem_;
    QDialogButtonBox* buttons_;
};

}  // namespace handpiece::desktop
