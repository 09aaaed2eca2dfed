// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/constraint_projection.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <optional>
#include <vector>

#include "support/random.h"

namespace handpiece::force::constraint_projection_test {
namespace {

using contact::ConstraintSet;
using core::Vec3;

double worstViolation(const ConstraintSet& set, const Vec3& step) {
    double worst = 0.0;
    for (const auto& c : set)
        worst = std::max(worst, -(c.gapMm + c.normal.dot(step)));
    return worst;
}

/// The nearest allowed step by trying every choice of up to three planes that hold it.
std::optional<Vec3> bruteForce(const ConstraintSet& set, const Vec3& wanted) {
    std::optional<Vec3> best;
    const auto consider = [&](const std::vector<std::size_t>& planes) {
        Eigen::MatrixXd n(3, planes.size());
        Eigen::VectorXd right(planes.size());
        for (std::size_t i = 0; i < planes.size(); ++i) {
            const auto column = static_cast<Eigen::Index>(i);
            n.col(column) = set[planes[i]].normal;
            right[column] = -set[planes[i]].gapMm - set[planes[i]].normal.dot(wanted);
        }
        const Eigen::MatrixXd gram = n.transpose() * n;
        if (!planes.empty() && gram.fullPivLu().rank() < n.cols()) return;
        const Vec3 step = planes.empty() ? wanted : Vec3(wanted + n * gram.fullPivLu().solve(right));
        if (worstViolation(set, step) > 1e-9) return;
        if (!best || (step - wanted).norm() < (*best - wanted).norm()) best = step;
    };
    consider({});
    for (std::size_t i = 0; i < set.size(); ++i) {
        consider({i});
        for (std::size_t j = 0; j < i; ++j) {
            consider({i, j});
            for (std::size_t k = 0; k < j; ++k)
                consider({i, j, k});
        }
    }
    return best;
}

TEST(ConstraintProjection, agreesWithTryingEveryChoiceOfPlanes) {
    std::mt19937_64 generator(test::seed());
    int held = 0;
    for (int round = 0; round < 1500; ++round) {
        ConstraintSet set;
        const int count = 1 + static_cast<int>(generator() % 14);
        for (int i = 0; i < count; ++i) {
            // The origin is allowed: gaps are not negative, so the planes never contradict each other.
            set.pushBack({test::randomDirection(generator), test::uniform(generator, 0.0, 0.05), Vec3::Zero(), {}});
        }
        const Vec3 wanted = test::uniform(generator, 0.0, 1.0) * test::randomDirection(generator);
        const Projection p = project(set, wanted);
        const std::optional<Vec3> expected = bruteForce(set, wanted);
        ASSERT_TRUE(expected);
        // The slack lets every plane give way by 1e-6 of the multipliers; sharp corners magnify that.
        double pressure = 0.0;
        for (int j = 0; j < p.activeCount; ++j)
            pressure += p.multiplierMm[j];
        const double length = (*expected - wanted).norm();
        const double allowed = length > 0.0 ? 2e-6 * pressure * pressure / length + 1e-8 : 1e-12;
        EXPECT_NEAR((p.stepMm - wanted).norm(), length, allowed) << "round " << round;
        EXPECT_LE(worstViolation(set, p.stepMm), 1.01e-6 * pressure + 2e-9);
        EXPECT_NEAR(p.slackMm, 1e-6 * pressure, 1e-9 + 1e-6 * pressure);
        held += p.activeCount > 0;
    }
    EXPECT_GT(held, 500);
}

TEST(ConstraintProjection, forcesOfTheActivePlanesAddUpToTheStep) {
    std::mt19937_64 generator(test::seed());
    for (int round = 0; round < 500; ++round) {
        ConstraintSet set;
        for (int i = 0; i < 40; ++i) {
            Vec3 n = test::randomDirection(generator);
            n.z() = std::abs(n.z()) + 0.05;  // one side: always solvable
            set.pushBack({n.normalized(), test::uniform(generator, -0.02, 0.02), Vec3::Zero(), {}});
        }
        const Vec3 wanted = test::uniform(generator, 0.0, 3.0) * test::randomDirection(generator);
        const Projection p = project(set, wanted);
        Vec3 sum = wanted;
        for (int j = 0; j < p.activeCount; ++j) {
            EXPECT_GE(p.multiplierMm[j], -1e-12);
            sum += p.multiplierMm[j] * set[p.active[j]].normal;
        }
        EXPECT_LT((sum - p.stepMm).norm(), 1e-8);
        EXPECT_LT(p.iterations, kMaxProjectionIterations);
    }
}

TEST(ConstraintProjection, sharesTheViolationOfAWedgedBurEvenly) {
    ConstraintSet set;
    set.pushBack({Vec3::UnitX(), -0.03, Vec3::Zero(), {}});
    set.pushBack({-Vec3::UnitX(), -0.01, Vec3::Zero(), {}});
    const Projection p = project(set, Vec3(0.0, 0.4, 0.0));
    EXPECT_NEAR(p.stepMm.x(), 0.01, 1e-5);
    EXPECT_NEAR(p.stepMm.y(), 0.4, 1e-9);
    EXPECT_NEAR(p.slackMm, 0.02, 1e-5);
}

TEST(ConstraintProjection, takesManyAlmostEqualPlanes) {
    ConstraintSet set;
    for (int i = 0; i < 96; ++i) {
        const double a = 1e-7 * i;
        set.pushBack({Vec3(std::sin(a), 0, std::cos(a)), -1e-4 * (i % 5), Vec3::Zero(), {}});
    }
    const Projection p = project(set, Vec3(0.01, 0.0, -2.0));
    EXPECT_NEAR(p.stepMm.z(), 4e-4, 1e-5);
    EXPECT_NEAR(p.stepMm.x(), 0.01, 1e-4);
    EXPECT_LT(p.iterations, kMaxProjectionIterations);
}

}  // namespace
}  // namespace handpiece::force::constraint_projection_test
