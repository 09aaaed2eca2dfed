// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/fidelity_words.h"

#include <QCoreApplication>
#include <array>

namespace handpiece::desktop {
namespace {

/// As handpiece::fidelity says it.
constexpr std::array kSentences = {
    QT_TRANSLATE_NOOP("Fidelity", "Servo period"),
    QT_TRANSLATE_NOOP("Fidelity", "Servo jitter"),
    QT_TRANSLATE_NOOP("Fidelity", "Pauses of the servo"),
    QT_TRANSLATE_NOOP("Fidelity", "Lateness of the tick"),
    QT_TRANSLATE_NOOP("Fidelity", "Age of a pose at the tick"),
    QT_TRANSLATE_NOOP("Fidelity", "Slope of the force"),
    QT_TRANSLATE_NOOP("Fidelity", "Round-trip delay"),
    QT_TRANSLATE_NOOP("Fidelity", "Step of the encoders"),
    QT_TRANSLATE_NOOP("Fidelity", "Noise at rest"),
    QT_TRANSLATE_NOOP("Fidelity", "What the device can do"),
    QT_TRANSLATE_NOOP("Fidelity", "Motors"),
    QT_TRANSLATE_NOOP("Fidelity", "Troubles"),
    QT_TRANSLATE_NOOP("Fidelity", "Calibration"),
    QT_TRANSLATE_NOOP("Fidelity", "Scheduling"),
    QT_TRANSLATE_NOOP("Fidelity", "Memory"),
    QT_TRANSLATE_NOOP("Fidelity", "CPU frequency"),
    QT_TRANSLATE_NOOP("Fidelity", "Permission"),
    QT_TRANSLATE_NOOP("Fidelity", "Records lost"),
    QT_TRANSLATE_NOOP("Fidelity", "too few frames"),
    QT_TRANSLATE_NOOP("Fidelity", "none"),
    QT_TRANSLATE_NOOP("Fidelity", "not on this clock"),
    QT_TRANSLATE_NOOP("Fidelity", "no ticks"),
    QT_TRANSLATE_NOOP("Fidelity", "it cannot push"),
    QT_TRANSLATE_NOOP("Fidelity", "it was not to push"),
    QT_TRANSLATE_NOOP("Fidelity", "not measured: it cannot push"),
    QT_TRANSLATE_NOOP("Fidelity", "not measured: it was not to push"),
    QT_TRANSLATE_NOOP("Fidelity", "not measured: too few frames saw it move"),
    QT_TRANSLATE_NOOP("Fidelity", "not measured: it hardly moved"),
    QT_TRANSLATE_NOOP("Fidelity", "not measured: it was moved"),
    QT_TRANSLATE_NOOP("Fidelity", "it cannot push: input only"),
    QT_TRANSLATE_NOOP("Fidelity", "not told by this device"),
    QT_TRANSLATE_NOOP("Fidelity", "none needed"),
    QT_TRANSLATE_NOOP("Fidelity", "good"),
    QT_TRANSLATE_NOOP("Fidelity", "wanted"),
    QT_TRANSLATE_NOOP("Fidelity", "virtual time"),
    QT_TRANSLATE_NOOP("Fidelity", "locked"),
    QT_TRANSLATE_NOOP("Fidelity", "not locked"),
    QT_TRANSLATE_NOOP("Fidelity", "not told by this machine"),
    QT_TRANSLATE_NOOP("Fidelity", "not asked for: this driver opens no USB device itself"),
    QT_TRANSLATE_NOOP("Fidelity", "switch the device off and on"),
    QT_TRANSLATE_NOOP("Fidelity",
                      "connect it without a hub, close other programs, and let the machine grant real-time scheduling"),
    QT_TRANSLATE_NOOP("Fidelity", "close other programs; switch power saving off in the machine's set-up"),
    QT_TRANSLATE_NOOP("Fidelity", "let the machine grant real-time scheduling (docs/devices.md)"),
    QT_TRANSLATE_NOOP("Fidelity", "connect the device without a hub; close other programs"),
    QT_TRANSLATE_NOOP("Fidelity", "see the servo's period and pauses above; they come first"),
    QT_TRANSLATE_NOOP("Fidelity", "hold the stylus loosely while it pushes"),
    QT_TRANSLATE_NOOP("Fidelity", "check again for longer, with nothing else running"),
    QT_TRANSLATE_NOOP("Fidelity", "choose a softer stiffness, or the device's fastest servo"),
    QT_TRANSLATE_NOOP("Fidelity", "calibrate the device; hold it still while it is measured"),
    QT_TRANSLATE_NOOP("Fidelity", "leave the device alone for the first seconds"),
    QT_TRANSLATE_NOOP("Fidelity", "put it on a firm table; lay the stylus down while it is measured"),
    QT_TRANSLATE_NOOP("Fidelity",
                      "contact is made crisp by short transients instead: run --crisp on, or Device, Crisp contact"),
    QT_TRANSLATE_NOOP("Fidelity", "let the device rest for some minutes"),
    QT_TRANSLATE_NOOP("Fidelity", "handpiece device calibrate"),
    QT_TRANSLATE_NOOP("Fidelity", "let your group ask for it: rtprio in /etc/security/limits.d (docs/devices.md)"),
    QT_TRANSLATE_NOOP("Fidelity", "let your group lock it: memlock in /etc/security/limits.d (docs/devices.md)"),
    QT_TRANSLATE_NOOP("Fidelity", "close other programs and check again"),
    QT_TRANSLATE_NOOP("Fidelity", "set it while practising: cpupower frequency-set -g performance"),
    QT_TRANSLATE_NOOP("Fidelity", "install the udev rules (docs/devices.md) and connect the device again"),
};

}  // namespace

QString fidelityWords(const std::string& english) {
    return QCoreApplication::translate("Fidelity", english.c_str());  // what it does not know stays as it is
}

QStringList fidelitySentences() {
    QStringList all;
    for (const char* sentence : kSentences)
        all << QString::fromLatin1(sentence);
    return all;
}

}  // namespace handpiece::desktop
