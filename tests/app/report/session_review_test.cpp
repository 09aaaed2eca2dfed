// SPDX-License-Identifier: Apache-2.0
// What a page gets of a session: unpacked here by a few lines of its own, held against the session played.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/app/report/review.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/tooth/state_file.h"
#include "support/closed_meshes.h"

namespace handpiece::report::session_review_test {
namespace {

using simulation::SessionPlayer;

struct Worked {
    Worked() : state(simulation::workThreeSeconds(folder.path() / "session.h5", folder.path() / "cut-off.h5")) {}
    test::TemporaryFolder folder;
    tooth::StateDelta state;
};
const Worked& worked() {
    static const Worked it;
    return it;
}

Review reviewAt(std::size_t threads, std::size_t mostBytes = kMostReviewBytes) {
    core::setThreadCount(threads);
    SessionPlayer player(worked().folder.path() / "session.h5", {false, false, {}});
    ReviewGatherer gatherer;
    gatherer.follow(player);
    (void)player.compareAll({}, {ReviewGatherer::stepS(), [&] { gatherer.look(); }});
    core::setThreadCount(0);
    return gatherer.review("</script><b>", {}, mostBytes);
}

struct Unpacked {
    explicit Unpacked(const Review& review) : text(nlohmann::json::parse(review.json)) {
        std::size_t size = 0;
        for (const auto& section : text["sections"])
            size += section["bytes"].get<std::size_t>();
        std::vector<std::uint8_t> all(size);
        uLongf got = static_cast<uLongf>(size);
        EXPECT_EQ(uncompress(all.data(), &got, reinterpret_cast<const Bytef*>(review.data.data()),
                             static_cast<uLong>(review.data.size())),
                  Z_OK);
        EXPECT_EQ(got, size);
        auto at = all.cbegin();
        for (const auto& section : text["sections"]) {
            const auto end = at + section["bytes"].get<std::ptrdiff_t>();
            sections[section["name"]] = std::vector<std::uint8_t>(at, end);
            at = end;
        }
        for (std::size_t k = 0; k < 3; ++k)
            nodes[k] = text["grid"]["nodes"][k];
        // Differences along all three axes are undone by sums along each.
        distance = sections["uncut"];
        const std::size_t step[3] = {1, nodes[0], nodes[0] * nodes[1]};
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < distance.size(); ++i)
                if (i / step[k] % nodes[k] > 0)
                    distance[i] = static_cast<std::uint8_t>(distance[i] + distance[i - step[k]]);
        uncut = distance;
    }
    /// Those until a time.
    void apply(double untilS = 1e9) {
        const std::size_t edge = text["grid"]["brickEdge"];
        const std::size_t bx = text["grid"]["bricks"][0], by = text["grid"]["bricks"][1];
        const std::vector<std::uint8_t>&ids = sections["bricks"], &changes = sections["changes"];
        const std::vector<double> times = text["keys"]["timesS"];
        std::size_t i = 0, from = 0, key = 0;
        distance = uncut;
        for (const std::size_t count : text["keys"]["bricks"].get<std::vector<std::size_t>>()) {
            if (times[key++] > untilS) return;
            std::size_t brick = 0;
            for (std::size_t n = 0; n < count; ++n, ++i) {
                brick += ids[3 * i] + 256u * ids[3 * i + 1] + 65536u * ids[3 * i + 2];
                for (std::size_t z = 0; z < edge; ++z)
                    for (std::size_t y = 0; y < edge; ++y)
                        for (std::size_t x = 0; x < edge; ++x, ++from) {
                            std::uint8_t& d = distance[brick % bx * edge + x +
                                                       nodes[0] * (brick / bx % by * edge + y +
                                                                   nodes[1] * (brick / bx / by * edge + z))];
                            d = static_cast<std::uint8_t>(d + changes[from]);
                        }
            }
        }
        EXPECT_EQ(from, changes.size());
    }

