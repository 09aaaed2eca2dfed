// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "handpiece/model/case/held_aside.h"
#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/senses/view/mesh_pieces.h"
#include "handpiece/senses/view/simplify.h"
#include "handpiece/senses/view/slice.h"

namespace handpiece::view {
namespace {

/// More than this, and drawing all is as quick as finding what changed.
constexpr std::size_t kMaxChanges = 20000;
constexpr double kCreaseRad = 0.9, kPieceTriangles = 200.0;
constexpr double kCrownCentreMm = 3.0, kCrownMm = 7.0;  // under a crown's top: a first molar's is 7.5 mm high [R]
constexpr int kNeckSectors = 24;
constexpr double kBeforeProximalMm = 0.05, kOverOcclusalMm = 4.0;
constexpr float kPatchMm = 2.0f;
constexpr double kSectionPixelMm = 0.05;
constexpr std::size_t kTrianglesACall = 6000;  // to be simplified: some milliseconds

/// How high each vertex of an adjacent tooth lies in the crown goes where removed depths do, 20 mm for its top, so that
/// its neck is shaded as the worked tooth's is. The long axis is that along which it is longest; `hangs`: of the other
/// jaw; `enamel`: its vertices, where they are known.
void noteHeights(const geometry::TriangleMesh& mesh, bool hangs, std::span<const core::Vec3> enamel,
                 std::vector<MeshPiece>& pieces) {
    core::Vec3 middle = core::Vec3::Zero();
    for (const core::Vec3& v : mesh.vertices)
        middle += v / static_cast<double>(mesh.vertices.size());
    core::Mat3 spread = core::Mat3::Zero();
    for (const core::Vec3& v : mesh.vertices)
        spread += (v - middle) * (v - middle).transpose();
    core::Vec3 up(0.05, 0.03, 1.0);
    constexpr int kRounds = 40;  // of power iteration: degrees are enough
    for (int i = 0; i < kRounds && spread.norm() > 0.0; ++i)
        up = (spread * up).normalized();
    constexpr double kLeastUpright = 0.7;  // a crown alone is wider than high
    if (std::abs(up.z()) < kLeastUpright) up = core::Vec3::UnitZ();
    if ((up.z() < 0.0) != hangs) up = -up;
    double topMm = -1e300;
    for (const core::Vec3& v : mesh.vertices)
        topMm = std::max(topMm, up.dot(v));
    // Enamel ends higher between teeth than towards lip and tongue.
    const core::Vec3 ahead = up.unitOrthogonal(), aside = up.cross(ahead);
    const auto sectorOf = [&](const core::Vec3& p) {
        const double turn = std::atan2(aside.dot(p - middle), ahead.dot(p - middle)) / (2.0 * std::numbers::pi);
        return kNeckSectors * (turn - std::floor(turn));
    };
    std::array<double, kNeckSectors> neckMm;
    neckMm.fill(enamel.empty() ? topMm - kCrownMm : topMm);
    for (const core::Vec3& v : enamel) {
        double& lowest = neckMm[static_cast<std::size_t>(sectorOf(v)) % kNeckSectors];
        lowest = std::min(lowest, up.dot(v));
    }
    const auto neckAt = [&](const core::Vec3& p) {
        const double sector = sectorOf(p) - 0.5 + kNeckSectors;
        const auto before = static_cast<std::size_t>(sector);
        const double share = sector - static_cast<double>(before);
        return (1.0 - share) * neckMm[before % kNeckSectors] + share * neckMm[(before + 1) % kNeckSectors];
    };
    for (MeshPiece& piece : pieces)
        for (GpuVertex& v : piece.vertices) {
            const core::Vec3 p(static_cast<double>(v.positionMm[0]), static_cast<double>(v.positionMm[1]),
                               static_cast<double>(v.positionMm[2]));
            const double neck = std::min(neckAt(p), topMm - 1.0);
            const double share = std::clamp((up.dot(p) - neck) / (topMm - neck), 0.0, 1.0);
            v.removedUm = static_cast<std::uint16_t>(std::lround(20000.0 * share));
        }
}

}  // namespace

void Scene::changeAll() {
    ++epoch_;
    changes_.clear();
}

void Scene::note(const PooledMesh& mesh) {
    if (mesh.indexCount == 0) return;
    if (changes_.size() >= kMaxChanges) changeAll();
    changes_.push_back({mesh.minMm, mesh.maxMm});
}

void Scene::measure() {
    bounds_ = toothBounds_;
    for (const auto* meshes : {&mesh_, &scenery_, &parts_})
        for (const Static& s : *meshes) {
            bounds_.extend(s.mesh.minMm.cast<double>());
            bounds_.extend(s.mesh.maxMm.cast<double>());
        }
}

void Scene::setTooth(const core::Box& bounds) {
    for (const Brick& brick : bricks_) {
        pool_.remove(brick.now);
        pool_.remove(brick.coarse);
        if (brick.isCut) {
            pool_.remove(brick.before);
            pool_.remove(brick.beforeCoarse);
        }
    }
    for (const Patch& patch : patches_)
        pool_.remove(patch.near);
    patches_.clear();
    patchAt_.clear();
    stale_.clear();
    bricks_.clear();
    slot_.clear();
    sorted_ = true;
    coarseCount_ = cutCount_ = 0;
    hasBefore_ = hasScannedBricks_ = false;
    teethInBricks_.clear();
    drop(mesh_);
    drop(parts_);
    overDentine_.set({});
    toothBounds_ = bounds;
    measure();
    changeAll();
}

void Scene::updateBricks(std::span<const surface::BrickUpdate> bricks, bool before) {
    hasBefore_ = hasBefore_ || before;
    for (const surface::BrickUpdate& update : bricks) {
        if (const std::uint16_t tooth = tooth::toothOf(update.id); tooth > 0) showTooth(tooth);
        put(update, before || update.isUncut);
    }
}

/// In bricks from now on, and no more as a part of the scenery.
void Scene::showTooth(std::uint16_t number) {
    if (!teethInBricks_.insert(number).second) return;
    std::erase_if(scenery_, [&](const Static& piece) {
        const bool isIt = piece.part + 1 == number;
        if (isIt) pool_.remove(piece.mesh);
        return isIt;
    });
    changeAll();
}

void Scene::put(const surface::BrickUpdate& update, bool before) {
    const auto [found, isNew] = slot_.try_emplace(update.id, static_cast<std::uint32_t>(bricks_.size()));
    if (isNew) {
        if (!bricks_.empty() && bricks_.back().id > update.id) sorted_ = false;
        bricks_.push_back({});
        bricks_.back().id = update.id;
    }
    Brick& brick = bricks_[found->second];
    const PooledMesh now = update.mesh != nullptr
                               ? pool_.add(pieceOf(*update.mesh, update.removedDepthMm.get(), update.colours.get()))
                               : PooledMesh{};
    const PooledMesh coarse = update.coarse != nullptr
                                  ? pool_.add(pieceOf(*update.coarse, nullptr, update.coarseColours.get()))
                                  : PooledMesh{};
    const bool isScanned = update.colours != nullptr || update.coarseColours != nullptr;
    if (isScanned && !hasScannedBricks_) {
        hasScannedBricks_ = true;
        changeAll();  // all is drawn in another way from now on
    }
    const bool hasCoarse = update.coarse != nullptr;
    note(brick.now);
    coarseCount_ -= brick.hasCoarse ? 1 : 0;
    coarseCount_ += hasCoarse ? 1 : 0;
    const bool isFirst = before || (isNew && !hasBefore_);
    if (isFirst) {
        // As it was and as it is are one again.
        if (brick.isCut) {
            note(brick.before);
            pool_.remove(brick.before);
            pool_.remove(brick.beforeCoarse);
            --cutCount_;
        }
        pool_.remove(brick.now);
        pool_.remove(brick.coarse);
        brick.isCut = false;
    } else if (!brick.isCut) {
        // What it showed so far is kept; for a brick that is new that is nothing.
        brick.before = brick.now;
        brick.beforeCoarse = brick.coarse;
        brick.beforeHasCoarse = brick.hasCoarse;
        brick.isCut = true;
        ++cutCount_;
    } else {
        pool_.remove(brick.now);
        pool_.remove(brick.coarse);
    }
    brick.now = now;
    brick.coarse = coarse;
    brick.hasCoarse = hasCoarse;
    brick.mesh = update.mesh;
    // Fewer triangles would blur the colours, however near they lie.
    if (!isScanned) putInPatch(brick);
    note(now);
}

void Scene::putInPatch(Brick& brick) {
    if (brick.patch == kNoPatch) {
        if (brick.mesh == nullptr) return;
        std::array<int, 4> at{0, 0, 0, tooth::toothOf(brick.id)};
        for (std::size_t k = 0; k < 3; ++k)
            at[k] = static_cast<int>(std::floor(brick.now.centreMm[static_cast<int>(k)] / kPatchMm));
        const auto [found, isNew] = patchAt_.try_emplace(at, static_cast<std::uint32_t>(patches_.size()));
        if (isNew) patches_.emplace_back();
        brick.patch = found->second;
        patches_[brick.patch].bricks.push_back(brick.id);
    }
    Patch& patch = patches_[brick.patch];
    if (patch.isStale) return;
    pool_.remove(patch.near);
    patch.near = {};
    patch.isStale = true;
    stale_.push_back(brick.patch);
}

void Scene::simplifySome() {
    std::size_t triangles = 0;
    while (!stale_.empty() && triangles < kTrianglesACall) {
        Patch& patch = patches_[stale_.back()];
        stale_.pop_back();
        std::vector<std::shared_ptr<const surface::BrickMesh>> meshes;
        for (const std::uint32_t id : patch.bricks)
            if (const auto& mesh = bricks_[slot_.at(id)].mesh) {
                meshes.push_back(mesh);
                triangles += mesh->triangles.size();
            }
        patch.near = pool_.add(simplified(meshes, kNearMm).piece);
        patch.isStale = false;
    }
}

void Scene::drop(std::vector<Static>& meshes) {
    for (const Static& s : meshes)
        pool_.remove(s.mesh);
    meshes.clear();
}

void Scene::add(std::vector<Static>& to, const geometry::TriangleMesh& mesh, cases::Tissue tissue,
                const geometry::VertexColours& colours, std::size_t part) {
    const core::Box box = mesh.bounds();
    if (box.isEmpty()) return;
    // Small pieces: little is drawn beside the bur while a cut redraws its rectangle.
    const double cells = std::max(1.0, static_cast<double>(mesh.triangles.size()) / kPieceTriangles);
    std::vector<MeshPiece> pieces =
        piecesOf(mesh, tissue, kCreaseRad, box.size().maxCoeff() / std::sqrt(cells), colours);
    if (tissue == cases::Tissue::neighbour) {
        std::vector<core::Vec3> enamel;
        if (others_ != nullptr && part < others_->size())
            for (const cases::Part& own : (*others_)[part].parts)
                if (own.tissue == cases::Tissue::enamel)
                    for (const core::Vec3& v : own.mesh.vertices)
                        enamel.push_back((*others_)[part].inCase.apply(v));
        noteHeights(mesh, box.centre().z() > toothBounds_.max.z(), enamel, pieces);
    }
    for (MeshPiece& piece : pieces) {
        to.push_back({tissue, pool_.add(piece), box, part, false, nullptr, 0});
        if (tissue == cases::Tissue::gum) to.back().uncut = std::make_shared<const MeshPiece>(std::move(piece));
    }
}

void Scene::setMesh(const geometry::TriangleMesh& mesh, cases::Tissue tissue, const geometry::VertexColours& colours) {
    setTooth(mesh.bounds());
    add(mesh_, mesh, tissue, colours);
    hasScannedBricks_ = !colours.empty();
    measure();
}

void Scene::setOthers(std::shared_ptr<const std::vector<cases::PlacedTooth>> others) {
    others_ = std::move(others);
    changeAll();
}

std::vector<std::pair<std::uint16_t, SectionFace>> Scene::othersCutBy(const Plane& plane) const {
    std::vector<std::pair<std::uint16_t, SectionFace>> cut;
    // Those in bricks may be cut otherwise too: what is left of them is not known here.
    for (std::size_t i = 0; others_ != nullptr && i < others_->size(); ++i) {
        const auto number = static_cast<std::uint16_t>(i + 1);
        if (teethInBricks_.contains(number)) continue;
        if (auto face = sliceOf((*others_)[i], plane, kSectionPixelMm)) cut.emplace_back(number, *std::move(face));
    }
    return cut;
}

void Scene::setScenery(std::span<const cases::Part> parts) {
    drop(scenery_);
    hasScannedScenery_ = false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (teethInBricks_.contains(static_cast<std::uint16_t>(i + 1))) continue;
        const std::size_t before = scenery_.size();
        add(scenery_, parts[i].mesh, parts[i].tissue, parts[i].colours, i);
        hasScannedScenery_ = hasScannedScenery_ || !parts[i].colours.empty();
        for (std::size_t k = before; k < scenery_.size(); ++k)
            scenery_[k].isHeldAside = cases::isHeldAside(parts[i]);
    }
    std::vector<Wounds::Piece> gingiva;
    for (Static& s : scenery_)
        if (s.uncut != nullptr) {
            s.gingiva = static_cast<std::uint32_t>(gingiva.size() + 1);
            gingiva.push_back({s.gingiva, s.mesh.minMm, s.mesh.maxMm, std::exchange(s.uncut, nullptr)});
        }
    wounds_.setGingiva(std::move(gingiva));
    measure();
    changeAll();
}

