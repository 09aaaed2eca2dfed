// SPDX-License-Identifier: Apache-2.0
// What stations show, over real HTTP: who may look on, what nobody sees, what is no picture, what is old, thirty at
// once; a station's own side; reviews of sessions.
#include <atomic>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/retention.h"
#include "school/housekeeper.h"
#include "school/jpeg.h"
#include "school/live_board.h"
#include "school/server/school_fixture.h"
#include "school/server/small_picture.h"
#include "school/station_service.h"
#include "school/worker.h"
#include "support/error_of.h"

namespace handpiece::school_server::live_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* kPassword = "a long enough one";

/// Somebody who is logged in.
class Looker {
  public:
    Looker(const std::string& address, const std::string& login) : http_(address) {
        const auto in = http_.Post("/login", httplib::Params{{"login", login}, {"password", kPassword}});
        EXPECT_TRUE(in && in->status == 303) << login;
        if (!in) return;
        const std::string set = in->get_header_value("Set-Cookie");
        headers_ = {{"Cookie", set.substr(0, set.find(';'))}};
    }
    httplib::Result get(const std::string& path) { return http_.Get(path, headers_); }
    int statusOf(const std::string& path) {
        const auto result = get(path);
        return result ? result->status : 0;
    }
    struct Feed {
        nlohmann::json json;
        std::map<std::string, std::string> pictures;  ///< by station
    };
    Feed feed(const std::string& path) {
        Feed feed;
        const auto result = get(path);
        EXPECT_TRUE(result && result->status == 200) << path;
        if (!result || result->status != 200) return feed;
        auto [json, rest] = school_wire::unframed(result->body);
        feed.json = nlohmann::json::parse(json);
        for (const auto& tile : feed.json["tiles"]) {
            const std::size_t bytes = tile["bytes"];
            if (bytes > 0) feed.pictures[tile["station"]] = rest.substr(0, bytes);
            rest.remove_prefix(bytes);
        }
        EXPECT_TRUE(rest.empty());
        return feed;
    }

  private:
    httplib::Client http_;
    httplib::Headers headers_;
};

