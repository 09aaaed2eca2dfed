// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/first_mouth.h"

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/model/dentition/occlusion.h"

namespace handpiece::course {

cases::Case standIn(cases::Tooth tooth, cases::Case mouth) {
    static_cast<cases::Tooth&>(mouth) = std::move(tooth);
    dentition::grindOntoAntagonists(mouth);
    return mouth;
}

cases::Case firstMouth(const std::filesystem::path& folder) {
    cases::Tooth tooth = keptTooth(kFirstFdi, {}, kFirstFaces, folder);
    return standIn(std::move(tooth), keptMouth(kFirstFdi, {}, folder));
}

}  // namespace handpiece::course
