// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/link/shared_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "handpiece/base/core/error.h"

namespace handpiece::link {

SharedLibrary::SharedLibrary(std::string what, const std::vector<std::string>& names, const std::string& environment,
                             std::string remedy)
    : what_(std::move(what)), remedy_(std::move(remedy)) {
    std::vector<std::string> candidates = names;
    if (const char* path = environment.empty() ? nullptr : std::getenv(environment.c_str()); path && *path)
        candidates = {path};
    std::string reason, tried;
    for (const std::string& candidate : candidates) {
        handle_ = dlopen(candidate.c_str(), RTLD_LAZY | RTLD_GLOBAL);
        if (handle_) {
            name_ = std::filesystem::path(candidate).filename().string();
            return;
        }
        tried += (tried.empty() ? "" : ", ") + candidate;
        // "No such file" of the last guess hides why the right one was refused.
        const char* said = dlerror();
        const std::string words = said ? said : "unknown reason";
        if (reason.empty() || words.find("No such file") == std::string::npos) reason = words;
    }
    throw core::Error(fmt::format("{} is not installed or cannot be loaded ({})", what_, reason), tried, remedy_)
        .as("library-missing", {what_, tried, reason});
}

void* SharedLibrary::symbolOrNull(const char* name) const noexcept {
    return dlsym(handle_, name);
}

void* SharedLibrary::symbol(const char* name) const {
    if (void* found = symbolOrNull(name)) return found;
    throw core::Error(fmt::format("{} has no function {}: it is of a version that is not supported", what_, name),
                      name_, remedy_)
        .as("library-wrong", {what_, name});
}

}  // namespace handpiece::link
