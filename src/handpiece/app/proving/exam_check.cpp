// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/proving/exam_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::proving {
namespace {

/// Stretches reach the file 0.7 s late, and a checkpoint has whole blocks only.
constexpr double kSlackS = 10.0;

void append(std::string& bytes, std::uint64_t number) {
    for (int i = 0; i < 8; ++i)
        bytes += static_cast<char>(number >> (8 * i));
}
std::string bytesOf(const session::Record& r) {
    std::string bytes;
    append(bytes, r.tick);
    for (const std::int32_t one : {r.position[0], r.position[1], r.position[2], r.orientation[0], r.orientation[1],
                                   r.orientation[2], r.orientationW, r.pedal})
        append(bytes, static_cast<std::uint32_t>(one));
    append(bytes, r.buttons), append(bytes, r.elapsedPeriods);
    return bytes;
}

class Recordings {
  public:
    Recordings(std::span<const exam::Entry> entries, std::span<const std::filesystem::path> sessions)
        : entries_(entries), sessions_(sessions) {}

    [[nodiscard]] std::vector<std::string> heard(const std::vector<std::string>& locked) && {
        for (std::size_t i = 0; i < sessions_.size(); ++i) {
            const session::SessionReader reader(sessions_[i]);
            const auto part = static_cast<std::int64_t>(i + 1);
            holdInputs(part);
            holdPace(part, reader);
            holdLocks(part, reader, locked);
        }
        for (const exam::Entry& e : entries_)
            if (e.kind == "checkpoint" && e.part > static_cast<std::int64_t>(sessions_.size()))
                tell(fmt::format("recording {} was noted during the work and not handed over", e.part));
        return std::move(told_);
    }

  private:
    void tell(std::string what) {
        if (std::find(told_.begin(), told_.end(), what) == told_.end()) told_.push_back(std::move(what));
    }
    void holdInputs(std::int64_t part) {
        std::map<std::int64_t, std::string> noted;
        for (const exam::Entry& e : entries_)
            if (e.kind == "checkpoint" && e.part == part) {
                const auto [at, isNew] = noted.emplace(e.ticks, e.inputs);
                if (!isNew && at->second != e.inputs) return tell(another(part, e.ticks));
            }
        RecordedInputs inputs(sessions_[static_cast<std::size_t>(part - 1)]);
        for (const auto& [ticks, hash] : noted) {
            inputs.goOn(ticks);
            if (inputs.ticks() != ticks || inputs.hash() != hash) return tell(another(part, ticks));
        }
    }
    static std::string another(std::int64_t part, std::int64_t ticks) {
        return fmt::format("recording {} is another than the one that was noted during the work (at tick {})", part,
                           ticks);
    }
    void holdPace(std::int64_t part, const session::SessionReader& reader) {
        exam::Milliseconds at = entries_.front().at;
        double done = 0.0;
        const auto step = [&](exam::Milliseconds now, double ticks) {
            const double tooFastS = (ticks - done) / reader.info().rateHz - 1e-3 * static_cast<double>(now - at);
            if (tooFastS > kSlackS)
                tell(fmt::format("recording {} ran {:.0f} s faster than the time", part, std::floor(tooFastS)));
            at = now, done = ticks;
        };
        for (const exam::Entry& e : entries_)
            if (e.kind == "checkpoint" && e.part == part)
                step(e.at, static_cast<double>(e.ticks));
            else if (e.kind == "finished")
                step(e.at, static_cast<double>(reader.size()));
    }
    void holdLocks(std::int64_t part, const session::SessionReader& reader, const std::vector<std::string>& locked) {
        const auto isLocked = [&](const char* help) {
            return std::find(locked.begin(), locked.end(), help) != locked.end();
        };
        std::map<std::string, std::int64_t> done;
        for (const session::Event& event : reader.events())
            if ((event.name == "undo" || event.name == "redo")
                    ? isLocked("undo")
                    : event.name == "reset" && (isLocked("undo") || isLocked("reset")))
                ++done[event.name];
        for (const auto& [name, times] : done)
            tell(fmt::format("recording {}: {} was used {} times, and it was locked", part, name, times));
    }

    std::span<const exam::Entry> entries_;
    std::span<const std::filesystem::path> sessions_;
    std::vector<std::string> told_;
};

}  // namespace

void RecordedInputs::goOn(std::int64_t most) {
    const session::SessionReader reader(session_);
    const auto there = std::min<std::int64_t>(static_cast<std::int64_t>(reader.size()), most);
    while (ticks_ + kBlock <= there) {
        std::string bytes = hash_;
        for (const session::Record& record :
             reader.records(static_cast<std::uint64_t>(ticks_), static_cast<std::size_t>(kBlock))) {
            bytes += bytesOf(record);
            const std::array<std::int32_t, 3> at{record.position[0], record.position[1], record.position[2]};
            hasMoved_ = hasMoved_ || at != first_.value_or(at);
            if (!first_) first_ = at;
        }
        hash_ = school::sha256(bytes);
        ticks_ += kBlock;
    }
}

std::vector<std::string> recordingDoubts(const std::vector<std::string>& locked, std::span<const exam::Entry> entries,
                                         std::span<const std::filesystem::path> sessions) {
    if (entries.empty()) return {};
    return Recordings(entries, sessions).heard(locked);
}

}  // namespace handpiece::proving
