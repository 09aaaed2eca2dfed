// SPDX-License-Identifier: Apache-2.0
// Jaws opened by what the teeth tell, beside the mouth that knows its own hinge.
#include <gtest/gtest.h>

#include "handpiece/base/core/rotation.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/case/work_on.h"
#include "model/dentition/mouths.h"

namespace handpiece::dentition::jaws_test {
namespace {

using core::Pose;

/// A case of it without gingiva and bone; `openingMm` as makeMouth takes it.
cases::Case caseOf(const Mouth& m, int fdi, double openingMm) {
    const Pose mandible = opened(m.arches, openingMm);
    const auto stands = [&](std::size_t i) {
        return isUpper(i) ? m.arches.toothInMouth[i] : mandible * m.arches.toothInMouth[i];
    };
    const std::size_t own = indexOf(fdi);
    cases::Case made;
    static_cast<cases::Tooth&>(made) = m.teeth[own];
    for (std::size_t i = 0; i < kToothCount; ++i) {
        if (i == own) continue;
        cases::PlacedTooth other;
        static_cast<cases::Tooth&>(other) = m.teeth[i];
        other.inCase = stands(own).inverse() * stands(i);
        made.others.push_back(std::move(other));
    }
    for (const std::size_t i : {indexOf(16), indexOf(36)})  // as pieces of bone would stand
        made.scenery.push_back({"piece", cases::Tissue::bone, 6,
                                geometry::transformed(m.teeth[i].outer, stands(own).inverse() * stands(i)), true});
    return made;
}

TEST(Jaws, OpenAsThoseOfAGeneratedMouth) {
    const Mouth& whole = mouth(1);
    for (const int fdi : {46, 11}) {
        const cases::Case asMade = caseOf(whole, fdi, 0.0), wanted = caseOf(whole, fdi, kOpeningMm);
        cases::Case wide = asMade;
        ASSERT_TRUE(cases::openJaws(wide, kOpeningMm));
        for (std::size_t i = 0; i < wide.others.size(); ++i) {
            const Pose &is = wide.others[i].inCase, &shouldBe = wanted.others[i].inCase;
            EXPECT_LT((is.positionMm - shouldBe.positionMm).norm(), 2.5) << fdi << ", " << wide.others[i].fdiNumber;
            EXPECT_LT(core::angleBetween(is.orientation, shouldBe.orientation), 0.05);
        }
        for (std::size_t i = 0; i < wide.scenery.size(); ++i)
            EXPECT_LT((wide.scenery[i].mesh.bounds().centre() - wanted.scenery[i].mesh.bounds().centre()).norm(), 3.0);
        // Wider open already, and back again.
        EXPECT_FALSE(cases::openJaws(wide, 20.0));
        const cases::Case closed = cases::inOcclusion(wide);
        for (std::size_t i = 0; i < closed.others.size(); ++i)
            EXPECT_LT((closed.others[i].inCase.positionMm - asMade.others[i].inCase.positionMm).norm(), 1e-9);
    }
}

TEST(Jaws, OpenWithoutFrontTeethAndNotWithoutAnArch) {
    const Mouth& whole = mouth(1);
    const cases::Case wanted = caseOf(whole, 46, kOpeningMm);
    cases::Case few = caseOf(whole, 46, 0.0);
    std::erase_if(few.others, [](const cases::PlacedTooth& t) { return t.fdiNumber % 10 < 5; });
    cases::Case lower = few;
    ASSERT_TRUE(cases::openJaws(few, kOpeningMm));
    for (const cases::PlacedTooth& t : few.others)
        for (const cases::PlacedTooth& other : wanted.others)
            if (other.fdiNumber == t.fdiNumber) {
                EXPECT_LT((t.inCase.positionMm - other.inCase.positionMm).norm(), 6.0) << t.fdiNumber;
            }
    std::erase_if(lower.others, [](const cases::PlacedTooth& t) { return cases::isUpperTooth(t.fdiNumber); });
    EXPECT_FALSE(cases::openJaws(lower, kOpeningMm));
    EXPECT_TRUE(lower.opening.isIdentity());
}

}  // namespace
}  // namespace handpiece::dentition::jaws_test
