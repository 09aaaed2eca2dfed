// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Random preparations of which everything is known: carved exactly into blocks, cylinders and a molar in turned grids.
/// For the tests and for measures_study.

#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "assess/measures/analytic.h"

namespace handpiece::measures::test {

enum class Kind { classOne, classTwo, classThree, classFive, crown, molar };
inline constexpr const char* kKindNames[] = {"class I", "class II", "class III", "class V", "crown", "class I, molar"};

/// One thing that is wrong with a preparation that is right otherwise.
enum class Fault { none, overDeep, undercut, thinRidge, nickedNeighbour, nearPulp, roughWall };
inline constexpr const char* kFaultNames[] = {"none",         "over-deep by 0.3 mm", "undercut 8 deg",
                                              "ridge 0.9 mm", "nicked neighbour",    "0.4 mm over the pulp",
                                              "rough wall"};
inline constexpr int kFaults = 7;

/// What was made, and what a measure is to say of it.
struct Truth {
    Request request;
    double value;
    std::string row;     ///< of the table of errors
    double scale = 1.0;  ///< of the error, into the row's unit
};

struct Trial {
    Kind kind = Kind::classOne;
    Body body;
    std::unique_ptr<tooth::ToothMirror> cut;
    Body neighbour;
    std::unique_ptr<tooth::ToothMirror> neighbourCut;  ///< null where no tooth stands beside it
    core::Pose neighbourInTooth{};
    std::vector<cases::Landmark> landmarks;
    std::shared_ptr<const geometry::TriangleTree> gingiva;
    Axes axes;
    Form form = Form::found;
    double askedDepthMm = 0.0;  ///< of the task, where it is made to be right
    std::vector<Truth> truths;

    [[nodiscard]] std::vector<Measured> take(const std::vector<Request>& requests) const;
    /// The errors of all truths; gives what was measured of them, and of `more` after them.
    std::vector<Measured> judge(Table& table, std::vector<Request> more = {}) const;
    /// The shipped rubric that would be asked.
    [[nodiscard]] const char* rubric() const;
};

/// Makes trials in bodies that it keeps: one turned grid of each.
class Lab {
  public:
    Lab(double voxelMm, std::mt19937_64& random) : voxelMm_(voxelMm), random_(random) {}

    /// Sizes as wide as students' are. `withVolumes`: what is gone is integrated, too.
    [[nodiscard]] Trial make(Kind kind, bool withVolumes = true);
    /// A class I or II within its tolerances, with one fault or none.
    [[nodiscard]] Trial makeRight(Kind kind, Fault fault);

  private:
    [[nodiscard]] Trial cavity(Kind kind, std::optional<Fault> fault, bool withVolumes);
    [[nodiscard]] Trial classThree();
    [[nodiscard]] Trial classFive(bool withVolumes);
    [[nodiscard]] Trial crown(bool withVolumes);
    [[nodiscard]] Trial molar();
    [[nodiscard]] Marks marks();
    [[nodiscard]] double any(double low, double high);
    void setNeighbour(Trial& trial, double gapMm, double heightMm, double nickMm);

    double voxelMm_;
    std::mt19937_64& random_;
    std::optional<Body> block_, ball_, barrel_, stump_, molar_;
};

/// Whether a fault is found, and whether the uncertainty reaches over the limit.
struct Finding {
    bool isFound = false, isBorderline = false;
    std::string said;  ///< each value that was looked at
};
/// All faults' findings of one trial, in the order of Fault. The limits are those of the shipped rubrics' critical
/// errors where they have one: ridge 1 mm, neighbour 0.1 mm, pulp 0.5 mm; else half-way between what is right and the
/// fault: 0.2 mm under the task's depth, 9 um of roughness, an undercut of 0.02 mm (none is 0, the
/// least that counts 0.03).
[[nodiscard]] std::array<Finding, kFaults> findings(const Trial& trial);

}  // namespace handpiece::measures::test
