// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/exercise/school_defaults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <string_view>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"

namespace handpiece::exercise {
namespace {

namespace fs = std::filesystem;
using config::Table;

/// Runs read(); what it throws becomes one sentence, and what it would have read stays unset.
template <class Read>
void each(SchoolDefaults& defaults, Read&& read) {
    try {
        read();
    } catch (const std::exception& e) {
        defaults.problems.emplace_back(e.what());
    }
}

/// One table of the file, or nothing.
class Section {
  public:
    Section(const Table& file, std::string_view name, SchoolDefaults& defaults) : defaults_(defaults) {
        each(defaults, [&] { table_ = file.table(name); });
    }
    void allowOnly(std::initializer_list<std::string_view> known) {
        if (table_) each(defaults_, [&] { table_->allowOnly(known); });
    }
    void flag(std::string_view key, std::optional<bool>& value) {
        if (table_) each(defaults_, [&] { value = table_->flag(key); });
    }
    void number(std::string_view key, double least, double most, std::optional<double>& value) {
        if (!table_) return;
        each(defaults_, [&] {
            const std::optional<double> found = table_->number(key);
            if (found && !(*found >= least && *found <= most)) {
                table_->fail(fmt::format("{} = {} is out of range", key, *found),
                             fmt::format("give {} to {}", least, most), key);
            }
            value = found;
        });
    }
    void text(std::string_view key, std::initializer_list<std::string_view> known, std::optional<std::string>& value) {
        if (!table_) return;
        each(defaults_, [&] {
            const std::optional<std::string> found = table_->text(key);
            if (found && known.size() > 0 && std::find(known.begin(), known.end(), *found) == known.end()) {
                table_->fail(fmt::format("there is no {} \"{}\"", key, *found),
                             fmt::format("choose one of {}", fmt::join(known, ", ")), key);
            }
            if (found && found->empty()) table_->fail(fmt::format("{} is empty", key), "give a name", key);
            value = found;
        });
    }
    void folder(std::string_view key, std::optional<fs::path>& value) {
        if (!table_) return;
        each(defaults_, [&] {
            const std::optional<std::string> found = table_->text(key);
            if (!found) return;
            fs::path path = *found;
            if (found->rfind("~/", 0) == 0) {
                const char* home = std::getenv("HOME");
                if (home == nullptr || *home == '\0') table_->fail("~ stands for no folder here", "set HOME", key);
                path = fs::path(home) / found->substr(2);
            }
            if (!path.is_absolute()) {
                table_->fail(fmt::format("{} = \"{}\" is not a whole path", key, *found),
                             "let it begin with / or with ~/", key);
            }
            value = path;
        });
    }
    /// For a rule beyond a range.
    void check(std::string_view key, bool good, const std::string& problem, const std::string& remedy) {
        if (table_ && !good) each(defaults_, [&] { table_->fail(problem, remedy, key); });
    }

  private:
    SchoolDefaults& defaults_;
    std::optional<Table> table_;
};

void read(const Table& file, SchoolDefaults& d) {
    each(d, [&] { file.allowOnly({"window", "hand", "tooth", "measure", "folders", "sessions", "sound"}); });
    Section window(file, "window", d);
    window.allowOnly({"language", "layout"});
    window.text("language", {"en", "ja"}, d.language);
    window.text("layout", {"practice", "laboratory", "paper"}, d.layout);
    Section hand(file, "hand", d);
    hand.allowOnly({"device", "left_handed", "scale", "crisp"});
    hand.text("device", {}, d.device);
    hand.flag("left_handed", d.leftHanded);
    hand.number("scale", 1.0, 3.0, d.scale);
    if (d.scale && *d.scale != 1.0 && *d.scale != 2.0 && *d.scale != 3.0) {
        hand.check("scale", false, fmt::format("scale = {} is none of the three", *d.scale), "give 1, 2 or 3");
        d.scale.reset();
    }
    hand.flag("crisp", d.crisp);
    Section tooth(file, "tooth", d);
    tooth.allowOnly({"voxel_um"});
    tooth.number("voxel_um", 20.0, 400.0, d.voxelUm);
    Section measure(file, "measure", d);
    measure.allowOnly({"pulp_good_mm", "pulp_least_mm"});
    measure.number("pulp_good_mm", 0.0, 5.0, d.pulpGoodMm);
    measure.number("pulp_least_mm", 0.0, 5.0, d.pulpLeastMm);
    if (d.pulpGoodMm && d.pulpLeastMm && *d.pulpLeastMm > *d.pulpGoodMm) {
        measure.check("pulp_least_mm", false,
                      fmt::format("pulp_least_mm = {} is more than pulp_good_mm", *d.pulpLeastMm),
                      "give the smaller thickness here");
        d.pulpGoodMm.reset();
        d.pulpLeastMm.reset();
    }
    Section folders(file, "folders", d);
    folders.allowOnly({"sessions", "cases"});
    folders.folder("sessions", d.sessionsFolder);
    folders.folder("cases", d.casesFolder);
    Section sessions(file, "sessions", d);
    sessions.allowOnly({"record"});
    sessions.flag("record", d.record);
    Section sound(file, "sound", d);
    sound.allowOnly({"on", "volume"});
    sound.flag("on", d.sound);
    sound.number("volume", 0.0, 1.0, d.volume);
}

}  // namespace

SchoolDefaults readSchoolDefaults(const fs::path& file) {
    SchoolDefaults defaults;
    std::error_code none;
    if (file.empty() || !fs::exists(file, none)) return defaults;
    each(defaults, [&] {
        const Table table = Table::read(file);
        defaults.file = file;
        read(table, defaults);
    });
    return defaults;
}

SchoolDefaults schoolDefaults() {
    const char* named = std::getenv("HANDPIECE_SCHOOL_SETTINGS");
    return readSchoolDefaults(named != nullptr ? fs::path(named) : fs::path("/etc/handpiece/settings.toml"));
}

}  // namespace handpiece::exercise
