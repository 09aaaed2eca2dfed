// SPDX-License-Identifier: Apache-2.0
// A double of the HD library of OpenHaptics, written from its documented names, values and order (not from the
// product's own declarations, so that a slip in either shows). Built as a shared library; the product loads it as it
// would the real one. It counts every breach of the documented order.
#include "devices/drivers/double_hd.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using Lock = std::unique_lock<std::recursive_mutex>;
using Seconds = std::chrono::duration<double>;

enum : unsigned {
    SUCCESS = 0,
    INVALID_ENUM = 0x0100,
    INVALID_VALUE = 0x0101,
    INVALID_OPERATION = 0x0102,
    BAD_HANDLE = 0x0104,
    EXCEEDED_MAX_FORCE = 0x0201,
    DEVICE_ALREADY_INITIATED = 0x0301,
    COMM_ERROR = 0x0302,
    ILLEGAL_BEGIN = 0x0400,
    ILLEGAL_END = 0x0401,
    FRAME_ERROR = 0x0402,
    CALIBRATION_OK = 0x5000,
    CALIBRATION_NEEDS_UPDATE = 0x5001,
    NO_DEVICE = 0xFFFFFFFF,
};

struct Key {
    double t = 0.0;
    std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0};
    unsigned buttons = 0;
};

struct FaultAt {
    std::string kind;
    double t = 0.0, lasts = 0.1;
    unsigned code = 0;
    bool done = false;
};

struct Device {
    std::string name, model = "Touch";
    bool open = false, unplugged = false, inFrame = false, framed = false, sprung = false;
    bool forceOutput = false, set = false;
    std::map<unsigned, bool> enabled{{0x4001, true}, {0x4002, true}, {0x4003, true}, {0x4004, true}};
    std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0}, goal{0, 0, 0, 1, 0, 0, 0};
    std::array<double, 3> velocity{}, wanted{}, wantedTorque{}, force{}, torque{};
    double ramp = 0.0, t = 0.0;
    unsigned buttons = 0, calibration = CALIBRATION_OK;
    int style = 4, inkwell = 0, safety = 1;
    double temperature = 0.1;
    unsigned errorCode = 0;
    int errorTimes = 0;
    bool errorAtEnd = false;
    double stallS = 0.0;
    unsigned long long count = 0;
    unsigned long job = 0;  // whose frame it was
    std::vector<Key> script;
    std::vector<FaultAt> faults;
    std::vector<std::array<double, 8>> log;

    [[nodiscard]] bool premium() const { return model.find("6DOF") != std::string::npos; }
    [[nodiscard]] double maxForce() const {
        return premium() ? 8.5 : model.find("Touch X") != std::string::npos ? 7.9 : 3.3;
    }
    [[nodiscard]] double stiffness() const { return model.find("Omni") != std::string::npos ? 0.7 : 0.4; }
};

struct Job {
    unsigned long id = 0;
    unsigned (*work)(void*) = nullptr;
    void* data = nullptr;
    unsigned short priority = 0;
};

struct World {
    std::recursive_mutex mutex;
    std::condition_variable_any news;
    std::deque<Device> devices;
    int current = -1;
    std::vector<Job> jobs;
    unsigned long nextJob = 1, running = 0;
    unsigned long rate = 1000;
    std::thread thread;
    std::thread::id servo;
    bool stopping = false, started = false, killed = false, wake = false;
    std::chrono::steady_clock::time_point tickBegan;
    unsigned breaches = 0, initError = 0;
    std::string lastBreach, licence;
};
// Never destroyed: a scheduler that was left running is then no crash of its own making.
World& world() {
    static World& one = *new World;
    return one;
}

struct ErrorInfo {
    unsigned code;
    int internal;
    unsigned device;
};
thread_local std::vector<ErrorInfo> errors;