    nlohmann::json text;
    std::map<std::string, std::vector<std::uint8_t>> sections;
    std::size_t nodes[3] = {};
    std::vector<std::uint8_t> uncut, distance;
};

/// Every node of every brick, as the field has it in the state.
void expectTooth(const Unpacked& page, const tooth::ToothModel& model, const tooth::StateDelta& state) {
    const field::FieldView view = model.field.view();
    const std::size_t edge = page.text["grid"]["brickEdge"], stride = 8 / edge;
    const double voxelMm = page.text["grid"]["voxelMm"], steps = page.text["grid"]["stepsAVoxel"];
    EXPECT_DOUBLE_EQ(voxelMm, view.voxelMm * static_cast<double>(stride));
    std::size_t cut = 0, worst = 0;
    const auto bricks = static_cast<std::uint32_t>(view.bricks[0] * view.bricks[1] * view.bricks[2]);
    std::size_t next = 0;
    for (std::uint32_t dense = 0; dense < bricks; ++dense) {
        std::array<float, field::kBrickValues> values;
        model.uncutBrick(dense, values.data());
        while (next < state.bricks.size() && state.bricks[next].id < dense)
            ++next;
        if (next < state.bricks.size() && state.bricks[next].id == dense && !state.bricks[next].uncut)
            values = state.bricks[next].values;
        const auto brick = field::brickAt(view.bricks, dense);
        for (std::size_t z = 0; z < edge; ++z)
            for (std::size_t y = 0; y < edge; ++y)
                for (std::size_t x = 0; x < edge; ++x) {
                    const double exact = static_cast<double>(values[stride * (x + 9 * (y + 9 * z))]) / voxelMm * steps;
                    const std::size_t at =
                        static_cast<std::size_t>(brick[0]) * edge + x +
                        page.nodes[0] * (static_cast<std::size_t>(brick[1]) * edge + y +
                                         page.nodes[1] * (static_cast<std::size_t>(brick[2]) * edge + z));
                    const double got = page.distance[at] - 128.0;
                    worst += std::abs(got - std::clamp(exact, -127.0, 127.0)) > 0.5 + 1e-6;
                    cut += page.distance[at] != page.uncut[at];
                }
    }
    EXPECT_EQ(worst, 0u);
    EXPECT_GT(cut, 100u);
}

void expectEnd(const Unpacked& page) {
    const SessionPlayer player(worked().folder.path() / "session.h5", {false, false, {}});
    expectTooth(page, *player.station().tooth, worked().state);
}

TEST(SessionReview, EndsWithTheToothThatTheSessionLeaves) {
    Unpacked page(reviewAt(1));
    page.apply();
    expectEnd(page);
    EXPECT_GT(page.text["keys"]["timesS"].size(), 4u);
    EXPECT_EQ(page.text["burs"].size(), 2u);
    EXPECT_GE(page.text["strokes"].size(), 2u);
    // What lies anywhere in the grid has its name and colour.
    std::uint8_t tissue = 0;
    for (const std::uint8_t step : page.sections["tissue"]) {
        tissue = static_cast<std::uint8_t>(tissue + step);
        if (tissue == 0) continue;
        const auto& known = page.text["tissues"];
        ASSERT_TRUE(std::any_of(known.begin(), known.end(), [&](const auto& one) { return one["id"] == tissue; }))
            << int{tissue};
    }
}

TEST(SessionReview, IsTheSameAtAnyThreadCountAndHasNoMarkup) {
    const Review one = reviewAt(1), two = reviewAt(2);
    EXPECT_EQ(one.json, two.json);
    EXPECT_EQ(one.data, two.data);
    EXPECT_EQ(one.json.find('<'), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(one.json)["title"], "</script><b>");
    HtmlReport page("</title><script>alert(1)</script>");
    page.review(one);
    const std::string text = page.text();
    EXPECT_EQ(text.find("alert(1)</script>"), std::string::npos);
    EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
    EXPECT_NE(text.find("script-src 'sha256-"), std::string::npos);
    // Two blocks of data and the viewer.
    std::size_t scripts = 0;
    for (std::size_t at = text.find("<script"); at != std::string::npos; at = text.find("<script", at + 1))
        ++scripts;
    EXPECT_EQ(scripts, 3u);
}

TEST(SessionReview, ThatWouldBeTooLargeChangesInFewerSteps) {
    const Review whole = reviewAt(1);
    const std::size_t most = whole.data.size() - whole.data.size() / 8;
    Unpacked all(whole), fewer(reviewAt(1, most));
    EXPECT_LT(fewer.text["keys"]["timesS"].size(), all.text["keys"]["timesS"].size());
    EXPECT_EQ(fewer.text["keys"]["timesS"].back(), all.text["keys"]["timesS"].back());
    fewer.apply();
    expectEnd(fewer);
}

/// A session at the block, from a tooth on; saved on the way where that is asked.
tooth::StateDelta sit(const std::filesystem::path& file, const device::Motion& motion, const tooth::StateDelta& from,
                      double midS, double lastS, tooth::StateDelta* saved = nullptr) {
    simulation::SimulationSetup station = simulation::blockStation();
    simulation::LiveSessionSettings settings;
    settings.sessionFile = file;
    if (!from.bricks.empty()) station.resume(from);
    station.settings.resumed = !from.bricks.empty();
    const auto lead = std::make_shared<simulation::Lead>();
    simulation::LiveSession sitting(station, simulation::blockCase(), simulation::handOf(motion, lead), settings,
                                    nullptr);
    if (saved != nullptr) {
        EXPECT_TRUE(simulation::leadTo(sitting, *lead, midS));
        *saved = sitting.state();
    }
    EXPECT_TRUE(simulation::leadTo(sitting, *lead, lastS));
    sitting.stop();
    return sitting.state();
}

TEST(SessionReview, OfAChainPlaysAllSessionsInTheirOrderWithoutWhatWasGivenUp) {
    const test::TemporaryFolder folder;
    const auto first = folder.path() / "a.h5", second = folder.path() / "b.h5";
    tooth::StateDelta saved;
    const tooth::StateDelta givenUp = sit(first, simulation::twoHoles(), {}, 1.5, 3.1, &saved);
    const tooth::StateDelta end = sit(second, simulation::hole(0.5), saved, 0.0, 1.3);
    ASSERT_NE(tooth::stateHash(saved), tooth::stateHash(givenUp));
    SessionPlayer player(first, {false, false, {}});
    // The first key frame with the saved tooth.
    std::optional<std::uint64_t> until;
    for (std::size_t i = 0; i < player.reader().keyFrameTicks().size() && !until; ++i)
        if (const session::KeyFrame frame = player.reader().keyFrame(i);
            tooth::stateHash(tooth::decodeState(frame.state, player.station().teeth(), "a.h5")) ==
            tooth::stateHash(saved))
            until = frame.tick;
    ASSERT_TRUE(until);
    const std::vector<Reviewed> chain{{first, "a.h5", until}, {second, "b.h5"}};
    Unpacked page(reviewOf(chain, "both", {}, false));
    const double joinS = static_cast<double>(*until) / 1000.0;
    const double lengthS = joinS + SessionPlayer(second, {false, false, {}}).durationS();
    EXPECT_NEAR(page.text["durationS"].get<double>(), lengthS, 0.002);
    page.apply(joinS);
    expectTooth(page, *player.station().tooth, saved);
    page.apply();
    expectTooth(page, *player.station().tooth, end);
    // A stroke of each; the second of the first was given up.
    ASSERT_EQ(page.text["strokes"].size(), 2u);
    EXPECT_LT(page.text["strokes"][0][1].get<double>(), joinS + 0.001);
    EXPECT_GE(page.text["strokes"][1][0].get<double>(), joinS);
    const auto& moments = page.text["moments"];
    EXPECT_TRUE(std::any_of(moments.begin(), moments.end(), [&](const auto& one) {
        return one["text"].template get<std::string>().find("b.h5") != std::string::npos &&
               std::abs(one["timeS"].template get<double>() - joinS) < 0.002;
    }));
    // Another tooth is none of the chain.
    ReviewGatherer gatherer;
    gatherer.follow(player);
    const auto other = folder.path() / "c.h5";
    simulation::SimulationSettings finer = simulation::blockSettings();
    finer.field.voxelMm = 0.1;
    const simulation::SimulationSetup station = simulation::makeSimulation(simulation::blockCase(), finer, false);
    simulation::LiveSessionSettings settings;
    settings.sessionFile = other;
    const auto lead = std::make_shared<simulation::Lead>();
    simulation::LiveSession sitting(station, simulation::blockCase(), simulation::handOf(simulation::hole(0.0), lead),
                                    settings, nullptr);
    ASSERT_TRUE(simulation::leadTo(sitting, *lead, 1.2));
    sitting.stop();
    const SessionPlayer stranger(other, {false, false, {}});
    EXPECT_THROW(gatherer.follow(stranger, "c.h5"), core::Error);
}

TEST(SessionReview, ThatHasNoRoomSaysSoInItsPlace) {
    Review review = reviewAt(1, 1000);
    EXPECT_TRUE(review.data.empty());
    HtmlReport page("large");
    page.paragraph("before");
    page.reviewHere();
    page.paragraph("after");
    page.review(review);
    const std::string text = page.text();
    EXPECT_EQ(text.find("<script"), std::string::npos);
    const auto said = text.find("too large");
    EXPECT_LT(text.find("<p>before"), said);
    EXPECT_LT(said, text.find("<p>after"));
}

TEST(SessionReview, APageWithoutOneRunsNoScript) {
    HtmlReport page("plain");
    EXPECT_NE(page.text().find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(page.text().find("script"), std::string::npos);
}

/// Rows of three numbers, as differences, low bytes then high ones.
std::vector<std::array<std::uint32_t, 3>> threesOf(const std::vector<std::uint8_t>& bytes, std::size_t& at,
                                                   std::size_t count) {
    std::vector<std::array<std::uint32_t, 3>> threes(count);
    for (std::size_t k = 0; k < 3; ++k, at += 2 * count)
        for (std::size_t i = 0, sum = 0; i < count; ++i) {
            sum = (sum + bytes[at + i] + 256u * bytes[at + count + i]) % 65536u;
            threes[i][k] = static_cast<std::uint32_t>(sum);
        }
    return threes;
}

TEST(SessionReview, ShowsWhatStandsNearAsItIs) {
    cases::Case toothCase = simulation::blockCase();
    const core::Vec3 centre(5.0, 0.0, -1.0);
    const auto seen = [](const char* name, geometry::TriangleMesh mesh) {
        cases::Part part;
        part.name = name, part.tissue = cases::Tissue::gum, part.mesh = std::move(mesh);
        return part;
    };
    toothCase.scenery = {seen("far", test::sphereMesh(3, 2.0, {30.0, 0.0, 0.0})),
                         seen("near", test::sphereMesh(5, 2.0, centre)),
                         seen("reaching", test::sphereMesh(5, 6.0, {-9.0, 0.0, -1.0}))};
    const test::TemporaryFolder folder;
    const simulation::SimulationSetup station =
        simulation::makeSimulation(toothCase, simulation::blockSettings(), false);
    simulation::LiveSessionSettings live;
    live.sessionFile = folder.path() / "one.h5";
    const auto lead = std::make_shared<simulation::Lead>();
    simulation::LiveSession sitting(station, toothCase, simulation::handOf(simulation::twoHoles(), lead), live,
                                    nullptr);
    ASSERT_TRUE(simulation::leadTo(sitting, *lead, 0.8));
    sitting.stop();

    SessionPlayer player(live.sessionFile, {false, false, {}});
    ReviewGatherer gatherer;
    gatherer.follow(player);
    (void)player.compareAll({}, {ReviewGatherer::stepS(), [&] { gatherer.look(); }});
    Unpacked page(gatherer.review("around"));
    const nlohmann::json& around = page.text["around"];
    ASSERT_EQ(around["parts"].size(), 2u);
    EXPECT_EQ(around["parts"][0]["name"], "near");
    const std::vector<std::uint8_t>& bytes = page.sections["around"];
    std::size_t at = 0;
    std::vector<std::vector<core::Vec3>> placesMm;
    std::vector<double> volumesMm3;
    for (const nlohmann::json& part : around["parts"]) {
        placesMm.emplace_back();
        for (const auto& three : threesOf(bytes, at, part["vertices"])) {
            core::Vec3 mm;
            for (std::size_t k = 0; k < 3; ++k)
                mm[static_cast<Eigen::Index>(k)] =
                    around["lowMm"][k].get<double>() + around["stepMm"].get<double>() * three[k];
            placesMm.back().push_back(mm);
        }
        double volume = 0.0;
        for (const auto& t : threesOf(bytes, at, part["triangles"]))
            volume += placesMm.back().at(t[0]).dot(placesMm.back().at(t[1]).cross(placesMm.back().at(t[2]))) / 6.0;
        volumesMm3.push_back(volume);
    }
    EXPECT_EQ(at, bytes.size());
    // Closed and the right way out as before; every place near the sphere, and as many as it takes to show it.
    EXPECT_NEAR(volumesMm3[0], 4.0 / 3.0 * M_PI * 8.0, 0.05 * 4.0 / 3.0 * M_PI * 8.0);
    for (const core::Vec3& p : placesMm[0])
        EXPECT_NEAR((p - centre).norm(), 2.0, 0.05);
    EXPECT_GT(placesMm[0].size(), 300u);
    EXPECT_LT(placesMm[0].size(), toothCase.scenery[1].mesh.vertices.size() / 4);
    // Of the large one what lies within 6 mm of the block alone.
    EXPECT_GT(placesMm[1].size(), 300u);
    for (const core::Vec3& p : placesMm[1])
        EXPECT_GT(p.x(), -2.0 - 6.0 - 0.2);
    EXPECT_EQ(page.text["notes"].size(), 1u);
}

}  // namespace
}  // namespace handpiece::report::session_review_test
