// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/chart_dialog.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QVBoxLayout>
#include <algorithm>
#include <set>

#include "desktop/framework/mnemonics.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

constexpr int kMostSeed = 999999;
/// Of a full set of permanent teeth.
constexpr int kLeastAge = 18, kMostAge = 90;
constexpr std::size_t kMostCases = 40;

/// The cases among these places, in their order: folders and packages, and those one level below a folder.
std::vector<fs::path> casesIn(const std::vector<fs::path>& places) {
    std::vector<fs::path> found;
    const auto isCase = [](const fs::path& path) {
        std::error_code error;
        return fs::exists(path / "case.toml", error) || path.extension() == ".handpiece";
    };
    const auto add = [&](const fs::path& path) {
        if (found.size() < kMostCases && isCase(path) && std::find(found.begin(), found.end(), path) == found.end())
            found.push_back(path);
    };
    for (const fs::path& place : places) {
        std::error_code error;
        if (place.empty()) continue;
        add(place);
        std::vector<fs::path> inside;
        if (!isCase(place))
            for (const auto& entry : fs::directory_iterator(place, error))
                inside.push_back(entry.path());
        std::sort(inside.begin(), inside.end());
        for (const fs::path& path : inside)
            add(path);
    }
    return found;
}

}  // namespace

ChartDialog::ChartDialog(Setting setting, QWidget* parent)
    : QDialog(parent),
      setting_(std::move(setting)),
      mouth_(named(new QComboBox, "chartMouth", tr("Mouth"),
                   tr("A patient that the program makes, or a case from the folders of your cases"))),
      notation_(named(new QComboBox, "notationBox", tr("Notation"), tr("How teeth are numbered"))),
      patient_(new QWidget),
      seed_(named(new WholeField, "patientSeed", tr("Patient's number"),
                  tr("Another number is another patient; 0 is the average of all"))),
      age_(named(new WholeField, "patientAge", tr("Patient's age"), tr("With age the pulp shrinks and cusps wear"))),
      inMouth_(named(new QCheckBox(tr("In the whole mouth")), "patientMouth", tr("In the whole mouth"),
                     tr("With the other teeth, gingiva and bone; otherwise the tooth stands alone"))),
      chart_(new ToothChart),
      note_(note(QString(), this, "chartNote")) {
    setObjectName(QStringLiteral("toothDialog"));
    setWindowTitle(tr("Choose a tooth"));
    mouth_->addItem(tr("A patient of the program"));
    mouth_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    mouth_->setMinimumContentsLength(18);
    notation_->addItems({tr("FDI (ISO 3950)"), tr("Universal"), tr("Palmer")});
    notation_->setCurrentIndex(static_cast<int>(setting_.notation));
    seed_->setRange(0, kMostSeed);
    seed_->setValue(static_cast<int>(std::min<std::uint64_t>(setting_.starter.patient.seed, kMostSeed)));
    age_->setRange(kLeastAge, kMostAge);
    age_->setSuffix(tr(" years"));
    age_->setValue(static_cast<int>(setting_.starter.patient.ageYears));
    inMouth_->setChecked(setting_.starter.inMouth);
    auto* above = new QHBoxLayout;
    above->addWidget(mouth_, 1);
    above->addWidget(new QLabel(tr("Notation")));
    above->addWidget(notation_);
    auto* row = new QHBoxLayout(patient_);
    row->setContentsMargins(0, 0, 0, 0);
    row->addWidget(new QLabel(tr("Patient")));
    row->addWidget(seed_);
    row->addWidget(new QLabel(tr("Age")));
    row->addWidget(age_);
    row->addWidget(inMouth_);
    row->addStretch();
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    auto* column = new QVBoxLayout(this);
    column->addLayout(above);
    column->addWidget(patient_);
    column->addWidget(chart_, 1);
    column->addWidget(note_);
    column->addWidget(buttons);
    chart_->setNotation(setting_.notation);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(notation_, &QComboBox::activated, this, [this](int index) {
        chart_->setNotation(static_cast<Notation>(index));
        emit notationChosen(index);
    });
    connect(mouth_, &QComboBox::currentIndexChanged, this, &ChartDialog::showMouth);
    connect(seed_, &WholeField::valueChanged, this, &ChartDialog::showMouth);
    connect(age_, &WholeField::valueChanged, this, &ChartDialog::showMouth);
    connect(chart_, &ToothChart::toothChosen, this, &ChartDialog::choose);
    showMouth();
    readCases(casesIn(setting_.places));
    chart_->setFocus();
}

ChartDialog::~ChartDialog() {
    // Nobody waits for what is read no more: the job goes when it has ended.
    if (job_) job_->disconnect(this);
}

