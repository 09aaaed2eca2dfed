// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The result of a piece of work: one's own judgement first where the exercise asks for it, then the score and why.

#include <QDialog>
#include <optional>
#include <vector>

#include "desktop/work/simulator.h"
#include "handpiece/school/store/store.h"

class QButtonGroup;
class QLabel;
class QListWidget;
class QPlainTextEdit;
class QPushButton;
class QSpinBox;
class QStackedWidget;
class QTableWidget;
class QVBoxLayout;

namespace handpiece::desktop {

class SolidView;

/// What a student expects of their own work [%].
struct OwnJudgement {
    double percent = 0.0;
    QString words;
};

/// [resultDialog]. Beside the window, which shows what a click on it asks for.
class ResultDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ResultDialog(QWidget* parent);

    /// Null `ideal`: none is shown. With `asksFirst` the result is seen once the person has said what they expect.
    void setResult(std::shared_ptr<const Simulator::Finished> done, course::Parts ideal, bool asksFirst);
    /// Of a result of before: what was said of it then, by oneself and by a teacher.
    void setSaid(std::optional<OwnJudgement> own, std::vector<school::Comment> comments);
    void setIdeal(course::Parts ideal);
    [[nodiscard]] const std::shared_ptr<const Simulator::Finished>& shown() const noexcept { return done_; }

  signals:
    /// Before the result is seen; not at all where nobody was asked.
    void judged(const handpiece::desktop::OwnJudgement& own);
    /// To be looked at: a place, and the seconds in which it happened where they are known.
    void evidenceChosen(const handpiece::measures::Evidence& evidence);
    void againRequested();
    void nextRequested();
    void pageRequested();

  protected:
    void closeEvent(QCloseEvent* event) override;

  private:
    QWidget* makeJudging();
    QWidget* makeResult();
    void judge();
    void fill();
    void fillErrors();
    void fillTable();
    void fillComments();
    void showTooth();

    std::shared_ptr<const Simulator::Finished> done_;
    course::Parts ideal_;
    std::optional<OwnJudgement> own_;
    bool isAsking_ = false;
    QStackedWidget* pages_;
    QSpinBox* percent_;
    QPlainTextEdit* words_;
    QLabel *title_, *score_, *why_, *time_, *compared_, *proof_;
    QListWidget* comments_;
    std::vector<school::Comment> said_;
    QPushButton* page_;
    QVBoxLayout* errors_;
    std::vector<QWidget*> errorRows_;
    QTableWidget* table_;
    SolidView* tooth_;
    QButtonGroup* which_;
};

}  // namespace handpiece::desktop
