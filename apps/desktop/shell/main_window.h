// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The window: menus, bars, panels around the picture, three layouts. docs/desktop-objects.md lists the object names.

#include <QHash>
#include <QMainWindow>
#include <QPointer>
#include <QTimer>
#include <functional>
#include <memory>

#include "desktop/view/view_widget.h"
#include "panels/detail.h"
#include "panels/sound_control.h"
#include "panels/theme.h"
#include "panels/welcome_strip.h"
#include "shell/actions.h"
#include "shell/error_dialog.h"
#include "shell/settings.h"
#include "shell/simulator.h"

class QComboBox;
class QDockWidget;
class QLabel;
class QSlider;
class QToolBar;

namespace handpiece::desktop {

class DrillBar;
class ExerciseFeature;
class ForceGauge;
class JobStrip;
class MeasureBox;
class NoticeBar;
class ParameterBox;
class PedalMenu;
class PlotPanel;
class ReplayBar;
class StatusLine;
struct StatusFigures;
class ViewBar;
class VolumeBars;

/// Shows a simulator and steers it. It can be taken down and made anew (another language) while the work goes on.
class MainWindow : public QMainWindow {
    Q_OBJECT
  public:
    MainWindow(Simulator& simulator, Settings& settings, QWidget* parent = nullptr);
    ~MainWindow() override;

    void setDetail(Detail detail);
    [[nodiscard]] Detail detail() const noexcept { return detail_; }
    [[nodiscard]] ViewWidget* view() const noexcept { return view_; }
    [[nodiscard]] const Actions& actions() const noexcept { return *actions_; }
    [[nodiscard]] ExerciseFeature& exercise() const noexcept { return *exercise_; }

    /// Whatever the file is; asks about unsaved work first.
    void openFile(const QString& file);
    void openStarter(const Starter& starter);
    /// Offers what a crash left, tells of settings that were set aside: a strip each, no dialog.
    void greet();
    void tell(const QString& noticeId, const QStringList& arguments = {});
    void tellSaved(const QString& file);
    void showProblem(const Problem& problem);
    /// The dialog open now; null when there is none.
    [[nodiscard]] ErrorDialog* errorDialog() const noexcept { return errorDialog_; }
    /// To the settings: places of panels, eye, looks.
    void rememberAll();

    /// At the first start: what fits on a screen with this much room.
    [[nodiscard]] static QSize firstSize(const QSize& room);

    /// How long a hint stays.
    int hintMs = 6000;

    /// Whom to ask for file names and about unsaved work; tests put their own answers here.
    struct Questions {
        enum class Unsaved { save, discard, cancel };
        std::function<QString(const QString&title, const QString&start, const QString&filter)> fileToOpen, fileToSave;
        std::function<Unsaved()> unsaved;
    };
    Questions questions;
    /// Opens the wizard from a scan to a case, at this file or folder or (empty) none. None: this window has no wizard.
    std::function<void(const QString& path)> newCaseFromScan;
    /// Open the page about the device, and its first three steps. None: this window has no such dialogs.
    std::function<void()> openDevicePage, setUpDevice;

  signals:
    void languageChosen(const QString& code);
    void appearanceChosen(handpiece::desktop::Appearance appearance);
    /// The first picture of the tooth that is open.
    void firstPicture();

