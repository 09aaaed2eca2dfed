// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What holds the handpiece when it is not the mouse: which devices there are, the one that was chosen, how it does.

#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "desktop/framework/job.h"
#include "desktop/framework/problem.h"
#include "handpiece/app/input/device_opening.h"
#include "handpiece/tick/device/passing_device.h"

namespace handpiece::desktop {

/// A device that was opened. It lives from its choice until another takes its place: sittings come and go meanwhile,
/// one at a time, and each reads and commands it from its own tick. Otherwise the window's thread.
class Hand {
  public:
    Hand(std::string name, input::OpenDevice opened, std::filesystem::path profiles);

    /// As it was chosen: "haply", or "haply:0A1B" for one of several.
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] const link::DriverInfo& info() const noexcept { return opened_.info; }
    [[nodiscard]] device::Device& device() noexcept { return *opened_.device; }
    [[nodiscard]] safety::HealthBoard& health() noexcept { return *opened_.health; }
    [[nodiscard]] const input::Calibration& calibration() const noexcept { return opened_.calibration; }
    [[nodiscard]] const workspace::Profile& profile() const noexcept { return profile_; }
    [[nodiscard]] bool wasSetUp() const;  ///< its profile is in a file
    /// Writes it. What cannot be changed while it runs (scale, shares, clutch) is true from the next opening on:
    /// then this returns false. Throws core::Error.
    bool setProfile(const workspace::Profile& profile);
    /// What a school has chosen, for a device that was not set up yet.
    void suit(std::optional<bool> leftHanded, std::optional<double> scale);
    /// Puts the tooth into the arm's reach.
    void placeFor(const input::ToothPlace& tooth);
    /// Where the hand is now, it has the bur where it begins: over the tooth.
    void placeHere(const core::Vec3& handMm);
    /// For the force model: about which point torque is counted.
    [[nodiscard]] force::Parameters fitted(const force::Parameters& parameters) const {
        return input::fittedTo(opened_, parameters);
    }

  private:
    [[nodiscard]] workspace::WorkspaceMapping placing() const;

    std::string name_;
    input::OpenDevice opened_;
    std::filesystem::path profiles_;
    workspace::Profile profile_;
    input::ToothPlace tooth_;
};

/// One device of the list.
struct DeviceRow {
    /// "openhaptics", or "haply:0A1B" where there are several; "3D Systems Touch, ... (OpenHaptics HD)"
    QString name, text;
    bool available = false, pushes = true;
    QString why, remedy;  ///< when it is not there
};

/// How devices are found and opened. A test may put its own there.
struct DeviceOpener {
    std::function<std::vector<drivers::Found>()> look = input::lookForDevices;
    std::function<input::OpenDevice(const input::DeviceChoice&)> open = [](const input::DeviceChoice& choice) {
        return input::openDevice(choice);
    };
    /// Not started: for the fidelity check.
    std::function<std::unique_ptr<link::Driver>(const input::DeviceChoice&)> driver = input::openDriver;
};

/// Lives on the window's thread; looking, opening and closing are done beside it.
class DeviceManager : public QObject {
    Q_OBJECT
  public:
    struct Options {
        std::filesystem::path profiles;  ///< empty: workspace::profileFolder()
        std::string inject;              ///< faults on purpose, for the next devices that are opened
        DeviceOpener desk;
        std::shared_ptr<const link::PedalValue> foot;  ///< a pedal beside every device
        std::optional<bool> leftHanded;                ///< of a device that was not set up yet
        std::optional<double> scale;
        /// A device that has gone for so long gives way to the mouse; one that tells nothing for twice as long is told
        /// of.
        std::chrono::milliseconds patience{1500};
    };
    explicit DeviceManager(Options options, QObject* parent = nullptr);
    ~DeviceManager() override;

    void look();
    [[nodiscard]] const std::vector<DeviceRow>& rows() const noexcept { return rows_; }
    [[nodiscard]] bool isLooking() const noexcept { return looking_ != nullptr; }

    /// Opens it beside everything else; opened() or refused() tells. The one that is open is closed before. An empty
    /// name: the mouse, at once.
    void choose(QString name);
    /// The mouse holds the handpiece from now on; `then` once the device is closed and free for somebody else.
    void letGo(std::function<void()> then = {});
    [[nodiscard]] bool isOpening() const noexcept { return isOpening_; }
    /// The one that was asked for last; empty: the mouse.
    [[nodiscard]] const QString& wanted() const noexcept { return wanted_; }
    /// Null: the mouse.
    [[nodiscard]] const std::shared_ptr<Hand>& current() const noexcept { return current_; }
    [[nodiscard]] const safety::Health& health() const noexcept { return health_; }
    /// The trouble it has now that a person should know of.
    [[nodiscard]] link::DeviceFault trouble() const noexcept { return trouble_; }
    [[nodiscard]] const Options& options() const noexcept { return options_; }
    /// How the device of this name is opened: a driver's, or with a colon one of its devices by name, serial or number.
    [[nodiscard]] input::DeviceChoice choiceOf(const QString& name) const;
    /// To what a person calls it.
    [[nodiscard]] QString textOf(const QString& name) const;

  signals:
    void foundChanged();
    void opened();
    void refused(const QString& name, const handpiece::desktop::Problem& problem);
    /// It gives no force and says why; or it is well again (none).
    void troubled(handpiece::link::DeviceFault trouble, int vendorCode);
    /// It has been gone for longer than the patience; the mouse has taken over.
    void lost(const QString& name, handpiece::link::DeviceFault trouble, int vendorCode);
    /// About 30 times a second while one is open.
    void polled();
    /// Another device, or none.
    void changed();

  private:
    void poll();
    void open(const QString& name);
    void dispose(std::shared_ptr<Hand> hand);
    void goOnWhenClosed();

    Options options_;
    std::vector<DeviceRow> rows_;
    QString wanted_;
    std::shared_ptr<Hand> current_;
    safety::Health health_;
    link::DeviceFault trouble_ = link::DeviceFault::none;
    std::chrono::steady_clock::time_point openedAt_, since_;
    std::unique_ptr<Job> looking_, opening_;
    std::vector<std::unique_ptr<Job>> closing_;
    std::weak_ptr<Hand> before_;  ///< a sitting may hold it yet
    std::function<void()> whenClosed_;
    bool isOpening_ = false;
    QTimer timer_, closeTimer_;
};

/// A device of the window's, lent to one loop.
class LentDevice final : public device::PassingDevice {
  public:
    explicit LentDevice(const std::shared_ptr<Hand>& hand) : PassingDevice({hand, &hand->device()}) {}
};

/// What a trouble is called among the problems: "device-unplugged".
[[nodiscard]] QString problemIdOf(link::DeviceFault trouble);
/// In the person's words, with what to do.
[[nodiscard]] Problem problemOf(link::DeviceFault trouble, std::int32_t vendorCode);

}  // namespace handpiece::desktop
