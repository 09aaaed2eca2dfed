// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam's beginning, with an invigilator beside the candidate; and its end, with the receipt.

#include <QDialog>

#include "desktop/features/school/exam_link.h"

class QLabel;
class QLineEdit;
class QPlainTextEdit;
class QPushButton;
class QStackedWidget;

namespace handpiece::desktop {

/// First the code on the candidate's slip; then what it begins, and who confirms the candidate's identity.
class ExamDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ExamDialog(QWidget* parent);
    /// From its first page, with nothing typed.
    void restart();
    void showOffer(const ExamOffer& offer);
    /// It can be tried again.
    void showProblem(const Problem& problem);

  signals:
    /// `opening`: typed where the exam is sealed still; else empty.
    void lookRequested(const QString& candidate, const QString& opening);
    void beginRequested(const QString& candidate, const QString& invigilator, const QString& pin);

  private:
    void setBusy(bool isBusy);
    void goOn();
    void goBack();

    QStackedWidget* pages_;
    QLineEdit *candidate_, *opening_, *invigilator_, *pin_;
    QWidget* openingRow_;
    QLabel *title_, *what_, *time_, *locked_, *again_, *problem_;
    QPushButton *back_, *next_;
};

class ReceiptDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ReceiptDialog(QWidget* parent);
    void show(const QString& title, const ExamEnding& ending);
    [[nodiscard]] const ExamEnding& ending() const noexcept { return ending_; }
    /// The receipt where it came, else what the station signed.
    [[nodiscard]] const QString& text() const;

  signals:
    void saveRequested();

  private:
    ExamEnding ending_;
    QLabel *heading_, *words_;
    QPlainTextEdit* text_;
    QPushButton* save_;
};

/// "37 min 30 s"
[[nodiscard]] QString durationWords(qint64 ms);
/// "25 % more time and 10 min for pauses are in it."; empty where there is neither.
[[nodiscard]] QString allowanceWords(int extraPercent, int pauseMinutes);

}  // namespace handpiece::desktop
