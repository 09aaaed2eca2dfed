// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/main_window.h"

#include <QCloseEvent>
#include <QDir>
#include <QDropEvent>
#include <QMimeData>
#include <QScreen>
#include <QStatusBar>
#include <QUrl>
#include <QVBoxLayout>

#include "desktop/framework/feature.h"
#include "desktop/framework/job_strip.h"
#include "desktop/framework/roomy_layout.h"
#include "desktop/framework/screen_fit.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/widgets/status_line.h"

namespace handpiece::desktop {
namespace {

constexpr int kStateVersion = 1;
RoomyLayout& roomyLayoutOf(const MainWindow& window) {
    return *window.findChild<RoomyLayout*>(QString(), Qt::FindDirectChildrenOnly);
}

constexpr const char* kLayouts[] = {"practice", "laboratory", "paper"};  // in the order of Detail

}  // namespace

MainWindow::MainWindow(Settings& settings, QWidget* parent)
    : QMainWindow(parent),
      questions(settings, this),
      settings_(settings),
      commands_(new Commands(this)),
      shelves_(new Shelves(this, *commands_)),
      docks_(new Docks(this)) {
    new RoomyLayout(this, kStateVersion);
    setObjectName(QStringLiteral("mainWindow"));
    setWindowIcon(applicationIcon());
    setAcceptDrops(true);
    makeCentre();
}

MainWindow::~MainWindow() {
    // Panels tell nobody of their end.
    qDeleteAll(findChildren<Feature*>(Qt::FindDirectChildrenOnly));
}

QSize MainWindow::firstSize(const QSize& room) {
    // The frame's title is outside of what resize() counts.
    return QSize(1440, 900).boundedTo(room - QSize(0, kTitlePixels));
}

void MainWindow::makeCentre() {
    auto* centre = new QWidget;
    centre->setObjectName(QStringLiteral("centre"));
    centre_ = new QVBoxLayout(centre);
    centre_->setContentsMargins(0, 0, 0, 0);
    centre_->setSpacing(0);
    view_ = new ViewWidget;
    if (view_->objectName().isEmpty()) view_->setObjectName(QStringLiteral("view"));
    job_ = new JobStrip;
    auto* notices = new NoticeBar;
    notices_ = new Notices(notices);
    view_->addStrip(job_);
    view_->addStrip(notices);
    centre_->addWidget(view_, 1);
    setCentralWidget(centre);
    status_ = new StatusLine;
    connect(docks_, &Docks::detailChanged, status_, &StatusLine::setDetail);
    statusBar()->setObjectName(QStringLiteral("statusBar"));
    setDockOptions(AnimatedDocks | AllowTabbedDocks | AllowNestedDocks);
    setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
    setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
    setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
}

void MainWindow::addBelow(QWidget* strip) {
    centre_->addWidget(strip);
}

void MainWindow::begin() {
    shelves_->fill(docks_->all());
    statusBar()->addPermanentWidget(status_);
    HelpCard::Commands card;
    for (const QAction* action : commands_->onCard())
        card.emplace_back(action->text().remove(QStringLiteral("...")),
                          action->shortcut().toString(QKeySequence::NativeText));
    view_->setHelpCommands(card);
    const QString layout = settings_.value(QStringLiteral("window/layout"), QLatin1String(kLayouts[0])).toString();
    resize(firstSize(screen()->availableGeometry().size()));
    if (const QByteArray geometry = settings_.value(QStringLiteral("window/geometry")).toByteArray();
        !geometry.isEmpty())
        restoreGeometry(geometry);
    const auto* known = std::find(std::begin(kLayouts), std::end(kLayouts), layout);
    setDetail(known == std::end(kLayouts) ? Detail::practice : static_cast<Detail>(known - kLayouts));
    view_->setFocus();
}

void MainWindow::refresh(const exercise::Permissions& permissions) {
    commands_->refresh(permissions);
    StatusFigures figures;
    for (const auto& field : statusFields)
        field(figures);
    status_->setFigures(figures);
}

QString MainWindow::layoutKey() const {
    return QStringLiteral("layout/%1").arg(QLatin1String(kLayouts[static_cast<int>(detail_)]));
}

void MainWindow::rememberLayout() {
    if (arranged_) settings_.set(layoutKey(), roomyLayoutOf(*this).state());
}

void MainWindow::rememberAll() {
    rememberLayout();
    settings_.set(QStringLiteral("window/geometry"), saveGeometry());
    settings_.set(QStringLiteral("window/layout"), QLatin1String(kLayouts[static_cast<int>(detail_)]));
    emit aboutToRemember();
    settings_.sync();
}

void MainWindow::setDetail(Detail detail) {
    if (arranged_ && detail == detail_) return;
    rememberLayout();
    detail_ = detail;
    arrange();
    arranged_ = true;
    roomyLayoutOf(*this).restore(settings_.value(layoutKey()).toByteArray());
    docks_->showWanted();
    emit detailChanged(detail);
}

void MainWindow::resetLayout() {
    settings_.remove(layoutKey());
    arrange();
    roomyLayoutOf(*this).restore({});
}

void MainWindow::arrange() {
    setUpdatesEnabled(false);
    docks_->arrange(detail_);
    shelves_->arrange(detail_);
    setUpdatesEnabled(true);
}

void MainWindow::openFile(const QString& file) {
    if (file.isEmpty()) return;
    const QFileInfo info(file);
    for (const auto& open : openersBeside)
        if (open(info)) return;
    // case.toml and attempt.toml stand for their folders.
    const QString path = info.suffix() == QLatin1String("toml") ? info.absolutePath() : info.absoluteFilePath();
    whenMayLeave([this, path] {
        settings_.set(QStringLiteral("files/folder"), QFileInfo(path).absolutePath());
        whenRead(path, [this, path] {
            for (const auto& open : openers)
                if (open(path)) return;
        });
    });
}

void MainWindow::tellSaved(const QString& file) {
    const QStringList arguments{QDir::toNativeSeparators(file)};
    if (notices_->isFreeFor(Notice::saved)) {
        notices_->tell(Notice::saved, arguments);
    } else {
        // It never covers what is told of the work.
        statusBar()->showMessage(noticeText(Notice::saved, arguments), notices_->hintMs);
    }
}

void MainWindow::showProblem(const Problem& problem) {
    // One at a time: the first is the cause of the others more often than not.
    if (errorDialog_) return;
    errorDialog_ = new ErrorDialog(problem, this);
    emit problemShown(errorDialog_);
    errorDialog_->open();
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (closing_) {
        event->accept();
        return;
    }
    event->ignore();
    view_->escape();
    whenMayClose([this] {
        closing_ = true;
        rememberAll();
        closeWork();
        close();  // of use when something was saved or awaited first: within its own event Qt passes it over
    });
    event->setAccepted(closing_);
}

void MainWindow::changeEvent(QEvent* event) {
    if (event->type() == QEvent::WindowStateChange && isMinimized()) view_->escape();
    QMainWindow::changeEvent(event);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.size() == 1 && urls.front().isLocalFile()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    openFile(urls.front().toLocalFile());
}

}  // namespace handpiece::desktop
