// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/outside_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/taken_from.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/model/case/package.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

/// Larger than what any work comes to; in memory once, while it is copied.
constexpr std::uint64_t kMostBytes = 2ull << 30;
/// Copies that are kept, so that a file that is opened again is not copied again.
constexpr std::size_t kMostCopies = 32;
constexpr std::uint64_t kMostCopiedBytes = 1ull << 30;
/// Of one's own, the newest.
constexpr std::size_t kMostOwn = 5000;
constexpr std::size_t kDigits = 64;

/// What changes with a file's bytes, as the system tells it.
struct Stamp {
    dev_t device{};
    ino_t number{};
    off_t bytes{};
    timespec written{}, changed{};
    friend bool operator==(const Stamp& a, const Stamp& b) {
        const auto same = [](const timespec& s, const timespec& t) {
            return s.tv_sec == t.tv_sec && s.tv_nsec == t.tv_nsec;
        };
        return a.device == b.device && a.number == b.number && a.bytes == b.bytes && same(a.written, b.written) &&
               same(a.changed, b.changed);
    }
};
/// Of a plain file; none of anything else.
std::optional<Stamp> stampOf(const fs::path& file) {
    struct stat is {};
    if (stat(file.c_str(), &is) != 0 || !S_ISREG(is.st_mode)) return {};
    return Stamp{is.st_dev, is.st_ino, is.st_size, is.st_mtim, is.st_ctim};
}

bool isReadApart(const fs::path& file) {
    const std::string extension = file.extension().string();
    return extension == ".h5" || extension == ".H5" || cases::isPackageName(file);
}

bool isBelow(const fs::path& file, const fs::path& folder) {
    std::error_code error;
    if (folder.empty()) return false;
    const fs::path whole = fs::weakly_canonical(folder, error);
    if (error) return false;
    const fs::path place = fs::weakly_canonical(file.parent_path(), error);
    if (error) return false;
    return std::mismatch(whole.begin(), whole.end(), place.begin(), place.end()).first == whole.end();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

/// What was said of the copy, said of the file.
core::Error saidOf(const core::Error& e, const fs::path& copy, const fs::path& file) {
    const auto own = [&](const std::string& text) { return replaced(text, copy.string(), file.string()); };
    std::vector<std::string> arguments;
    for (const std::string& one : e.arguments())
        arguments.push_back(own(one));
    return core::Error(own(e.problem()), e.where().empty() ? file.string() : own(e.where()), own(e.remedy()))
        .as(e.id(), arguments);
}

/// It ended its reader, or would not come to an end.
bool isFatal(const core::Error& e) {
    return e.id() == "sandbox-died" || e.id() == "sandbox-slow" || e.id() == "sandbox-large";
}

}  // namespace

struct OutsideFiles::State {
    State(const Folders& folders, Reader how)
        : reader(std::move(how)),
          own{folders.sessions, folders.starters, folders.sessions.parent_path() / "exam"},
          list(folders.sessions.parent_path() / "own-files.txt") {
        try {
            if (!core::isOurs(list)) return;
            const std::vector<std::byte> bytes = core::readFile(list, 2 * kMostOwn * (kDigits + 1));
            const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            for (std::size_t at = 0; at + kDigits < text.size(); at += kDigits + 1)
                note(std::string(text.substr(at, kDigits)));
        } catch (const core::Error&) {
            known.clear(), newest.clear();  // then these are read as anybody's
        }
    }

    /// What was copied, by its whole path.
    struct Copy {
        Stamp stamp;
        fs::path place;
        std::uint64_t used = 0;
    };

    [[nodiscard]] bool isOwnPlace(const fs::path& file) const {
        return core::isOurs(file) &&
               std::any_of(own.begin(), own.end(), [&](const fs::path& o) { return isBelow(file, o); });
    }
    [[nodiscard]] bool isKnown(const fs::path& file) {
        const std::optional<Stamp> stamp = stampOf(file);
        if (!stamp) return true;  // whoever opens it says what is wrong
        const std::lock_guard lock(mutex);
        const fs::path whole = core::wholePath(file);
        const auto found = copies.find(whole);
        if (found != copies.end() && found->second.stamp == *stamp) return true;
        const auto mine = written.find(whole);
        return mine != written.end() && mine->second == *stamp;
    }

    /// Where its bytes lie.
    fs::path placeOf(const fs::path& file, const core::Progress& progress) {
        const std::optional<Stamp> stamp = stampOf(file);
        if (!stamp || isOwnPlace(file)) return file;
        const fs::path whole = core::wholePath(file);
        {
            const std::lock_guard lock(mutex);
            const auto found = copies.find(whole);
            std::error_code error;
            if (found != copies.end() && found->second.stamp == *stamp && fs::exists(found->second.place, error)) {
                found->second.used = ++uses;
                return found->second.place;
            }
        }
        std::string sum;
        fs::path copy;
        {
            const std::vector<std::byte> bytes = core::readFile(file, kMostBytes);
            sum = prepared::sha256Of(bytes);
            requireNotFatal(sum);
            copy = copyFolder() / sum.substr(0, 32) / file.filename();
            core::prepareOutputFolder(copy.parent_path(), true);
            core::writeFile(copy, bytes, {true, false});
        }
        core::report(progress, 0.05);
        look(sum, copy, file, core::part(progress, 0.05, 1.0));
        keep(whole, {*stamp, copy, 0});
        return copy;
    }