void fail(unsigned code) {
    if (errors.size() < 32) errors.push_back({code, 0, static_cast<unsigned>(world().current)});
}
void breach(const std::string& what, unsigned code = SUCCESS) {
    World& w = world();
    ++w.breaches;
    w.lastBreach = what;
    if (code != SUCCESS) fail(code);
}
/// The current device, or a breach.
Device* current(const char* who) {
    World& w = world();
    if (w.current < 0 || static_cast<std::size_t>(w.current) >= w.devices.size() ||
        !w.devices[static_cast<std::size_t>(w.current)].open) {
        breach(std::string(who) + " without a device", BAD_HANDLE);
        return nullptr;
    }
    return &w.devices[static_cast<std::size_t>(w.current)];
}
Device* byHandle(unsigned handle, const char* who) {
    World& w = world();
    if (handle >= w.devices.size() || !w.devices[handle].open) {
        breach(std::string(who) + " with a bad handle", BAD_HANDLE);
        return nullptr;
    }
    return &w.devices[handle];
}
bool inFrame(Device& d, const char* who, unsigned parameter) {
    if (d.inFrame) return true;
    char text[80];
    std::snprintf(text, sizeof text, "%s(0x%04X) outside of a frame", who, parameter);
    breach(text, FRAME_ERROR);
    return false;
}

void complain(const std::string& what) {
    std::fprintf(stderr, "HD double: %s\n", what.c_str());
    std::abort();
}

std::vector<Key> readScript(const char* path) {
    std::ifstream in(path);
    if (!in) complain(std::string("cannot read ") + path);
    std::vector<Key> keys;
    std::string line;
    while (std::getline(in, line)) {
        if (line.empty() || line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0]))) continue;
        std::vector<double> v;
        std::stringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');)
            v.push_back(std::stod(cell));
        Key key;
        if (v.size() != 5 && v.size() != 9) complain("a line of the script has neither 5 nor 9 numbers: " + line);
        key.t = v[0];
        std::copy_n(v.begin() + 1, v.size() == 9 ? 7 : 3, key.pose.begin());
        key.buttons = static_cast<unsigned>(v.back());
        keys.push_back(key);
    }
    if (keys.empty()) complain("the script is empty");
    return keys;
}

std::vector<FaultAt> readFaults(const char* text) {
    std::vector<FaultAt> faults;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');) {
        const auto at = part.find('@');
        if (at == std::string::npos) complain("a fault without @: " + part);
        FaultAt f;
        f.kind = part.substr(0, at);
        const std::string rest = part.substr(at + 1);
        f.t = std::stod(rest);
        if (const auto colon = rest.find(':'); colon != std::string::npos) f.lasts = std::stod(rest.substr(colon + 1));
        if (const auto is = rest.find('='); is != std::string::npos)
            f.code = static_cast<unsigned>(std::stoul(rest.substr(is + 1), nullptr, 0));
        faults.push_back(f);
    }
    return faults;
}

