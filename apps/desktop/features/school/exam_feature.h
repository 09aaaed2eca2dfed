// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam in the window: begun by codes, worked on with its locks under a clock that is always seen, handed over.
/// docs/school-exams.md

#include <QElapsedTimer>
#include <QTimer>
#include <functional>

#include "desktop/features/school/exam_link.h"
#include "desktop/framework/feature.h"

class QLabel;
class QMessageBox;

namespace handpiece::desktop {

class ExamBar;
class ExamDialog;
class ReceiptDialog;

class ExamFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { begin };
    explicit ExamFeature(const FeatureContext& context);
    void showDocument() override;

    [[nodiscard]] ExamLink& link() noexcept { return link_; }
    /// Whether the window closes while an exam runs.
    std::function<bool()> mayClose;

  private:
    void connectLink();
    void greet();
    void hearDesk(const ExamDesk& desk);
    void hearProblem(const QString& of, const Problem& problem);
    void hearEnding(const ExamEnding& ending);
    void takeUp(const ExamDesk& desk);
    void openTooth();
    void showTime();
    void showBar();
    void pause(bool isPaused);
    void askHandOver();
    void handOver();
    void tellTimeOver();
    void offerHandOver(const char* name, const QString& text, const QString& more, const QString& reject);
    [[nodiscard]] bool closeDialogs();
    [[nodiscard]] bool isShut();
    [[nodiscard]] qint64 leftMs() const;
    [[nodiscard]] QString exerciseFile(const QString& sitting) const;
    [[nodiscard]] QMessageBox* question(const char* name, const QString& text, const QString& more,
                                        const QString& accept, const QString& reject);

    CommandSet<Command> commands_;
    ExamLink link_;
    ExamBar* bar_;
    ExamDialog* dialog_;
    ReceiptDialog* receipt_;
    QLabel* cover_;  ///< over the picture in a pause
    QTimer clock_, again_;
    ExamDesk desk_;
    QElapsedTimer sinceDesk_;
    QString ending_;  ///< sitting whose end is asked for
    QString title_;   ///< of the exam that ran last
    bool isHandingOver_ = false, isSilent_ = false, isOverTold_ = false, isTaken_ = false;
};

}  // namespace handpiece::desktop
