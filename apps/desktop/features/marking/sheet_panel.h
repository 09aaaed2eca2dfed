// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One work on the marking desk, beside its picture: criteria, one's own marks or overrides, comments.

#include <QString>
#include <QWidget>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "desktop/widgets/number_field.h"
#include "handpiece/app/marking/desk.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QListWidget;
class QPushButton;
class QToolButton;
class QTreeWidget;
class QTreeWidgetItem;

namespace handpiece::desktop {

/// [markingSheet]. Shows what the desk says and asks for changes; the desk decides.
class SheetPanel : public QWidget {
    Q_OBJECT
  public:
    explicit SheetPanel(QWidget* parent = nullptr);

    /// Null or an empty code: nothing. `place`: "3 of 12".
    void showWork(const marking::Desk* desk, const QString& code, const QString& place, bool hasPrevious, bool hasNext);
    [[nodiscard]] const QString& code() const noexcept { return code_; }
    /// The criterion that is chosen; empty: none.
    [[nodiscard]] std::string criterion() const;
    /// Whether a comment can be pinned to a moment now.
    void setHasTime(bool hasTime);
    /// The place that was clicked in the picture, for the next comment; none: none is waiting.
    void setPlace(const std::optional<core::Vec3>& placeMm);
    /// Whether it is this work that the picture shows.
    void setIsShown(bool isShown);
    /// It was kept.
    void clearComment();

  signals:
    void stepRequested(int step);
    void tableRequested();
    void markRequested(const std::string& criterion, const handpiece::marking::Mark& mark);
    void giveInRequested();
    void overrideRequested(const std::string& criterion, const handpiece::marking::Override& said);
    void withdrawRequested(const std::string& criterion);
    void decisionRequested(const std::optional<handpiece::marking::Decision>& decision);
    /// The next click in the picture says where; off: it does not.
    void placeWanted(bool wanted);
    /// Whether at the middle of the picture, at this moment of the replay.
    void commentRequested(const QString& text, bool atPlace, bool atTime);
    void commentRemoved(int number);
    /// All that was said of it, as a file for its student.
    void returnRequested();
    void placeRequested(const std::optional<handpiece::core::Vec3>& placeMm, const std::optional<double>& timeS);

  private:
    /// What the fields were filled for: only another fills them anew.
    struct Edited {
        std::string code, criterion;
        bool marks = false, canSay = false;
        std::optional<marking::Mark> mark;
        std::optional<marking::Override> said;
        std::optional<marking::Decision> decision;
    };
    /// What stands in the fields and was not said: it waits while another criterion or work is looked at.
    struct Typed {
        QString band;
        double points = -1.0;
        int critical = 0;
        bool cannotTell = false;
        QString reason;
        friend bool operator==(const Typed&, const Typed&) = default;
    };
    struct TypedOfWork {
        std::map<std::string, Typed> criteria;
        std::optional<std::pair<int, QString>> decision;
        QString comment;
    };
    [[nodiscard]] Typed typed() const;
    void put(const Typed& typed);
    /// Of this desk's work.
    [[nodiscard]] TypedOfWork& waiting(const std::string& code);
    [[nodiscard]] bool isMarking() const;  ///< blind, and one's own mark is not in
    void fillCriteria();
    void fitNames();
    void addEvidence(QTreeWidgetItem* under, const score::CriterionScore& of);
    void fillComments();
    void showSummary();
    [[nodiscard]] QString stillToMark() const;
    void showEditor();
    void keepTyped(const Edited& next);
    void showDecision(const std::string& code, const std::optional<marking::Decision>& said);
    void showWhetherReady();
    void say();

    const marking::Desk* desk_ = nullptr;
    QString code_;
    std::optional<Edited> edited_;
    Typed filled_;                                ///< what the fields were filled with
    std::map<std::string, TypedOfWork> waiting_;  ///< by desk and code
    std::string deskName_;
    bool isShown_ = false;
    QLabel *title_, *summary_, *notShown_;
    QToolButton *previous_, *next_;
    QTreeWidget* criteria_;
    QLabel* editing_;
    QComboBox *band_, *critical_, *decision_;
    DecimalField* points_;
    QCheckBox* cannotTell_;
    QLineEdit *reason_, *decisionReason_, *comment_;
    QPushButton *say_, *withdraw_, *giveIn_, *decide_, *addComment_, *removeComment_, *pick_, *return_;
    QWidget* decisionRow_;
    QCheckBox *atPlace_, *atTime_;
    QListWidget* comments_;
};

}  // namespace handpiece::desktop