void readEnvironment(Device& d) {
    if (const char* model = std::getenv("HANDPIECE_HD_DOUBLE_MODEL")) d.model = model;
    if (const char* script = std::getenv("HANDPIECE_HD_DOUBLE_SCRIPT")) {
        d.script = readScript(script);
        d.sprung = true;
        d.pose = d.goal = d.script.front().pose;
        d.t = 0.0;
    }
    if (const char* faults = std::getenv("HANDPIECE_HD_DOUBLE_FAULTS")) d.faults = readFaults(faults);
    if (std::getenv("HANDPIECE_HD_DOUBLE_LOG") != nullptr) d.log.reserve(600'000);
}

void writeLog(const Device& d) {
    const char* path = std::getenv("HANDPIECE_HD_DOUBLE_LOG");
    if (path == nullptr || d.log.empty()) return;
    std::FILE* out = std::fopen(path, "w");
    if (out == nullptr) return;
    std::fprintf(out, "# breaches %u %s\n", world().breaches, world().lastBreach.c_str());
    std::fputs("t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,buttons\n", out);
    for (const auto& row : d.log)
        std::fprintf(out, "%.4f,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f,%.0f\n", row[0], row[1], row[2], row[3], row[4], row[5],
                     row[6], row[7]);
    std::fclose(out);
}

void follow(Device& d) {
    if (d.script.empty()) return;
    const auto after = std::find_if(d.script.begin(), d.script.end(), [&](const Key& key) { return key.t > d.t; });
    if (after == d.script.begin() || after == d.script.end()) {
        const Key& key = after == d.script.begin() ? d.script.front() : d.script.back();
        d.goal = key.pose;
        d.buttons = key.buttons;
        return;
    }
    const Key &a = *(after - 1), &b = *after;
    const double s = (d.t - a.t) / (b.t - a.t);
    for (std::size_t i = 0; i < 7; ++i)
        d.goal[i] = a.pose[i] + s * (b.pose[i] - a.pose[i]);
    d.buttons = a.buttons;
}

/// One tick of the hand: 0.15 kg held by a spring of 0.5 N/mm that is damped by 0.7 of the critical.
void move(Device& d, double dt) {
    follow(d);
    const double norm =
        std::sqrt(d.goal[3] * d.goal[3] + d.goal[4] * d.goal[4] + d.goal[5] * d.goal[5] + d.goal[6] * d.goal[6]);
    for (std::size_t i = 3; i < 7; ++i)
        d.pose[i] = d.goal[i] / norm;
    if (!d.sprung) {
        std::copy_n(d.goal.begin(), 3, d.pose.begin());
        return;
    }
    const double mass = 0.15, k = 500.0, c = 0.7 * 2.0 * std::sqrt(k * mass);
    for (std::size_t i = 0; i < 3; ++i) {
        const double force = k * (d.goal[i] - d.pose[i]) * 1e-3 - c * d.velocity[i] + d.force[i];
        d.velocity[i] += force / mass * dt;
        d.pose[i] += d.velocity[i] * dt * 1e3;
    }
}

void misbehave(Device& d) {
    World& w = world();
    for (FaultAt& f : d.faults) {
        if (f.done || d.t < f.t) continue;
        f.done = true;
        if (f.kind == "unplug") d.unplugged = true;
        if (f.kind == "stall") d.stallS = f.lasts;
        if (f.kind == "kill") w.killed = true;
        if (f.kind == "error") {
            d.errorCode = f.code;
            d.errorTimes = 1;
        }
    }
}

void endOfTick(double dt) {
    World& w = world();
    for (Device& d : w.devices) {
        if (!d.open) continue;
        if (d.inFrame) {
            breach("a tick ended inside a frame", FRAME_ERROR);
            d.inFrame = false;
        }
        if (!d.framed || d.unplugged) d.force = d.torque = {};  // nobody set it in this tick: it is lost
        d.framed = false;
        move(d, dt);
        d.t += dt;
        misbehave(d);
        if (d.log.size() < d.log.capacity())
            d.log.push_back({d.t, d.pose[0], d.pose[1], d.pose[2], d.force[0], d.force[1], d.force[2],
                             static_cast<double>(d.buttons)});
    }
}

void letGo(World& w) {
    for (Device& d : w.devices)
        d.force = d.torque = {};
}

void schedule() {
    World& w = world();
    auto next = std::chrono::steady_clock::now();
    while (true) {
        std::vector<Job> jobs;
        double dt = 0.001;
        {
            const Lock lock(w.mutex);
            w.servo = std::this_thread::get_id();
            if (w.stopping || w.killed) break;
            jobs = w.jobs;
            dt = 1.0 / static_cast<double>(w.rate);
            w.tickBegan = std::chrono::steady_clock::now();
        }
        for (const Job& job : jobs) {
            {
                const Lock lock(w.mutex);
                if (std::none_of(w.jobs.begin(), w.jobs.end(), [&](const Job& j) { return j.id == job.id; })) continue;
                w.running = job.id;
            }
            const unsigned answer = job.work(job.data);
            const Lock lock(w.mutex);
            w.running = 0;
            if (!errors.empty()) {
                breach("a callback left errors on the stack");
                errors.clear();
            }
            if (answer == 0) std::erase_if(w.jobs, [&](const Job& j) { return j.id == job.id; });
        }
        {
            const Lock lock(w.mutex);
            endOfTick(dt);
            errors.clear();
        }
        next += std::chrono::duration_cast<std::chrono::steady_clock::duration>(Seconds(dt));
        const auto now = std::chrono::steady_clock::now();
        if (next < now) next = now;
        std::this_thread::sleep_until(next);
    }
    const Lock lock(w.mutex);
    letGo(w);
}

void multiply(const std::array<double, 7>& pose, double* m) {
    const double w = pose[3], x = pose[4], y = pose[5], z = pose[6];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
            m[4 * column + row] = r[3 * row + column];
        m[4 * column + 3] = 0.0;
        m[12 + column] = pose[static_cast<std::size_t>(column)];
    }
    m[15] = 1.0;
}

