// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/tooth_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/split_mix.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/dentition/landmarks.h"
#include "handpiece/model/dentition/rules.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {
namespace {
using core::Vec3;

void checkTooth(int fdi, const Patient& patient) {
    if (!cases::isPermanentTooth(fdi))
        throw core::Error(fmt::format("{} is no permanent tooth", fdi), "--fdi",
                          "give a number of two digits: quadrant 1 to 4, then 1 (central incisor) to 8 (third molar)");
    if (!(patient.ageYears >= 6.0 && patient.ageYears <= 110.0))
        throw core::Error(fmt::format("an age of {} years", patient.ageYears), "--age", "give 6 to 110");
}

/// A smooth field of small shifts: no cusp stands, no groove runs as on a drawing.
class Wander {
  public:
    explicit Wander(std::uint64_t seed) {
        Draws draws(seed, false);
        for (Wave& w : waves_) {
            const double turn = 2.0 * std::numbers::pi * draws.uniform();
            w = {core::cos(turn), core::sin(turn), 2.0 * std::numbers::pi * draws.uniform()};
        }
    }
    /// At a place, of waves this long [mm].
    [[nodiscard]] Vec3 at(const Vec3& p, double lengthMm) const {
        Vec3 shift = Vec3::Zero();
        const double k = 2.0 * std::numbers::pi / lengthMm;
        for (std::size_t i = 0; i < waves_.size(); ++i) {
            const Wave& w = waves_[i];
            shift[static_cast<int>(i % 3)] += core::sin(k * (w.x * p.x() + w.y * p.y()) + w.phase);
        }
        return shift;
    }

  private:
    struct Wave {
        double x = 0.0, y = 0.0, phase = 0.0;
    };
    std::array<Wave, 6> waves_;
};

void wander(Spec& spec, const Wander& field) {
    const auto moved = [&](Vec3& p, double up) {
        const Vec3 shift = field.at(p, 6.0);
        p += Vec3(0.10 * shift.x(), 0.10 * shift.y(), up * shift.z());
    };
    for (Crest& c : spec.crests)
        moved(c.from, 0.0), moved(c.by, 0.08), moved(c.to, 0.04);
    for (Cusp& c : spec.cusps)
        moved(c.tip, 0.0);
    for (Hollow& h : spec.hollows)
        moved(h.centre, 0.0);
    for (Groove& g : spec.grooves) {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < g.points.size(); ++i) {
            if (i > 0) points.push_back(0.5 * (g.points[i - 1] + g.points[i]));
            points.push_back(g.points[i]);
        }
        // Fissures are no engraver's work: steep and narrow here, hardly more than where two slopes meet there; down a
        // side they fade away.
        if (!g.name.empty() && g.name != "central") points.back().z() = 0.0;
        g.widths.clear();
        for (Vec3& p : points) {
            const double depth = p.z();
            // A field: what meets goes on meeting.
            moved(p, 0.0);
            const Vec3 bend = field.at(p, 2.2), change = field.at(p, 3.1);
            p += Vec3(0.07 * bend.x(), 0.07 * bend.y(), 0.0);
            p.z() = depth * std::max(0.62 + 0.26 * change.z(), 0.12);
            g.widths.push_back(std::clamp(1.55 - 0.35 * change.z() + 0.2 * bend.z(), 0.9, 2.4));
        }
        g.points = std::move(points);
    }
}

