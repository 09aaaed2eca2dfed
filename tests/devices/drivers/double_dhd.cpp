// SPDX-License-Identifier: Apache-2.0
/// @file
/// A double of Force Dimension's library: the functions that callers of it use, in their order and with their errors,
/// and an arm with a hand on it inside. Breaches of the order are counted. Built without DOUBLE_DHD_DRD it is the plain
/// libdhd, without the automatic calibration.

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include "devices/drivers/double_dhd.h"

#define EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using Clock = std::chrono::steady_clock;
using handpiece::doubles::DhdArm;
using handpiece::doubles::DhdDouble;
using handpiece::doubles::DhdSent;

enum : int { kCom = 2, kNoDevice = 5, kTimeout = 7, kInvalidIndex = 15, kInUse = 20 };

thread_local int lastError = 0;

struct Arm {
    DhdArm made;
    bool plugged = true, taken = false, open = false, byDrd = false, enabled = false, initialised = true;
    bool calibrating = false;
    int raised = 0, cause = 0;
    double position[3] = {}, velocity[3] = {}, frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double massKg = 0, stiffness = 0, radius = 0, hz = 0;
    Clock::time_point swungAt, startedAt, stallUntil;
    unsigned buttons = 0;
    DhdSent sent;
};

class Double final : public DhdDouble {
  public:
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Arm> arms;
    int inside = 0;  // calls under way
    unsigned breachCount = 0;
    std::string breach, failing;
    int failingCode = 0;

    void wrong(const std::string& what) {
        ++breachCount;
        breach = what;
    }

    bool reset(const std::vector<DhdArm>& wanted) override {
        std::unique_lock lock(mutex);
        for (Arm& arm : arms)
            arm.stallUntil = {};
        changed.notify_all();
        const auto quiet = [&] {
            if (inside > 0) return false;
            for (const Arm& arm : arms)
                if (arm.open) return false;
            return true;
        };
        const bool ended = changed.wait_for(lock, std::chrono::seconds(10), quiet);
        arms.clear();
        for (const DhdArm& made : wanted) {
            arms.emplace_back();
            arms.back().made = made;
        }
        breachCount = 0;
        breach.clear();
        failing.clear();
        return ended;
    }
    Arm& at(int arm) { return arms.at(static_cast<std::size_t>(arm)); }
    void move(int arm, const double (&positionM)[3], const double (&frame)[3][3]) override {
        const std::lock_guard lock(mutex);
        std::memcpy(at(arm).position, positionM, sizeof positionM);
        std::memcpy(at(arm).frame, frame, sizeof frame);
        at(arm).massKg = 0;
    }
    void swing(int arm, double massKg, double stiffnessNPerM, double radiusM, double hz) override {
        const std::lock_guard lock(mutex);
        Arm& a = at(arm);
        a.massKg = massKg;
        a.stiffness = stiffnessNPerM;
        a.radius = radiusM;
        a.hz = hz;
        a.startedAt = a.swungAt = Clock::now();
    }
    void press(int arm, unsigned mask) override {
        const std::lock_guard lock(mutex);
        at(arm).buttons = mask;
    }
    DhdSent sent(int arm) override {
        const std::lock_guard lock(mutex);
        return at(arm).sent;
    }
    void unplug(int arm) override {
        const std::lock_guard lock(mutex);
        Arm& a = at(arm);
        a.plugged = a.enabled = a.sent.motorsOn = false;
        a.cause = 5;
        std::memset(a.sent.forceN, 0, sizeof a.sent.forceN);
        std::memset(a.sent.torqueNm, 0, sizeof a.sent.torqueNm);
    }
    void stall(int arm, double seconds) override {
        const std::lock_guard lock(mutex);
        at(arm).stallUntil =
            Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }
    void raise(int arm, int code) override {
        const std::lock_guard lock(mutex);
        at(arm).raised = code;
    }
    void initialise(int arm, bool done) override {
        const std::lock_guard lock(mutex);
        at(arm).initialised = done;
    }
    void forceOff(int arm, int cause) override {
        const std::lock_guard lock(mutex);
        at(arm).enabled = at(arm).sent.motorsOn = false;
        at(arm).cause = cause;
    }
    void takenElsewhere(int arm) override {
        const std::lock_guard lock(mutex);
        at(arm).taken = true;
    }
    void failNext(const std::string& function, int code) override {
        const std::lock_guard lock(mutex);
        failing = function;
        failingCode = code;
    }
    unsigned breaches() override {
        const std::lock_guard lock(mutex);
        return breachCount;
    }
    std::string lastBreach() override {
        const std::lock_guard lock(mutex);
        return breach;
    }
};

