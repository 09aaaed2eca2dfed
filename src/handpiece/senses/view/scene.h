// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What there is to draw: the tooth by bricks, as it is and as it was, its inner tissues, the scenery. Private to this
/// room.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/surface/brick_update.h"
#include "handpiece/senses/view/mesh_pool.h"
#include "handpiece/senses/view/over_dentine.h"
#include "handpiece/senses/view/renderer.h"
#include "handpiece/senses/view/wounds.h"

namespace handpiece::view {

/// `near`: the tooth as it is, uncut places with fewer triangles that lie within Scene::kNearMm of all.
enum class Detail { full, near, coarse };

class Scene {
  public:
    void setTooth(const core::Box& bounds);
    void updateBricks(std::span<const surface::BrickUpdate> bricks, bool before);
    void setMesh(const geometry::TriangleMesh& mesh, cases::Tissue tissue, const geometry::VertexColours& colours);
    void setOthers(std::shared_ptr<const std::vector<cases::PlacedTooth>> others);
    void setScenery(std::span<const cases::Part> parts);
    void setParts(std::span<const cases::Part> parts);
    void setGingivaCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down);
    /// Gingiva as it is at a time. True where it will be another some time later: blood runs.
    bool bleed(double timeS);

    [[nodiscard]] const core::Box& toothBounds() const noexcept { return toothBounds_; }
    /// All that may be seen, scenery too.
    [[nodiscard]] const core::Box& bounds() const noexcept { return bounds_; }
    [[nodiscard]] const OverDentine& overDentine() const noexcept { return overDentine_; }
    /// Sections of the other teeth whose tissues are known, that are whole and that the plane goes through, by their
    /// numbers.
    [[nodiscard]] std::vector<std::pair<std::uint16_t, SectionFace>> othersCutBy(const Plane& plane) const;
    /// Something of it has a scan's colours.
    [[nodiscard]] bool isScanned() const noexcept { return hasScannedBricks_ || hasScannedScenery_; }
    [[nodiscard]] bool hasCoarse() const noexcept { return coarseCount_ > 0; }

    /// How far what Detail::near shows may lie from all triangles [mm].
    static constexpr float kNearMm = 0.004f;
    /// Simplifies what is not yet so, a few patches a call.
    void simplifySome();
    [[nodiscard]] bool isStale() const noexcept { return !stale_.empty(); }
    /// Detail::near is worth it: little is still to be simplified, and shown whole until then.
    [[nodiscard]] bool hasNear() const noexcept { return !patches_.empty() && 8 * stale_.size() <= patches_.size(); }

    /// Counts up when all is another; a brick's change only adds to changes().
    [[nodiscard]] std::uint64_t epoch() const noexcept { return epoch_; }
    /// Boxes of what changed, the oldest first; forgotten when the epoch changes. A reader keeps its place.
    struct Change {
        gl::Vec3f minMm, maxMm;
    };
    [[nodiscard]] const std::vector<Change>& changes() const noexcept { return changes_; }

    /// Other teeth that would stand between an eye and the tooth's crown are left out, by their numbers: a look from
    /// mesial or distal shows this tooth. Where adjacent teeth are, what surrounds the tooth ends at a plane before its
    /// proximal side, or their empty sockets would hide it; of jaws that are closed the other one is left out whole.
    struct InTheWay {
        std::set<std::uint16_t> teeth;
        std::optional<Plane> plane;
    };
    /// Nothing without `eyeMm`.
    [[nodiscard]] InTheWay inTheWay(const std::optional<gl::Vec3f>& eyeMm) const;
    /// What `look` and `culler` let through, in an order that does not depend on the rest. Good until the next change.
    struct Visible {
        std::vector<const PooledMesh*> tooth, around;
    };
    [[nodiscard]] const Visible& visible(const Look& look, Detail detail, const Culler& culler, const InTheWay& out);
    /// The teeth as they were, where they are others now.
    [[nodiscard]] const std::vector<const PooledMesh*>& cutAway(const Culler& culler, const InTheWay& out);
    [[nodiscard]] bool isCut() const noexcept { return cutCount_ > 0; }
    [[nodiscard]] PixelRect rectOfCut(const Eye& eye, const Viewport& viewport) const;
    std::size_t draw(const std::vector<const PooledMesh*>& meshes) { return pool_.draw(meshes); }

  private:
    struct Brick {
        std::uint32_t id = 0;  ///< as in surface::BrickUpdate
        PooledMesh now, coarse, before, beforeCoarse;
        bool hasCoarse = false, beforeHasCoarse = false;
        bool isCut = false;                              ///< `now` is not `before`, which then owns its own range
        std::shared_ptr<const surface::BrickMesh> mesh;  ///< of `now`
        std::uint32_t patch = kNoPatch;
    };
    /// Bricks that are simplified together: of those alone most points lie on the rim, and stay.
    static constexpr std::uint32_t kNoPatch = 0xffffffffu;
    struct Patch {
        std::vector<std::uint32_t> bricks;  ///< their ids, all of one tooth
        PooledMesh near;
        bool isStale = false;
    };
    struct Static {
        cases::Tissue tissue;
        PooledMesh mesh;
        core::Box wholeMm;     ///< of the part that it is a piece of
        std::size_t part = 0;  ///< its number
        bool isHeldAside = false;
        std::shared_ptr<const MeshPiece> uncut;  ///< of gingiva, until the wounds have it
        std::uint32_t gingiva = 0;               ///< its number there, from 1; 0: is none
    };
    void put(const surface::BrickUpdate& update, bool before);
    void drop(std::vector<Static>& meshes);
    void add(std::vector<Static>& to, const geometry::TriangleMesh& mesh, cases::Tissue tissue,
             const geometry::VertexColours& colours, std::size_t part = 0);
    void showTooth(std::uint16_t number);
    void note(const PooledMesh& mesh);
    void putInPatch(Brick& brick);
    void changeAll();
    void measure();

    MeshPool pool_;
    std::vector<Brick> bricks_;                              ///< by rising id
    std::unordered_map<std::uint32_t, std::uint32_t> slot_;  ///< id -> place in bricks_ (sorted only when asked)
    bool sorted_ = true;
    std::vector<Static> mesh_, scenery_, parts_;
    OverDentine overDentine_;
    std::shared_ptr<const std::vector<cases::PlacedTooth>> others_;
    Wounds wounds_;
    core::Box toothBounds_, bounds_;
    std::vector<Patch> patches_;
    std::map<std::array<int, 4>, std::uint32_t> patchAt_;  ///< by tooth and place
    std::vector<std::uint32_t> stale_;                     ///< patches that are to be simplified (again)
    std::size_t coarseCount_ = 0, cutCount_ = 0;
    bool hasBefore_ = false;
    bool hasScannedBricks_ = false, hasScannedScenery_ = false;
    std::set<std::uint16_t> teethInBricks_;  ///< of those around the one worked on
    std::uint64_t epoch_ = 1;
    std::vector<Change> changes_;
    Visible visible_;
    std::vector<const PooledMesh*> cut_;
};

}  // namespace handpiece::view
