// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/first_mouth.h"

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/model/dentition/occlusion.h"

namespace handpiece::course {

cases::Case firstMouth(const std::filesystem::path& folder) {
    cases::Case tooth = keptTooth(kFirstFdi, {}, kFirstFaces, folder);
    cases::Case mouth = keptMouth(kFirstFdi, {}, folder);
    static_cast<cases::Tooth&>(mouth) = std::move(static_cast<cases::Tooth&>(tooth));
    dentition::grindOntoAntagonists(mouth);
    return mouth;
}

}  // namespace handpiece::course
