// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The chart of a mouth to choose a tooth by: of a patient that the program makes, or of a case.

#include <QDialog>
#include <QPointer>
#include <filesystem>
#include <map>
#include <vector>

#include "desktop/features/files/tooth_drawing.h"
#include "desktop/framework/job.h"
#include "desktop/widgets/number_field.h"
#include "desktop/work/documents.h"

class QCheckBox;
class QComboBox;
class QLabel;

namespace handpiece::desktop {

class ChartDialog : public QDialog {
    Q_OBJECT
  public:
    /// What is open now, and where cases are looked for.
    struct Setting {
        Starter starter;
        int openTooth = 0;
        std::shared_ptr<const cases::Case> openCase;  ///< its teeth are drawn as they are ...
        bool isStarterOpen = false;                   ///< ... when it is of the starter's patient
        std::vector<std::filesystem::path> places;    ///< folders with cases, and cases
        Notation notation = Notation::fdi;
    };
    explicit ChartDialog(Setting setting, QWidget* parent = nullptr);
    ~ChartDialog() override;

    [[nodiscard]] ToothChart* chart() const { return chart_; }

  signals:
    void starterChosen(const handpiece::desktop::Starter& starter);
    void caseChosen(const QString& path, int fdi);
    void notationChosen(int notation);

  private:
    struct Mouth {
        std::filesystem::path path;
        QString name;
        int ownTooth = 0;
        std::map<int, ToothDrawing> drawings;
    };
    void readCases(std::vector<std::filesystem::path> places);
    void takeCase(const Mouth& mouth);
    void showMouth();
    void choose(int fdi);
    [[nodiscard]] Starter asked(int fdi) const;

    Setting setting_;
    std::vector<Mouth> mouths_;
    QComboBox* mouth_;
    QComboBox* notation_;
    QWidget* patient_;
    WholeField* seed_;
    WholeField* age_;
    QCheckBox* inMouth_;
    ToothChart* chart_;
    QLabel* note_;
    QPointer<Job> job_;
};

}  // namespace handpiece::desktop
