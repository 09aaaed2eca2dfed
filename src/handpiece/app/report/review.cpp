// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "handpiece/app/report/advice.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/place_section.h"
#include "handpiece/app/report/review_gather.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::report {
namespace {

using config::words;
using core::Vec3;
using Json = nlohmann::ordered_json;

/// Of the bytes there are, the share that pictures may have, and that poses may have.
constexpr double kPictureShare = 0.5, kPoseShare = 0.4;
constexpr double kPlaceStepMm = 0.002, kTurnStep = 1.0 / 32767.0, kForceStepN = 0.001, kDepthStepMm = 0.001;

std::uint16_t sixteenBits(double value, double step) {
    const double rounded = std::floor(value / step + 0.5);
    return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::clamp(rounded, -32767.0, 32767.0)));
}

double rounded(double value, double step) {
    return std::floor(value / step + 0.5) * step;
}

/// Both in one: of a brick in both the changes add up.
ChangedAt joined(const ChangedAt& first, const ChangedAt& second, std::size_t perBrick) {
    ChangedAt both;
    both.timeS = second.timeS;
    std::size_t i = 0, j = 0;
    const auto take = [&](const ChangedAt& key, std::size_t at) {
        both.changes.insert(both.changes.end(), key.changes.begin() + static_cast<std::ptrdiff_t>(at * perBrick),
                            key.changes.begin() + static_cast<std::ptrdiff_t>((at + 1) * perBrick));
    };
    while (i < first.bricks.size() || j < second.bricks.size()) {
        const bool isFirst =
            j == second.bricks.size() || (i < first.bricks.size() && first.bricks[i] <= second.bricks[j]);
        const bool isBoth = i < first.bricks.size() && j < second.bricks.size() && first.bricks[i] == second.bricks[j];
        both.bricks.push_back(isFirst ? first.bricks[i] : second.bricks[j]);
        take(isFirst ? first : second, isFirst ? i : j);
        if (isBoth)
            for (std::size_t n = 0; n < perBrick; ++n) {
                std::uint8_t& sum = both.changes[both.changes.size() - perBrick + n];
                sum = static_cast<std::uint8_t>(sum + second.changes[j * perBrick + n]);
            }
        i += isFirst;
        j += !isFirst || isBoth;
    }
    return both;
}

Json threeOf(const Vec3& p) {
    return Json::array({rounded(p.x(), 0.001), rounded(p.y(), 0.001), rounded(p.z(), 0.001)});
}

