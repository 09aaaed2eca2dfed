// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a file held that was not taken from it, told in one place: a program says once where it goes (a line on stderr,
/// a notice), and every reading of a mesh that asked for no notes of its own tells it there.

#include <functional>
#include <span>
#include <string>

namespace handpiece::geometry {

/// `where`: the file; `note`: one plain sentence. May be called from any thread, by one at a time.
using NotesListener = std::function<void(const std::string& where, const std::string& note)>;

/// For this process, in place of the one before; an empty one: nothing is told.
void listenToNotes(NotesListener listener);
/// In the order given.
void tellNotes(const std::string& where, std::span<const std::string> notes);

}  // namespace handpiece::geometry
