// SPDX-License-Identifier: Apache-2.0
// What stations show while somebody works at them, and who may look on. docs/school-live.md
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "handpiece/app/report/live_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "school/answers.h"
#include "school/jpeg.h"
#include "school/routes.h"
#include "school/visit.h"

namespace handpiece::school_server {

/// apps/web/live/live.js
extern const char* const kLiveScript;

namespace {

using config::words;
using httplib::Request;
using httplib::Response;
using school::Action;
using school::Milliseconds;

constexpr int kLeastSide = 32, kMostSide = 1280;
/// No picture waits longer at a station.
constexpr std::int64_t kMostAgeMs = 60'000;

[[noreturn]] void refusePicture(const std::string& why) {
    throw core::Error(why, "the station's picture", "use programs that belong together")
        .as("message-damaged", {"picture", why});
}

void requirePicture(const std::string& picture) {
    if (picture.size() > school_wire::kMostPicture) refusePicture("it is too long");
    const auto size = jpegSize(picture);
    if (!size) refusePicture("it is no JPEG");
    if (std::min(size->width, size->height) < kLeastSide || std::max(size->width, size->height) > kMostSide)
        refusePicture(fmt::format("it has {} by {} pixels", size->width, size->height));
}

/// Throws core::Error "live-private": nobody may watch this.
void admit(school::Books& books, LiveWork& shown, Milliseconds now) {
    const auto isPrivate = [](const char* why) {
        return core::Error(why, "", "work on what the class has to do, or share your practice").as("live-private");
    };
    const auto person = books.person(shown.live.person);
    if (!person || person->erased > 0) throw isPrivate("the school does not know this person");
    shown.personName = person->name;
    const auto isStudentOf = [&](const std::string& id) {
        const auto in = books.enrolments(id);
        return std::any_of(in.begin(), in.end(),
                           [&](const school::Enrolment& e) { return e.person == person->code && e.role == "student"; });
    };
    if (!shown.live.assignment.empty()) {
        const auto assignment = books.assignment(shown.live.assignment);
        if (!assignment || assignment->pack != shown.live.exerciseHash || now < assignment->opens ||
            now > assignment->closes || !isStudentOf(assignment->schoolClass))
            throw isPrivate("this is no work that the person's class has to do now");
        shown.live.title = assignment->title;
        shown.live.isShared = false;
        shown.classes = {assignment->schoolClass};
        return;
    }
    if (!shown.live.isShared) throw isPrivate("practice is private unless it is shared");
    for (const school::SchoolClass& one : books.classes())
        if (one.closed == 0 && isStudentOf(one.id)) shown.classes.push_back(one.id);
    if (shown.classes.empty()) throw isPrivate("the person is in no class");
}

std::string roleOf(const Visit& v) {
    const std::vector<school::Role> roles = rolesOf(v.person);
    return roles.empty() ? std::string() : std::string(school::nameOf(roles.front()));
}

/// As this person may see it.
report::LiveTile tileOf(const LiveWork& shown, bool seesName, Milliseconds now) {
    report::LiveTile tile;
    tile.station = shown.station, tile.stationName = shown.stationName;
    tile.person = seesName && !shown.personName.empty() ? shown.personName : shown.live.person;
    tile.exercise = shown.live.title;
    tile.elapsedS = shown.live.elapsedS, tile.removedMm3 = shown.live.removedMm3;
    tile.flags = shown.live.flags;
    tile.isShared = shown.live.isShared;
    tile.ageMs = now - shown.captured;
    tile.state = shown.state(now) == LiveWork::State::now    ? report::LiveTile::State::now
                 : shown.state(now) == LiveWork::State::late ? report::LiveTile::State::late
                                                             : report::LiveTile::State::gone;
    tile.sequence = shown.sequence;
    return tile;
}

/// One relation for all classes by which they may watch it.
school::Relation relationTo(const Visit& v, const LiveWork& shown) {
    school::Relation relation;
    for (const std::string& id : shown.classes) {
        relation = relationToClass(v, id);
        if (may(v, Action::watchStation, relation)) break;
    }
    return relation;
}

using Works = std::vector<std::shared_ptr<const LiveWork>>;

/// Who looks is told to the station, and each begin of it to the audit, before anything is shown.
void noteWatching(Service& of, const Visit& v, const Works& works, bool closely) {
    const school_wire::Watcher who{v.person.name.empty() ? v.person.code : v.person.name, roleOf(v)};
    for (const auto& one : works)
        if (of.live.watch(v.person.code, who, *one, closely, v.now))
            noteLook(v, "station watched", one->live.person, one->station);
}

/// Tiles as they are now; pictures that came after `since`.
Page feedOf(const Visit& v, const Works& works, bool seesNames, std::uint64_t since) {
    nlohmann::ordered_json tiles = nlohmann::ordered_json::array();
    std::string pictures;
    std::uint64_t latest = since;
    for (const auto& one : works) {
        const report::LiveTile tile = tileOf(*one, seesNames, v.now);
        std::vector<std::string> flags;
        for (const std::string& flag : tile.flags)
            flags.push_back(report::liveFlagWord(flag));
        const bool isNew = one->picture && one->sequence > since;
        if (isNew) pictures += *one->picture, latest = std::max(latest, one->sequence);
        tiles.push_back({{"station", tile.station},
                         {"who", tile.person},
                         {"state", report::nameOf(tile.state)},
                         {"figures", report::liveFigures(tile)},
                         {"flags", std::move(flags)},
                         {"sequence", one->sequence},
                         {"bytes", isNew ? one->picture->size() : std::size_t{0}}});
    }
    const std::string json = nlohmann::ordered_json{{"sequence", latest}, {"tiles", std::move(tiles)}}.dump(
        -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    Page page{200, school_wire::framed(json, pictures), {}, {}};
    page.type = "application/octet-stream";
    return page;
}

std::uint64_t sinceOf(const Request& request) {
    return request.has_param("since") ? numberOf(request, "since") : 0;
}

struct OfClass {
    school::Relation relation;
    bool mayWatch = false;
};
OfClass toClass(const Visit& v, const std::string& id) {
    OfClass of{relationToClass(v, id)};
    of.mayWatch = may(v, Action::watchStation, of.relation);
    return of;
}

/// Null: there is nothing, or nothing that they may see.
std::shared_ptr<const LiveWork> workAt(Service& of, const Visit& v, const std::string& station,
                                       school::Relation& relation) {
    auto work = of.live.of(station, v.now);
    if (!work) return nullptr;
    relation = relationTo(v, *work);
    return may(v, Action::watchStation, relation) ? work : nullptr;
}

Page classPage(Service& of, const Visit& v, const std::string& id) {
    const OfClass as = toClass(v, id);
    if (!as.mayWatch) return notYours();
    const Works works = of.live.inClass(id, v.now);
    noteWatching(of, v, works, false);
    std::vector<report::LiveTile> tiles;
    for (const auto& one : works)
        tiles.push_back(tileOf(*one, visibleIn(v, as.relation).whose, v.now));
    school::SchoolClass named{id};
    for (const school::SchoolClass& one : v.books.classes())
        if (one.id == id) named = one;
    Page page{200, report::liveClassPage(lookerOf(v), named, tiles), {}, {}};
    page.runsScript = true;
    return page;
}

Page stationPage(Service& of, const Visit& v, const std::string& station) {
    school::Relation relation;
    const auto work = workAt(of, v, station, relation);
    if (!work) return notYours();
    noteWatching(of, v, {work}, true);
    Page page{
        200,
        report::liveStationPage(lookerOf(v), tileOf(*work, visibleIn(v, relation).whose, v.now), work->classes.front()),
        {},
        {}};
    page.runsScript = true;
    return page;
}

}  // namespace

std::vector<Entry> liveRoutes(Service* of) {
    return {
        {"PUT", "/api/v1/live",
         StationHandler([of](const Request& request, Response& response, const school::Station& station) {
             LiveWork shown;
             const Milliseconds now = of->clock();
             try {
                 if (request.body.size() > school_wire::kMostPicture + 10'000) refusePicture("it is too long");
                 shown.live = school_wire::liveFrom(request.body);
                 requirePicture(shown.live.picture);
                 shown.station = station.id, shown.stationName = station.name;
                 requireActsFor(station, shown.live.person);
                 admit(*of->books.take(), shown, now);
             } catch (const core::Error&) {
                 of->live.end(station.id);  // what was there before is no longer so
                 throw;
             }
             shown.received = now;
             shown.captured = now - std::clamp<std::int64_t>(shown.live.ageMs, 0, kMostAgeMs);
             shown.picture = std::make_shared<const std::string>(std::move(shown.live.picture));
             shown.live.picture.clear();
             of->live.put(std::move(shown));
             answer(response, toJson(of->live.watched(station.id, now)));
         })},
        {"POST", "/api/v1/live/end",
         StationHandler([of](const Request&, Response& response, const school::Station& station) {
             of->live.end(station.id);
             answer(response, "{}");
         })},
        {"GET", "/attempts/([0-9a-f]{32})/review",
         Shown([of](const Request& request, const Visit& v) { return reviewOf(v, request.matches[1], of->reviews); })},
        {"GET", "/live.js", Handler([](const Request&, Response& response) {
             response.set_content(kLiveScript, "text/javascript; charset=utf-8");
         })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/live",
         Shown([of](const Request& request, const Visit& v) { return classPage(*of, v, request.matches[1]); })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/live/feed", Shown([of](const Request& request, const Visit& v) {
             const std::string id = request.matches[1];
             const OfClass as = toClass(v, id);
             if (!as.mayWatch) return notYours();
             const Works works = of->live.inClass(id, v.now);
             noteWatching(*of, v, works, false);
             return feedOf(v, works, visibleIn(v, as.relation).whose, sinceOf(request));
         })},
        {"GET", "/live/([0-9a-f]{32})",
         Shown([of](const Request& request, const Visit& v) { return stationPage(*of, v, request.matches[1]); })},
        {"GET", "/live/([0-9a-f]{32})/feed", Shown([of](const Request& request, const Visit& v) {
             school::Relation relation;
             const auto work = workAt(*of, v, request.matches[1], relation);
             if (!work) return notYours();
             noteWatching(*of, v, {work}, true);
             return feedOf(v, {work}, visibleIn(v, relation).whose, sinceOf(request));
         })},
        {"GET", "/live/([0-9a-f]{32})/picture", Shown([of](const Request& request, const Visit& v) {
             school::Relation relation;
             const auto work = workAt(*of, v, request.matches[1], relation);
             if (!work || !work->picture) return notYours();
             noteWatching(*of, v, {work}, false);
             Page page{200, *work->picture, {}, {}};
             page.type = "image/jpeg";
             return page;
         })},
    };
}

}  // namespace handpiece::school_server
