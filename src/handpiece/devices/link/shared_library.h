// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A vendor's library, loaded when it is asked for: none is needed to build or to start.

#include <string>
#include <vector>

namespace handpiece::link {

/// Functions of a library by name. The library stays loaded until the program ends: some vendors' drivers fail when
/// they are loaded a second time.
class SharedLibrary {
  public:
    /// The first of `names` that can be loaded. `environment` (may be empty) names a variable whose value, when set, is
    /// the only path tried. Throws core::Error ("library-missing") that names what was looked for, the loader's reason
    /// (wrong architecture, a missing library of its own) and `remedy`.
    SharedLibrary(std::string what, const std::vector<std::string>& names, const std::string& environment,
                  std::string remedy);

    /// Throws core::Error ("library-wrong") naming the function when it is not there: a wrong version.
    template <class Function>
    void require(Function*& function, const char* name) const {
        function = reinterpret_cast<Function*>(symbol(name));
    }
    /// Null when it is not there.
    template <class Function>
    void find(Function*& function, const char* name) const noexcept {
        function = reinterpret_cast<Function*>(symbolOrNull(name));
    }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }  ///< that was loaded, without its folder

  private:
    [[nodiscard]] void* symbol(const char* name) const;
    [[nodiscard]] void* symbolOrNull(const char* name) const noexcept;
    std::string what_, name_, remedy_;
    void* handle_ = nullptr;
};

}  // namespace handpiece::link
