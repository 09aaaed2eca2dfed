// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/returned_work.h"

#include <fmt/format.h>

#include <map>

#include "handpiece/app/assessment/found_work.h"
#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"

namespace handpiece::marking {
namespace fs = std::filesystem;

std::vector<ReturnedWork> findWork(const fs::path& folder, const core::Progress& progress) {
    std::vector<ReturnedWork> works;
    for (assessment::FoundWork& one : assessment::findWork(folder))
        works.push_back({one.path.lexically_relative(folder).generic_string(),
                         {},
                         one.path,
                         one.isResultOnly,
                         std::move(one.error)});
    if (works.size() > kMaxWorks)
        throw core::Error(fmt::format("there are more than {} works", kMaxWorks), folder.string(),
                          "mark them in parts");
    std::map<std::string, std::string> first;  // who has this content
    for (std::size_t i = 0; i < works.size(); ++i) {
        core::report(progress, static_cast<double>(i) / static_cast<double>(works.size()));
        ReturnedWork& work = works[i];
        try {
            work.id = assessment::workHash(work.path);
        } catch (const core::Error& error) {
            work.error = error;
        }
        if (!work.id.empty()) {
            const auto [at, isNew] = first.emplace(work.id, work.name);
            if (isNew) continue;
            work.twin = at->second;
            work.error = core::Error("another work is the same, byte for byte", work.path.string(), "ask whose it is")
                             .as("same-work");
        }
        // A name of its own, so that it has a row.
        core::Hasher hasher;
        hasher.add(std::string_view(work.name));
        work.id = rubric::hashText(hasher.value());
    }
    return works;
}

}  // namespace handpiece::marking
