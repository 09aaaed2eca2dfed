// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The bare window: the picture, strips over it, menus, bars, docks in three layouts, messages. What is in them comes
/// from features. docs/desktop-objects.md lists the object names.

#include <QFileInfo>
#include <QMainWindow>
#include <QPointer>
#include <functional>
#include <vector>

#include "desktop/framework/commands.h"
#include "desktop/framework/docks.h"
#include "desktop/framework/error_dialog.h"
#include "desktop/framework/notices.h"
#include "desktop/framework/questions.h"
#include "desktop/framework/settings.h"
#include "desktop/framework/shelves.h"
#include "desktop/picture/view_widget.h"
#include "desktop/widgets/detail.h"
#include "desktop/widgets/theme.h"

class QVBoxLayout;

namespace handpiece::desktop {

class JobStrip;
class StatusLine;
struct StatusFigures;

/// It can be taken down and made anew (another language) while the work goes on.
class MainWindow : public QMainWindow {
    Q_OBJECT
  public:
    explicit MainWindow(Settings& settings, QWidget* parent = nullptr);
    ~MainWindow() override;

    // What features bring.

    [[nodiscard]] Commands& commands() const noexcept { return *commands_; }
    [[nodiscard]] Docks& docks() const noexcept { return *docks_; }
    [[nodiscard]] Notices& notices() const noexcept { return *notices_; }
    [[nodiscard]] JobStrip& job() const noexcept { return *job_; }
    [[nodiscard]] StatusLine& status() const noexcept { return *status_; }
    [[nodiscard]] ViewWidget* view() const noexcept { return view_; }
    [[nodiscard]] Shelves& shelves() const noexcept { return *shelves_; }
    /// Below the picture.
    void addBelow(QWidget* strip);
    /// Fields of the status line, asked for at every refresh().
    std::vector<std::function<void(StatusFigures&)>> statusFields;
    /// Asked in their order; the first that takes a file has it. These leave the tooth that is open alone ...
    std::vector<std::function<bool(const QFileInfo&)>> openersBeside;
    /// ... and these put another in its place: they are asked once the work that is open may go.
    std::vector<std::function<bool(const QString& path)>> openers;
    /// Runs `then` once unsaved work is out of the way, unless that was cancelled.
    std::function<void(std::function<void()> then)> whenMayLeave = [](const std::function<void()>& then) { then(); };
    /// Likewise before the window closes.
    std::function<void(std::function<void()> then)> whenMayClose = [this](std::function<void()> then) {
        whenMayLeave(std::move(then));
    };
    /// Runs `then` once what a person named may be looked into; what must not be opened is told.
    std::function<void(const QString& path, std::function<void()> then)> whenRead =
        [](const QString&, const std::function<void()>& then) { then(); };
    /// The window closes for good.
    std::function<void()> closeWork = [] {};

    /// Once all features are there: menus and bars are filled, the layout is as it was.
    void begin();
    /// Commands and status, as they are now.
    void refresh(const exercise::Permissions& permissions);

    void setDetail(Detail detail);
    [[nodiscard]] Detail detail() const noexcept { return detail_; }
    /// All moving of panels in this layout is undone.
    void resetLayout();

    /// Whatever the file is; asks about unsaved work first.
    void openFile(const QString& file);
    void tellSaved(const QString& file);
    void showProblem(const Problem& problem);
    /// The dialog open now; null when there is none.
    [[nodiscard]] ErrorDialog* errorDialog() const noexcept { return errorDialog_; }
    /// To the settings: places of panels, and what features keep.
    void rememberAll();

    /// At the first start: what fits on a screen with this much room.
    [[nodiscard]] static QSize firstSize(const QSize& room);

    Questions questions;

  signals:
    void languageChosen(const QString& code);
    void appearanceChosen(handpiece::desktop::Appearance appearance);
    /// The first picture of the tooth that is open.
    void firstPicture();
    /// The person is there: what a crash left is offered, settings that were set aside are told of.
    void greet();
    void aboutToRemember();
    void detailChanged(handpiece::desktop::Detail detail);
    /// A feature may add a remedy.
    void problemShown(handpiece::desktop::ErrorDialog* dialog);

  protected:
    void closeEvent(QCloseEvent* event) override;
    void changeEvent(QEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

  private:
    void makeCentre();
    void arrange();
    [[nodiscard]] QString layoutKey() const;
    void rememberLayout();

    Settings& settings_;
    Commands* commands_;
    Shelves* shelves_;
    Docks* docks_;
    Detail detail_ = Detail::practice;
    bool arranged_ = false, closing_ = false;
    QVBoxLayout* centre_;
    ViewWidget* view_;
    JobStrip* job_;
    Notices* notices_;
    StatusLine* status_;
    QPointer<ErrorDialog> errorDialog_;
};

}  // namespace handpiece::desktop
