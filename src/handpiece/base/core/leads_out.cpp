// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/leads_out.h"

#include <algorithm>

namespace handpiece::core {

bool leadsOut(const std::filesystem::path& folder, const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path home = std::filesystem::weakly_canonical(folder, error);
    if (error) return false;
    const std::filesystem::path real = std::filesystem::weakly_canonical(file, error);
    return !error && std::mismatch(home.begin(), home.end(), real.begin(), real.end()).first != home.end();
}

}  // namespace handpiece::core
