// SPDX-License-Identifier: Apache-2.0
#include "school/remote_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/content_files.h"
#include "school/line.h"

namespace handpiece::school_server {
namespace {

using school::Milliseconds;
using school_station::Line;

/// A session of a day's work has some 300 MB [R]; who sends more is no server of ours.
constexpr std::uint64_t kMostFile = 4ull << 30;
constexpr int kPatience = 5;  // leases

class RemoteWork final : public LentWork {
  public:
    RemoteWork(Line& line, Line& aside, school_wire::Work work)
        : line_(line),
          aside_(aside),
          work_(std::move(work)),
          path_(fmt::format("/api/v1/works/{}/{}", work_.number, work_.turn)) {}
    [[nodiscard]] std::int64_t turn() const override { return work_.turn; }
    [[nodiscard]] const std::string& question() const override { return work_.question; }

    [[nodiscard]] sandboxed::Files files(const core::Progress& progress) override {
        sandboxed::Files files;
        for (const school_wire::Work::File& one : work_.sessions) {
            files.sessions.push_back(folder_.path() / (one.hash + ".h5"));
            fetch(one, files.sessions.back(), progress);
        }
        files.exercise = folder_.path() / "exercise.handpiece";
        fetch(work_.exercise, files.exercise, progress);
        return files;
    }
    [[nodiscard]] bool renew() override {
        try {
            (void)aside_.post(path_ + "/renew", "{}");
            return true;
        } catch (const core::Error& e) {
            // Whether it is still lent, who is out of reach tells later.
            return e.id() == "server-silent";
        }
    }
    void enter(sandboxed::Proof proof, const core::Progress& progress) override {
        const std::string json = sandboxed::toJson(proof);
        untilHeard(progress, [&] { (void)line_.post(path_ + "/proof", json); });
    }
    void giveBack(Milliseconds pause, bool counts) override {
        try {
            (void)line_.post(fmt::format("{}/back?pause_ms={}&counts={}", path_, pause, counts ? 1 : 0), "{}");
        } catch (const core::Error&) {
            // Then another has it when its time is over.
        }
    }

  private:
    /// A server that is out of reach is asked again, for as long as it may keep the work.
    template <class Ask>
    void untilHeard(const core::Progress& progress, Ask ask) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatience * work_.leaseMs);
        for (;;) {
            try {
                return ask();
            } catch (const core::Error& e) {
                if (e.id() != "server-silent" || std::chrono::steady_clock::now() > end) throw;
            }
            core::report(progress, 0.0);
            std::this_thread::sleep_for(std::chrono::seconds(1));
        }
    }
    void fetch(const school_wire::Work::File& what, const std::filesystem::path& to, const core::Progress& progress) {
        if (core::isThere(to)) return;  // the same session twice
        const auto goesOn = [&] { return !progress || progress(0.0); };
        untilHeard(progress,
                   [&] { line_.fetch(path_ + "/files/" + what.hash, to, std::min(what.bytes, kMostFile), goesOn); });
        if (school::sha256Of(to) != what.hash)
            throw core::Error("a file came as another than the server has", what.hash,
                              "see whether the network is all right")
                .as("server-silent", {what.hash});
    }

    Line &line_, &aside_;  ///< the other, since it is asked while a file comes
    const school_wire::Work work_;
    const std::string path_;
    const core::PrivateFolder folder_;
};

class RemoteSource final : public WorkSource {
  public:
    explicit RemoteSource(const school_station::Enrolment& e) : line_(e.server, e.key), aside_(e.server, e.key) {}
    [[nodiscard]] std::unique_ptr<LentWork> take() override {
        const std::string json = line_.post(fmt::format("/api/v1/works?engine={}", core::kEngineRevision), "{}");
        if (json.empty()) return {};
        return std::make_unique<RemoteWork>(line_, aside_, school_wire::workFrom(json));
    }

  private:
    Line line_, aside_;
};

}  // namespace

std::unique_ptr<WorkSource> worksOf(const school_station::Enrolment& enrolment) {
    return std::make_unique<RemoteSource>(enrolment);
}

}  // namespace handpiece::school_server
