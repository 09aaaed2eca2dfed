// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The drill: which bur, which handpiece, how fast.

#include <QStringList>
#include <QWidget>
#include <vector>

#include "desktop/widgets/detail.h"
#include "desktop/widgets/number_field.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/rotor.h"

class QButtonGroup;
class QComboBox;
class QLabel;
class QLineEdit;
class QListView;
class QPushButton;
class QSlider;
class QToolButton;
class QVBoxLayout;

namespace handpiece::desktop {

class BurModel;
class BurFilter;
class SpeedDial;

/// Bur picker, handpiece and speed [drillBar]. Shows the shipped burs and drives until told otherwise.
class DrillBar : public QWidget {
    Q_OBJECT
  public:
    explicit DrillBar(QWidget* parent = nullptr);

    void setBurs(const std::vector<instrument::CatalogueEntry>& burs);
    /// What is looked for in the list, and of which shape; -1: of all.
    struct Shown {
        QString words;
        int shape = -1;
    };
    void setShown(const Shown& shown);
    [[nodiscard]] Shown shown() const;
    /// Only these may be chosen; empty: all. The others stay visible, grey, with the reason.
    void setAllowedBurs(const QStringList& names);
    /// The bur in hand. A name that no bur of the list has is shown as a bur of one's own.
    void setBur(const QString& name);
    [[nodiscard]] QString bur() const { return bur_; }
    /// A bur of one's own, from a file: added in front of the list (replacing one of that name), not yet in hand.
    void addOwnBur(const instrument::CatalogueEntry& entry, const instrument::Profile& profile);
    /// Into the list with its outline, unless the catalogue has it.
    void addOwnBur(const QString& name, const instrument::Bur& bur, const std::string& cuttingParameters);
    void setDrives(const std::vector<instrument::Drive>& drives);
    void setDrive(const QString& name);
    [[nodiscard]] QString drive() const { return drive_; }
    /// The set speed, held to the drive's free speed [rpm].
    void setSpeed(double rpm);
    [[nodiscard]] double speedRpm() const { return speedRpm_; }
    /// As fast as the bur turns now; `stalled`: it stands although the pedal is down.
    void setActualSpeed(double rpm, bool stalled);
    void setDetail(Detail detail);
    /// The next (or, -1, the one before) that may be chosen, as the keys full stop and comma do. Emits burChosen.
    void chooseNext(int step);
    /// Faster or slower by so many twentieths of the free speed, as + and - do. Emits speedSet.
    void stepSpeed(int steps);

  signals:
    void burChosen(const QString& name);
    void burFileRequested();
    void driveChosen(const QString& name);
    void speedSet(double rpm);

  private:
    void choose(const QString& name);
    void showBur();
    void showSpeed();
    void takeSpeed(double rpm, bool tell);
    [[nodiscard]] const instrument::Drive* current() const;

    BurModel* model_;
    BurFilter* filter_;
    QWidget* card_;
    QLabel *burName_, *burText_;
    QLineEdit* search_;
    QComboBox* kind_;
    QListView* list_;
    QPushButton* own_;
    QLabel* listNote_;
    QVBoxLayout* driveRows_;
    QButtonGroup* driveButtons_;
    SpeedDial* dial_;
    QLabel *speedCaption_, *stall_;
    QSlider* slider_;
    WholeField* spin_;
    std::vector<instrument::Drive> drives_;
    QString bur_, drive_;
    QStringList allowed_;
    double speedRpm_ = 0.0;
    Detail detail_ = Detail::practice;
};

}  // namespace handpiece::desktop
