// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was measured of a piece of work, kept in files, so that another rubric can judge it without cutting it again.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/app/assessment/score_work.h"

namespace handpiece::assessment {

/// What kept measures hold for, beside this engine and these measures (measures::kMeasuresRevision).
struct StoreKey {
    std::string work;      ///< hash of its files: workHash()
    std::string exercise;  ///< hash of what it was held against
};

/// As text, and back: nothing where it is of another key, engine or revision, damaged, or holds what cannot be.
[[nodiscard]] std::string encodeMeasures(const StoreKey& key, const MeasuredWork& work);
[[nodiscard]] std::optional<MeasuredWork> decodeMeasures(std::string_view text, const StoreKey& key);

/// What was measured of `from` and is not in `to`, taken into it; its own identity stays. False, and nothing done: they
/// are of different teeth.
bool takeMissing(MeasuredWork& to, const MeasuredWork& from);
/// Null: it was not measured.
[[nodiscard]] const measures::Measured* findMeasured(const MeasuredWork& in, const std::string& kind,
                                                     const measures::Selection& of);

/// One small file a piece of work, in a folder of the user's own: what somebody else wrote is not believed. Any thread.
class MeasureStore {
  public:
    /// Empty: keeps nothing.
    explicit MeasureStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// In the user's cache folder.
    [[nodiscard]] static MeasureStore usual();

    [[nodiscard]] std::optional<MeasuredWork> find(const StoreKey& key) const;
    /// In the place of what it has. A store that cannot be written is no error: it will be measured again.
    void keep(const StoreKey& key, const MeasuredWork& work) const;
    /// Beside what it has of the same tooth, proven or not as this.
    void add(const StoreKey& key, MeasuredWork work) const;

  private:
    [[nodiscard]] std::filesystem::path placeOf(const StoreKey& key) const;
    std::filesystem::path folder_;
};

/// readWork() with proof; what the store has as proven is not cut again, if it comes to the same tooth still.
[[nodiscard]] Work readProvenOnce(const std::filesystem::path& path, const tasks::Task& task, const StoreKey& key,
                                  const MeasureStore& store, const core::Progress& progress = {});

}  // namespace handpiece::assessment