void Scene::setGingivaCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down) {
    wounds_.setCuts(std::move(cuts), down);
}

bool Scene::bleed(double timeS) {
    for (const auto& [number, mesh] : wounds_.at(timeS)) {
        const auto shown =
            std::find_if(scenery_.begin(), scenery_.end(), [n = number](const Static& s) { return s.gingiva == n; });
        if (shown == scenery_.end()) continue;
        note(shown->mesh);
        pool_.remove(shown->mesh);
        shown->mesh = pool_.add(mesh);
        note(shown->mesh);
    }
    return wounds_.isFlowing();
}

void Scene::setParts(std::span<const cases::Part> parts) {
    drop(parts_);
    for (const cases::Part& part : parts)
        add(parts_, part.mesh, part.tissue, {});
    overDentine_.set(parts);
    changeAll();
}

namespace {

/// Whether the way from `from` to `to` leads through the box.
bool leadsThrough(const core::Box& box, const core::Vec3& from, const core::Vec3& to) {
    double enter = 0.0, leave = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double way = to[k] - from[k];
        if (std::abs(way) < 1e-9) {
            if (from[k] < box.min[k] || from[k] > box.max[k]) return false;
            continue;
        }
        const double a = (box.min[k] - from[k]) / way, b = (box.max[k] - from[k]) / way;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave;
}

}  // namespace