std::string hexOf(const std::array<std::uint8_t, 3>& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

Json burOf(double fromS, const instrument::Bur& bur) {
    Json outline = Json::array();
    for (const instrument::SurfaceRing& ring : bur.rings())
        outline.push_back(Json::array({rounded(ring.rhoMm, 0.001), rounded(ring.zMm, 0.001)}));
    return {{"fromS", rounded(fromS, 0.001)}, {"name", bur.name()}, {"outlineMm", std::move(outline)}};
}

/// What was lost because the work is not done, then the criteria, the dearest first.
Json errorsOf(const ReviewedAgainst& against, std::span<const Sitting> sittings) {
    Json errors = Json::array();
    const Bearings bearings = against.task ? bearingsOf(*against.task) : Bearings{};
    const score::Assessment& a = against.result->assessment;
    const auto lead = [&](Json& error, const std::vector<measures::Evidence>& evidence) {
        for (const measures::Evidence& e : evidence) {
            if (e.placeMm && !error.contains("placeMm")) error["placeMm"] = threeOf(*e.placeMm);
            if (e.timeS && !error.contains("timeS") && e.session < sittings.size() &&
                *e.timeS <= sittings[e.session].lengthS + 0.001)
                error["timeS"] = rounded(sittings[e.session].fromS + *e.timeS, 0.001);
        }
    };
    const auto lost = [](double points) { return words()("assessment.points-lost", fmt::format("{:.1f}", points)); };
    if (costsUndone(a)) {
        const score::Completeness& c = *a.completeness;
        Json error{{"title", words().text("assessment.not-finished")},
                   {"lost", lost(a.lostUndone())},
                   {"measured", fmt::format("{:.1f} ± {:.1f} {}", *c.value, c.uncertainty, c.unit)},
                   {"practise", std::string()}};
        lead(error, c.evidence);
        errors.push_back(std::move(error));
    }
    for (const std::size_t i : costliest(a)) {
        const score::CriterionScore& c = a.criteria[i];
        Json error{{"title", criterionTitle(*against.rubric, c.id)},
                   {"lost", c.critical == score::Verdict::yes ? words().text("rubric.critical")
                                                              : lost(c.maxPoints - c.ownPoints)},
                   {"measured", c.value ? valueOf(c) : report::said(c.reason)}};
        const Advice advice = adviceOf(c, *against.rubric, bearings);
        error["practise"] = advice.words;
        if (advice.at != nullptr) lead(error, {*advice.at});
        lead(error, c.evidence);
        errors.push_back(std::move(error));
    }
    return errors;
}

/// The last stays.
template <class T>
std::vector<T> everyOther(std::vector<T> all) {
    std::vector<T> fewer;
    for (std::size_t i = 0; i < all.size(); ++i)
        if ((all.size() - 1 - i) % 2 == 0) fewer.push_back(std::move(all[i]));
    return fewer;
}

/// Columns of threes as rows, part by part.
std::vector<std::uint8_t> aroundBytes(const Around& around) {
    std::vector<std::uint8_t> all;
    for (const AroundPart& part : around.parts)
        for (const auto* threes : {&part.vertices, &part.triangles}) {
            std::vector<std::vector<std::uint16_t>> rows(3);
            for (const std::array<std::uint16_t, 3>& three : *threes)
                for (std::size_t k = 0; k < 3; ++k)
                    rows[k].push_back(three[k]);
            const std::vector<std::uint8_t> planes = planesOf(rows);
            all.insert(all.end(), planes.begin(), planes.end());
        }
    return all;
}

std::vector<std::uint8_t> posedOf(const std::vector<Pose>& all, const tooth::ToothModel& model) {
    std::vector<double> tipMm(all.size());
    core::parallelFor(all.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            tipMm[i] = -model.tree.signedDistance(all[i].placeMm);
    });
    std::vector<std::vector<std::uint16_t>> rows(9);
    double beforeMs = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Pose& p = all[i];
        // Of the rounded times, so that they do not run off.
        const double ms = std::min(std::floor(p.timeS * 1000.0 + 0.5), beforeMs + 65535.0);
        rows[0].push_back(static_cast<std::uint16_t>(ms - beforeMs));
        beforeMs = ms;
        for (std::size_t k = 0; k < 3; ++k)
            rows[1 + k].push_back(sixteenBits(p.placeMm[static_cast<Eigen::Index>(k)], kPlaceStepMm));
        for (std::size_t k = 0; k < 4; ++k)
            rows[4 + k].push_back(sixteenBits(p.turn[k], kTurnStep));
        rows[8].push_back(sixteenBits(std::max(tipMm[i], -1.0), kDepthStepMm));
    }
    return planesOf(rows);
}

/// What stands for the whole tooth's distances in those to the ideal.
std::array<std::uint8_t, 256> wholeAsIdeal(const PageGrid& grid) {
    std::array<std::uint8_t, 256> whole{};
    for (int i = 0; i < 256; ++i)
        whole[static_cast<std::size_t>(i)] =
            eightBits((i - kMiddle) / kStepsAVoxel * grid.voxelMm(), kMost / kDeviationMostMm);
    return whole;
}

