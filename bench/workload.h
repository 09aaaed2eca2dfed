// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teeth, the bur, the ways and the right answers that all methods share; each made when first asked for.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/field_method.h"
#include "query.h"
#include "trajectory.h"

namespace handpiece::bench {

/// Of our methods: below the hover's clearance of 1 mm, since "no contact" is asked there and not the distance.
inline constexpr double kReachMm = 0.5;

struct Resolution {
    std::string name;  ///< "68k"
    std::size_t faces;
};
/// The face counts of the paper's Table II.
[[nodiscard]] std::span<const Resolution> resolutions();

/// One tick's truth.
struct Reference {
    std::size_t tick;
    double depthMm;
};

/// Everything is kept, on disk too (generated teeth and fields beside the program). Not thread-safe.
class Workload {
  public:
    /// `quick`: 400 ticks and ways found on the coarsest tooth, for a smoke test.
    explicit Workload(bool quick);

    [[nodiscard]] const instrument::Bur& bur() const { return *bur_; }
    [[nodiscard]] PeerInput peerInput(const Resolution& resolution);
    [[nodiscard]] std::shared_ptr<const tooth::ToothModel> tooth(const Resolution& resolution, double voxelMm);
    /// Farther apart than `reachMm` the answer is kNoContact.
    [[nodiscard]] std::unique_ptr<Query> exactQuery(const Resolution& resolution, double reachMm);
    [[nodiscard]] std::unique_ptr<Query> fieldQuery(const Resolution& resolution,
                                                    double voxelMm);  ///< depth and patches
    [[nodiscard]] std::unique_ptr<Query> fieldOnlyQuery(const Resolution& resolution, double voxelMm);  ///< depth
    [[nodiscard]] std::unique_ptr<Query> hullQuery(const Resolution& resolution);

    /// The same poses for every resolution: found on the finest tooth.
    [[nodiscard]] std::span<const core::Pose> poses(Way way);
    /// The depth by its definition at every tenth tick, by brute force.
    [[nodiscard]] const std::vector<Reference>& references(const Resolution& resolution, Way way);

    /// Another bur's own way over one tooth, and the right answers there.
    struct BurDrag {
        std::unique_ptr<Query> query;
        std::vector<core::Pose> poses;
        std::vector<Reference> references;
    };
    /// `name` as makeBur() knows it, or "mesh": the paper's bur as an STL brings it.
    [[nodiscard]] BurDrag drag(const std::string& name, const Resolution& resolution, Way way);

  private:
    [[nodiscard]] std::filesystem::path toothFile(const Resolution& resolution);
    [[nodiscard]] const geometry::TriangleMesh& mesh(const Resolution& resolution);

    [[nodiscard]] int ticks() const;
    [[nodiscard]] std::vector<Reference> referencesOf(const instrument::Bur& bur, const Resolution& resolution,
                                                      std::span<const core::Pose> poses);

    bool quick_;
    std::filesystem::path cache_;
    std::shared_ptr<const instrument::Bur> bur_;
    std::map<std::string, geometry::TriangleMesh> meshes_;
    std::pair<std::string, std::shared_ptr<const tooth::ToothModel>> lastTooth_;
    std::map<Way, std::vector<core::Pose>> poses_;
    std::map<std::pair<std::string, Way>, std::vector<Reference>> references_;
};

}  // namespace handpiece::bench