Scene::InTheWay Scene::inTheWay(const std::optional<gl::Vec3f>& eyeMm) const {
    InTheWay out;
    if (!eyeMm || toothBounds_.isEmpty()) return out;
    const core::Vec3 eye = eyeMm->cast<double>(), middle = toothBounds_.centre();
    const double top = toothBounds_.max.z(), side = eye.x() < middle.x() ? -1.0 : 1.0;
    const core::Vec3 to(middle.x(), middle.y(), top - std::min(kCrownCentreMm, 0.5 * toothBounds_.size().z()));
    bool isBeside = false;  // one of the same jaw, on the eye's side
    bool isOver = false;    // one of the other jaw, over this tooth
    std::vector<std::uint16_t> otherJaw;
    const auto ask = [&](std::uint16_t number, const core::Box& box) {
        if (box.centre().z() > top) otherJaw.push_back(number);
        if (!leadsThrough(box, eye, to)) return;
        out.teeth.insert(number);
        isOver = isOver || box.centre().z() > top;
        isBeside = isBeside || (box.centre().z() < top && side * (box.centre().x() - middle.x()) > 0.0);
    };
    // Teeth as wholes, those in bricks as they were before they were cut.
    const Static* last = nullptr;
    for (const Static& s : scenery_) {
        if (s.tissue == cases::Tissue::neighbour && (last == nullptr || last->part != s.part))
            ask(static_cast<std::uint16_t>(s.part + 1), s.wholeMm);
        last = &s;
    }
    std::map<std::uint16_t, core::Box> boxes;
    const auto extend = [](core::Box& box, const Brick& brick) {
        const PooledMesh& mesh = brick.isCut ? brick.before : brick.now;
        if (mesh.indexCount == 0) return;
        box.extend(mesh.minMm.cast<double>());
        box.extend(mesh.maxMm.cast<double>());
    };
    if (!teethInBricks_.empty())
        for (const Brick& brick : bricks_)
            if (const std::uint16_t tooth = tooth::toothOf(brick.id); tooth > 0) extend(boxes[tooth], brick);
    for (const auto& [number, box] : boxes)
        if (!box.isEmpty()) ask(number, box);
    if (isOver && eye.z() > top) {
        // Jaws that are closed, or nearly: the other one goes whole, with its gingiva and bone.
        out.teeth.insert(otherJaw.begin(), otherJaw.end());
        out.plane = Plane{core::Vec3::UnitZ(), top + kOverOcclusalMm};
        return out;
    }
    if (!isBeside) return out;

    core::Box crown;
    for (const Brick& brick : bricks_)
        if (const PooledMesh& mesh = brick.isCut ? brick.before : brick.now;
            tooth::toothOf(brick.id) == 0 && mesh.minMm.z() > top - kCrownMm)
            extend(crown, brick);
    if (crown.isEmpty()) crown = toothBounds_;
    const double endMm = (side < 0.0 ? -crown.min.x() : crown.max.x()) + kBeforeProximalMm;
    if (side * eye.x() > endMm) out.plane = Plane{side * core::Vec3::UnitX(), endMm};
    return out;
}