/// How far places lie from the ideal tooth, positive where tissue should be gone: less (modulo 256) what
/// wholeAsIdeal() says, which is nothing away from all that was cut or is to be.
Volume idealOf(const tasks::Task& task, const Gathered& seen) {
    const PageGrid& grid = *seen.grid;
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    const zones::Zones& zones = *laid.zones;
    const Vec3 around = Vec3::Constant(kDeviationMostMm + 2.0 * grid.voxelMm());
    const Vec3 low = zones.box().min - around, high = zones.box().max + around;
    const auto whole = wholeAsIdeal(grid);
    Volume ideal;
    ideal.nodes = grid.nodes;
    ideal.values.resize(seen.uncut.values.size());
    core::parallelFor(grid.bricks(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const bool isCut = b < seen.everChanged.size() && seen.everChanged[b];
            grid.eachNode(static_cast<std::uint32_t>(b), [&](int x, int y, int z, std::size_t) {
                const std::size_t at = seen.uncut.index(x, y, z);
                const Vec3 p = grid.placeMm(x, y, z);
                const bool isNear = isCut || ((p.array() >= low.array()).all() && (p.array() <= high.array()).all());
                // Far outside nothing is ever asked.
                if (!isNear || seen.uncut.values[at] == kMiddle + kMost) return;
                ideal.values[at] = static_cast<std::uint8_t>(
                    eightBits(toIdealMm(zones, seen.model->tree, p), kMost / kDeviationMostMm) -
                    whole[seen.uncut.values[at]]);
            });
        }
    });
    return ideal;
}
/// What is said and drawn beside the arrays.
Json headOf(const Gathered& seen, const std::string& title) {
    const field::FieldView& view = seen.grid->view;
    Json json{{"format", "handpiece-review"}, {"version", 2}, {"language", words().language()}, {"title", title}};
    Json said = Json::object();
    for (const auto& [id, text] : words().texts())
        if (id.rfind("review.", 0) == 0 && id.rfind("review.event-", 0) != 0) said[id.substr(7)] = text;
    json["words"] = std::move(said);
    json["durationS"] = rounded(seen.durationS(), 0.001);
    json["buccalSign"] = seen.buccalSign;
    json["isUpper"] = seen.isUpper;
    json["notes"] = seen.notes;
    json["grid"] = {{"originMm", Json::array({view.originMm[0], view.originMm[1], view.originMm[2]})},
                    {"voxelMm", seen.grid->voxelMm()},
                    {"nodes", seen.grid->nodes},
                    {"bricks", Json::array({view.bricks[0], view.bricks[1], view.bricks[2]})},
                    {"brickEdge", seen.grid->edge},
                    {"stepsAVoxel", kStepsAVoxel}};
    Json tissues = Json::array();
    for (const view::LegendEntry& entry : view::legendOf(seen.model->tissues.tissues(), view::Palette::textbook))
        tissues.push_back(
            {{"id", static_cast<int>(entry.tissue)}, {"name", nameOf(entry.tissue)}, {"colour", hexOf(entry.colour)}});
    json["tissues"] = std::move(tissues);
    json["around"] = {{"lowMm", threeOf(seen.around.lowMm)}, {"stepMm", Around::kStepMm}, {"parts", Json::array()}};
    for (const AroundPart& part : seen.around.parts)
        json["around"]["parts"].push_back({{"name", part.name},
                                           {"colour", hexOf(view::colourOf(part.tissue, view::Palette::textbook))},
                                           {"vertices", part.vertices.size()},
                                           {"triangles", part.triangles.size()}});
    json["burs"] = Json::array();
    for (const auto& [fromS, bur] : seen.burs)
        json["burs"].push_back(burOf(fromS, *bur));
    json["strokes"] = Json::array();
    for (const Stroke& stroke : seen.strokes)
        json["strokes"].push_back(Json::array({rounded(stroke.fromS, 0.001), rounded(stroke.toS, 0.001)}));
    json["moments"] = Json::array();
    for (const Moment& moment : seen.moments)
        json["moments"].push_back({{"timeS", rounded(moment.timeS, 0.001)}, {"text", moment.text}});
    return json;
}

Json scaleOfDeviation() {
    Json scale = Json::array();
    constexpr int kSteps = 33;
    for (int i = 0; i < kSteps; ++i)
        scale.push_back(
            hexOf(view::deviationColour((2.0 * i / (kSteps - 1) - 1.0) * kDeviationMostMm, kDeviationMostMm)));
    return scale;
}

std::size_t bytesOf(const std::vector<Review::Picture>& pictures) {
    std::size_t all = 0;
    for (const Review::Picture& picture : pictures)
        all += picture.png.size();
    return all;
}

std::vector<std::uint8_t> curvesOf(const Gathered& seen) {
    std::vector<std::vector<std::uint16_t>> curves(2);
    const double durationS = std::max(seen.durationS(), 1e-9);
    for (const simulation::PlotPoint& p : seen.points) {
        curves[0].push_back(static_cast<std::uint16_t>(std::clamp(p.timeS / durationS, 0.0, 1.0) * 65535.0 + 0.5));
        curves[1].push_back(sixteenBits(static_cast<double>(p.forceN), kForceStepN));
    }
    return planesOf(curves);
}

/// Every two as one.
std::vector<ChangedAt> inPairs(std::vector<ChangedAt> keys, std::size_t perBrick) {
    std::vector<ChangedAt> fewer;
    for (std::size_t i = 0; i < keys.size(); i += 2)
        fewer.push_back(i + 1 < keys.size() ? joined(keys[i], keys[i + 1], perBrick) : std::move(keys[i]));
    return fewer;
}

/// Numbers of the bricks that change, of each key as differences of 24 bits.
std::vector<std::uint8_t> bricksOf(const std::vector<ChangedAt>& keys) {
    std::vector<std::uint8_t> ids;
    for (const ChangedAt& key : keys) {
        std::uint32_t before = 0;
        for (const std::uint32_t brick : key.bricks) {
            for (int shift = 0; shift < 24; shift += 8)
                ids.push_back(static_cast<std::uint8_t>((brick - before) >> shift));
            before = brick;
        }
    }
    return ids;
}

/// As a script's text may stand in a page.
std::string withoutTags(const Json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    return text;
}

}  // namespace

