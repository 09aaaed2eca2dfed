// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/kept_cases.h"

#include <fmt/format.h>

#include <optional>

#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/model/case/as_written.h"
#include "handpiece/model/case/packed_case.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/dentition/arch.h"
#include "handpiece/model/dentition/mouth.h"

namespace handpiece::course {
namespace {

namespace fs = std::filesystem;
constexpr const char* kPacked = ".packed-case";

cases::Case kept(const fs::path& place, const std::function<bool(const cases::Case&)>& isIt,
                 const std::function<cases::Case()>& make, const KeptListener& listener) {
    std::error_code error;
    if (fs::exists(fs::symlink_status(place, error))) {
        try {
            cases::Case found = cases::readCase(place);
            if (isIt(found)) return found;
        } catch (const core::Error&) {  // damaged
        }
        if (listener.renewed) listener.renewed(place);
        fs::remove_all(place, error);
    }
    // What the packages bring is used where it lies: there is nothing to keep.
    const std::string name = place.filename().string() + kPacked;
    if (const auto packed = prepared::read(name)) {
        if (std::optional<cases::Case> found = cases::unpackCase(*packed, place); found && isIt(*found))
            return std::move(*found);
        prepared::refuse(name);
    }
    if (listener.making) listener.making();
    const cases::Case made = make();
    if (prepared::isCollecting()) prepared::keep(name, cases::packCase(made));
    try {
        fs::create_directories(place.parent_path(), error);
        cases::writeCase(made, place);
        // As read back: an STL holds less than a double, and the cache beside it belongs to what it holds.
        return cases::readCase(place);
    } catch (const core::Error& why) {
        if (listener.notKept) listener.notKept(place, why);
        return cases::asWritten(made, place);
    }
}

std::string patientName(const dentition::Patient& patient) {
    return fmt::format("{}-{:g}", patient.seed, patient.ageYears);
}

}  // namespace

std::string keptRevision() {
    return fmt::format("{}-{}", HANDPIECE_VERSION, dentition::kTeethRevision);
}

fs::path keptToothPlace(int fdi, const dentition::Patient& patient, std::size_t faces, const fs::path& folder) {
    return folder / fmt::format("tooth-{}-{}-{}-{}", patientName(patient), fdi, faces, keptRevision());
}

fs::path keptMouthPlace(const dentition::Patient& patient, const fs::path& folder) {
    return folder / fmt::format("mouth-{}-{}-{}", patientName(patient), kMouthFaces, keptRevision());
}

cases::Case keptTooth(int fdi, const dentition::Patient& patient, std::size_t faces, const fs::path& folder,
                      const core::Progress& progress, const KeptListener& listener) {
    return kept(
        keptToothPlace(fdi, patient, faces, folder), [fdi](const cases::Case& c) { return c.fdiNumber == fdi; },
        [&] {
            cases::Case made;
            static_cast<cases::Tooth&>(made) = dentition::makeTooth(fdi, patient, {faces, 0}, progress);
            return made;
        },
        listener);
}

cases::Case keptMouth(int fdi, const dentition::Patient& patient, const fs::path& folder,
                      const core::Progress& progress, const KeptListener& listener) {
    constexpr int kMadeAt = 46;
    cases::Case mouth = kept(
        keptMouthPlace(patient, folder),
        [](const cases::Case& c) { return c.others.size() + 1 == dentition::kToothCount; },
        [&] {
            return dentition::makeMouth(patient, {kMadeAt, kMouthFaces}, progress);
        },
        listener);
    // What is kept beside the mouth, the fields of all that stands there, serves each of its teeth.
    return cases::workOn(std::move(mouth), fdi);
}

}  // namespace handpiece::course
