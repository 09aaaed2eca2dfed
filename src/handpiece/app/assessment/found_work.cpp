// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/found_work.h"

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/package.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entriesOf(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (!at->path().filename().string().starts_with('.')) found.push_back(at->path());
    if (error) throw core::Error("the folder cannot be read: " + error.message(), folder.string(), "choose another");
    std::sort(found.begin(), found.end());
    return found;
}

void look(const fs::path& folder, bool isBelow, std::vector<FoundWork>& found) {
    const std::size_t before = found.size();
    fs::path result;
    bool hasSessions = false;
    for (const fs::path& path : entriesOf(folder)) {
        std::error_code none;
        if (fs::is_directory(path, none)) {
            if (cases::isAttempt(path))
                found.push_back({path});
            else if (!isBelow)
                look(path, true, found);
        } else if (path.filename() == "result.json") {
            result = path;
        } else if (path.extension() == ".h5") {
            hasSessions = true;
            if (!isBelow) found.push_back({path});
        } else if (cases::isPackageName(path)) {
            try {
                if (cases::isAttempt(path)) found.push_back({path});  // else a case, or the exercise itself
            } catch (const core::Error& error) {
                found.push_back({path, false, error});
            }
        }
    }
    if (isBelow && hasSessions) found.push_back({folder});
    if (!result.empty() && found.size() == before) found.push_back({result, true});
}

}  // namespace

std::vector<FoundWork> findWork(const fs::path& folder) {
    if (!core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "choose the folder with the returned work")
            .as("no-work-folder");
    std::vector<FoundWork> found;
    look(folder, false, found);
    return found;
}

}  // namespace handpiece::assessment
