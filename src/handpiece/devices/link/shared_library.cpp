// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/link/shared_library.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "handpiece/base/core/error.h"
#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace handpiece::link {
namespace {

// What differs between systems: load, name a function, say why not.
#ifdef _WIN32
// Not compiled by anybody yet.
void* load(const std::string& name) {
    return reinterpret_cast<void*>(LoadLibraryA(name.c_str()));
}
void* function(void* library, const char* name) noexcept {
    return reinterpret_cast<void*>(GetProcAddress(reinterpret_cast<HMODULE>(library), name));
}
/// Fills `isMissing` when the file is simply not there.
std::string reasonOf(const std::string& /*name*/, bool& isMissing) {
    const DWORD code = GetLastError();
    isMissing = code == ERROR_MOD_NOT_FOUND || code == ERROR_FILE_NOT_FOUND;
    return fmt::format("Windows error {}", code);
}
#else
void* load(const std::string& name) {
    return dlopen(name.c_str(), RTLD_LAZY | RTLD_GLOBAL);
}
void* function(void* library, const char* name) noexcept {
    return dlsym(library, name);
}
std::string reasonOf(const std::string& name, bool& isMissing) {
    const char* said = dlerror();
    std::string words = said ? said : "unknown reason";
    // "libPHANToMIO.so.4: cannot open ..." says that a library of its own is not there.
    isMissing = words.rfind(name, 0) == 0 && words.find("No such file") != std::string::npos;
    return words;
}
#endif

}  // namespace

SharedLibrary::SharedLibrary(std::string what, const std::vector<std::string>& names, const std::string& environment,
                             std::string remedy)
    : what_(std::move(what)), remedy_(std::move(remedy)) {
    std::vector<std::string> candidates = names;
    if (const char* path = environment.empty() ? nullptr : std::getenv(environment.c_str()); path && *path)
        candidates = {path};
    std::string reason, tried;
    for (const std::string& candidate : candidates) {
        handle_ = load(candidate);
        if (handle_) {
            name_ = std::filesystem::path(candidate).filename().string();
            return;
        }
        tried += (tried.empty() ? "" : ", ") + candidate;
        // That the last guess is not there hides why the right one was refused.
        bool isMissing = false;
        const std::string words = reasonOf(candidate, isMissing);
        if (reason.empty() || !isMissing) reason = words;
    }
    throw core::Error(fmt::format("{} is not installed or cannot be loaded ({})", what_, reason), tried, remedy_)
        .as("library-missing", {what_, tried, reason});
}

void* SharedLibrary::symbolOrNull(const char* name) const noexcept {
    return function(handle_, name);
}

void* SharedLibrary::symbol(const char* name) const {
    if (void* found = symbolOrNull(name)) return found;
    throw core::Error(fmt::format("{} has no function {}: it is of a version that is not supported", what_, name),
                      name_, remedy_)
        .as("library-wrong", {what_, name});
}

}  // namespace handpiece::link