/// Lobes swell between what has a name: ridges carry knobs, the sides are a little uneven.
void undulate(Spec& spec, std::uint64_t seed) {
    Draws draws(seed, false);
    const auto knob = [&](const Vec3& at, const Vec3& radii, double depth) {
        spec.hollows.push_back({at + 0.25 * Vec3(draws.normal(), draws.normal(), 0.0), radii, depth});
    };
    for (const Crest& c : spec.crests) {
        const double t = 0.45 + 0.2 * draws.uniform(), u = 1.0 - t;
        const Vec3 at = u * u * c.from + 2.0 * u * t * c.by + t * t * c.to;
        const double round = 1.1 + 0.5 * draws.uniform();
        if (c.isMarginal)
            knob(at, Vec3(round, round, 1.1), 0.16 * (draws.uniform() - 0.6));
        else if (!c.isRim && !spec.isEdge)
            knob(at, Vec3(round, round, 1.1), -(0.02 + 0.12 * draws.uniform()) * std::min(1.0, c.round * c.round));
    }
    const Sizes& z = spec.sizes;
    if (spec.cusps.size() >= 4)  // each cusp is a lobe of the outline too
        for (const Cusp& c : spec.cusps)
            knob(Vec3(1.3 * c.tip.x(), 1.45 * c.tip.y(), (0.5 + 0.08 * draws.uniform()) * z.crown), Vec3(2.1, 2.1, 2.9),
                 -(0.08 + 0.2 * draws.uniform()));
    constexpr int kSides = 5;
    for (int i = 0; i < kSides; ++i) {
        const double turn = 2.0 * std::numbers::pi * (i + 0.5 * draws.uniform()) / kSides;
        knob(Vec3(0.5 * z.mesiodistal * core::cos(turn), 0.5 * z.buccolingual * core::sin(turn),
                  z.crown * (0.35 + 0.3 * draws.uniform())),
             Vec3(2.2, 2.2, 2.4), 0.14 * (draws.uniform() - 0.5));
    }
}

/// No two molars have one outline: rhombic or square, round or angular, straight or bellied.
void outline(Spec& spec, Draws& draws) {
    spec.skew += 0.05 * draws.normal(), spec.lean += 0.025 * draws.normal(), spec.wedge += 0.025 * draws.normal();
    spec.contourSquare += 0.05 * draws.normal(), spec.rimSquare += 0.07 * draws.normal();
    for (Outline* o : {&spec.mesial, &spec.distal, &spec.buccal, &spec.lingual}) {
        o->belly += 0.03 * draws.normal(), o->contourZ += 0.08 * draws.normal();
        o->rim *= 1.0 + 0.015 * draws.normal(), o->top *= 1.0 + 0.03 * draws.normal();
    }
}

/// Lesser ridges branch from the triangular ones down into the fossae; supplemental grooves are the valleys between.
void branch(Spec& spec, std::uint64_t seed) {
    Draws draws(seed, false);
    const std::size_t count = spec.crests.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Crest main = spec.crests[i];
        if (!main.name.starts_with("triangular")) continue;
        const Vec3 way = main.to - main.from;
        const double length = way.head<2>().norm();
        const Vec3 aside = Vec3(-way.y(), way.x(), 0.0) / length;
        for (const double side : {1.0, -1.0}) {
            const double t = 0.12 + 0.3 * draws.uniform(), u = 1.0 - t, far = 0.55 + 0.3 * draws.uniform(),
                         out = (0.38 + 0.22 * draws.uniform()) * length, bow = 0.25 * draws.normal(),
                         low = 0.1 + 0.25 * draws.uniform(), round = 0.3 + 0.35 * draws.uniform();
            if (draws.uniform() < 0.2) continue;
            const Vec3 from = u * u * main.from + 2.0 * u * t * main.by + t * t * main.to - Vec3(0, 0, 0.12);
            Vec3 to = main.from + far * way + side * out * aside;
            to.z() = main.to.z() + low;
            Vec3 by = 0.5 * (from + to) + side * bow * aside;
            by.z() += 0.1 * (from.z() - to.z());
            spec.crests.push_back({from, by, to, round, 1.1});
        }
    }
}