  protected:
    void closeEvent(QCloseEvent* event) override;
    void changeEvent(QEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

  private:
    // layouts.cpp
    void makePanels();
    void makeBars();
    void makeMenus();
    QDockWidget* dock(const char* name, const QString& title, QWidget* panel);
    void arrange(Detail detail);
    [[nodiscard]] QString layoutKey(Detail detail) const;
    void rememberLayout();

    // main_window_files.cpp
    void connectFiles();
    void ifFree(std::function<void()> then);
    void save(bool underNewName, std::function<void()> then = {});
    void showRecent();
    void writePicture();
    void writeReport();
    void keepRecording();
    void resumeLast();
    void chooseTooth();
    void chooseRecovery();
    void editCode();
    void showCode();
    [[nodiscard]] static QString titleOf(const SessionNote& note);
    void showAbout();
    void mend();
    void savePlot(const QString& format);
    [[nodiscard]] QString startFolder() const;

    // main_window_device.cpp
    void connectDevice();
    void listDevices();
    void chooseDevice(const QString& name);
    void nameDevice();
    void tellDevice(link::DeviceFault trouble, int vendorCode);
    void showDevice(StatusFigures& figures) const;
    [[nodiscard]] bool holdsDevice() const;
    /// What the person holds, in words.
    [[nodiscard]] QString deviceInHand() const;

    // main_window_wiring.cpp
    void connectWork();
    void connectView();
    void connectPanels();
    void connectSound();
    void showDocument();
    void takePermissions();
    void tellLocked(exercise::Operation operation);
    void showSettings();
    void showTick();
    void takeBackNotices(const messages::HapticSample& sample);
    void showSound();
    void showReadouts();
    void takeRecording(SoundControl::Channel channel, const QString& file);
    void readRecordings(std::function<void(const std::optional<Problem>&)> done);
    void recallRecordings();
    void toggleMicrophone(SoundControl::Channel channel, bool start);
    void editBindings();
    [[nodiscard]] static QString eventText(const std::string& name);
    void setTouching(bool touching);
    void takeLook(const view::Look& look);
    void takeSection();
    [[nodiscard]] core::Box toothBounds() const;
    void showTitle();
    void showEnabled();
    void rememberEye();
    void recallEye();
    void recallLook();
    void recallBindings();
    void tellStep(WelcomeStrip::Step step);

    Simulator& simulator_;
    Settings& settings_;
    Actions* actions_;
    Detail detail_ = Detail::practice;
    bool wasOpen_ = false, wasCut_ = false;  ///< pulp and tooth, as last shown
    bool arranged_ = false, closing_ = false, hasPicture_ = false, touching_ = false;
    ViewWidget* view_;
    JobStrip* job_;
    NoticeBar* notices_;
    WelcomeStrip* welcome_;
    ReplayBar* replay_;
    ExerciseFeature* exercise_;
    DrillBar* drill_;
    SoundControl* sound_;
    ParameterBox* parameters_;
    MeasureBox* measure_;
    ViewBar* looks_;
    PlotPanel* plots_;
    ForceGauge* gauge_;
    VolumeBars* volumes_;
    StatusLine* status_;
    QLabel *soundNote_, *code_;
    QToolBar *fileBar_, *toolBar_;
    QComboBox* resolution_;
    QSlider* mix_;
    QMenu *recent_, *panelsMenu_, *devices_;
    PedalMenu* pedals_;
    QList<QDockWidget*> docks_;
    QPointer<ErrorDialog> errorDialog_;
    QTimer readouts_, eyeTimer_, microphoneTimer_;
    sound::Recording recordings_[2];
    std::unique_ptr<sound::Microphone> microphone_;
    QHash<QString, QTimer*> hints_;  ///< by notice: when it goes
    std::vector<Crashed> crashed_;
    double eyeDistanceMm_ = 0.0;
    std::uint64_t rateTicks_ = 0, rateMissed_ = 0, rateLate_ = 0;
    qint64 rateSinceNs_ = 0;
    double rateHz_ = 0.0;
    bool late_ = false;
    bool deviceAsked_ = false;      ///< a person is waiting for it: what goes wrong is worth a dialog
    bool risesFromStatus_ = false;  ///< the menu of devices, now
    QString deviceTried_;
    QString lastOpened_;  ///< or tried to
};

/// What holds the handpiece, for a person; devices of makers keep the names they have.
[[nodiscard]] QString deviceText(const device::Capability& device);

/// What a notice says in the person's language; `grave`: worth red.
struct NoticeText {
    QString text;
    bool grave = false, hint = false;
};
[[nodiscard]] NoticeText noticeText(const QString& id, const QStringList& arguments);

}  // namespace handpiece::desktop
