// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/returned_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/case/attempt.h"

namespace handpiece::marking {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entriesOf(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        found.push_back(at->path());
    if (error) throw core::Error("the folder cannot be read: " + error.message(), folder.string(), "choose another");
    std::sort(found.begin(), found.end());
    return found;
}

class Finder {
  public:
    explicit Finder(const fs::path& folder) : root_(folder) {}

    void look(const fs::path& folder, bool isBelow) {
        const std::size_t before = found_.size();
        fs::path result;
        for (const fs::path& path : entriesOf(folder)) {
            const std::string name = path.filename().string();
            if (name.starts_with('.')) continue;
            std::error_code none;
            if (fs::is_directory(path, none)) {
                if (fs::exists(path / cases::kAttemptFile, none))
                    take(path, false);
                else if (!isBelow)
                    look(path, true);
            } else if (name == "result.json") {
                result = path;
            } else if (path.extension() == ".h5") {
                take(path, false);
            } else if (cases::isPackageName(path)) {
                takePackage(path);
            }
        }
        if (!result.empty() && found_.size() == before) take(result, true);
    }
    std::vector<ReturnedWork> found() { return std::move(found_); }

  private:
    void takePackage(const fs::path& path) {
        try {
            if (cases::isAttempt(path)) take(path, false);  // else a case, or the exercise itself
        } catch (const core::Error& error) {
            take(path, false);
            found_.back().problem = error.problem();
        }
    }
    void take(const fs::path& path, bool isResultOnly) {
        if (found_.size() >= kMaxWorks)
            throw core::Error(fmt::format("there are more than {} works", kMaxWorks), root_.string(),
                              "mark them in parts");
        found_.push_back({path.lexically_relative(root_).generic_string(), {}, path, isResultOnly, {}});
    }

    fs::path root_;
    std::vector<ReturnedWork> found_;
};

}  // namespace

std::vector<ReturnedWork> findWork(const fs::path& folder, const core::Progress& progress) {
    if (!core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "choose the folder with the returned work")
            .as("no-work-folder");
    Finder finder(folder);
    finder.look(folder, false);
    std::vector<ReturnedWork> works = finder.found();
    std::map<std::string, std::string> first;  // who has this content
    for (std::size_t i = 0; i < works.size(); ++i) {
        core::report(progress, static_cast<double>(i) / static_cast<double>(works.size()));
        ReturnedWork& work = works[i];
        try {
            work.id = assessment::workHash(work.path);
        } catch (const core::Error& error) {
            work.problem = error.problem();
        }
        if (!work.id.empty()) {
            const auto [at, isNew] = first.emplace(work.id, work.name);
            if (isNew) continue;
            work.problem = "another work is the same, byte for byte";
            work.twin = at->second;
        }
        // A name of its own, so that it has a row.
        core::Hasher hasher;
        hasher.add(std::string_view(work.name));
        work.id = rubric::hashText(hasher.value());
    }
    return works;
}

}  // namespace handpiece::marking
