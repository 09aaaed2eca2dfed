// SPDX-License-Identifier: Apache-2.0
#include "school/remote_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
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
constexpr std::uint64_t kMostBytes = 2ull << 30;
/// The server reads the recordings itself before it answers a proof. Nothing else is waited for so long.
constexpr std::chrono::minutes kProofPatience{10};
constexpr int kPatienceLeases = 5;  // leases

/// There as long as this is; of the user's alone.
class WorkFolder {
  public:
    explicit WorkFolder(const std::filesystem::path& in) : path_(in / school::newId()) {
        core::prepareOutputFolder(path_, true);
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
    }
    ~WorkFolder() {
        std::error_code left;  // it goes at the next start
        std::filesystem::remove_all(path_, left);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    const std::filesystem::path path_;
};

class RemoteWork final : public LentWork {
  public:
    RemoteWork(Line& line, Line& aside, Line& patient, std::filesystem::path in, school_wire::Work work)
        : line_(line),
          aside_(aside),
          patient_(patient),
          in_(std::move(in)),
          work_(std::move(work)),
          path_(fmt::format("/api/v1/works/{}/{}", work_.number, work_.turn)) {}
    [[nodiscard]] std::int64_t turn() const override { return work_.turn; }
    [[nodiscard]] const std::string& question() const override { return work_.question; }

    [[nodiscard]] sandboxed::Files files(const core::Progress& progress) override {
        std::uint64_t bytes = work_.exercise.bytes;
        for (const school_wire::Work::File& one : work_.sessions)
            bytes += std::min(one.bytes, kMostBytes);
        if (bytes > kMostBytes)
            throw core::Error("the server lends what no work has", fmt::format("{} MB", bytes >> 20),
                              "ask whether this is its address")
                .as("server-nonsense", {"200"});
        const std::filesystem::path folder = folder_.emplace(in_).path();
        sandboxed::Files files;
        for (const school_wire::Work::File& one : work_.sessions) {
            files.sessions.push_back(folder / (one.hash + ".h5"));
            fetch(one, files.sessions.back(), progress);
        }
        files.exercise = folder / "exercise.handpiece";
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
        untilHeard(progress, [&] { (void)patient_.post(path_ + "/proof", json); });
        std::printf("work %lld: %s\n", static_cast<long long>(work_.number), proof.score.state.c_str());
        (void)std::fflush(stdout);
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
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatienceLeases * work_.leaseMs);
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
        untilHeard(progress, [&] { line_.fetch(path_ + "/files/" + what.hash, to, what.bytes, goesOn); });
        if (school::sha256Of(to) != what.hash)
            throw core::Error("a file came as another than the server has", what.hash,
                              "see whether the network is all right")
                .as("server-silent", {what.hash});
    }

    Line &line_, &aside_, &patient_;  ///< one is asked while a file comes, one for a proof
    const std::filesystem::path in_;
    const school_wire::Work work_;
    const std::string path_;
    std::optional<WorkFolder> folder_;
};

class RemoteSource final : public WorkSource {
  public:
    RemoteSource(const school_station::Enrolment& e, std::filesystem::path folder)
        : folder_(std::move(folder)),
          line_(e.server, e.key),
          aside_(e.server, e.key),
          patient_(e.server, e.key, kProofPatience) {}
    [[nodiscard]] std::unique_ptr<LentWork> take() override {
        const std::string json = line_.post(fmt::format("/api/v1/works?engine={}", core::kEngineRevision), "{}");
        if (json.empty()) return {};
        return std::make_unique<RemoteWork>(line_, aside_, patient_, folder_, school_wire::workFrom(json));
    }

  private:
    const std::filesystem::path folder_;
    Line line_, aside_, patient_;
};

}  // namespace

std::unique_ptr<WorkSource> worksOf(const school_station::Enrolment& enrolment, const std::filesystem::path& folder) {
    return std::make_unique<RemoteSource>(enrolment, folder);
}

}  // namespace handpiece::school_server