Double& state() {
    // Outlives threads that hang in a call when the program ends.
    static auto* const one = [] {
        auto* made = new Double;
        if (std::getenv("HANDPIECE_DHD_DOUBLE")) {
            made->arms.emplace_back();
            made->arms.back().made = {34, "omega.6", 1702, true, false, false};
            made->swing(0, 0.1, 500.0, 0.01, 0.5);
        }
        return made;
    }();
    return *one;
}

int fail(int code) {
    lastError = code;
    return -1;
}

/// A call for one arm: waits out a stall, and knows whether the arm can answer.
class Call {
  public:
    Call(const char* name, char id) : lock_(state().mutex) {
        Double& all = state();
        ++all.inside;
        if (id < 0 || static_cast<std::size_t>(id) >= all.arms.size() || !all.at(id).open) {
            all.wrong(std::string(name) + " for a device that is not open");
            fail(kInvalidIndex);
            return;
        }
        all.changed.wait(lock_, [&] {
            const auto until = all.at(id).stallUntil;
            if (Clock::now() >= until) return true;
            all.changed.wait_until(lock_, until);
            return Clock::now() >= all.at(id).stallUntil;
        });
        if (all.failing == name) {
            all.failing.clear();
            fail(all.failingCode);
            return;
        }
        if (!all.at(id).plugged && std::strcmp(name, "close") != 0) {
            fail(kNoDevice);
            return;
        }
        arm_ = &all.at(id);
    }
    ~Call() {
        --state().inside;
        state().changed.notify_all();
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    explicit operator bool() const { return arm_ != nullptr; }
    Arm* operator->() const { return arm_; }
    void wait(double seconds) {
        state().changed.wait_for(lock_, std::chrono::duration<double>(seconds), [] { return false; });
    }

  private:
    std::unique_lock<std::mutex> lock_;
    Arm* arm_ = nullptr;
};

/// The mass moves on to now, in steps of at most a tenth of a millisecond.
void swingTo(Arm& arm, Clock::time_point now) {
    double left = std::min(std::chrono::duration<double>(now - arm.swungAt).count(), 0.1);
    double t = std::chrono::duration<double>(now - arm.startedAt).count() - left;
    arm.swungAt = now;
    const double damping = 2 * 0.7 * std::sqrt(arm.stiffness * arm.massKg);
    while (left > 0) {
        const double dt = std::min(left, 1e-4);
        const double turn = 2 * 3.14159265358979 * arm.hz * t;
        const double target[3] = {0, arm.radius * std::cos(turn), arm.radius * std::sin(turn)};
        for (int i = 0; i < 3; ++i) {
            const double pushed = arm.enabled ? arm.sent.forceN[i] : 0.0;
            const double force = arm.stiffness * (target[i] - arm.position[i]) - damping * arm.velocity[i] + pushed;
            arm.velocity[i] += force / arm.massKg * dt;
            arm.position[i] += arm.velocity[i] * dt;
        }
        left -= dt;
        t += dt;
    }
}

int openIndex(int index, bool byDrd) {
    Double& all = state();
    const std::lock_guard lock(all.mutex);
    if (index < 0 || static_cast<std::size_t>(index) >= all.arms.size()) return fail(kInvalidIndex);
    Arm& arm = all.at(index);
    if (all.failing == "open") {
        all.failing.clear();
        return fail(all.failingCode);
    }
    if (!arm.plugged) return fail(kNoDevice);
    if (arm.taken) return fail(kInUse);
    if (arm.open) {
        all.wrong("a device was opened twice");
        return index;
    }
    arm.open = true;
    arm.byDrd = byDrd;
    return index;
}

int closeId(char id, bool byDrd) {
    const Call call("close", id);
    if (!call) return -1;
    if (call->byDrd != byDrd) state().wrong("opened by one library's call, closed by the other's");
    if (call->enabled) state().wrong("closed with its force enabled");
    call->open = call->enabled = call->sent.motorsOn = false;
    return 0;
}

int send(const char* name, char id, const double (&force)[3], const double (&torque)[3], double gripper) {
    const Call call(name, id);
    if (!call) return -1;
    const bool zero =
        force[0] == 0 && force[1] == 0 && force[2] == 0 && torque[0] == 0 && torque[1] == 0 && torque[2] == 0;
    if (!call->enabled && !zero && call->cause == 0) state().wrong("a force without dhdEnableForce");
    if (call->calibrating) state().wrong("a force while the arm calibrates itself");
    std::memcpy(call->sent.forceN, force, sizeof force);
    std::memcpy(call->sent.torqueNm, torque, sizeof torque);
    call->sent.gripperN = gripper;
    ++call->sent.count;
    return 0;
}

}  // namespace

EXPORT DhdDouble* doubleDhd() {
    return &state();
}