/// Antagonists grind planes onto the cusps, as the years pass.
void addFacets(Spec& spec, std::uint64_t seed, double ageYears) {
    if (spec.isEdge) return;
    Draws draws(seed, false);
    const double years = std::max(ageYears - 25.0, 0.0);  // before, they are hardly seen
    for (const Cusp& c : spec.cusps) {
        const double depth = 0.004 * years * (0.3 + 0.9 * draws.uniform());
        const double side = (c.tip.y() < 0.0 ? -1.0 : 1.0) * (draws.uniform() < 0.5 ? -1.0 : 1.0);
        const double along = 0.8 * (draws.uniform() - 0.5), aside = side * (0.15 + 0.45 * draws.uniform());
        if (depth > 0.0) spec.facets.push_back({core::Vec2(c.tip.x() + along, c.tip.y() + aside), depth});
    }
}

/// What all crowns of a mouth share, a standard deviation, and what the clipping of draws takes from spreads.
constexpr double kMouth = 0.045, kClipped = 1.04;

/// How tall a crown is, a share of the mean: as large as the mouth's teeth are, as tall as its crowns are for their
/// widths, and the tooth's own. No draw is beyond 2, their sum no farther than two of its own standard deviations.
double tallness(double mouthsSize, Draws& mouth, Draws& tooth) {
    constexpr double kMouthsTallness = 0.07, kOwn = 0.055, kMost = 0.2;
    const double tall = 1.0 + kClipped * kMouthsTallness * mouth.normal(), own = 1.0 + kClipped * kOwn * tooth.normal();
    return std::clamp(mouthsSize * tall * own, 1.0 - kMost, 1.0 + kMost);
}

Spec specFor(int fdi, const Patient& patient) {
    const bool upper = fdi < 30;
    Spec spec = specOf(upper, fdi % 10, patient);
    // Sizes of one mouth go together; each tooth has some play of its own.
    const bool isAverage = patient.seed == 0;
    Draws mouth(patient.seed, isAverage);
    Draws tooth(patient.seed * 1000003 + static_cast<std::uint64_t>(fdi % 10 + (upper ? 0 : 8)), isAverage);
    // Widths of two teeth of a mouth: r about 0.5; roots go their own way (docs/anatomy.md, Held against people).
    const double all = 1.0 + kClipped * kMouth * mouth.normal(), longer = 1.0 + 0.045 * mouth.normal();
    const auto ofItsOwn = [&](double spread) {
        return 1.0 + kClipped * std::sqrt(spread * spread - kMouth * kMouth) * tooth.normal();
    };
    const double x = all * ofItsOwn(spec.spreads.mesiodistal), y = all * ofItsOwn(spec.spreads.buccolingual);
    const double crown = tallness(all, mouth, tooth), root = longer * (1.0 + 0.04 * tooth.normal());
    scale(spec, x, y, crown, root);
    // No two mouths have the same wrinkles or the same bends of the roots; the average one has wrinkles too.
    const std::uint64_t own = patient.seed * 9176263 + static_cast<std::uint64_t>(fdi % 10 + (upper ? 0 : 8));
    wander(spec, Wander(own));
    undulate(spec, own + 1);
    // The first lower premolar has hardly a table; third molars are wrinkled as they are.
    if (!spec.isEdge && fdi % 10 != 8 && (upper || fdi % 10 != 4)) branch(spec, own + 2);
    spec.unevenSeed = own + 3, spec.uneven = spec.isEdge ? 0.02 : fdi % 10 >= 6 ? 0.045 : 0.03;
    if (fdi % 10 >= 6) outline(spec, tooth);
    for (Hollow& h : spec.hollows)
        h.depth *= 1.0 + 0.1 * tooth.normal();
    // Those of third molars stand so close that they would grow together.
    const double play = fdi % 10 == 8 ? 0.4 : 1.0;
    for (Root& r : spec.roots)
        r.middle.x() += 0.12 * play * tooth.normal(), r.apex.x() += 0.3 * play * tooth.normal(),
            r.apex.y() += 0.2 * play * tooth.normal();
    // Edges are rounded, ridges pass into each other: what is measured is brought to what is asked.
    const Sizes asked = spec.sizes;
    for (int i = 0; i < 2; ++i) {
        const Anatomy made(spec);
        const double wide = made.mesialContact.x() - made.distalContact.x(),
                     deep = made.lingualContour.y() - made.buccalContour.y();
        const Sizes before = spec.sizes;
        scale(spec, 1.0, 1.0, asked.crown / (made.highest.z() - made.buccalCervixZ()),
              asked.root / (made.buccalCervixZ() - made.lowest.z()));
        spec.sizes = before;
        spec.sizes.mesiodistal += asked.mesiodistal - wide, spec.sizes.buccolingual += asked.buccolingual - deep;
    }
    wear(spec, (fdi % 10 >= 6 ? 0.012 : 0.008) * std::max(patient.ageYears - 12.0, 0.0));
    addFacets(spec, own + 4, patient.ageYears);
    addPulp(spec, patient.ageYears);
    return spec;
}

}  // namespace

