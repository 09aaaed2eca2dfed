// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/history_bytes.h"

#include <cstring>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/layout.h"

namespace handpiece::simulation {
namespace {

constexpr char kMagic[4] = {'H', 'P', 'U', 'H'};
constexpr std::uint64_t kVersion = 1, kMaxSteps = 1u << 20;

void append(std::vector<std::byte>& bytes, std::uint64_t value) {
    for (int i = 0; i < 8; ++i)
        bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
}

class Reader {
  public:
    Reader(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}
    [[noreturn]] void refuse() const {
        throw core::Error("the strokes before the session are damaged", where_, "take another copy");
    }
    std::span<const std::byte> take(std::uint64_t size) {
        if (size > bytes_.size()) refuse();
        const auto taken = bytes_.first(static_cast<std::size_t>(size));
        bytes_ = bytes_.subspan(taken.size());
        return taken;
    }
    std::uint64_t number() {
        std::uint64_t value = 0;
        const auto taken = take(8);
        for (std::size_t i = 0; i < 8; ++i)
            value |= static_cast<std::uint64_t>(taken[i]) << (8 * i);
        return value;
    }
    [[nodiscard]] bool isAtEnd() const { return bytes_.empty(); }

  private:
    std::span<const std::byte> bytes_;
    const std::string& where_;
};

}  // namespace

KeptHistory keepHistory(const history::History& history, const tooth::StateDelta& now, const SimulationSetup& station) {
    std::size_t done = history.undoSteps(), count = done + history.redoSteps();
    if (count == 0) return {};
    std::vector<std::vector<std::byte>> steps;
    const std::uint64_t identity = station.identity();
    std::size_t size = 0;
    for (std::size_t i = 0; i < count; ++i) {
        steps.push_back(tooth::encodeState(history.step(i), identity));
        size += steps.back().size() + 8;
    }
    constexpr std::size_t kRoom = session::kMaxHistoryBytes - 64;
    const auto drop = [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            size -= steps[i].size() + 8;
        steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(from), steps.begin() + static_cast<std::ptrdiff_t>(to));
        count = steps.size();
    };
    if (size > kRoom) drop(done, count);
    for (; size > kRoom; --done)
        drop(0, 1);
    KeptHistory kept;
    const auto* magic = reinterpret_cast<const std::byte*>(kMagic);
    kept.bytes.assign(magic, magic + sizeof(kMagic));
    for (const std::uint64_t n : {kVersion, std::uint64_t{count}, std::uint64_t{done}})
        append(kept.bytes, n);
    for (const std::vector<std::byte>& step : steps) {
        append(kept.bytes, step.size());
        kept.bytes.insert(kept.bytes.end(), step.begin(), step.end());
    }
    // From the bytes, so that the sitting and a replay of it have the same.
    kept.steps = std::make_shared<const history::History>(decodeHistory(kept.bytes, now, station, "history"));
    return kept;
}

history::History decodeHistory(std::span<const std::byte> bytes, const tooth::StateDelta& now,
                               const SimulationSetup& station, const std::string& where) {
    Reader reader(bytes, where);
    if (std::memcmp(reader.take(sizeof(kMagic)).data(), kMagic, sizeof(kMagic)) != 0) reader.refuse();
    const std::uint64_t version = reader.number(), count = reader.number(), done = reader.number();
    if (version != kVersion)
        throw core::Error("the strokes before the session are of another version", where, "use a newer Handpiece");
    if (count > kMaxSteps || done > count) reader.refuse();
    history::History history;
    history.start(now);
    const tooth::Teeth teeth = station.teeth();
    for (std::uint64_t i = 0; i < count; ++i)
        history.append(tooth::decodeState(reader.take(reader.number()), teeth, where), i < done);
    if (!reader.isAtEnd()) reader.refuse();
    return history;
}

}  // namespace handpiece::simulation