class LiveTest : public SchoolTest {
  protected:
    void SetUp() override {
        SchoolTest::SetUp();
        Books open = books();
        const Act act{"server", 1};
        const std::string hash = school::hashOfPassword(kPassword);
        std::vector<school::Person> people;
        for (const auto& [code, name, role] :
             std::vector<std::tuple<const char*, const char*, const char*>>{{"t1", "Dr. <Sato>", "teacher"},
                                                                            {"t2", "Dr. Other", "teacher"},
                                                                            {"e1", "Examiner", "examiner"},
                                                                            {"a1", "Admin", "administrator"},
                                                                            {"s018", "Jun", "student"}})
            people.push_back({code, name, code, "", hash, {role}, 1, 0});
        open.add(people, act);
        open.setPassword("s017", hash, act);
        for (const char* id : {"c1", "c2"})
            open.add(school::SchoolClass{id, id, "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> in{{"c1", "s017", "student"},
                                                {"c1", "s018", "student"},
                                                {"c1", "t1", "teacher"},
                                                {"c1", "e1", "examiner"},
                                                {"c2", "t2", "teacher"}};
        open.enrol(in, act);
        exercise_ = rubric::hashText(tasks::contentHash(blockTask()));
        const std::string rubric = open.pack(exercise_)->rubric;
        open.add(
            school::Assignment{"as1", "c1", exercise_, rubric, "Block & hole", "practice", "", 1, 4'000'000'000'000},
            act);
        open.add(school::Assignment{"over", "c1", exercise_, rubric, "Over", "practice", "", 1, 2}, act);
    }
    [[nodiscard]] school_wire::Live live(char mark = 0) const {
        school_wire::Live live;
        live.person = "s017", live.assignment = "as1", live.exerciseHash = exercise_, live.title = "<own title>";
        live.elapsedS = 83.0, live.removedMm3 = 1.25;
        live.flags = {"pulp-exposed", "of a newer station"};
        live.ageMs = 40, live.picture = picture(mark);
        return live;
    }
    /// A station by its key, without all that it has besides.
    struct Station {
        explicit Station(const Enrolment& e) : id(e.station), http(e.server) {
            http.set_default_headers({{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + e.key}});
        }
        int put(const std::string& bytes, std::string* told = nullptr) {
            const auto result = http.Put("/api/v1/live", bytes, "application/octet-stream");
            if (result && told) *told = result->body;
            return result ? result->status : 0;
        }
        int put(const school_wire::Live& live, std::string* told = nullptr) { return put(toBytes(live), told); }
        std::string id;
        httplib::Client http;
    };
    std::string exercise_;
};

TEST_F(LiveTest, TeachersOfTheClassLookOnAndNobodyElse) {
    School school(data());
    const Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    Station station(enrolment);
    std::string told;
    ASSERT_EQ(station.put(live('a'), &told), 200) << told;
    EXPECT_THAT(school_wire::watchedFrom(told).by, IsEmpty());

    Looker teacher(school.address(), "t1");
    const auto page = teacher.get("/classes/c1/live");
    ASSERT_EQ(page->status, 200);
    EXPECT_THAT(page->body, AllOf(HasSubstr("Ida"), HasSubstr("chair 1"), HasSubstr("Block &amp; hole"),
                                  HasSubstr("pulp opened"), HasSubstr("/live/" + station.id), HasSubstr("<noscript>"),
                                  Not(HasSubstr("own title")), Not(HasSubstr("newer station"))));
    EXPECT_THAT(
        page->get_header_value("Content-Security-Policy"),
        AllOf(HasSubstr("default-src 'none'"), HasSubstr("script-src 'self'"), Not(HasSubstr("unsafe-inline' 's"))));
    const auto first = teacher.feed("/classes/c1/live/feed?since=0");
    ASSERT_THAT(first.json["tiles"], SizeIs(1));
    EXPECT_EQ(first.pictures.at(station.id), picture('a'));
    EXPECT_EQ(first.json["tiles"][0]["who"], "Ida");
    EXPECT_EQ(first.json["tiles"][0]["flags"], nlohmann::json({"pulp opened"}));
    // Pictures only when they are new.
    const std::string since = "?since=" + first.json["sequence"].dump();
    EXPECT_THAT(teacher.feed("/classes/c1/live/feed" + since).pictures, IsEmpty());
    ASSERT_EQ(station.put(live('b'), &told), 200);
    EXPECT_EQ(teacher.feed("/classes/c1/live/feed" + since).pictures.at(station.id), picture('b'));
    // The station hears who looks, and that it is not looked at alone.
    const school_wire::Watched watched = school_wire::watchedFrom(told);
    ASSERT_THAT(watched.by, SizeIs(1));
    EXPECT_EQ(watched.by[0].name, "Dr. <Sato>");
    EXPECT_EQ(watched.by[0].role, "teacher");
    EXPECT_FALSE(watched.closely);
    EXPECT_EQ(teacher.statusOf("/live/" + station.id), 200);
    EXPECT_EQ(teacher.feed("/live/" + station.id + "/feed").pictures.at(station.id), picture('b'));
    const auto one = teacher.get("/live/" + station.id + "/picture");
    EXPECT_EQ(one->body, picture('b'));
    EXPECT_EQ(one->get_header_value("Content-Type"), "image/jpeg");
    ASSERT_EQ(station.put(live('c'), &told), 200);
    EXPECT_TRUE(school_wire::watchedFrom(told).closely);
    // Its begin stands in the audit, not each look.
    const auto looks = books().audit(0, 1000, "s017");
    EXPECT_EQ(std::count_if(looks.begin(), looks.end(), [](const auto& l) { return l.what == "station watched"; }), 1);
    EXPECT_EQ(looks.back().who, "t1");

    for (const char* who : {"t2", "e1", "a1", "ida", "s018"}) {
        Looker other(school.address(), who);
        for (const std::string& path :
             {std::string("/classes/c1/live"), std::string("/classes/c1/live/feed"), "/live/" + station.id,
              "/live/" + station.id + "/feed", "/live/" + station.id + "/picture", "/live/" + std::string(32, '0')})
            EXPECT_EQ(other.statusOf(path), 403) << who << " " << path;
    }
    EXPECT_THAT(Looker(school.address(), "t2").feed("/classes/c2/live/feed").json["tiles"], SizeIs(0));
    // Over: nothing of it is left.
    EXPECT_EQ(station.http.Post("/api/v1/live/end", "{}", "application/json")->status, 200);
    EXPECT_THAT(teacher.feed("/classes/c1/live/feed").json["tiles"], SizeIs(0));
    EXPECT_EQ(teacher.statusOf("/live/" + station.id), 403);
}

TEST_F(LiveTest, PracticeIsPrivateUnlessItIsShared) {
    School school(data());
    Station station(school_station::enrol(school.address(), kCode, "s017"));
    Looker teacher(school.address(), "t1"), other(school.address(), "t2");
    const auto tiles = [&](Looker& who, const char* schoolClass) {
        return who.feed(std::string("/classes/") + schoolClass + "/live/feed").json["tiles"].size();
    };
    const auto refusedAs = [&](const std::function<void(school_wire::Live&)>& change) {
        EXPECT_EQ(station.put(live()), 200);
        EXPECT_EQ(tiles(teacher, "c1"), 1u);
        school_wire::Live one = live();
        change(one);
        std::string told;
        EXPECT_EQ(station.put(one, &told), 403);
        EXPECT_THAT(told, HasSubstr("live-private"));
        EXPECT_EQ(tiles(teacher, "c1"), 0u) << "what was shown before is no longer so";
    };
    refusedAs([](auto& l) { l.assignment.clear(); });
    refusedAs([](auto& l) { l.assignment = "over"; });
    refusedAs([](auto& l) { l.assignment = "as1' OR 1=1"; });
    refusedAs([](auto& l) { l.exerciseHash = "0123456789abcdef"; });
    refusedAs([](auto& l) { l.person = "t1"; });
    refusedAs([](auto& l) { l.person = "nobody"; });
    school_wire::Live shared = live('s');
    shared.assignment.clear(), shared.isShared = true;
    ASSERT_EQ(station.put(shared), 200);
    EXPECT_EQ(tiles(teacher, "c1"), 1u);
    EXPECT_EQ(tiles(other, "c2"), 0u);
    EXPECT_THAT(teacher.get("/classes/c1/live")->body, HasSubstr("(shared practice)"));
    // Who has left the class is watched no more.
    {
        Books open = books();
        open.leave("c1", "s017", {"server", 5});
    }
    EXPECT_EQ(station.put(shared), 403);
    EXPECT_EQ(station.put(live()), 403);
    EXPECT_EQ(tiles(teacher, "c1"), 0u);
}

TEST_F(LiveTest, WhatIsNoPictureIsRefused) {
    School school(data());
    Station station(school_station::enrol(school.address(), kCode, "s017"));
    Looker teacher(school.address(), "t1");
    std::string large = picture(), huge = picture();
    const std::size_t frame = large.find("\xFF\xC0");
    ASSERT_NE(frame, std::string::npos);
    large[frame + 5] = '\x10';  // 4096 and some rows
    huge.insert(2, std::string("\xFF\xFE\xFF\xFF", 4) + std::string(0xFFFD, 'x'));
    for (int i = 0; i < 4; ++i)
        huge.insert(2, huge.substr(2, 0x10001));
    const std::string whole = picture();
    const std::vector<std::string> junk{"",
                                        "no picture",
                                        std::string("\x89PNG\r\n\x1A\n") + std::string(500, 'x'),
                                        "<svg xmlns='http://www.w3.org/2000/svg'><script>alert(1)</script></svg>",
                                        whole.substr(0, whole.size() - 1),
                                        whole.substr(0, 40),
                                        whole.substr(0, 2) + "<html>" + whole.substr(2),
                                        large,
                                        huge};
    for (const std::string& one : junk) {
        ASSERT_EQ(station.put(live()), 200);
        school_wire::Live bad = live();
        bad.picture = one;
        std::string told;
        EXPECT_EQ(station.put(bad, &told), 400) << one.size();
        EXPECT_THAT(told, HasSubstr("message-damaged"));
        EXPECT_THAT(teacher.feed("/classes/c1/live/feed").pictures, IsEmpty()) << one.size();
    }
    for (const std::string& message :
         {std::string(), std::string("abc"), std::string("\xFF\xFF\xFF\xFF{}"), school_wire::framed("[]", picture()),
          school_wire::framed("{}", picture()), std::string(400'000, 'x')})
        EXPECT_EQ(station.put(message), 400) << message.size();
    // Too much for any message of the server's is not even read; and without a key nothing is.
    EXPECT_EQ(station.put(std::string(5 << 20, 'x')), 413);
    httplib::Client stranger(school.address());
    stranger.set_default_headers({{"Handpiece-Protocol", "1"}});
    EXPECT_EQ(stranger.Put("/api/v1/live", toBytes(live()), "application/octet-stream")->status, 401);
}

TEST(JpegHeader, IsReadOfAnyBytes) {
    const std::string whole = picture();
    const auto size = jpegSize(whole);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 48);
    EXPECT_EQ(size->height, 32);
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_FALSE(jpegSize(whole.substr(0, length))) << length;
    constexpr unsigned kSeed = 20261126;
    SCOPED_TRACE(kSeed);
    std::mt19937 chance(kSeed);
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        std::string changed = whole;
        for (unsigned k = chance() % 4 + 1; k > 0; --k)
            changed[chance() % changed.size()] = static_cast<char>(chance());
        const auto read = jpegSize(changed);
        if (read)
            EXPECT_TRUE(read->width > 0 && read->width < 65536 && read->height > 0 && read->height < 65536);
        else
            ++refused;
    }
    EXPECT_GT(refused, 1000);
}

TEST(LiveBoard, WhatIsOldIsGone) {
    LiveBoard board;
    const auto put = [&](const char* station, school::Milliseconds at) {
        LiveWork work;
        work.station = station, work.stationName = station, work.live.person = "s017";
        work.classes = {"c1"}, work.received = work.captured = at;
        work.picture = std::make_shared<const std::string>(picture());
        board.put(std::move(work));
    };
    put("one", 1000), put("two", 9000);
    {
        LiveBoard chairs;
        for (const char* name : {"chair 10", "chair 2", "chair"}) {
            LiveWork work;
            work.station = work.stationName = name, work.classes = {"c1"};
            chairs.put(std::move(work));
        }
        std::vector<std::string> names;
        for (const auto& one : chairs.inClass("c1", 0))
            names.push_back(one->stationName);
        EXPECT_EQ(names, (std::vector<std::string>{"chair", "chair 2", "chair 10"}));
    }
    const auto state = [&](school::Milliseconds now) { return board.of("one", now)->state(now); };
    EXPECT_EQ(state(1000), LiveWork::State::now);
    EXPECT_EQ(state(1000 + LiveBoard::kLateMs + 1), LiveWork::State::late);
    EXPECT_NE(board.of("one", 1000 + LiveBoard::kGoneMs)->picture, nullptr);
    EXPECT_EQ(state(1001 + LiveBoard::kGoneMs), LiveWork::State::gone);
    EXPECT_EQ(board.of("one", 1001 + LiveBoard::kGoneMs)->picture, nullptr) << "not kept any longer";
    EXPECT_NE(board.of("two", 1001 + LiveBoard::kGoneMs)->picture, nullptr);
    EXPECT_THAT(board.inClass("c1", 1001 + LiveBoard::kGoneMs), SizeIs(2));
    EXPECT_THAT(board.inClass("c1", 1001 + LiveBoard::kForgottenMs), SizeIs(1));
    EXPECT_EQ(board.of("one", 1001 + LiveBoard::kForgottenMs), nullptr);
    // Who looks, for as long as they ask; anew when another person sits there, or much later.
    LiveWork work;
    work.station = "two", work.live.person = "s017";
    EXPECT_TRUE(board.watch("t1", {"Dr.", "teacher"}, work, true, 10'000));
    EXPECT_FALSE(board.watch("t1", {"Dr.", "teacher"}, work, false, 11'000));
    EXPECT_TRUE(board.watched("two", 12'000).closely);
    EXPECT_FALSE(board.watched("two", 20'500).closely) << "the page of all, since";
    EXPECT_THAT(board.watched("two", 20'500).by, SizeIs(1));
    EXPECT_THAT(board.watched("two", 30'000).by, IsEmpty());
    EXPECT_THAT(board.watched("one", 12'000).by, IsEmpty());
    work.live.person = "s018";
    EXPECT_TRUE(board.watch("t1", {"Dr.", "teacher"}, work, false, 31'000));
    EXPECT_THAT(board.inClass("c1", 31'001 + LiveBoard::kForgottenMs), IsEmpty());
    EXPECT_TRUE(board.watch("t1", {"Dr.", "teacher"}, work, false, 31'001 + LiveBoard::kForgottenMs));
}

TEST_F(LiveTest, ThirtyStationsAtOnce) {
    constexpr int kStations = 30, kPictures = 20, kBrowsers = 4;
    std::vector<std::string> codes;
    {
        Books open = books();
        for (int i = 0; i < kStations; ++i)
            open.offerCode(codes.emplace_back(school::newStationCode()), fmt::format("chair {:02}", i),
                           4'000'000'000'000, {"server", 1});
    }
    School school(data());
    std::vector<std::unique_ptr<Station>> stations;
    for (int i = 0; i < kStations; ++i)
        stations.push_back(std::make_unique<Station>(
            school_station::enrol(school.address(), codes[static_cast<std::size_t>(i)], "s017")));
    std::atomic<int> failures{0};
    std::atomic<bool> ends{false};
    std::vector<std::thread> threads, browsers;
    for (int b = 0; b < kBrowsers; ++b)
        browsers.emplace_back([&] {
            Looker teacher(school.address(), "t1");
            std::uint64_t since = 0;
            std::map<std::string, char> last;
            while (!ends) {
                const auto feed = teacher.feed(fmt::format("/classes/c1/live/feed?since={}", since));
                since = feed.json["sequence"];
                for (const auto& [station, bytes] : feed.pictures) {
                    const char mark = bytes[6];
                    // Each station's own, whole, and never an older one after a newer.
                    if (bytes != picture(mark) || mark < last[station]) ++failures;
                    last[station] = mark;
                }
            }
        });
    for (auto& station : stations)
        threads.emplace_back([&] {
            for (int i = 0; i < kPictures; ++i)
                if (station->put(live(static_cast<char>('A' + i))) != 200) ++failures;
        });
    for (std::thread& thread : threads)
        thread.join();
    ends = true;
    for (std::thread& thread : browsers)
        thread.join();
    EXPECT_EQ(failures, 0);
    Looker teacher(school.address(), "t1");
    const auto feed = teacher.feed("/classes/c1/live/feed");
    EXPECT_THAT(feed.pictures, SizeIs(kStations));
    for (const auto& [station, bytes] : feed.pictures)
        EXPECT_EQ(bytes, picture('A' + kPictures - 1));
}

/// What a service tells, to be waited for.
class Told {
  public:
    void take(const school_station::Standing& standing) {
        const std::lock_guard lock(mutex_);
        last_ = standing;
    }
    [[nodiscard]] school_station::Standing last() const {
        const std::lock_guard lock(mutex_);
        return last_;
    }
    [[nodiscard]] bool comesTo(const std::function<bool(const school_station::Standing&)>& what) const {
        for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(10ms))
            if (what(last())) return true;
        return false;
    }

  private:
    mutable std::mutex mutex_;
    school_station::Standing last_;
};

TEST_F(LiveTest, AStationsOwnSideShowsAndPushesByItself) {
    auto school = std::make_unique<School>(data());
    const int port = school->port();
    Chair chair;
    const Enrolment enrolment = school_station::enrol(school->address(), kCode, "s017");
    school_station::writeEnrolment(enrolment, chair.home() / "school.json");
    const std::string first = chair.finish(session(), "one.h5");
    Told told;
    school_station::StationService service({chair.home(), chair.home() / "sessions"},
                                           [&](const auto& standing) { told.take(standing); });
    // What waited goes at the start.
    ASSERT_TRUE(told.comesTo([&](const auto& s) { return s.isConnected && s.waiting == 0 && !s.assigned.empty(); }));
    ASSERT_TRUE(told.comesTo([&](const auto&) { return books().attempt(first).has_value(); }));
    EXPECT_EQ(told.last().assigned, (std::vector<std::string>{exercise_})) << "not what is over";
    // What goes on is the class's as the server gave it to do, whatever the window says.
    school_wire::Live shown = live('x');
    shown.assignment = "nonsense", shown.person = "t1";
    Looker teacher(school->address(), "t1");
    service.show(shown);
    ASSERT_TRUE(told.comesTo([](const auto& s) { return s.isShown; }));
    EXPECT_EQ(teacher.feed("/classes/c1/live/feed").json["tiles"][0]["who"], "Ida");
    service.show(shown);
    EXPECT_TRUE(told.comesTo([](const auto& s) { return s.watchers.size() == 1; }));
    service.rest();
    EXPECT_TRUE(told.comesTo([](const auto& s) { return !s.isShown && s.watchers.empty(); }));
    EXPECT_THAT(teacher.feed("/classes/c1/live/feed").json["tiles"], SizeIs(0));
    // Practice is not shown.
    shown.exerciseHash = "0123456789abcdef";
    service.show(shown);
    EXPECT_TRUE(told.comesTo([](const auto& s) { return !s.trouble.empty(); }));
    EXPECT_FALSE(told.last().isShown);
    // Without the server all is kept, and goes when it is back.
    school.reset();
    const std::string second = chair.finish(session(), "two.h5");
    service.push();
    ASSERT_TRUE(told.comesTo([](const auto& s) { return !s.isConnected && s.waiting == 1; }));
    school = std::make_unique<School>(data(), 0, port);
    ASSERT_TRUE(told.comesTo([](const auto& s) { return s.isConnected && s.waiting == 0; }));
    EXPECT_TRUE(books().attempt(second));
}

TEST_F(LiveTest, AReviewIsMadeOnceForWhoMaySeeTheAttempt) {
    School school(data());
    Chair chair;
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    const std::string practice = chair.finish(session(), "one.h5");
    {  // its time is before the assignment's
        Books open = books();
        open.add(school::Assignment{"late", "c1", exercise_, open.pack(exercise_)->rubric, "Late", "practice", "",
                                    4'000'000'000'000, 4'000'000'000'001},
                 {"server", 1});
    }
    (void)chair.push(enrolment);
    ASSERT_EQ(books().attempt(practice)->assignment, "as1");
    Worker worker(worksOf({data(), databaseOf(data())}, systemClock()));
    while (worker.workOnce()) {
    }
    const std::string path = "/attempts/" + practice + "/review";
    Looker teacher(school.address(), "t1");
    EXPECT_THAT(teacher.get("/attempts/" + practice)->body, HasSubstr(path));
    httplib::Result page = teacher.get(path);
    ASSERT_EQ(page->status, 200);
    EXPECT_THAT(page->body, HasSubstr("id=\"again\""));
    EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("script-src 'self'"));
    for (int i = 0; i < 6000 && page->body.find("id=\"again\"") != std::string::npos; ++i) {
        std::this_thread::sleep_for(20ms);
        page = teacher.get(path);
    }
    ASSERT_EQ(page->status, 200);
    // Letters of data and pictures may spell anything.
    const std::string words = page->body.substr(0, page->body.find("id=\"review-data\""));
    EXPECT_THAT(words, AllOf(HasSubstr("review-text"), HasSubstr("/attempts/" + practice), HasSubstr("\"errors\""),
                             Not(HasSubstr("Ida")), Not(HasSubstr("s017"))));
    EXPECT_LT(words.size(), page->body.size());
    EXPECT_LT(page->body.size(), 3'000'000u);
    EXPECT_THAT(page->get_header_value("Content-Security-Policy"),
                AllOf(HasSubstr("script-src 'sha256-"), Not(HasSubstr("'self' data")), Not(HasSubstr("connect-src"))));
    // Kept: there at once, the same, and for the student as well.
    EXPECT_EQ(teacher.get(path)->body, page->body);
    EXPECT_EQ(Looker(school.address(), "ida").get(path)->body, page->body);
    EXPECT_EQ(Looker(school.address(), "e1").statusOf(path), 200) << "nobody's name is in it";
    for (const char* who : {"t2", "a1", "s018"})
        EXPECT_EQ(Looker(school.address(), who).statusOf(path), 403) << who;
    const auto looks = books().audit(0, 1000, "s017");
    EXPECT_GE(std::count_if(looks.begin(), looks.end(), [](const auto& l) { return l.what == "review seen"; }), 2);
    // What need not be kept any more goes, and its pages with it.
    const auto pages = [&] {
        return std::distance(fs::directory_iterator(data() / "reviews"), fs::directory_iterator());
    };
    ASSERT_EQ(pages(), 1);
    Service service({.data = data(), .database = databaseOf(data())}, systemClock());
    Housekeeper(service).round();
    EXPECT_EQ(pages(), 1) << "its attempt is there";
    {
        Books open = books();
        school::Retention(open).setForClass("c1", {1, 0}, {"server", 1});
    }
    Service later({.data = data(), .database = databaseOf(data())}, [] { return systemClock()() + 3 * 86'400'000; });
    Housekeeper(later).round();
    EXPECT_FALSE(books().attempt(practice));
    EXPECT_EQ(pages(), 0);
}

}  // namespace
}  // namespace handpiece::school_server::live_test
