// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/read_notes.h"

#include <mutex>
#include <utility>

namespace handpiece::geometry {
namespace {

std::mutex mutex;

NotesListener& listening() {
    static NotesListener listener;
    return listener;
}

}  // namespace

void listenToNotes(NotesListener listener) {
    const std::lock_guard lock(mutex);
    listening() = std::move(listener);
}

void tellNotes(const std::string& where, std::span<const std::string> notes) {
    const std::lock_guard lock(mutex);
    if (!listening()) return;
    for (const std::string& note : notes)
        listening()(where, note);
}

}  // namespace handpiece::geometry