Review ReviewGatherer::review(const std::string& title, const ReviewedAgainst& against, std::size_t mostBytes) const {
    const Gathered& seen = *gathered_;
    Json json = headOf(seen, title);
    if (against.result != nullptr && against.rubric != nullptr) json["errors"] = errorsOf(against, seen.sittings);

    std::vector<std::uint8_t> ideal;
    if (against.task != nullptr && against.task->preparation) {
        if (cases::caseKey(against.task->toothCase) != seen.caseKey)
            throw core::Error("this is work on another tooth than the exercise's", against.task->id,
                              "name the exercise that it was made in");
        ideal = differencesOf(idealOf(*against.task, seen));
        json["deviation"] = {
            {"mostMm", kDeviationMostMm}, {"scale", scaleOfDeviation()}, {"whole", wholeAsIdeal(*seen.grid)}};
    }

    Review review;
    review.pictures = seen.pictures;
    while (!review.pictures.empty() &&
           static_cast<double>(bytesOf(review.pictures)) > kPictureShare * static_cast<double>(mostBytes))
        review.pictures = everyOther(std::move(review.pictures));
    mostBytes -= std::min(mostBytes, bytesOf(review.pictures));

    std::vector<Pose> poses = seen.poses;
    std::vector<std::uint8_t> posed = posedOf(poses, *seen.model);
    while (poses.size() > 2 &&
           static_cast<double>(compressed({{&posed}}).size()) > kPoseShare * static_cast<double>(mostBytes)) {
        poses = everyOther(std::move(poses));
        posed = posedOf(poses, *seen.model);
    }
    json["poses"] = poses.size();
    json["curvePoints"] = seen.points.size();

    const std::vector<std::uint8_t> uncut = differencesOf(seen.uncut), tissue = stepsOf(seen.tissue.values),
                                    curved = curvesOf(seen), around = aroundBytes(seen.around);
    for (std::vector<ChangedAt> keys = seen.keys;; keys = inPairs(std::move(keys), seen.grid->perBrick())) {
        const std::vector<std::uint8_t> bricks = bricksOf(keys);
        std::vector<std::uint8_t> changes;
        json["keys"] = {{"timesS", Json::array()}, {"bricks", Json::array()}};
        for (const ChangedAt& key : keys) {
            json["keys"]["timesS"].push_back(rounded(key.timeS, 0.001));
            json["keys"]["bricks"].push_back(key.bricks.size());
            changes.insert(changes.end(), key.changes.begin(), key.changes.end());
        }
        json["sections"] = Json::array();
        std::vector<const std::vector<std::uint8_t>*> all;
        const auto add = [&](const char* name, const std::vector<std::uint8_t>& bytes) {
            json["sections"].push_back({{"name", name}, {"bytes", bytes.size()}});
            all.push_back(&bytes);
        };
        add("uncut", uncut);
        add("tissue", tissue);
        add("ideal", ideal);
        add("around", around);
        add("poses", posed);
        add("curves", curved);
        add("bricks", bricks);
        add("changes", changes);
        review.data = compressed(all);
        if (review.data.size() <= mostBytes) break;
        if (keys.size() <= 2) {
            review.data.clear();
            break;
        }
    }
    review.json = withoutTags(json);
    return review;
}

Review reviewOf(std::span<const Reviewed> chain, const std::string& title, const ReviewedAgainst& against,
                bool pictures, std::size_t mostBytes, const core::Progress& progress) {
    ReviewGatherer gatherer(
        pictures ? std::max<std::size_t>(2, kReviewPictures / std::max<std::size_t>(chain.size(), 1)) : 0,
        against.task);
    const auto share = [&](std::size_t i) { return static_cast<double>(i) / static_cast<double>(chain.size()); };
    for (std::size_t i = 0; i < chain.size(); ++i) {
        const Reviewed& one = chain[i];
        const core::Progress part = core::part(progress, share(i), share(i + 1));
        simulation::SessionPlayer player(one.path, {true, pictures, {}}, core::part(part, 0.0, 0.2));
        gatherer.follow(player, one.name, one.untilTick);
        const core::Progress playing = core::part(part, 0.2, 1.0);
        if (!one.untilTick) {
            (void)player.compareAll(playing, {ReviewGatherer::stepS(), [&] { gatherer.look(); }});
        } else {
            // Not a tick farther: the tooth is to be the one that was saved.
            const double endS = static_cast<double>(*one.untilTick) / player.reader().info().rateHz;
            gatherer.look();
            for (double timeS = ReviewGatherer::stepS(); timeS < endS + ReviewGatherer::stepS();
                 timeS += ReviewGatherer::stepS()) {
                player.advance(std::min(timeS, endS));
                gatherer.look();
                core::report(playing, std::min(1.0, timeS / endS));
            }
        }
    }
    if (against.result != nullptr && !against.result->identity.proven)
        gatherer.note(fmt::format("{}: {}", words().text("assessment.not-proven"), said(against.result->proof)));
    return gatherer.review(title, against, mostBytes);
}

}  // namespace handpiece::report
