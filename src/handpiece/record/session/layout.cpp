// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/layout.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/hash.h"

namespace handpiece::session {

std::size_t bytesOf(NumberType type) noexcept {
    switch (type) {
        case NumberType::u8:
            return 1;
        case NumberType::u16:
            return 2;
        case NumberType::u32:
        case NumberType::i32:
        case NumberType::f32:
            return 4;
        case NumberType::u64:
        case NumberType::i64:
        case NumberType::f64:
            return 8;
    }
    return 0;
}

std::span<const Column> columns() noexcept {
    using enum NumberType;
    static const Column kColumns[] = {
        {"position", i32, 3, offsetof(Record, position), "2^-20 mm",
         "tip of the bur in the tooth's frame as read from the device, x y z; -2147483648: no number"},
        {"orientation", i32, 3, offsetof(Record, orientation), "2^-30",
         "x y z of the quaternion that turns bur into tooth, as read from the device; -2147483648: no number"},
        {"orientation_w", i32, 1, offsetof(Record, orientationW), "2^-31",
         "w of that quaternion: odd where it is negative; the rest is twice what |w| exceeds the root of 2^60 - x2 - "
         "y2 "
         "- z2 by, rounded down (a few units at most); -2147483648: no number"},
        {"pedal", i32, 1, offsetof(Record, pedal), "2^-16", "0 up, 65536 down"},
        {"buttons", u32, 1, offsetof(Record, buttons), "bits", "bit 0: the upper one"},
        {"elapsed_periods", u16, 1, offsetof(Record, elapsedPeriods), "periods",
         "since the tick before: more than 1 where the machine was late"},
        {"last_command", u64, 1, offsetof(Record, lastCommand), "count",
         "number of the newest command from outside the tick that has taken effect"},
        {"velocity", f32, 3, offsetof(Record, velocityMmS), "mm/s", "of the tip, filtered, x y z"},
        {"force", f32, 3, offsetof(Record, forceN), "N", "commanded, on the hand, in the tooth's frame, x y z"},
        {"torque", f32, 3, offsetof(Record, torqueNmm), "N mm", "commanded, on the hand, about the grip, x y z"},
        {"depth", f32, 1, offsetof(Record, depthMm), "mm", "of the device's bur in the tooth; negative when apart"},
        {"rpm", f32, 1, offsetof(Record, speedRpm), "1/min", "speed of the bur"},
        {"load_torque", f32, 1, offsetof(Record, loadTorqueNmm), "N mm", "with which the tooth held the bur back"},
        {"feed", f32, 1, offsetof(Record, feedMmS), "mm/s", "at which the bur ate into the tooth"},
        {"tissue", u8, 1, offsetof(Record, tissue), "tissue",
         "that carries most of the pressure: 0 none, 1 enamel, 2 dentine, 3 pulp, 4 caries, 5 cementum, 6 gum, 7 bone, "
         "8 neighbour, 9 restoration, 10 demineralised enamel, 11 to 16 carious dentine from soft over leathery (13) "
         "to "
         "firm (15) and nearly hard, 17 stained enamel, 18 calculus"},
        {"tooth", u8, 1, offsetof(Record, tooth), "tooth",
         "that this tissue is of: 0 the one worked on, else the number of one that stands around it", 3},
        {"removed", f64, cases::kTissueCount, offsetof(Record, removedMm3), "mm3",
         "of the tooth worked on, by tissue (see tissue), since it was whole"},
        {"removed_others", f64, 1, offsetof(Record, removedOthersMm3), "mm3",
         "of all teeth around it since they were whole", 3},
        {"flags", u32, 1, offsetof(Record, flags), "bits",
         "1 force limited, 2 slope limited, 4 invalid pose, 8 fault, 16 waiting for the bur to be clear, 32 cutting, "
         "64 stalled, 128 restoring, 256 out of memory for cuts, 512 shank, 1024 head or 2048 handle bears most, 4096 "
         "presses on gingiva, 8192 the bur is in it"},
        {"tick", u64, 1, offsetof(Record, tick), "count", "number of the tick; its nominal time is tick / rate_hz [s]"},
    };
    return kColumns;
}

std::uint64_t hashOf(std::span<const std::byte> bytes) noexcept {
    core::Hasher hasher;
    if (!bytes.empty()) hasher.add(bytes);  // nothing may have no address
    return hasher.value();
}

std::string_view readme() noexcept {
    return R"(A session of Handpiece, an open dental surgery simulator: what the hand did to a tooth and what it felt.

/samples     one dataset a quantity, one row a tick, from the first tick to the last. Each has the attributes
             'unit' and 'description'. Position, orientation and pedal are whole numbers of the step that 'unit'
             names: multiply to have mm. After a power cut or a kill some datasets may be a second longer than
             others: 'tick' is never the longer one, so cut all to its length.
/events      what happened at which tick: 'tick', 'part', 'name', 'text'. Text too long for a row goes on in the next
             rows, with part 1, 2, ... and the same tick and name.
/key_frames  the cut tooth at some ticks, for the program to open the session anywhere: 'index' has tick, offset,
             bytes and hash of each, 'data' the bytes.
/closed      1 once the recorder has closed the file; 0 after a kill or a full disk.
/tooth       the tooth it is cut from, as bytes for the program.
/history     only of a tooth that was cut before: strokes that could be undone at the beginning, for the program.
/scenery     what stands around it, where there is something, for the program.
/settings    JSON: bur, parameters, all that a replay needs.

Attributes of the file: format, format_version, handpiece_version, engine_revision, hdf5_version, rate_hz, and code, which the student
typed. There is no name of a person or a machine in it.

Python:  f = h5py.File('session.h5', 'r'); n = len(f['samples/tick']); t = f['samples/tick'][:] / f.attrs['rate_hz']
         x = f['samples/position'][:n] * 2.0**-20; force = f['samples/force'][:n]; events = f['events'][:]

Units: millimetre, newton, second; tooth's frame: +z out of the crown, +x mesial. docs/session-format.md of the program
has the details.
)";
}

std::size_t chunkRows(double rateHz) noexcept {
    return static_cast<std::size_t>(std::clamp(std::round(0.7 * rateHz), 16.0, 65536.0));
}

}  // namespace handpiece::session
