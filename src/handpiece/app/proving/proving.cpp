// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/proving/proving.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"

namespace handpiece::proving {
namespace {

/// Two scores are the same when one cannot tell them apart as they are written.
constexpr double kSamePoints = 1e-6;

class Case {
  public:
    Case(const school::PushedAttempt& attempt, std::span<const std::filesystem::path> sessions, const tasks::Task& task,
         const rubric::Rubric& rubric)
        : attempt_(attempt.attempt), sessions_(sessions), task_(task), rubric_(rubric) {
        score_.attempt = attempt_.id;
        score_.rubric = rubric::hashText(rubric::hashOf(rubric));
        score_.engine = core::kEngineRevision;
    }

    school::Score heard(const core::Progress& progress) {
        if (sessions_.empty()) return refused("it came without a session");
        if (attempt_.exerciseHash != rubric::hashText(tasks::contentHash(task_)))
            return refused(fmt::format("it was done on exercise {}, and the assignment's is {}", attempt_.exerciseHash,
                                       rubric::hashText(tasks::contentHash(task_))));
        if (const std::string other = otherThanNamed(); !other.empty()) return refused(other);
        std::string felt;  // by which device, as the recording has it
        try {
            std::vector<std::string> conditions;
            std::vector<assessment::ChainLink> chain;
            for (std::size_t i = 0; i < sessions_.size(); ++i) {
                const std::string name = fmt::format("session {}", i + 1);
                chain.push_back({name, sessions_[i], false});
                for (const std::string& one : otherConditions(sessions_[i], task_))
                    conditions.push_back(sessions_.size() > 1 ? fmt::format("{}: {}", name, one) : one);
            }
            if (!conditions.empty()) return refused(fmt::format("{}", fmt::join(conditions, "; ")));
            const assessment::Work work = assessment::readChain(chain, task_, true, core::part(progress, 0.0, 0.9));
            const assessment::Result result =
                assessment::scoreWork(work, task_, rubric_, core::part(progress, 0.9, 1.0));
            take(result);
            felt = result.assessment.context.device;
            if (!work.isProven) return refused(work.proof);
        } catch (const core::Error& e) {
            if (e.problem() == "cancelled") throw;
            return refused(e.problem());  // where it lies here is nobody's business
        }
        score_.state = "proven";
        score_.reason = saidOtherwise();
        if (!attempt_.device.empty() && attempt_.device != felt)
            score_.reason += fmt::format("{}its station said that it was felt by {}, and its recording says {}",
                                         score_.reason.empty() ? "" : "; ", attempt_.device, felt);
        return std::move(score_);
    }

  private:
    school::Score refused(std::string why) {
        score_.state = "refused";
        score_.passed = "teacher";  // whatever it would be worth
        score_.reason = std::move(why);
        return std::move(score_);
    }
    std::string otherThanNamed() const {
        if (attempt_.sessionHashes.size() != sessions_.size())
            return fmt::format("it names {} sessions, and {} came", attempt_.sessionHashes.size(), sessions_.size());
        for (std::size_t i = 0; i < sessions_.size(); ++i)
            if (assessment::workHash(sessions_[i]) != attempt_.sessionHashes[i])
                return fmt::format("session {} is another than the attempt names", i + 1);
        return {};
    }
    void take(const assessment::Result& result) {
        const score::Assessment& a = result.assessment;
        score_.stateHash = result.identity.stateHash;
        score_.score = a.score, score_.maxScore = a.maxScore, score_.wholeScore = a.wholeScore;
        score_.passed = score::nameOf(a.passed);
        score_.borderline = a.borderline;
        score_.result = assessment::resultJson(a, result.identity);
    }
    /// Of the station's own score, where it was by the same rubric.
    std::string saidOtherwise() const {
        if (attempt_.rubricHash != score_.rubric) return {};
        if (std::abs(attempt_.score - score_.score) <= kSamePoints &&
            std::abs(attempt_.maxScore - score_.maxScore) <= kSamePoints && attempt_.passed == score_.passed)
            return {};
        return fmt::format("its station said {:g} of {:g}, passed: {}", attempt_.score, attempt_.maxScore,
                           attempt_.passed);
    }

    const school::Attempt& attempt_;
    std::span<const std::filesystem::path> sessions_;
    const tasks::Task& task_;
    const rubric::Rubric& rubric_;
    school::Score score_;
};

}  // namespace

school::Score prove(const school::PushedAttempt& attempt, std::span<const std::filesystem::path> sessions,
                    const tasks::Task& task, const rubric::Rubric& rubric, const core::Progress& progress) {
    rubric::requireSound(rubric);
    return Case(attempt, sessions, task, rubric).heard(progress);
}

}  // namespace handpiece::proving
