// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The marking desk's own window: what is marked, the table of works, agreement.

#include <QDialog>

#include "desktop/features/marking/work_table.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QTabWidget;
class QTableView;

namespace handpiece::desktop {

class AgreementPage;

/// What the person chose on the first page.
struct DeskWish {
    QString folder, exercise, rubric, marker;  ///< rubric: empty for the exercise's own; a name, or a file
    bool isBlind = false, prove = true;
};

/// [markingDesk].
class DeskDialog : public QDialog {
    Q_OBJECT
  public:
    explicit DeskDialog(QWidget* parent);

    [[nodiscard]] DeskWish wish() const;
    void setFolder(const QString& folder);
    void setExercise(const QString& path);
    void setMarker(const QString& marker);
    void setBlind(bool isBlind);
    void setRubricFile(const QString& file);
    /// Null: back to the first page.
    void setDesk(const marking::Desk* desk);
    /// Scores, marks or comments have changed.
    void refresh();
    /// Under way: what, and how far; an empty title: nothing.
    void setWork(const QString& title, double share);
    void setNote(const QString& note);
    [[nodiscard]] AgreementPage* agreement() const noexcept { return agreement_; }
    [[nodiscard]] bool isAgreementShown() const;
    /// The work before or behind one as the table is sorted and filtered now; empty: none.
    [[nodiscard]] QString beside(const QString& code, int step) const;
    void select(const QString& code);

  signals:
    void folderRequested();
    void exerciseRequested();
    void rubricRequested();
    void beginRequested();
    void scoreRequested();
    void cancelRequested();
    void openRequested(const QString& code);
    void exportRequested(const QString& what);
    void agreementRequested();

  protected:
    void showEvent(QShowEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

  private:
    QWidget* makeSetUp();
    QWidget* makeWorks();
    void showWhetherReady();
    void filter();

    QTabWidget* tabs_;
    QLineEdit *folder_, *exercise_, *marker_;
    QComboBox* rubric_;
    QCheckBox *blind_, *prove_;
    QPushButton *begin_, *open_, *score_, *cancel_, *export_;
    QCheckBox *critical_, *borderline_, *unproven_, *problem_;
    QTableView* table_;
    WorkTable* works_;
    WorkFilter* filter_;
    QProgressBar* progress_;
    QLabel *note_, *count_;
    AgreementPage* agreement_;
    bool isAtWork_ = false;
    const marking::Desk* desk_ = nullptr;
};

}  // namespace handpiece::desktop