ToothForm::ToothForm(int fdi, const Patient& patient) : fdi_(fdi) {
    checkTooth(fdi, patient);
    // +x mesial and +z occlusal: +y is lingual in the lower right and upper left, buccal in the others.
    buccalSign_ = fdi / 10 == 1 || fdi / 10 == 3 ? 1 : -1;
    anatomy_ = std::make_shared<const Anatomy>(specFor(fdi, patient));
}

namespace {
/// Between the tooth's frame and that of anatomy.h, either way.
Vec3 turned(const Vec3& p, int buccalSign) {
    return {p.x(), -buccalSign * p.y(), p.z()};
}
}  // namespace

double ToothForm::outer(const Vec3& p) const {
    return anatomy_->outer(turned(p, buccalSign_));
}
double ToothForm::enamel(const Vec3& p) const {
    return anatomy_->enamel(turned(p, buccalSign_));
}
double ToothForm::dentine(const Vec3& p) const {
    return anatomy_->dentine(turned(p, buccalSign_));
}
double ToothForm::pulp(const Vec3& p) const {
    return anatomy_->pulp(turned(p, buccalSign_));
}
double ToothForm::cementum(const Vec3& p) const {
    return anatomy_->cementum(turned(p, buccalSign_));
}
double ToothForm::aboveCervix(const Vec3& p) const {
    return anatomy_->aboveCervix(turned(p, buccalSign_));
}
core::Box ToothForm::bounds() const {
    return anatomy_->bounds();
}
double ToothForm::crownHeightMm() const {
    return anatomy_->highest.z() - anatomy_->buccalCervixZ();
}
double ToothForm::rootLengthMm() const {
    return anatomy_->buccalCervixZ() - anatomy_->lowest.z();
}
double ToothForm::mesiodistalMm() const {
    return anatomy_->mesialContact.x() - anatomy_->distalContact.x();
}
double ToothForm::buccolingualMm() const {
    return anatomy_->lingualContour.y() - anatomy_->buccalContour.y();
}
Vec3 ToothForm::mesialContactMm() const {
    return turned(anatomy_->mesialContact, buccalSign_);
}
Vec3 ToothForm::distalContactMm() const {
    return turned(anatomy_->distalContact, buccalSign_);
}

std::vector<cases::Landmark> ToothForm::landmarks() const {
    std::vector<cases::Landmark> marks = landmarksOf(*anatomy_);
    for (cases::Landmark& mark : marks)
        for (Vec3& p : mark.pointsMm)
            p = turned(p, buccalSign_);
    return marks;
}

std::string toothName(int fdi) {
    static constexpr const char* kNames[] = {"central incisor", "lateral incisor", "canine",       "first premolar",
                                             "second premolar", "first molar",     "second molar", "third molar"};
    return fmt::format("{} {} {}", fdi < 30 ? "upper" : "lower", fdi / 10 == 1 || fdi / 10 == 4 ? "right" : "left",
                       kNames[fdi % 10 - 1]);
}

std::string toothKindName(int fdi) {
    std::string name = toothName(fdi);
    const std::size_t side = name.find(' ');
    name.erase(side, name.find(' ', side + 1) - side);
    std::replace(name.begin(), name.end(), ' ', '-');
    return name;
}

}  // namespace handpiece::dentition
