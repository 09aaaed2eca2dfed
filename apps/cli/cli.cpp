// SPDX-License-Identifier: Apache-2.0
#include "cli/cli.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/commands.h"
#include "handpiece/base/core/error.h"

namespace handpiece::cli {

int run(int argc, const char* const* argv, const MethodRegistry& /*extraMethods*/) {
    CLI::App app{"Handpiece: an open dental surgery simulator"};
    app.require_subcommand(1);
    try {
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    } catch (const core::Error& e) {
        std::fprintf(stderr, "handpiece: %s\n", e.what());
        return 1;
    }
}

}  // namespace handpiece::cli