const Scene::Visible& Scene::visible(const Look& look, Detail detail, const Culler& culler, const InTheWay& out) {
    if (!sorted_) {
        std::sort(bricks_.begin(), bricks_.end(), [](const Brick& a, const Brick& b) { return a.id < b.id; });
        for (std::uint32_t i = 0; i < bricks_.size(); ++i)
            slot_[bricks_[i].id] = i;
        sorted_ = true;
    }
    visible_.tooth.clear();
    visible_.around.clear();
    const auto offer = [&](const PooledMesh& mesh) {
        if (mesh.indexCount > 0 && culler.mayBeSeen(mesh)) visible_.tooth.push_back(&mesh);
    };
    const auto offerAround = [&](const PooledMesh& mesh) {
        if (mesh.indexCount == 0 || !culler.mayBeSeen(mesh)) return;
        if (out.plane && out.plane->normal.cast<float>().dot(mesh.centreMm) >
                             static_cast<float>(out.plane->offsetMm) + mesh.radiusMm)
            return;
        visible_.around.push_back(&mesh);
    };
    const auto offerOf = [&](std::uint32_t brick, const PooledMesh& mesh) {
        const std::uint16_t tooth = tooth::toothOf(brick);
        if (tooth == 0)
            offer(mesh);
        else if (!out.teeth.contains(tooth))
            offerAround(mesh);
    };
    const bool asItWas = look.tooth == ToothShown::before, coarse = detail == Detail::coarse,
               near = detail == Detail::near && !asItWas;
    if (near)
        for (const Patch& patch : patches_)
            offerOf(patch.bricks.front(), patch.near);
    for (const Brick& brick : bricks_) {
        if (near && brick.patch != kNoPatch && patches_[brick.patch].near.indexCount > 0) continue;
        if (asItWas && brick.isCut)
            offerOf(brick.id, coarse && brick.beforeHasCoarse ? brick.beforeCoarse : brick.before);
        else
            offerOf(brick.id, coarse && brick.hasCoarse ? brick.coarse : brick.now);
    }
    const auto isVisible = [&](cases::Tissue tissue) { return look.visible[static_cast<std::size_t>(tissue)]; };
    const auto offerAll = [&](const std::vector<Static>& meshes) {
        for (const Static& s : meshes)
            if (isVisible(s.tissue)) offer(s.mesh);
    };
    offerAll(mesh_);
    // Inner tissues lie under the surface; they matter only where one of those around them is left out.
    if (std::any_of(parts_.begin(), parts_.end(), [&](const Static& s) { return !isVisible(s.tissue); }))
        offerAll(parts_);
    for (const Static& s : scenery_) {
        const bool isLeftOut =
            s.tissue == cases::Tissue::neighbour && out.teeth.contains(static_cast<std::uint16_t>(s.part + 1));
        if (isVisible(s.tissue) && !isLeftOut && (look.cheeks || !s.isHeldAside)) offerAround(s.mesh);
    }
    return visible_;
}

const std::vector<const PooledMesh*>& Scene::cutAway(const Culler& culler, const InTheWay& out) {
    cut_.clear();
    for (const Brick& brick : bricks_)
        if (brick.isCut && brick.before.indexCount > 0 && !out.teeth.contains(tooth::toothOf(brick.id)) &&
            culler.mayBeSeen(brick.before))
            cut_.push_back(&brick.before);
    return cut_;
}

PixelRect Scene::rectOfCut(const Eye& eye, const Viewport& viewport) const {
    PixelRect rect;
    for (const Brick& brick : bricks_)
        if (brick.isCut && brick.before.indexCount > 0)
            rect = rect.joined(rectOf(brick.before.minMm, brick.before.maxMm, eye, viewport));
    return rect;
}

}  // namespace handpiece::view
