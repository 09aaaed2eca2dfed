// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The result of a piece of work: one's own judgement first where the exercise asks for it, then the score and why.

#include <QDialog>
#include <optional>
#include <vector>

#include "desktop/widgets/number_field.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/school/store/store.h"

class QButtonGroup;
class QLabel;
class QListWidget;
class QPlainTextEdit;
class QPushButton;
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
    /// Of a result of before: what was said of it then, by oneself and by teachers.
    void setSaid(std::optional<OwnJudgement> own, const std::vector<school::Comment>& comments,
                 std::vector<marking::ReturnedMarks> returned);
    /// Null: none is shown, `why` in a sentence.
    void setIdeal(course::Parts ideal, const QString& why = {});
    void setHasTeacherWork(bool has);
    /// What is being written of it, or was: said in its own window, which lies over the other one. While `isBusy`
    /// nothing else can be written.
    void setNote(const QString& words, bool isBusy = false);
    [[nodiscard]] const std::shared_ptr<const Simulator::Finished>& shown() const noexcept { return done_; }

  signals:
    void opened();
    /// Before the result is seen; not at all where nobody was asked.
    void judged(const handpiece::desktop::OwnJudgement& own);
    /// To be looked at: a place, and the seconds in which it happened where they are known; `words` are said there.
    void evidenceChosen(const handpiece::measures::Evidence& evidence, const QString& words = {});
    /// An exercise that comes along, which trains what cost points.
    void practiseRequested(const QString& exercise);
    void againRequested();
    void nextRequested();
    void pageRequested();
    void handInRequested();
    /// The teacher's own work on the same tooth: where the place that was looked at last was cut, or from its
    /// beginning.
    void teacherWorkRequested(const std::optional<handpiece::measures::Evidence>& at);

  protected:
    void closeEvent(QCloseEvent* event) override;
    void showEvent(QShowEvent* event) override;

  private:
    QWidget* makeJudging();
    QWidget* makeResult();
    void judge();
    void fill();
    void fillErrors();
    void fillTable();
    void fillTeacher();
    void say(QString words, const std::string& author, std::optional<measures::Evidence> there);
    void lookAt(const measures::Evidence& evidence, const QString& words = {});
    void showTooth();
    void showIn(SolidView* view, const course::Parts& parts, bool isFirst);
    void showWhatCanBeWritten();

    std::shared_ptr<const Simulator::Finished> done_;
    course::Parts ideal_;
    QString noIdeal_;  ///< why there is none
    std::optional<OwnJudgement> own_;
    bool isAsking_ = false;
    bool hasTooth_ = false;  ///< of this result one was shown, so that the eye has its place
    QStackedWidget* pages_;
    WholeField* percent_;
    QPlainTextEdit* words_;
    QLabel *title_, *score_, *teacher_, *why_, *time_, *compared_, *proof_;
    QListWidget* comments_;
    std::vector<std::optional<measures::Evidence>> saidOf_;  ///< where the list's rows lead
    std::vector<marking::ReturnedMarks> returned_;
    QPushButton *page_, *handIn_, *teacherWork_;
    std::optional<measures::Evidence> lookedAt_;
    QLabel* note_;
    bool isWriting_ = false;
    QVBoxLayout* errors_;
    std::vector<QWidget*> errorRows_;
    QTableWidget* table_;
    SolidView *tooth_, *judged_;  ///< beside the result, and beside the question before it
    QButtonGroup* which_;
};

}  // namespace handpiece::desktop
