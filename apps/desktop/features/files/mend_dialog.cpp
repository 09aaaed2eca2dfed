// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/mend_dialog.h"

#include <QCheckBox>
#include <QDialogButtonBox>
#include <QFileInfo>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>

#include "handpiece/base/geometry/mesh_io.h"

namespace handpiece::desktop {

bool canMend(const QString& problemId, const std::filesystem::path& file) {
    static const QStringList mendable{QStringLiteral("not-closed"), QStringLiteral("forks"),
                                      QStringLiteral("turned-faces"), QStringLiteral("crosses-itself")};
    return mendable.contains(problemId) && geometry::meshFormatOf(file) != geometry::MeshFormat::unknown;
}

namespace {
struct Texts {
    Q_DECLARE_TR_FUNCTIONS(MendDialog)
};
}  // namespace

bool closesMuch(const geometry::RepairReport& report) {
    constexpr double kMuchMm2 = 300.0, kMuchShare = 0.25;
    return std::any_of(report.holes.begin(), report.holes.end(), [&](const geometry::ClosedHole& hole) {
        return hole.areaMm2 > kMuchMm2 || hole.areaMm2 > kMuchShare * report.before.areaMm2;
    });
}

QString mendWords(const geometry::RepairReport& report) {
    const QLocale locale;
    const auto count = [&](std::size_t n) { return locale.toString(qulonglong{n}); };
    const auto mm2 = [&](double area) { return locale.toString(area, 'f', area < 10.0 ? 2 : 0); };
    QStringList lines;
    const auto add = [&](std::size_t n, const QString& text) {
        if (n > 0) lines << text;
    };
    double closedMm2 = 0.0, baseMm2 = 0.0;
    for (const geometry::ClosedHole& hole : report.holes)
        closedMm2 += hole.areaMm2;
    for (const geometry::MadeBase& base : report.bases)
        baseMm2 += base.areaMm2;
    add(report.bases.size(), Texts::tr("Stood on a flat base of %1 mm².").arg(mm2(baseMm2)));
    add(report.holes.size(),
        Texts::tr("Holes closed: %1, with %2 mm² of new surface.").arg(count(report.holes.size()), mm2(closedMm2)));
    add(report.turnedFaces, Texts::tr("Faces turned to face outwards: %1.").arg(count(report.turnedFaces)));
    add(report.splitEdges, Texts::tr("Edges of more than two faces cut apart: %1.").arg(count(report.splitEdges)));
    add(report.droppedShells, Texts::tr("Loose pieces left out: %1, with %2 faces.")
                                  .arg(count(report.droppedShells), count(report.droppedFaces)));
    const std::size_t spare = report.removedDegenerateFaces + report.removedDuplicateFaces + report.removedFinFaces;
    add(spare, Texts::tr("Faces left out that were flat, double or hung loose: %1.").arg(count(spare)));
    add(report.removedCrossingFaces,
        Texts::tr("Faces replaced where the surface crossed itself: %1.").arg(count(report.removedCrossingFaces)));
    if (closesMuch(report))
        lines << Texts::tr("Much of this surface is new. The border of an open arch is better stood on a flat base.");
    if (lines.isEmpty()) lines << Texts::tr("Nothing had to be changed but where vertices meet.");
    lines
        << Texts::tr("Surface before %1 mm², after %2 mm².").arg(mm2(report.before.areaMm2), mm2(report.after.areaMm2));
    return lines.join(QLatin1Char('\n'));
}

struct MendDialog::Mended {
    geometry::TriangleMesh mesh;
    geometry::VertexColours colours;
    geometry::RepairReport report;
};

MendDialog::MendDialog(const std::filesystem::path& file, QWidget* parent) : QDialog(parent), file_(file) {
    setObjectName(QStringLiteral("mendDialog"));
    setWindowTitle(tr("Mend the surface"));
    setAttribute(Qt::WA_DeleteOnClose);
    auto* column = new QVBoxLayout(this);
    text_ = new QLabel;
    text_->setObjectName(QStringLiteral("mendText"));
    text_->setTextFormat(Qt::PlainText);
    text_->setWordWrap(true);
    text_->setMinimumWidth(420);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
    column->addWidget(text_);
    bar_ = new QProgressBar;
    bar_->setObjectName(QStringLiteral("mendProgress"));
    bar_->setAccessibleName(tr("Progress"));
    bar_->setRange(0, 0);
    column->addWidget(bar_);
    base_ = new QCheckBox(tr("Stand it on a flat base"));
    base_->setObjectName(QStringLiteral("mendBase"));
    base_->setToolTip(tr("The longest border gets walls and a floor; other holes are closed as usual"));
    base_->hide();
    column->addWidget(base_);
    connect(base_, &QCheckBox::toggled, this, &MendDialog::mend);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    buttons->setObjectName(QStringLiteral("mendButtons"));
    save_ = buttons->addButton(tr("Save as and open..."), QDialogButtonBox::AcceptRole);
    save_->setObjectName(QStringLiteral("mendSave"));
    save_->setToolTip(tr("The file that was mended stays as it is"));
    save_->setEnabled(false);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(save_, &QPushButton::clicked, this, &MendDialog::saveRequested);
    mend();
}

void MendDialog::mend() {
    text_->setText(tr("Mending %1").arg(QFileInfo(QString::fromStdString(file_.string())).fileName()));
    bar_->show();
    save_->setEnabled(false);
    base_->setEnabled(false);
    mended_ = std::make_shared<Mended>();
    geometry::RepairSettings settings;
    settings.base = base_->isChecked();
    job_ = std::make_unique<Job>(windowTitle(), [file = file_, settings, mended = mended_](const core::Progress&) {
        const geometry::ColouredMesh read = geometry::readColouredMesh(file);
        mended->mesh = read.mesh;
        mended->report = geometry::repair(mended->mesh, settings);
        geometry::requireUncrossed(mended->report, settings, file.string());
        mended->colours = geometry::coloursFrom(read.mesh, read.colours, mended->mesh);
    });
    connect(job_.get(), &Job::done, this, [this] { tell(mended_->report); });
    connect(job_.get(), &Job::failed, this, [this](const Problem& problem) {
        bar_->hide();
        base_->setEnabled(true);
        text_->setText(tr("This cannot be mended here: %1 %2").arg(problem.what, problem.remedy));
    });
    job_->start();
}

MendDialog::~MendDialog() = default;

void MendDialog::tell(const geometry::RepairReport& report) {
    bar_->hide();
    text_->setText(mendWords(report));
    base_->setEnabled(true);
    if (closesMuch(report)) base_->show();
    save_->setEnabled(true);
    save_->setDefault(true);
}

void MendDialog::save(const std::filesystem::path& file) const {
    geometry::writeMesh(file, mended_->mesh, mended_->colours);
}

bool MendDialog::hasColours() const {
    return !mended_->colours.empty();
}

}  // namespace handpiece::desktop