/// One after the other beside the window; each shows when it is read, one that cannot be read does not: that is told
/// when somebody opens it.
void ChartDialog::readCases(std::vector<fs::path> places) {
    if (places.empty()) return;
    const auto mouth = std::make_shared<Mouth>();
    mouth->path = places.front();
    places.erase(places.begin());
    job_ = new Job(
        tr("Reading cases"),
        [mouth](const core::Progress&) {
            if (fileKindOf(mouth->path) != FileKind::toothCase) return;
            const cases::Case read = cases::readCase(mouth->path);
            mouth->name = QString::fromStdString(read.name);
            mouth->ownTooth = read.fdiNumber;
            mouth->drawings = drawingsOf(read);
        },
        parentWidget());
    connect(job_, &Job::done, job_, &QObject::deleteLater);
    connect(job_, &Job::failed, job_, &QObject::deleteLater);
    connect(job_, &Job::done, this, [this, mouth, places] {
        takeCase(*mouth);
        readCases(places);
    });
    connect(job_, &Job::failed, this, [this, places] { readCases(places); });
    job_->start();
}

void ChartDialog::takeCase(const Mouth& mouth) {
    if (mouth.drawings.empty()) return;
    mouths_.push_back(mouth);
    mouth_->addItem(tr("%1 (%2)").arg(mouth.name, toQString(mouth.path.filename())));
    showMouth();
}

Starter ChartDialog::asked(int fdi) const {
    Starter starter = setting_.starter;
    starter.fdi = fdi;
    starter.patient = {static_cast<std::uint64_t>(seed_->value()), static_cast<double>(age_->value())};
    starter.inMouth = inMouth_->isChecked();
    return starter;
}

void ChartDialog::showMouth() {
    const int at = mouth_->currentIndex();
    patient_->setVisible(at == 0);
    std::set<int> available;
    std::map<int, QString> marks;
    if (at > 0) {
        const Mouth& mouth = mouths_[static_cast<std::size_t>(at - 1)];
        for (const auto& [fdi, drawing] : mouth.drawings)
            available.insert(fdi);
        chart_->setDrawings(mouth.drawings);
        chart_->setChosen(mouth.ownTooth);
        note_->setText(tr("The teeth of this case, as they are. Any of them can be the one worked on."));
    } else {
        for (const bool upper : {true, false})
            for (const int fdi : upper ? upperArch(false) : lowerArch(false))
                available.insert(fdi);
        for (const Mouth& mouth : mouths_)
            if (mouth.ownTooth != 0) {
                QString& mark = marks[mouth.ownTooth];
                mark += (mark.isEmpty() ? QString() : QStringLiteral("\n")) + tr("Case: %1").arg(mouth.name);
            }
        const bool isOpen = setting_.isStarterOpen && setting_.openCase &&
                            asked(setting_.starter.fdi).patient == setting_.starter.patient;
        chart_->setDrawings(isOpen ? drawingsOf(*setting_.openCase) : std::map<int, ToothDrawing>());
        chart_->setChosen(setting_.openTooth);
        note_->setText(marks.empty() ? tr("The first tooth of a new patient takes a while: the whole mouth is made.")
                                     : tr("Of teeth with a dot there are cases as well."));
    }
    chart_->setAvailable(available);
    chart_->setMarks(std::move(marks));
}

void ChartDialog::choose(int fdi) {
    const auto openCase = [this](const Mouth& mouth, int tooth) {
        const QString path = toQString(mouth.path);
        accept();
        emit caseChosen(path, tooth);
    };
    if (const int at = mouth_->currentIndex(); at > 0) return openCase(mouths_[static_cast<std::size_t>(at - 1)], fdi);
    const auto openStarter = [this, fdi] {
        const Starter starter = asked(fdi);
        accept();
        emit starterChosen(starter);
    };
    std::vector<Mouth> ofTooth;
    for (const Mouth& mouth : mouths_)
        if (mouth.ownTooth == fdi) ofTooth.push_back(mouth);
    if (ofTooth.empty()) return openStarter();
    auto* menu = withMnemonics(new QMenu(this));
    menu->setObjectName(QStringLiteral("chartChoice"));
    menu->setAttribute(Qt::WA_DeleteOnClose);
    connect(menu->addAction(tr("This patient's tooth")), &QAction::triggered, this, openStarter);
    for (const Mouth& mouth : ofTooth)
        connect(menu->addAction(menuText(tr("Case: %1").arg(mouth.name))), &QAction::triggered, this,
                [openCase, mouth, fdi] { openCase(mouth, fdi); });
    menu->setActiveAction(menu->actions().front());
    menu->popup(chart_->mapToGlobal(chart_->centreOf(fdi).toPoint()));
}

}  // namespace handpiece::desktop
