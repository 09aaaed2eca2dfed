// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/recorder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>
#include <variant>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/rt/spsc_queue.h"
#include "handpiece/record/session/session_writer.h"

namespace handpiece::session {
namespace {

constexpr double kQueueS = 4.0;
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20, kMaxWaitingBytes = std::size_t{256} << 20;
constexpr auto kPause = std::chrono::milliseconds(20);

}  // namespace

struct Recorder::State {
    using Item = std::variant<Event, KeyFrame>;

    SessionWriter writer;
    const std::uint64_t firstTick = 0;
    rt::SpscQueue<Record> records;
    std::uint64_t pushed = 0;  // by the caller's thread alone
    std::atomic<std::uint64_t> popped{0};
    mutable std::mutex mutex;  // of what follows; never held while the disk works
    std::vector<Item> items;
    std::size_t itemBytes = 0;
    RecorderStatus status;
    std::condition_variable wake;
    bool stop = false;
    bool broken = false;  // by the writing thread alone: something could not be written, the rest is thrown away
    std::thread thread;

    State(const std::filesystem::path& path, const SessionInfo& info)
        : writer(path, info), records(static_cast<std::size_t>(kQueueS * info.rateHz)) {}
    explicit State(const std::filesystem::path& path)
        : writer(path), firstTick(writer.firstTick()), records(static_cast<std::size_t>(kQueueS * writer.rateHz())) {}

    void add(Item item, std::size_t bytes) {
        const std::lock_guard lock(mutex);
        if (itemBytes + bytes > kMaxWaitingBytes) {
            ++status.lostItems;
            return;
        }
        itemBytes += bytes;
        items.push_back(std::move(item));
    }

    void writeWhatWaits() {
        std::vector<Item> taken;
        {
            const std::lock_guard lock(mutex);
            taken.swap(items);
            itemBytes = 0;
        }
        Record record;
        while (records.tryPop(record)) {
            popped.fetch_add(1, std::memory_order_release);
            if (!broken) writer.append(record);
        }
        if (broken) return;
        for (const Item& item : taken)
            std::visit([this](const auto& i) { writer.append(i); }, item);
    }

    void tell(std::string message) {
        const std::lock_guard lock(mutex);
        status.writtenRecords = writer.writtenRecords();
        status.sizeBytes = writer.sizeBytes();
        status.lostRecords = records.overflowCount();
        if (message.empty()) message = writer.failure();
        if (!message.empty() && status.message.empty()) {
            status.recording = false;
            status.message = "the session is no longer recorded: " + message;
            if (!writer.failure().empty()) {
                status.id = core::writeErrorId(writer.errorNumber());
                status.reason = std::strerror(writer.errorNumber());
            }
        }
    }

    void run() {
        for (bool last = false; !last;) {
            {
                std::unique_lock lock(mutex);
                wake.wait_for(lock, kPause, [this] { return stop; });
                last = stop;
            }
            std::string problem;
            try {
                writeWhatWaits();
                if (last) writer.close();
            } catch (const std::exception& e) {
                problem = core::asError(e).what();
                broken = true;
            }
            tell(std::move(problem));
        }
    }
};

Recorder::Recorder(const std::filesystem::path& path, const SessionInfo& info)
    : state_(std::make_unique<State>(path, info)) {
    state_->thread = std::thread([this] { state_->run(); });
}

Recorder::Recorder(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {
    state_->thread = std::thread([this] { state_->run(); });
}

Recorder::~Recorder() {
    close();
}

std::uint64_t Recorder::firstTick() const noexcept {
    return state_->firstTick;
}

bool Recorder::push(const Record& record) noexcept {
    Record placed = record;
    placed.tick += state_->firstTick;
    if (!state_->records.tryPush(placed)) return false;
    ++state_->pushed;
    return true;
}

void Recorder::pushWaiting(const Record& record) {
    State& s = *state_;
    while (s.pushed - s.popped.load(std::memory_order_acquire) >= s.records.capacity())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    push(record);
}

void Recorder::event(std::uint64_t tick, EventName name, std::string_view text) {
    if (text.size() > kMaxTextBytes) {
        const std::lock_guard lock(state_->mutex);
        ++state_->status.lostItems;
        return;
    }
    state_->add(Event{state_->firstTick + tick, std::string(nameOf(name)), std::string(text)}, text.size() + 64);
}

void Recorder::keyFrame(std::uint64_t tick, std::vector<std::byte> state) {
    const std::size_t bytes = state.size() + 64;
    state_->add(KeyFrame{state_->firstTick + tick, std::move(state)}, bytes);
}

RecorderStatus Recorder::status() const {
    const std::lock_guard lock(state_->mutex);
    RecorderStatus now = state_->status;
    now.lostRecords = state_->records.overflowCount();
    return now;
}

RecorderStatus Recorder::close() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stop = true;
    }
    state_->wake.notify_all();
    if (state_->thread.joinable()) state_->thread.join();
    RecorderStatus last = status();
    last.recording = false;
    return last;
}

}  // namespace handpiece::session