    fs::path copyFolder() {
        const std::lock_guard lock(mutex);
        if (!folder) folder.emplace();
        return folder->path();
    }
    void requireNotFatal(const std::string& sum) {
        const std::lock_guard lock(mutex);
        if (const auto ended = fatal.find(sum); ended != fatal.end()) throw core::Error(ended->second);
    }
    /// Once for the same bytes.
    void look(const std::string& sum, const fs::path& copy, const fs::path& file, const core::Progress& progress) {
        {
            const std::lock_guard lock(mutex);
            if (known.contains(sum) || fine.contains(sum)) return;
        }
        try {
            const std::vector<std::string> within = reader(copy, progress);
            const std::lock_guard lock(mutex);
            fine.insert(sum);
            fine.insert(within.begin(), within.end());
        } catch (const core::Error& e) {
            if (e.problem() == "cancelled") throw;
            std::error_code error;
            fs::remove(copy, error);
            const core::Error said = saidOf(e, copy, file);
            const std::lock_guard lock(mutex);
            if (isFatal(e)) fatal.emplace(sum, said);
            throw said;
        }
    }

    void keep(const fs::path& whole, Copy copy) {
        const std::lock_guard lock(mutex);
        copy.used = ++uses;
        copies[whole] = std::move(copy);
        const auto bytes = [this] {
            std::uint64_t sum = 0;
            for (const auto& [file, one] : copies)
                sum += static_cast<std::uint64_t>(one.stamp.bytes);
            return sum;
        };
        while (copies.size() > kMostCopies || (copies.size() > 1 && bytes() > kMostCopiedBytes)) {
            const auto oldest = std::min_element(copies.begin(), copies.end(), [](const auto& a, const auto& b) {
                return a.second.used < b.second.used;
            });
            const fs::path place = oldest->second.place;
            copies.erase(oldest);
            std::error_code error;
            if (std::none_of(copies.begin(), copies.end(), [&](const auto& c) { return c.second.place == place; }))
                fs::remove(place, error);
        }
    }

    void note(const std::string& sum) {
        if (!known.insert(sum).second) return;
        newest.push_back(sum);
        if (newest.size() <= kMostOwn) return;
        known.erase(newest.front());
        newest.pop_front();
    }
    void noteAndKeep(const std::string& sum) {
        const std::lock_guard lock(mutex);
        if (known.contains(sum)) return;
        note(sum);
        std::string text;
        for (const std::string& one : newest)
            text += one + '\n';
        try {
            core::prepareOutputFolder(list.parent_path(), true);
            core::writeFile(list, text, {.ownerOnly = true, .lasting = false});
        } catch (const core::Error&) {
            return;  // a full disk: it is read as anybody's at the next start
        }
    }

    const Reader reader;
    const std::vector<fs::path> own;
    const fs::path list;
    std::mutex mutex;
    std::optional<core::PrivateFolder> folder;  ///< of the copies, once there is one
    std::map<fs::path, Copy> copies;
    std::map<fs::path, Stamp> written;  ///< by this program
    std::uint64_t uses = 0;
    std::set<std::string> fine, known;         ///< SHA-256 of what was read, and of what is one's own ...
    std::list<std::string> newest;             ///< ... in the order in which it came
    std::map<std::string, core::Error> fatal;  ///< by SHA-256, or as once() was told
    std::optional<core::TakingFrom> taking;
};

OutsideFiles::OutsideFiles(const Folders& folders, Reader reader)
    : state_(std::make_shared<State>(folders, std::move(reader))) {
    // The state outlives whoever is asking just then.
    state_->taking.emplace([state = std::weak_ptr<State>(state_)](const fs::path& file) {
        const std::shared_ptr<State> asked = state.lock();
        if (!asked) throw core::Error("cancelled");
        return asked->placeOf(file, {});
    });
}

OutsideFiles::~OutsideFiles() {
    state_->taking.reset();
}

bool OutsideFiles::isAtHand(const fs::path& file) const {
    return !isReadApart(file) || state_->isKnown(file) || state_->isOwnPlace(file);
}

void OutsideFiles::read(const fs::path& file, const core::Progress& progress) const {
    if (isReadApart(file)) (void)state_->placeOf(file, progress);
}

void OutsideFiles::once(const std::string& what, const std::function<void()>& reads) const {
    state_->requireNotFatal(what);
    try {
        reads();
    } catch (const core::Error& e) {
        const std::lock_guard lock(state_->mutex);
        if (isFatal(e)) state_->fatal.emplace(what, e);
        throw;
    }
}

void OutsideFiles::made(const fs::path& file) const {
    const std::optional<Stamp> stamp = stampOf(file);
    if (!stamp) return;
    made(core::readFile(file, kMostBytes));
    const fs::path whole = core::wholePath(file);
    const std::lock_guard lock(state_->mutex);
    state_->written.insert_or_assign(whole, *stamp);
}

void OutsideFiles::made(std::span<const std::byte> bytes) const {
    state_->noteAndKeep(prepared::sha256Of(bytes));
}

OutsideFiles::Reader OutsideFiles::sandboxReader() {
    return [](const fs::path& copy, const core::Progress& progress) {
        if (cases::isPackageName(copy)) return sandboxed::checkPackage(copy, progress).sessions;
        (void)sandboxed::readThrough(copy, progress);
        return std::vector<std::string>();
    };
}

}  // namespace handpiece::desktop
