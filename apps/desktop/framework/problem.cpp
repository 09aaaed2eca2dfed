// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/problem.h"

#include <QCoreApplication>
#include <array>

namespace handpiece::desktop {
namespace {

/// What the library's errors are called (core::Error::id), and the window's own. %1, %2, ... are the arguments.
struct Entry {
    const char *id, *what, *remedy;
};
constexpr std::array kEntries = {
    Entry{"file-not-found", QT_TRANSLATE_NOOP("Problem", "There is no such file."),
          QT_TRANSLATE_NOOP("Problem", "Check the name, or choose the file again.")},
    Entry{"is-a-folder", QT_TRANSLATE_NOOP("Problem", "This is a folder, not a file."),
          QT_TRANSLATE_NOOP("Problem", "Choose a file inside it.")},
    Entry{"not-a-file", QT_TRANSLATE_NOOP("Problem", "This is a device or a pipe, not a plain file."),
          QT_TRANSLATE_NOOP("Problem", "Choose a file.")},
    Entry{"too-large", QT_TRANSLATE_NOOP("Problem", "The file is too large to be read."),
          QT_TRANSLATE_NOOP("Problem", "Choose another file.")},
    Entry{"not-a-case", QT_TRANSLATE_NOOP("Problem", "This folder holds no case: it has no %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose a folder with case.toml, a .handpiece file or an STL file.")},
    Entry{"case-without-surface", QT_TRANSLATE_NOOP("Problem", "This case names no surface of a whole tooth."),
          QT_TRANSLATE_NOOP("Problem", "Name the tooth in case.toml: outer.stl, or one part.")},
    Entry{"no-such-tooth", QT_TRANSLATE_NOOP("Problem", "The mouth has no tooth %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose one of the teeth that the chart shows.")},
    Entry{"not-an-attempt", QT_TRANSLATE_NOOP("Problem", "This is no attempt that was saved."),
          QT_TRANSLATE_NOOP("Problem", "Choose the folder or .handpiece file that was saved.")},
    Entry{"attempt-damaged",
          QT_TRANSLATE_NOOP("Problem", "What was cut in this attempt cannot be read: it is damaged."),
          QT_TRANSLATE_NOOP("Problem", "Take another copy of it.")},
    Entry{"bad-text", QT_TRANSLATE_NOOP("Problem", "Its text cannot be understood. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Mend the file, or take another copy of it.")},
    Entry{"not-readable", QT_TRANSLATE_NOOP("Problem", "The file cannot be read: %1."),
          QT_TRANSLATE_NOOP("Problem", "Check its permissions.")},
    Entry{"no-space", QT_TRANSLATE_NOOP("Problem", "The disk is full: %1. Nothing is lost, the tooth is still open."),
          QT_TRANSLATE_NOOP("Problem", "Make room, or save to another disk.")},
    Entry{"not-writable",
          QT_TRANSLATE_NOOP("Problem", "This place cannot be written: %1. Nothing is lost, the tooth is still open."),
          QT_TRANSLATE_NOOP("Problem", "Save under another name or in another folder.")},
    Entry{"store-newer",
          QT_TRANSLATE_NOOP("Problem", "Your results were kept by a newer Handpiece (version %1, this one knows %2)."),
          QT_TRANSLATE_NOOP("Problem", "Use that one. Nothing is lost.")},
    Entry{"store-locked", QT_TRANSLATE_NOOP("Problem", "Another program is writing your results."),
          QT_TRANSLATE_NOOP("Problem", "Close the other one, or try again.")},
    Entry{"store-damaged",
          QT_TRANSLATE_NOOP("Problem", "The file of your results cannot be read. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Move the file away: a new one is made.")},
    Entry{"not-a-package",
          QT_TRANSLATE_NOOP("Problem", "This is no .handpiece file, or a damaged one. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Take another copy of it.")},
    Entry{"bad-mesh", QT_TRANSLATE_NOOP("Problem", "This file holds no mesh that can be read. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Export it again as an STL, PLY or OBJ file.")},
    Entry{"no-triangles", QT_TRANSLATE_NOOP("Problem", "This file holds no surface."),
          QT_TRANSLATE_NOOP("Problem", "Choose an STL, PLY or OBJ file of a tooth.")},
    Entry{"not-closed",
          QT_TRANSLATE_NOOP("Problem", "The surface is not closed. Open edges: %1, holes: %2, the first at %3."),
          QT_TRANSLATE_NOOP("Problem", "Mend it here, or with: handpiece mesh repair FILE MENDED.stl")},
    Entry{"forks",
          QT_TRANSLATE_NOOP("Problem", "The surface forks. Edges of more than two faces: %1, the first at %2."),
          QT_TRANSLATE_NOOP("Problem", "Mend it here, or with: handpiece mesh repair FILE MENDED.stl")},
    Entry{"one-sided", QT_TRANSLATE_NOOP("Problem", "The surface has only one side."),
          QT_TRANSLATE_NOOP("Problem", "Draw it anew in a mesh editor.")},
    Entry{"turned-faces",
          QT_TRANSLATE_NOOP("Problem", "The surface is turned inside out in places. Places: %1, the first at %2."),
          QT_TRANSLATE_NOOP("Problem", "Mend it here, or with: handpiece mesh repair FILE MENDED.stl")},
    Entry{"no-volume", QT_TRANSLATE_NOOP("Problem", "The surface encloses no volume."),
          QT_TRANSLATE_NOOP("Problem", "Choose the closed surface of a tooth.")},
    Entry{"crosses-itself",
          QT_TRANSLATE_NOOP("Problem", "The surface crosses itself. Pairs of faces: %1, the first at %2."),
          QT_TRANSLATE_NOOP("Problem", "Mend it here, or with: handpiece mesh repair FILE MENDED.stl")},
    Entry{"wrong-size", QT_TRANSLATE_NOOP("Problem", "%1 mm is no size for a tooth."),
          QT_TRANSLATE_NOOP("Problem", "The file's unit is probably not the millimetre: scale it first.")},
    Entry{"case-moved", QT_TRANSLATE_NOOP("Problem", "The tooth that was cut is no longer at %1."),
          QT_TRANSLATE_NOOP("Problem", "Put it back there, or open an attempt that was saved as one .handpiece file.")},
    Entry{"case-changed", QT_TRANSLATE_NOOP("Problem", "The tooth at %1 has changed since: it is another tooth now."),
          QT_TRANSLATE_NOOP("Problem", "Put the one that was cut back there.")},
    Entry{"not-a-session", QT_TRANSLATE_NOOP("Problem", "This is no recorded session."),
          QT_TRANSLATE_NOOP("Problem", "Sessions are files that end in .h5.")},
    Entry{"session-newer", QT_TRANSLATE_NOOP("Problem", "This session was recorded by a newer Handpiece."),
          QT_TRANSLATE_NOOP("Problem", "Open it with that one.")},
    Entry{"session-damaged", QT_TRANSLATE_NOOP("Problem", "This session is damaged. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Take another copy of it.")},
    Entry{"session-empty", QT_TRANSLATE_NOOP("Problem", "Nothing was recorded in this session."),
          QT_TRANSLATE_NOOP("Problem", "It ended before its first second was over.")},
    Entry{"session-gap", QT_TRANSLATE_NOOP("Problem", "This session has a gap: the disk was too slow."),
          QT_TRANSLATE_NOOP("Problem", "Go on behind the gap, or export it as a table.")},
    Entry{"bur-size", QT_TRANSLATE_NOOP("Problem", "%1 mm is no size for a bur."),
          QT_TRANSLATE_NOOP("Problem", "The file's unit is probably not the millimetre: scale it first.")},
    Entry{"bur-not-round", QT_TRANSLATE_NOOP("Problem", "This bur is not round about z, tip down."),
          QT_TRANSLATE_NOOP("Problem", "Turn it so in a mesh editor. A bur is a solid of revolution.")},
    Entry{"bur-not-solid", QT_TRANSLATE_NOOP("Problem", "The bur's surface is not closed."),
          QT_TRANSLATE_NOOP("Problem", "Mend it first: handpiece mesh repair FILE MENDED.stl")},
    Entry{"bur-unknown", QT_TRANSLATE_NOOP("Problem", "There is no bur %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose one in the list.")},
    Entry{"parameter-refused", QT_TRANSLATE_NOOP("Problem", "This value cannot be set: %2."),
          QT_TRANSLATE_NOOP("Problem", "Choose a value from %3 to %4.")},
    Entry{"no-microphone", QT_TRANSLATE_NOOP("Problem", "There is no microphone."),
          QT_TRANSLATE_NOOP("Problem", "Connect one, and allow the program to use it.")},
    Entry{"no-sound-card", QT_TRANSLATE_NOOP("Problem", "There is no sound card. Everything but the sound goes on."),
          QT_TRANSLATE_NOOP("Problem", "Connect one and check the settings of the desktop.")},
    Entry{"not-a-wav", QT_TRANSLATE_NOOP("Problem", "This is no WAV file that can be read."),
          QT_TRANSLATE_NOOP("Problem", "Save the sound as WAV with one or two channels, PCM of 16 or 24 bits.")},
    Entry{"sound-unfit", QT_TRANSLATE_NOOP("Problem", "The rate of this recording cannot be used."),
          QT_TRANSLATE_NOOP("Problem", "Record with 48,000 samples a second.")},
    Entry{"sound-too-long", QT_TRANSLATE_NOOP("Problem", "The recording is too long."),
          QT_TRANSLATE_NOOP("Problem", "Cut out up to a minute in which the handpiece runs evenly.")},
    Entry{"sound-too-short", QT_TRANSLATE_NOOP("Problem", "The recording is too short."),
          QT_TRANSLATE_NOOP("Problem", "A tenth of a second is the least.")},
    Entry{"sound-silent", QT_TRANSLATE_NOOP("Problem", "The recording is silent."),
          QT_TRANSLATE_NOOP("Problem", "Check the microphone and its level.")},
    Entry{
        "no-opengl", QT_TRANSLATE_NOOP("Problem", "There is no OpenGL 3.3 to draw with."),
        QT_TRANSLATE_NOOP("Problem", "Install libegl-mesa0 and libgl1-mesa-dri. Everything but the picture goes on.")},
    Entry{"opengl-failed", QT_TRANSLATE_NOOP("Problem", "The graphics card has no memory left."),
          QT_TRANSLATE_NOOP("Problem", "Choose a lower picture quality or a smaller window.")},
    // Scans.
    Entry{"no-scan", QT_TRANSLATE_NOOP("Problem", "There is no scan in it. What was found: %1."),
          QT_TRANSLATE_NOOP("Problem",
                            "Choose a folder, ZIP or file with slices (DICOM, TIFF, PNG, JPEG, BMP), NRRD, "
                            "NIfTI, MetaImage, or raw numbers with a scan.toml.")},
    Entry{"no-spacing", QT_TRANSLATE_NOOP("Problem", "The scan does not tell how large its voxels are."),
          QT_TRANSLATE_NOOP("Problem", "Type the size of a voxel: the scanner's record has it.")},
    Entry{"scan-too-large",
          QT_TRANSLATE_NOOP("Problem", "It is larger than a scan of a tooth can be, or its header is damaged."),
          QT_TRANSLATE_NOOP("Problem", "Crop the scan around the tooth, or take another copy of it.")},
    Entry{"scan-empty", QT_TRANSLATE_NOOP("Problem", "No tooth was found in the scan. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Choose the series that shows the tooth, or set the thresholds by hand.")},
    Entry{"labels-empty", QT_TRANSLATE_NOOP("Problem", "None of the labels is of a tooth."),
          QT_TRANSLATE_NOOP(
              "Problem", "Tell what the file's numbers mean: 1 caries, 2 enamel, 3 dentine, 4 pulp, 5 restoration.")},
    Entry{"tooth-cut-off", QT_TRANSLATE_NOOP("Problem", "The tooth is cut off by the border of the scan."),
          QT_TRANSLATE_NOOP("Problem", "Choose another tooth, or a scan that shows all of it.")},
    Entry{"no-tooth-there", QT_TRANSLATE_NOOP("Problem", "There is no tooth at the place that was pointed at."),
          QT_TRANSLATE_NOOP("Problem", "Point at the crown or a root of a tooth.")},
    Entry{"scan-too-coarse",
          QT_TRANSLATE_NOOP("Problem", "The scan is too coarse: voxels of %1 mm cannot show enamel and pulp."),
          QT_TRANSLATE_NOOP("Problem", "Use a scan of %2 mm or finer.")},
    Entry{"scan-report-missing", QT_TRANSLATE_NOOP("Problem", "The case is saved, but its report is not. %1"),
          QT_TRANSLATE_NOOP("Problem", "Save the case again, or in another folder.")},
    Entry{"no-browser", QT_TRANSLATE_NOOP("Problem", "There is no program that shows this page."),
          QT_TRANSLATE_NOOP("Problem", "Open the file with a web browser.")},
    // Devices: what they say when they are opened, then what befalls them at work (link::Trouble).
    Entry{"library-missing", QT_TRANSLATE_NOOP("Problem", "The software of the device's maker was not found: %1."),
          QT_TRANSLATE_NOOP("Problem", "Install the maker's driver and library, then choose the device again.")},
    Entry{"library-wrong", QT_TRANSLATE_NOOP("Problem", "The maker's library is of another version: %1 has no %2."),
          QT_TRANSLATE_NOOP("Problem", "Install the version that docs/devices.md names.")},
    Entry{"two-libraries", QT_TRANSLATE_NOOP("Problem", "Two libraries want the same device: %1 and %2."),
          QT_TRANSLATE_NOOP("Problem", "Name the one that is meant in HANDPIECE_HD_LIBRARY and start again.")},
    Entry{"no-such-device", QT_TRANSLATE_NOOP("Problem", "There is no device called %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose one in the menu Device.")},
    Entry{"device-missing", QT_TRANSLATE_NOOP("Problem", "The device is not there: %1."),
          QT_TRANSLATE_NOOP("Problem", "Check its cable and power, then connect it again.")},
    Entry{"device-busy", QT_TRANSLATE_NOOP("Problem", "The device is in use already: %1."),
          QT_TRANSLATE_NOOP("Problem", "Close the other program that uses it.")},
    Entry{"device-permission", QT_TRANSLATE_NOOP("Problem", "This account may not use the device: %1."),
          QT_TRANSLATE_NOOP("Problem", "Install the udev rules (docs/devices.md), then plug it in again.")},
    Entry{"device-error", QT_TRANSLATE_NOOP("Problem", "%1 reports an error: %2"),
          QT_TRANSLATE_NOOP("Problem", "Switch the device off and on, then choose it again.")},
    Entry{"no-licence", QT_TRANSLATE_NOOP("Problem", "The maker's library asks for a licence: %1."),
          QT_TRANSLATE_NOOP("Problem", "Install the licence with the maker's program, then choose the device again.")},
    Entry{"device-deaf", QT_TRANSLATE_NOOP("Problem", "The maker's library does not answer."),
          QT_TRANSLATE_NOOP("Problem", "Switch the device off and on and start Handpiece again.")},
    Entry{"haply-silent", QT_TRANSLATE_NOOP("Problem", "The Haply service at %1 does not answer."),
          QT_TRANSLATE_NOOP("Problem", "Start Haply Hub, then choose the device again.")},
    Entry{"websocket-refused", QT_TRANSLATE_NOOP("Problem", "The device's service is not running at %1: %2."),
          QT_TRANSLATE_NOOP("Problem", "Start it (Haply Hub), then choose the device again.")},
    Entry{"haply-garbage", QT_TRANSLATE_NOOP("Problem", "The service at %1 sends what cannot be read."),
          QT_TRANSLATE_NOOP("Problem", "Update Haply Hub.")},
    Entry{"spnav-missing", QT_TRANSLATE_NOOP("Problem", "The service of the SpaceMouse is not running: %1."),
          QT_TRANSLATE_NOOP("Problem", "Install and start spacenavd, then choose the device again.")},
    Entry{"profile-of-another-device",
          QT_TRANSLATE_NOOP("Problem", "The device's settings are those of another device: %1."),
          QT_TRANSLATE_NOOP("Problem", "Take the file away, then set the device up.")},
    Entry{"bad-faults", QT_TRANSLATE_NOOP("Problem", "The faults to inject cannot be read: %1 (character %2)."),
          QT_TRANSLATE_NOOP("Problem", "Write for instance unplug@2.5, stall@3:0.2.")},
    Entry{"bad-placing", QT_TRANSLATE_NOOP("Problem", "The placing of the device cannot be used: %1."),
          QT_TRANSLATE_NOOP("Problem", "Set the device up again: Device, Set up...")},
    Entry{"device-started", QT_TRANSLATE_NOOP("Problem", "The device runs already."),
          QT_TRANSLATE_NOOP("Problem", "Choose it again in the menu Device.")},
    Entry{"firmware-missing",
          QT_TRANSLATE_NOOP("Problem",
                            "The firmware of the Falcon %1 is not loaded, and Handpiece may not bring it along."),
          QT_TRANSLATE_NOOP("Problem",
                            "Install the Force Dimension SDK, or name the maker's file in HANDPIECE_FALCON_FIRMWARE.")},
    Entry{"firmware-wrong", QT_TRANSLATE_NOOP("Problem", "The Falcon %1 does not take its firmware."),
          QT_TRANSLATE_NOOP("Problem", "Switch it off and on; check HANDPIECE_FALCON_FIRMWARE.")},
    Entry{"gate-setting", QT_TRANSLATE_NOOP("Problem", "The device's record has a value that cannot be: %1 of %2."),
          QT_TRANSLATE_NOOP("Problem", "Take the device's settings away, then set it up again.")},
    Entry{"haply-basis", QT_TRANSLATE_NOOP("Problem", "Haply's service is set to turn or scale the arm's movements."),
          QT_TRANSLATE_NOOP("Problem", "Set basis, mount and workspace back in Haply Hub.")},
    Entry{"websocket-beyond", QT_TRANSLATE_NOOP("Problem", "Haply's service at %1 is not on this machine."),
          QT_TRANSLATE_NOOP("Problem", "Set HANDPIECE_HAPLY_REMOTE=1 if forces may cross the network.")},
    Entry{"input-pushes", QT_TRANSLATE_NOOP("Problem", "A device that pushes was to be used as an input."),
          QT_TRANSLATE_NOOP("Problem", "Choose it again in the menu Device.")},
    Entry{"no-reading", QT_TRANSLATE_NOOP("Problem", "The device %1 does not tell where it is."),
          QT_TRANSLATE_NOOP("Problem", "Switch it off and on, and close other programs that use it.")},
    Entry{"not-started", QT_TRANSLATE_NOOP("Problem", "The device %1 cannot be calibrated before it is connected."),
          QT_TRANSLATE_NOOP("Problem", "Connect it first.")},
    Entry{"pedal-settings", QT_TRANSLATE_NOOP("Problem", "The pedal's settings cannot be used."),
          QT_TRANSLATE_NOOP("Problem", "Give an axis from 0 and a dead travel of 0 to 0.4.")},
    Entry{"scale-at-start",
          QT_TRANSLATE_NOOP("Problem", "A scale of %1 is finer than the one the device was opened with, %2."),
          QT_TRANSLATE_NOOP("Problem", "Connect the device again with that scale.")},
    Entry{"sdl-start", QT_TRANSLATE_NOOP("Problem", "SDL, which reads gamepads and pedals, does not start: %1."),
          QT_TRANSLATE_NOOP("Problem", "Install libsdl2-2.0-0 again.")},
    Entry{"servo-rate", QT_TRANSLATE_NOOP("Problem", "The device cannot run at %1 Hz."),
          QT_TRANSLATE_NOOP("Problem", "Ask for 50 to 8000 Hz.")},
    Entry{"spnav-forbidden", QT_TRANSLATE_NOOP("Problem", "This account may not use the SpaceMouse's service: %1."),
          QT_TRANSLATE_NOOP("Problem", "Allow it to use spacenavd's socket.")},
    Entry{"websocket-address", QT_TRANSLATE_NOOP("Problem", "This is no address of a service: %1."),
          QT_TRANSLATE_NOOP("Problem", "Write it as ws://localhost:10001.")},
    Entry{"websocket-silent", QT_TRANSLATE_NOOP("Problem", "The service at %1 does not answer."),
          QT_TRANSLATE_NOOP("Problem", "Start the device's service again.")},
    Entry{"websocket-wrong", QT_TRANSLATE_NOOP("Problem", "Another program answers at %1, not the device's service."),
          QT_TRANSLATE_NOOP("Problem", "Check which port the service uses.")},
    Entry{"device-starting", QT_TRANSLATE_NOOP("Problem", "The device has not told where it is yet."),
          QT_TRANSLATE_NOOP("Problem", "Check its cable and power; some must be calibrated first.")},
    Entry{"device-unplugged", QT_TRANSLATE_NOOP("Problem", "The device is gone."),
          QT_TRANSLATE_NOOP("Problem", "Check its cable and power.")},
    Entry{"device-vendor-error", QT_TRANSLATE_NOOP("Problem", "The device's own software reports an error (%1)."),
          QT_TRANSLATE_NOOP("Problem", "Switch the device off and on.")},
    Entry{"device-bad-data", QT_TRANSLATE_NOOP("Problem", "The device sends what cannot be read."),
          QT_TRANSLATE_NOOP("Problem", "Start its service again, or update it.")},
    Entry{"device-stalled", QT_TRANSLATE_NOOP("Problem", "The device has stopped telling where it is."),
          QT_TRANSLATE_NOOP("Problem", "Check its cable; close other programs that use it.")},
    Entry{"device-tick-stalled", QT_TRANSLATE_NOOP("Problem", "The simulation stood still."),
          QT_TRANSLATE_NOOP("Problem", "Close other programs; the force comes back by itself.")},
    Entry{"device-not-finite", QT_TRANSLATE_NOOP("Problem", "The device told a place that is no number."),
          QT_TRANSLATE_NOOP("Problem", "Lift the bur off the tooth; calibrate the device.")},
    Entry{"device-jumped", QT_TRANSLATE_NOOP("Problem", "The stylus jumped farther than a hand can move."),
          QT_TRANSLATE_NOOP("Problem", "Lift the bur off the tooth; calibrate the device.")},
    Entry{"device-not-calibrated", QT_TRANSLATE_NOOP("Problem", "The device is not calibrated."),
          QT_TRANSLATE_NOOP("Problem", "Calibrate it: Device, Set up...")},
    Entry{"device-hot", QT_TRANSLATE_NOOP("Problem", "The device's motors are too warm."),
          QT_TRANSLATE_NOOP("Problem", "Let it rest for some minutes.")},
    Entry{"device-input-lost", QT_TRANSLATE_NOOP("Problem", "Nobody holds the stylus."),
          QT_TRANSLATE_NOOP("Problem", "Take it in the hand.")},
    Entry{"device-stopped", QT_TRANSLATE_NOOP("Problem", "The device was stopped."),
          QT_TRANSLATE_NOOP("Problem", "Choose it again in the menu Device.")},
    // The window's own.
    Entry{"case-vanished",
          QT_TRANSLATE_NOOP("Problem", "The tooth you opened is no longer at %1. Nothing that was cut is lost."),
          QT_TRANSLATE_NOOP("Problem", "Save as a .handpiece file: it takes the tooth along.")},
    Entry{"no-attempt", QT_TRANSLATE_NOOP("Problem", "There is no attempt to resume yet."),
          QT_TRANSLATE_NOOP("Problem", "Save what you cut with File, Save: the next start finds it.")},
    Entry{"hull-cannot-cut",
          QT_TRANSLATE_NOOP("Problem", "The convex hull knows the whole tooth only, and this one is cut."),
          QT_TRANSLATE_NOOP("Problem", "Reset the tooth first.")},
    Entry{"voxel-in-stroke", QT_TRANSLATE_NOOP("Problem", "The voxel size cannot change while the bur is at work."),
          QT_TRANSLATE_NOOP("Problem", "Lift the bur first.")},
    Entry{"no-recording", QT_TRANSLATE_NOOP("Problem", "Nothing is being recorded."),
          QT_TRANSLATE_NOOP("Problem", "Open a tooth first: its recording begins by itself.")},
    Entry{"voxel-of-exercise",
          QT_TRANSLATE_NOOP("Problem",
                            "This exercise is worked in voxels of %1 um: a score never hangs on one's settings."),
          QT_TRANSLATE_NOOP("Problem", "Open another tooth to choose the size.")},
    Entry{"voxel-resumed",
          QT_TRANSLATE_NOOP("Problem", "The voxel size of a tooth that was cut before this recording cannot change."),
          QT_TRANSLATE_NOOP("Problem", "Reset the tooth, or open the case anew, and choose the size before cutting.")},
    Entry{"nothing-open", QT_TRANSLATE_NOOP("Problem", "No tooth is open."),
          QT_TRANSLATE_NOOP("Problem", "Open a case or a starter tooth first.")},
    Entry{"sitting-ended", QT_TRANSLATE_NOOP("Problem", "The simulation has stopped. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Save what was cut, then open the tooth again.")},
    Entry{"unknown-file", QT_TRANSLATE_NOOP("Problem", "This kind of file cannot be opened."),
          QT_TRANSLATE_NOOP("Problem",
                            "Cases are folders, .handpiece, .stl, .ply or .obj files; sessions are .h5 files.")},
    Entry{"desk-of-another", QT_TRANSLATE_NOOP("Problem", "This is the marking desk of %1."),
          QT_TRANSLATE_NOOP("Problem", "Mark under another name.")},
    Entry{"desk-other-exercise", QT_TRANSLATE_NOOP("Problem", "This marking desk was begun for another exercise, %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose that exercise, or mark under another name.")},
    Entry{"desk-other-rubric", QT_TRANSLATE_NOOP("Problem", "This desk marks blind by another rubric, %1."),
          QT_TRANSLATE_NOOP("Problem", "Choose that rubric, or mark under another name.")},
    Entry{"desk-blind", QT_TRANSLATE_NOOP("Problem", "This desk marks blind."),
          QT_TRANSLATE_NOOP("Problem", "Tick \"Mark blind\" to go on, or mark under another name.")},
    Entry{"desk-seen", QT_TRANSLATE_NOOP("Problem", "This desk shows the machine's score."),
          QT_TRANSLATE_NOOP("Problem", "Untick \"Mark blind\" to go on, or mark under another name.")},
    Entry{"desk-elsewhere", QT_TRANSLATE_NOOP("Problem", "Somebody else marks at this desk; this change was not kept."),
          QT_TRANSLATE_NOOP("Problem", "Begin again: what stands there now is taken up.")},
    Entry{"desk-damaged", QT_TRANSLATE_NOOP("Problem", "This marking desk cannot be read. Technical detail: %1"),
          QT_TRANSLATE_NOOP("Problem", "Bring its file back from a copy, or mark under another name.")},
    Entry{"desk-newer", QT_TRANSLATE_NOOP("Problem", "This marking desk was made by a newer program."),
          QT_TRANSLATE_NOOP("Problem", "Use the newer program.")},
    Entry{"marker-name", QT_TRANSLATE_NOOP("Problem", "Nobody can mark under this name."),
          QT_TRANSLATE_NOOP("Problem", "Give a name or a code without / \\ and quotes; \"machine\" is taken.")},
    Entry{"no-work-folder", QT_TRANSLATE_NOOP("Problem", "There is no such folder."),
          QT_TRANSLATE_NOOP("Problem", "Choose the folder with the returned work.")},
    Entry{"exercise-without-rubric", QT_TRANSLATE_NOOP("Problem", "This exercise has no rubric."),
          QT_TRANSLATE_NOOP("Problem", "Choose a rubric.")},
};

QString translated(const char* text) {
    return QCoreApplication::translate("Problem", text);
}

QString filledIn(const char* text, const QStringList& arguments) {
    const QString raw = translated(text);
    QString filled;
    // In one pass: an argument may hold a %1 itself.
    for (qsizetype i = 0; i < raw.size(); ++i) {
        const int number = raw[i] == QLatin1Char('%') && i + 1 < raw.size() ? raw[i + 1].digitValue() : -1;
        if (number >= 1 && number <= arguments.size())
            filled += arguments[number - 1], ++i;
        else
            filled += raw[i];
    }
    return filled;
}

}  // namespace

Problem problemOf(const core::Error& error) {
    QStringList arguments;
    for (const std::string& argument : error.arguments())
        arguments << QString::fromStdString(argument);
    const QString where = QString::fromStdString(error.where());
    if (const QString id = QString::fromStdString(error.id()); problemIds().contains(id))
        return problemById(id, arguments, where);
    // No words of the person's language: said to be the program's.
    const auto own = [](const char* text, const std::string& said) {
        return said.empty() ? QString() : translated(text).arg(QString::fromStdString(said));
    };
    return {{},
            {},
            own(QT_TRANSLATE_NOOP("Problem", "Technical detail: %1"), error.problem()),
            where,
            own(QT_TRANSLATE_NOOP("Problem", "Technical advice: %1"), error.remedy())};
}

Problem problemById(const QString& id, const QStringList& arguments, const QString& where) {
    for (const Entry& e : kEntries)
        if (id == QLatin1String(e.id))
            return {id, arguments, filledIn(e.what, arguments), where, filledIn(e.remedy, arguments)};
    return {id, arguments, id, where, {}};
}

QStringList problemIds() {
    QStringList ids;
    for (const Entry& e : kEntries)
        ids << QString::fromLatin1(e.id);
    return ids;
}

QString toQString(const std::filesystem::path& path) {
    return QString::fromStdString(path.string());
}
std::filesystem::path toPath(const QString& text) {
    return {text.toStdString()};
}

}  // namespace handpiece::desktop