void errorOfFrame(Device& d, bool atEnd) {
    if (d.unplugged) fail(COMM_ERROR);
    if (d.errorTimes == 0 || d.errorAtEnd != atEnd) return;
    if (d.errorTimes > 0) --d.errorTimes;
    fail(d.errorCode);
}

template <class Work>
void with(int device, Work work) {
    World& w = world();
    const Lock lock(w.mutex);
    if (device >= 0 && static_cast<std::size_t>(device) < w.devices.size())
        work(w.devices[static_cast<std::size_t>(device)]);
}

void populate(int devices, const char* model) {
    World& w = world();
    static const char* const names[] = {"Default Device", "Second Device", "Third Device"};
    w.devices.clear();
    for (int i = 0; i < devices; ++i) {
        w.devices.emplace_back();
        w.devices.back().name = names[i];
        if (model != nullptr && *model) w.devices.back().model = model;
    }
    w.current = -1;
}

}  // namespace

extern "C" {

// ---- As documented ---------------------------------------------------------------------------------------------

unsigned hdInitDevice(const char* name) {
    World& w = world();
    const Lock lock(w.mutex);
    if (w.devices.empty()) populate(1, nullptr);
    unsigned refused = w.initError;
    if (const char* code = std::getenv("HANDPIECE_HD_DOUBLE_INIT"))
        refused = static_cast<unsigned>(std::stoul(code, nullptr, 0));
    if (refused != 0) {
        fail(refused);
        return NO_DEVICE;
    }
    for (std::size_t i = 0; i < w.devices.size(); ++i) {
        Device& d = w.devices[i];
        if (name != nullptr ? d.name != name : i != 0) continue;
        if (d.open) {
            breach("hdInitDevice of a device that is initiated", DEVICE_ALREADY_INITIATED);
            return NO_DEVICE;
        }
        if (d.unplugged) {
            fail(COMM_ERROR);
            return NO_DEVICE;
        }
        d.open = true;
        d.ramp = 0.0;
        d.forceOutput = false;
        if (i == 0) readEnvironment(d);
        w.current = static_cast<int>(i);
        return static_cast<unsigned>(i);
    }
    fail(INVALID_VALUE);
    return NO_DEVICE;
}

void hdDisableDevice(unsigned handle) {
    World& w = world();
    const Lock lock(w.mutex);
    Device* d = byHandle(handle, "hdDisableDevice");
    if (d == nullptr) return;
    const bool used =
        std::any_of(w.jobs.begin(), w.jobs.end(), [&](const Job& job) { return job.id == d->job && d->job != 0; });
    if (used) breach("hdDisableDevice while its callback is scheduled");
    for (const double f : d->force)
        if (f != 0.0) breach("hdDisableDevice with a force on its motors");
    writeLog(*d);
    d->log.clear();
    d->open = d->inFrame = d->framed = d->forceOutput = false;
    d->job = 0;
    d->force = d->torque = {};
    if (w.current == static_cast<int>(handle)) w.current = -1;
    w.news.notify_all();
}

void hdMakeCurrentDevice(unsigned handle) {
    const Lock lock(world().mutex);
    if (byHandle(handle, "hdMakeCurrentDevice") != nullptr) world().current = static_cast<int>(handle);
}
unsigned hdGetCurrentDevice() {
    const Lock lock(world().mutex);
    return current("hdGetCurrentDevice") ? static_cast<unsigned>(world().current) : NO_DEVICE;
}

void hdBeginFrame(unsigned handle) {
    World& w = world();
    Lock lock(w.mutex);
    Device* d = byHandle(handle, "hdBeginFrame");
    if (d == nullptr) return;
    if (d->inFrame) return breach("hdBeginFrame inside a frame", ILLEGAL_BEGIN);
    if (d->framed && std::this_thread::get_id() == w.servo && d->enabled[0x4004])
        breach("two frames of a device in one tick", ILLEGAL_BEGIN);
    if (d->stallS > 0) {
        const double seconds = d->stallS;
        d->stallS = 0;
        w.wake = false;
        w.news.wait_for(lock, Seconds(seconds), [&] { return w.wake; });
    }
    d->inFrame = true;
    d->set = false;
    d->wanted = d->wantedTorque = {};
    d->job = w.running;
    w.current = static_cast<int>(handle);
    errorOfFrame(*d, false);
}

void hdEndFrame(unsigned handle) {
    const Lock lock(world().mutex);
    Device* d = byHandle(handle, "hdEndFrame");
    if (d == nullptr) return;
    if (!d->inFrame) return breach("hdEndFrame without hdBeginFrame", ILLEGAL_END);
    d->inFrame = false;
    d->framed = true;
    errorOfFrame(*d, true);
    double size = 0;
    for (const double f : d->wanted)
        size += f * f;
    size = std::sqrt(size);
    double share = 1.0;
    if (!std::isfinite(size)) {
        breach("a force that is no number");
        share = 0.0;
        d->wanted = {};
    } else if (size > d->maxForce() * (1 + 1e-9)) {
        fail(EXCEEDED_MAX_FORCE);
        if (d->enabled[0x4001]) share = d->maxForce() / size;
    }
    d->ramp = d->enabled[0x4002] ? std::min(1.0, d->ramp + 0.02) : 1.0;
    const bool on = d->forceOutput && d->set && !d->unplugged;
    for (std::size_t i = 0; i < 3; ++i) {
        d->force[i] = on ? d->wanted[i] * share * d->ramp : 0.0;
        d->torque[i] = on && d->premium() ? d->wantedTorque[i] * d->ramp : 0.0;
    }
    if (d->set) ++d->count;
}

ErrorInfo hdGetError() {
    if (errors.empty()) return {SUCCESS, 0, NO_DEVICE};
    const ErrorInfo newest = errors.back();
    errors.pop_back();
    return newest;
}
const char* hdGetErrorString(unsigned code) {
    return code == SUCCESS ? "no error" : "an error of the double";
}

static void switchTo(unsigned what, bool on, const char* who) {
    const Lock lock(world().mutex);
    Device* d = current(who);
    if (d == nullptr) return;
    if (what == 0x4000) {
        d->forceOutput = on;
        if (!on) d->force = d->torque = {};
    } else if (d->enabled.count(what) != 0)
        d->enabled[what] = on;
    else
        fail(INVALID_ENUM);
}
void hdEnable(unsigned what) {
    switchTo(what, true, "hdEnable");
}
void hdDisable(unsigned what) {
    switchTo(what, false, "hdDisable");
}
unsigned char hdIsEnabled(unsigned what) {
    const Lock lock(world().mutex);
    Device* d = current("hdIsEnabled");
    if (d == nullptr) return 0;
    return what == 0x4000 ? d->forceOutput : d->enabled[what];
}

void hdGetBooleanv(unsigned what, unsigned char* out) {
    const Lock lock(world().mutex);
    Device* d = current("hdGetBooleanv");
    if (d == nullptr) return;
    const int state = what == 0x2001 ? d->safety : what == 0x2002 ? d->inkwell : -1;
    if (state < 0) return fail(INVALID_ENUM);
    if (inFrame(*d, "hdGetBooleanv", what)) *out = static_cast<unsigned char>(state);
}

void hdGetIntegerv(unsigned what, int* out) {
    const Lock lock(world().mutex);
    Device* d = current("hdGetIntegerv");
    if (d == nullptr) return;
    switch (what) {
        case 0x2000:
            if (inFrame(*d, "hdGetIntegerv", what) && !d->unplugged) *out = static_cast<int>(d->buttons);
            return;
        case 0x2553:
            *out = 6;
            return;
        case 0x2554:
            *out = d->premium() ? 6 : 3;
            return;
        case 0x2555:
            *out = d->style;
            return;
        case 0x2600:
            *out = static_cast<int>(world().rate);
            return;
        default:
            fail(INVALID_ENUM);
    }
}

void hdGetDoublev(unsigned what, double* out) {
    const Lock lock(world().mutex);
    Device* d = current("hdGetDoublev");
    if (d == nullptr) return;
    const auto box = [&](double x, double y, double z) {
        out[0] = -x, out[1] = -y, out[2] = -z, out[3] = x, out[4] = y, out[5] = z;
    };
    switch (what) {
        case 0x2050:
            if (inFrame(*d, "hdGetDoublev", what) && !d->unplugged) std::copy_n(d->pose.begin(), 3, out);
            return;
        case 0x2051:
            if (inFrame(*d, "hdGetDoublev", what) && !d->unplugged)
                for (std::size_t i = 0; i < 3; ++i)
                    out[i] = d->velocity[i] * 1e3;
            return;
        case 0x2052:
            if (inFrame(*d, "hdGetDoublev", what) && !d->unplugged) multiply(d->pose, out);
            return;
        case 0x2505:
            *out = 1.25;
            return;
        case 0x2550:
            return box(210, 150, 100);
        case 0x2551:
            return box(80, 60, 35);
        case 0x2602:
            *out = d->stiffness();
            return;
        case 0x2603:
            *out = d->maxForce();
            return;
        case 0x2604:
            *out = 0.25 * d->maxForce();
            return;
        case 0x2605:
            if (d->temperature < 0) return fail(INVALID_ENUM);
            if (!inFrame(*d, "hdGetDoublev", what)) return;
            for (int i = 0; i < (d->premium() ? 6 : 3); ++i)
                out[i] = i == 1 ? d->temperature : 0.5 * d->temperature;
            return;
        case 0x2609:
            *out = 0.4;
            return;
        default:
            fail(INVALID_ENUM);
    }
}

void hdGetFloatv(unsigned what, float* out) {
    double wide[16] = {};
    hdGetDoublev(what, wide);
    for (int i = 0; i < 3; ++i)
        out[i] = static_cast<float>(wide[i]);
}
void hdGetLongv(unsigned what, long* /*out*/) {
    const Lock lock(world().mutex);
    if (current("hdGetLongv") != nullptr && what != 0x2010) fail(INVALID_ENUM);
}
const char* hdGetString(unsigned what) {
    const Lock lock(world().mutex);
    Device* d = current("hdGetString");
    if (d == nullptr) return nullptr;
    switch (what) {
        case 0x2500:
            return "3.50.0";
        case 0x2501:
            return d->model.c_str();
        case 0x2502:
            return "2023.1.4";
        case 0x2503:
            return "A double of Handpiece's tests";
        case 0x2504:
            return d->name == "Default Device" ? "DOUBLE-0001" : "DOUBLE-0002";
        default:
            fail(INVALID_ENUM);
            return nullptr;
    }
}

void hdSetDoublev(unsigned what, const double* in) {
    const Lock lock(world().mutex);
    Device* d = current("hdSetDoublev");
    if (d == nullptr) return;
    if (what != 0x2700 && what != 0x2701) return fail(INVALID_ENUM);
    if (!inFrame(*d, "hdSetDoublev", what)) return;
    if (what == 0x2701 && !d->premium()) return breach("a torque for an arm that has none", INVALID_OPERATION);
    std::copy_n(in, 3, what == 0x2700 ? d->wanted.begin() : d->wantedTorque.begin());
    if (what == 0x2700) d->set = true;
}
void hdSetFloatv(unsigned what, const float* in) {
    const double wide[3] = {in[0], in[1], in[2]};
    hdSetDoublev(what, wide);
}
void hdSetBooleanv(unsigned, const unsigned char*) {
    fail(INVALID_ENUM);
}
void hdSetIntegerv(unsigned, const int*) {
    fail(INVALID_ENUM);
}
void hdSetLongv(unsigned, const long*) {
    fail(INVALID_ENUM);
}

unsigned hdCheckCalibration() {
    const Lock lock(world().mutex);
    Device* d = current("hdCheckCalibration");
    return d == nullptr ? 0x5002u : d->calibration;
}
unsigned hdCheckCalibrationStyle() {
    const Lock lock(world().mutex);
    Device* d = current("hdCheckCalibrationStyle");
    return d == nullptr ? 0u : static_cast<unsigned>(d->style);
}
void hdUpdateCalibration(unsigned style) {
    const Lock lock(world().mutex);
    Device* d = current("hdUpdateCalibration");
    if (d == nullptr) return;
    if ((static_cast<unsigned>(d->style) & style) == 0)
        return breach("a calibration of a style it has not", INVALID_VALUE);
    // An encoder reset is by hand: whoever calls says that the arm is in its place.
    if (d->calibration != CALIBRATION_NEEDS_UPDATE && style != 1)
        return breach("hdUpdateCalibration that nobody asked for", INVALID_OPERATION);
    d->calibration = CALIBRATION_OK;
}
void hdUpdateCalibrationMessage(unsigned style) {
    hdUpdateCalibration(style);
}
void hdScaleGimbalAngles(double, double, double) {}
void hdDeploymentLicense(const char*, const char*, const char*) {}

void hdStartScheduler() {
    World& w = world();
    const Lock lock(w.mutex);
    if (w.started) return breach("hdStartScheduler while it runs", INVALID_OPERATION);
    w.started = true;
    w.stopping = w.killed = false;
    w.thread = std::thread(schedule);
}
void hdStopScheduler() {
    World& w = world();
    std::thread thread;
    {
        const Lock lock(w.mutex);
        if (!w.started) return breach("hdStopScheduler while it stands", INVALID_OPERATION);
        if (std::this_thread::get_id() == w.servo) return breach("hdStopScheduler in a callback", INVALID_OPERATION);
        w.stopping = true;
        thread = std::move(w.thread);
    }
    if (thread.joinable()) thread.join();
    const Lock lock(w.mutex);
    w.started = false;
    w.servo = {};
    letGo(w);
    w.news.notify_all();
}
void hdSetSchedulerRate(unsigned long hertz) {
    World& w = world();
    const Lock lock(w.mutex);
    if (w.started) return breach("hdSetSchedulerRate while it runs", INVALID_OPERATION);
    for (unsigned long n = 4; n <= 16; ++n)
        if (hertz == static_cast<unsigned long>(std::floor(8000.0 / static_cast<double>(n) + 0.5))) {
            w.rate = hertz;
            return;
        }
    fail(INVALID_VALUE);
}

unsigned long hdScheduleAsynchronous(unsigned (*work)(void*), void* data, unsigned short priority) {
    World& w = world();
    const Lock lock(w.mutex);
    w.jobs.push_back({w.nextJob++, work, data, priority});
    std::stable_sort(w.jobs.begin(), w.jobs.end(), [](const Job& a, const Job& b) { return a.priority > b.priority; });
    return w.nextJob - 1;
}
void hdScheduleSynchronous(unsigned (*work)(void*), void* data, unsigned short /*priority*/) {
    // The product has no use for it: the scheduler stands when it asks for anything.
    while (work(data) != 0) {
    }
}
void hdUnschedule(unsigned long job) {
    World& w = world();
    const Lock lock(w.mutex);
    if (std::erase_if(w.jobs, [&](const Job& j) { return j.id == job; }) == 0)
        breach("hdUnschedule of what is not scheduled", INVALID_VALUE);
}
unsigned char hdWaitForCompletion(unsigned long job, unsigned /*code*/) {
    World& w = world();
    const Lock lock(w.mutex);
    return std::any_of(w.jobs.begin(), w.jobs.end(), [&](const Job& j) { return j.id == job; });
}
double hdGetSchedulerTimeStamp() {
    const Lock lock(world().mutex);
    return Seconds(std::chrono::steady_clock::now() - world().tickBegan).count();
}

// ---- For tests -------------------------------------------------------------------------------------------------

void double_reset(int devices, const char* model) {
    World& w = world();
    Lock lock(w.mutex);
    w.wake = true;
    w.news.notify_all();
    w.news.wait_for(lock, std::chrono::seconds(5), [&] {
        return !w.started && std::none_of(w.devices.begin(), w.devices.end(), [](const Device& d) { return d.open; });
    });
    if (w.started || std::any_of(w.devices.begin(), w.devices.end(), [](const Device& d) { return d.open; }))
        complain("a device was left open");
    w.jobs.clear();
    w.rate = 1000;
    w.breaches = w.initError = 0;
    w.lastBreach.clear();
    populate(devices, model);
}
void double_move(int device, const double* pose) {
    with(device, [&](Device& d) { std::copy_n(pose, 7, d.goal.begin()); });
}
void double_sprung(int device, int yes) {
    with(device, [&](Device& d) { d.sprung = yes != 0; });
}
void double_press(int device, unsigned buttons) {
    with(device, [&](Device& d) { d.buttons = buttons; });
}
unsigned long long double_force(int device, double* out) {
    unsigned long long count = 0;
    with(device, [&](Device& d) {
        for (std::size_t i = 0; i < 3; ++i) {
            out[i] = d.force[i];
            out[3 + i] = d.torque[i] * 1000.0;  // set in N m
        }
        count = d.count;
    });
    return count;
}
void double_unplug(int device) {
    with(device, [](Device& d) {
        d.unplugged = true;
        d.force = d.torque = {};
    });
}
void double_stall(int device, double seconds) {
    with(device, [&](Device& d) { d.stallS = seconds; });
}
void double_wake() {
    const Lock lock(world().mutex);
    world().wake = true;
    world().news.notify_all();
}
void double_error(int device, unsigned code, int atEnd, int times) {
    with(device, [&](Device& d) {
        d.errorCode = code;
        d.errorAtEnd = atEnd != 0;
        d.errorTimes = times;
    });
}
void double_calibration(int device, int style, unsigned answer) {
    with(device, [&](Device& d) {
        d.style = style;
        d.calibration = answer;
    });
}
void double_switches(int device, int inkwell, int safety) {
    with(device, [&](Device& d) {
        d.inkwell = inkwell;
        d.safety = safety;
    });
}
void double_temperature(int device, double value) {
    with(device, [&](Device& d) { d.temperature = value; });
}
void double_init_error(unsigned code) {
    const Lock lock(world().mutex);
    world().initError = code;
}
void double_kill() {
    const Lock lock(world().mutex);
    world().killed = true;
}
unsigned double_breaches() {
    const Lock lock(world().mutex);
    return world().breaches;
}
const char* double_last_breach() {
    static std::string text;
    const Lock lock(world().mutex);
    text = world().lastBreach;
    return text.c_str();
}

}  // extern "C"
