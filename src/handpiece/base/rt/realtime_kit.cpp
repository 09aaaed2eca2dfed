// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/realtime_kit.h"

#ifdef HANDPIECE_DBUS
#include <dbus/dbus.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <future>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#endif

namespace handpiece::rt {

#ifdef HANDPIECE_DBUS
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr const char* kService = "org.freedesktop.RealtimeKit1";
constexpr const char* kPath = "/org/freedesktop/RealtimeKit1";

struct MessageUnref {
    void operator()(DBusMessage* message) const noexcept { dbus_message_unref(message); }
};
using Message = std::unique_ptr<DBusMessage, MessageUnref>;

struct Late : std::exception {};

struct Error : DBusError {
    Error() { dbus_error_init(this); }
    ~Error() { dbus_error_free(this); }
    Error(const Error&) = delete;
    Error& operator=(const Error&) = delete;
    [[noreturn]] void raise() const {
        if (dbus_error_has_name(this, DBUS_ERROR_NO_REPLY) || dbus_error_has_name(this, DBUS_ERROR_TIMEOUT))
            throw Late();
        throw std::runtime_error(message != nullptr ? message : "it failed");
    }
};

/// A connection of our own to the system bus; throws std::runtime_error with one line, Late when the time is over.
class Bus {
  public:
    explicit Bus(steady_clock::time_point end) : end_(end) {
        const char* named = std::getenv("DBUS_SYSTEM_BUS_ADDRESS");
        Error error;
        connection_ =
            dbus_connection_open_private(named != nullptr ? named : "unix:path=/run/dbus/system_bus_socket", &error);
        if (connection_ == nullptr) error.raise();
        try {
            // dbus_bus_register() would wait half a minute for a bus that stands.
            (void)call(DBUS_SERVICE_DBUS, DBUS_PATH_DBUS, DBUS_INTERFACE_DBUS, "Hello", DBUS_TYPE_INVALID);
        } catch (...) {
            close();
            throw;
        }
    }
    ~Bus() { close(); }
    Bus(const Bus&) = delete;
    Bus& operator=(const Bus&) = delete;

    /// The arguments as dbus_message_append_args() takes them, with DBUS_TYPE_INVALID at their end.
    template <class... Arguments>
    Message call(const char* service, const char* path, const char* interface, const char* method,
                 Arguments... arguments) {
        const Message message(dbus_message_new_method_call(service, path, interface, method));
        if (!message || !dbus_message_append_args(message.get(), arguments...)) throw std::bad_alloc();
        const auto left = std::chrono::duration_cast<milliseconds>(end_ - steady_clock::now()).count();
        if (left <= 0) throw Late();
        Error error;
        Message reply(
            dbus_connection_send_with_reply_and_block(connection_, message.get(), static_cast<int>(left), &error));
        if (!reply) error.raise();
        return reply;
    }

    [[nodiscard]] std::int64_t property(const char* name) {
        const Message reply = call(kService, kPath, DBUS_INTERFACE_PROPERTIES, "Get", DBUS_TYPE_STRING, &kService,
                                   DBUS_TYPE_STRING, &name, DBUS_TYPE_INVALID);
        DBusMessageIter outer, inner;
        if (dbus_message_iter_init(reply.get(), &outer) &&
            dbus_message_iter_get_arg_type(&outer) == DBUS_TYPE_VARIANT) {
            dbus_message_iter_recurse(&outer, &inner);
            DBusBasicValue value{};
            const int type = dbus_message_iter_get_arg_type(&inner);
            if (type == DBUS_TYPE_INT32 || type == DBUS_TYPE_INT64) {
                dbus_message_iter_get_basic(&inner, &value);
                return type == DBUS_TYPE_INT32 ? value.i32 : value.i64;
            }
        }
        throw std::runtime_error(fmt::format("it does not tell {}", name));
    }

  private:
    void close() noexcept {
        dbus_connection_close(connection_);
        dbus_connection_unref(connection_);
    }
    const steady_clock::time_point end_;
    DBusConnection* connection_ = nullptr;
};

/// The kernel then ends a thread that runs as long without a pause, so that it cannot keep a processor from everybody:
/// half of that brings SIGXCPU first (realtime_thread.cpp).
void limitTime(std::int64_t mostUs) {
    rlimit limit{};
    if (getrlimit(RLIMIT_RTTIME, &limit) != 0) return;
    limit.rlim_max = std::min(limit.rlim_max, static_cast<rlim_t>(mostUs));
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max / 2);
    (void)setrlimit(RLIMIT_RTTIME, &limit);
}

KitAnswer ask(std::uint64_t thread, int below, steady_clock::time_point end) {
    KitAnswer answer;
    try {
        Bus bus(end);
        try {
            const std::int64_t highest = bus.property("MaxRealtimePriority");
            limitTime(bus.property("RTTimeUSecMax"));
            const auto priority = static_cast<std::uint32_t>(std::max<std::int64_t>(1, highest - below));
            (void)bus.call(kService, kPath, kService, "MakeThreadRealtime", DBUS_TYPE_UINT64, &thread, DBUS_TYPE_UINT32,
                           &priority, DBUS_TYPE_INVALID);
            answer.priority = static_cast<int>(priority);
            return answer;
        } catch (const std::runtime_error& e) {
            answer.refusal = e.what();  // libdbus's and rtkit's texts have one line
        }
        const auto level = static_cast<std::int32_t>(bus.property("MinNiceLevel"));
        (void)bus.call(kService, kPath, kService, "MakeThreadHighPriority", DBUS_TYPE_UINT64, &thread, DBUS_TYPE_INT32,
                       &level, DBUS_TYPE_INVALID);
        answer.niceLevel = level;
    } catch (const std::runtime_error& e) {
        if (answer.refusal.empty()) answer.refusal = e.what();
    }
    return answer;
}

}  // namespace

KitAnswer askRealtimeKit(int thread, int below, milliseconds patience) {
    static std::atomic<bool> stands{false};
    const KitAnswer none{0, 0, fmt::format("no answer within {} ms", patience.count())};
    if (stands.load(std::memory_order_relaxed)) return none;
    // In a thread of its own: a bus that stands can also hold up who connects to it, for as long as it likes.
    std::promise<KitAnswer> promise;
    std::future<KitAnswer> future = promise.get_future();
    const auto end = steady_clock::now() + patience;
    try {
        std::thread([below, end, promise = std::move(promise), thread = static_cast<std::uint64_t>(thread)]() mutable {
            try {
                promise.set_value(ask(thread, below, end));
            } catch (...) {
                promise.set_exception(std::current_exception());
            }
        }).detach();
    } catch (const std::system_error& e) {
        return {0, 0, e.what()};
    }
    if (future.wait_until(end + patience / 10) == std::future_status::ready) {
        try {
            return future.get();
        } catch (const Late&) {
            // As if it had not come back.
        }
    }
    stands.store(true, std::memory_order_relaxed);
    return none;
}

#else

KitAnswer askRealtimeKit(int /*thread*/, int /*below*/, std::chrono::milliseconds /*patience*/) {
    return {0, 0, "this program was built without D-Bus"};
}

#endif

}  // namespace handpiece::rt
