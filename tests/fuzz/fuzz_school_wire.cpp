// SPDX-License-Identifier: Apache-2.0
// Any text as a message between station and server must give one that is written, read and written again as the same
// bytes, or one core::Error.
#include <cmath>

#include "fuzz_model.h"
#include "school/jpeg.h"
#include "school/wire.h"

namespace wire = handpiece::school_wire;

namespace {

template <class Read>
void twice(std::string_view text, Read read) {
    (void)handpiece::fuzz::readText(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(),
                                    [&](std::string_view one) {
                                        const std::string once = wire::toJson(read(one));
                                        const auto again = handpiece::fuzz::mustRead([&] { return read(once); });
                                        if (wire::toJson(again) != once) __builtin_trap();
                                    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    twice(text, [](std::string_view t) {
        const auto p = wire::attemptFrom(t);
        if (!std::isfinite(p.attempt.score) || p.files.size() > 1000) __builtin_trap();
        return p;
    });
    twice(text, [](std::string_view t) { return wire::judgementFrom(t); });
    twice(text, [](std::string_view t) { return wire::enrolledFrom(t); });
    twice(text, [](std::string_view t) { return wire::enrolFrom(t); });
    twice(text, [](std::string_view t) { return wire::receivedFrom(t); });
    twice(text, [](std::string_view t) { return wire::statusFrom(t); });
    twice(text, [](std::string_view t) { return wire::tasksFrom(t); });
    twice(text, [](std::string_view t) { return wire::workFrom(t); });
    twice(text, [](std::string_view t) { return wire::watchedFrom(t); });
    // What a station shows: read again it is the same, and a picture's size is one.
    (void)handpiece::fuzz::readText(data, size, [](std::string_view one) {
        const std::string once = wire::toBytes(wire::liveFrom(one));
        if (wire::toBytes(handpiece::fuzz::mustRead([&] { return wire::liveFrom(once); })) != once) __builtin_trap();
    });
    if (const auto pixels = handpiece::school_server::jpegSize(text); pixels && pixels->width < 1) __builtin_trap();
    (void)wire::errorFrom(text, 500);
    return 0;
}
