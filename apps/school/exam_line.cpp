// SPDX-License-Identifier: Apache-2.0
#include "school/exam_line.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/chain.h"
#include "school/exam_desk.h"

namespace handpiece::school_cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
constexpr auto kPause = std::chrono::milliseconds(1000);

class ExamLine {
  public:
    explicit ExamLine(const ExamLineSettings& settings)
        : client_(settings.socket), every_(std::chrono::duration<double>(settings.everyS)) {}

    [[noreturn]] void run() {
        std::thread([this] {
            for (;; std::this_thread::sleep_for(kPause))
                lookRound();
        }).detach();
        for (std::string line; std::getline(std::cin, line);) {
            const Json asked = Json::parse(line, nullptr, false);
            const std::string kind = asked.is_object() ? asked.value("kind", "") : "";
            try {
                if (!asked.is_object()) throw core::Error("this is no line of a window's", "standard input");
                answer(kind, asked);
            } catch (const std::exception& e) {
                tellProblem(kind, core::asError(e));
            }
        }
        // The window is gone; what is on its way may be cut off anywhere.
        std::_Exit(0);
    }

  private:
    void tell(Json said) {
        const std::string line = said.dump(-1, ' ', false, Json::error_handler_t::replace);
        const std::lock_guard lock(telling_);
        fmt::print("{}\n", line);
        (void)std::fflush(stdout);
    }
    void tellProblem(const std::string& of, const core::Error& e) {
        tell({{"kind", "problem"},
              {"of", of},
              {"id", e.id()},
              {"arguments", e.arguments()},
              {"problem", e.problem()},
              {"where", e.where()},
              {"remedy", e.remedy()}});
    }
    static Json deskJson(const char* kind, const school_exam::Desk& d) {
        return {{"kind", kind},
                {"sitting", d.sitting},
                {"title", d.title},
                {"now_ms", d.now},
                {"began_ms", d.began},
                {"deadline_ms", d.deadline},
                {"extra_percent", d.extraPercent},
                {"pause_minutes", d.pauseMinutes},
                {"locked", d.locked},
                {"again", d.again},
                {"trouble", d.trouble}};
    }

    void answer(const std::string& kind, const Json& asked) {
        const auto text = [&](const char* key) { return asked.value(key, ""); };
        if (kind == "look") {
            if (const std::string opening = text("opening"); !opening.empty()) client_.open(opening);
            Json exam = Json::parse(client_.look(text("candidate")));
            exam["kind"] = "exam";
            tell(std::move(exam));
        } else if (kind == "begin") {
            tell(deskJson("begun", client_.begin(text("candidate"), text("invigilator"), text("pin"))));
        } else if (kind == "exercise") {
            const std::filesystem::path file = text("file");
            core::prepareOutputFolder(file.parent_path(), true);
            client_.keepExercise(file);
            tell({{"kind", "exercise"}, {"file", file.string()}});
        } else if (kind == "watch") {
            const std::lock_guard lock(watching_);
            sitting_ = text("sitting");
            parts_.clear();
            for (const std::string& file : asked.value("recordings", std::vector<std::string>()))
                parts_.push_back({file, proving::RecordedInputs(file)});
            said_ = {};
        } else if (kind == "finish") {
            std::vector<std::filesystem::path> recordings;
            for (const std::string& file : asked.value("recordings", std::vector<std::string>()))
                recordings.emplace_back(file);
            const std::string sitting = text("sitting");
            const std::string entry = client_.finish(sitting, recordings);
            {
                const std::lock_guard lock(watching_);
                parts_.clear();
            }
            tellEnding(sitting, entry);
        } else if (kind == "ending") {
            const std::string sitting = text("sitting");
            tellEnding(sitting, client_.ending(sitting));
        } else {
            throw core::Error("this is no line of a window's", "standard input", "let the window start it");
        }
    }
    void tellEnding(const std::string& sitting, const std::string& joined) {
        const exam::Entry e = exam::entryFrom(exam::parted(joined, "the station's exams").text, "the station's exams");
        std::vector<std::string> files;
        for (const exam::HandedOver& one : e.files)
            files.push_back(one.file);
        tell({{"kind", "ended"},
              {"sitting", sitting},
              {"how", e.kind},
              {"at_ms", e.at},
              {"files", files},
              {"entry", joined},
              {"receipt", client_.receipt(sitting)}});
    }

    /// How it stands, and how far the work is.
    void lookRound() {
        try {
            const school_exam::Desk desk = client_.desk();
            tell(deskJson("desk", desk));
            const std::lock_guard lock(watching_);
            if (desk.sitting.empty() || desk.sitting != sitting_ || Clock::now() - said_ < every_) return;
            said_ = Clock::now();
            for (std::size_t i = 0; i < parts_.size(); ++i) {
                Part& part = parts_[i];
                if (!core::isThere(part.file)) continue;
                part.inputs.goOn();
                if (part.inputs.ticks() == part.told) continue;
                client_.checkpoint(sitting_, static_cast<std::int64_t>(i + 1), part.inputs.ticks(), part.inputs.hash());
                part.told = part.inputs.ticks();
            }
        } catch (const std::exception& e) {
            tellProblem("desk", core::asError(e));
        }
    }

    struct Part {
        std::filesystem::path file;
        proving::RecordedInputs inputs;
        std::int64_t told = 0;
    };
    const school_exam::ExamClient client_;
    const std::chrono::duration<double> every_;
    std::mutex telling_, watching_;
    std::string sitting_;      ///< guarded by `watching_`, as what follows
    std::vector<Part> parts_;  ///< in the order of the work
    Clock::time_point said_{};
};

}  // namespace

void runExamLine(const ExamLineSettings& settings) {
    ExamLine(settings).run();
}

}  // namespace handpiece::school_cli