EXPORT int dhdErrorGetLast() {
    return lastError;
}
EXPORT const char* dhdErrorGetLastStr() {
    return lastError == 0 ? "no error" : "the double was told to fail";
}
EXPORT int dhdGetDeviceCount() {
    const std::lock_guard lock(state().mutex);
    int count = 0;
    for (const Arm& arm : state().arms)
        count += arm.plugged ? 1 : 0;
    return count;
}
EXPORT int dhdGetAvailableCount() {
    const std::lock_guard lock(state().mutex);
    int count = 0;
    for (const Arm& arm : state().arms)
        count += arm.plugged && !arm.open && !arm.taken ? 1 : 0;
    return count;
}
EXPORT int dhdOpenID(char index) {
    return openIndex(index, false);
}
EXPORT int dhdClose(char id) {
    return closeId(id, false);
}
EXPORT int dhdStop(char id) {
    const Call call("dhdStop", id);
    if (!call) return -1;
    call->enabled = call->sent.motorsOn = false;
    return 0;
}
EXPORT int dhdEnableForce(unsigned char on, char id) {
    const Call call("dhdEnableForce", id);
    if (!call) return -1;
    call->enabled = call->sent.motorsOn = on != 0;
    call->cause = on != 0 ? 0 : 4;
    return 0;
}
EXPORT int dhdGetSystemType(char id) {
    const Call call("dhdGetSystemType", id);
    return call ? call->made.type : -1;
}
EXPORT const char* dhdGetSystemName(char id) {
    const Call call("dhdGetSystemName", id);
    return call ? call->made.name.c_str() : nullptr;
}
EXPORT int dhdGetSerialNumber(unsigned short* number, char id) {
    const Call call("dhdGetSerialNumber", id);
    if (!call) return -1;
    *number = call->made.serial;
    return 0;
}
EXPORT int dhdGetVersion(double* version, char id) {
    const Call call("dhdGetVersion", id);
    if (!call) return -1;
    *version = 3.5;
    return 0;
}
EXPORT void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    *major = 3;
    *minor = 17;
    *release = 6;
    *revision = 0;
}
EXPORT int dhdGetStatus(int* status, char id) {
    const Call call("dhdGetStatus", id);
    if (!call) return -1;
    std::memset(status, 0, 16 * sizeof(int));
    status[0] = status[1] = status[2] = 1;
    status[3] = call->initialised ? 0 : 1;
    status[5] = call->enabled ? 1 : 0;
    status[6] = call->enabled ? 0 : 1;
    status[14] = call->cause;
    return 0;
}
EXPORT unsigned dhdGetButtonMask(char id) {
    const Call call("dhdGetButtonMask", id);
    return call ? call->buttons : 0;
}
EXPORT bool dhdHasWrist(char id) {
    const Call call("dhdHasWrist", id);
    return call && call->made.wrist;
}
EXPORT bool dhdHasActiveWrist(char id) {
    const Call call("dhdHasActiveWrist", id);
    return call && call->made.activeWrist;
}
EXPORT bool dhdIsLeftHanded(char id) {
    const Call call("dhdIsLeftHanded", id);
    return call && call->made.leftHanded;
}
EXPORT int dhdGetPosition(double* x, double* y, double* z, char id) {
    const Call call("dhdGetPosition", id);
    if (!call) return -1;
    if (call->raised != 0) return fail(call->raised);
    if (call->massKg > 0) swingTo(*call.operator->(), Clock::now());
    *x = call->position[0];
    *y = call->position[1];
    *z = call->position[2];
    return 0;
}
EXPORT int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double (*frame)[3], char id) {
    const Call call("dhdGetPositionAndOrientationFrame", id);
    if (!call) return -1;
    if (call->raised != 0) return fail(call->raised);
    if (call->massKg > 0) swingTo(*call.operator->(), Clock::now());
    *x = call->position[0];
    *y = call->position[1];
    *z = call->position[2];
    std::memcpy(frame, call->frame, sizeof call->frame);
    return 0;
}
EXPORT int dhdSetForce(double x, double y, double z, char id) {
    return send("dhdSetForce", id, {x, y, z}, {0, 0, 0}, 0);
}
EXPORT int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz,
                                               double gripper, char id) {
    return send("dhdSetForceAndTorqueAndGripperForce", id, {fx, fy, fz}, {tx, ty, tz}, gripper);
}

#ifdef DOUBLE_DHD_DRD
EXPORT int drdOpenID(char index) {
    return openIndex(index, true);
}
EXPORT int drdClose(char id) {
    return closeId(id, true);
}
EXPORT bool drdIsInitialized(char id) {
    const Call call("drdIsInitialized", id);
    return call && call->initialised;
}
EXPORT int drdAutoInit(char id) {
    Call call("drdAutoInit", id);
    if (!call) return -1;
    if (call->made.type == 60) return fail(6);
    call->calibrating = true;
    call.wait(0.05);
    call->calibrating = false;
    call->initialised = true;
    call->enabled = call->sent.motorsOn = false;
    return 0;
}
#endif
