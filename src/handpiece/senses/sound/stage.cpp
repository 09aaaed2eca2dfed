// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/stage.h"

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <deque>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/senses/sound/signal.h"

namespace handpiece::sound {
namespace {

constexpr double kMetresPerMm = 1e-3 * kMagnification;
constexpr double kLoudest = 3.0;           // of a source near the eye, over its level at kReferenceMm
constexpr double kPassS = 0.015;           // a source or an ear that moved passes to its new place
constexpr double kRotorAboveTipMm = 15.0;  // middle of the head that turbineMesh makes

/// OpenAL's extensions, looked up once a device.
struct Extensions {
    LPALCLOOPBACKOPENDEVICESOFT openLoopback = nullptr;
    LPALCISRENDERFORMATSUPPORTEDSOFT isFormatSupported = nullptr;
    LPALCRENDERSAMPLESSOFT render = nullptr;
    PFNALCSETTHREADCONTEXTPROC setThreadContext = nullptr;
    PFNALCGETTHREADCONTEXTPROC getThreadContext = nullptr;
    LPALGETSOURCEDVSOFT getSourceDoubles = nullptr;
};

template <class Function>
void find(ALCdevice* device, Function& function, const char* name) {
    function = reinterpret_cast<Function>(alcGetProcAddress(device, name));
}

/// Makes a context the calling thread's for as long as it lives.
class Bind {
  public:
    Bind(const Extensions& al, ALCcontext* context) : al_(al), before_(al.getThreadContext()) {
        al_.setThreadContext(context);
    }
    ~Bind() { al_.setThreadContext(before_); }
    Bind(const Bind&) = delete;
    Bind& operator=(const Bind&) = delete;

  private:
    const Extensions& al_;
    ALCcontext* before_;
};

struct Queue {
    ALuint source = 0;
    struct Block {
        ALuint buffer;
        int frames;
    };
    std::deque<Block> blocks;   // in the source, the oldest first
    std::vector<ALuint> spare;  // buffers
};

struct Place {
    core::Vec3 eye, forward, up, motor, cutting;
};

}  // namespace

core::Vec3 motorPositionMm(const DrillState& drill) {
    return drill.positionMm + kRotorAboveTipMm * drill.axis;
}

struct Stage::State {
    StageKind kind;
    Extensions al;
    ALCdevice* device = nullptr;
    ALCcontext* context = nullptr;
    std::string name;
    bool placed = false;
    int periodFrames = 1024;
    std::array<Queue, 2> queues;
    Place at;

    ~State() {
        if (context) {
            {
                const Bind bind(al, context);
                for (Queue& queue : queues) {
                    if (!queue.source) continue;
                    alSourceStop(queue.source);
                    alSourcei(queue.source, AL_BUFFER, 0);
                    alDeleteSources(1, &queue.source);
                    for (const Queue::Block& block : queue.blocks)
                        alDeleteBuffers(1, &block.buffer);
                    for (const ALuint buffer : queue.spare)
                        alDeleteBuffers(1, &buffer);
                }
            }
            alcDestroyContext(context);
        }
        if (device) alcCloseDevice(device);
    }

    void open(bool headphones) {
        if (kind == StageKind::loopback) {
            find(nullptr, al.openLoopback, "alcLoopbackOpenDeviceSOFT");
            device = al.openLoopback ? al.openLoopback(nullptr) : nullptr;
            if (!device)
                throw core::Error("this OpenAL cannot render into memory", "ALC_SOFT_loopback", "install OpenAL Soft");
        } else {
            rt::guardAgainstRunaways();  // OpenAL asks RealtimeKit for its own thread
            device = alcOpenDevice(nullptr);
            if (!device)
                throw core::Error("there is no sound card", "OpenAL", "connect one and check its settings")
                    .as("no-sound-card");
        }
        find(device, al.isFormatSupported, "alcIsRenderFormatSupportedSOFT");
        find(device, al.render, "alcRenderSamplesSOFT");
        find(device, al.setThreadContext, "alcSetThreadContext");
        find(device, al.getThreadContext, "alcGetThreadContext");
        find(device, al.getSourceDoubles, "alGetSourcedvSOFT");
        if (!al.setThreadContext || !al.getThreadContext)
            throw core::Error("this OpenAL lacks ALC_EXT_thread_local_context", "OpenAL", "install OpenAL Soft");
        if (kind == StageKind::device) {
            const bool all = alcIsExtensionPresent(nullptr, "ALC_ENUMERATE_ALL_EXT") != ALC_FALSE;
            const ALCchar* text = alcGetString(device, all ? ALC_ALL_DEVICES_SPECIFIER : ALC_DEVICE_SPECIFIER);
            name = text ? text : "unnamed";
            // OpenAL's own stand-in for a machine without sound.
            if (name == "No Output")
                throw core::Error("there is no sound card", "OpenAL", "connect one and check its settings");
        } else {
            name = "loopback";
        }
        std::vector<ALCint> wants{ALC_FREQUENCY, static_cast<ALCint>(kSampleRateHz)};
        const auto want = [&wants](ALCint key, ALCint value) { wants.insert(wants.end(), {key, value}); };
        if (kind == StageKind::loopback) {
            want(ALC_FORMAT_CHANNELS_SOFT, ALC_STEREO_SOFT);
            want(ALC_FORMAT_TYPE_SOFT, ALC_FLOAT_SOFT);
            if (!al.render || !al.isFormatSupported ||
                !al.isFormatSupported(device, static_cast<ALCint>(kSampleRateHz), ALC_STEREO_SOFT, ALC_FLOAT_SOFT))
                throw core::Error("this OpenAL cannot render 48 kHz stereo into memory", "ALC_SOFT_loopback",
                                  "install OpenAL Soft");
        }
        if (alcIsExtensionPresent(device, "ALC_SOFT_HRTF")) want(ALC_HRTF_SOFT, headphones ? ALC_TRUE : ALC_FALSE);
        if (kind == StageKind::loopback && alcIsExtensionPresent(device, "ALC_SOFT_output_limiter"))
            want(ALC_OUTPUT_LIMITER_SOFT, ALC_FALSE);
        wants.push_back(0);
        context = alcCreateContext(device, wants.data());
        if (!context)
            throw core::Error(fmt::format("OpenAL makes no context (error {:#x})", alcGetError(device)), name,
                              "check the sound settings");
        ALCint refresh = 0, rate = 0;
        alcGetIntegerv(device, ALC_REFRESH, 1, &refresh);
        alcGetIntegerv(device, ALC_FREQUENCY, 1, &rate);
        // In frames of ours, rounded up: the refresh rate is told in whole hertz.
        if (refresh > 0 && rate > 0) periodFrames = static_cast<int>(std::ceil(kSampleRateHz / refresh));
    }

    void makeSources() {
        const Bind bind(al, context);
        if (!alIsExtensionPresent("AL_EXT_FLOAT32"))
            throw core::Error("this OpenAL lacks AL_EXT_FLOAT32", name, "install OpenAL Soft");
        if (!alIsExtensionPresent("AL_SOFT_source_latency")) al.getSourceDoubles = nullptr;
        alGetError();
        // Held at its loudest by the source's largest gain, which is 1: the listener makes up for it.
        alDistanceModel(AL_INVERSE_DISTANCE_CLAMPED);
        alListenerf(AL_GAIN, static_cast<ALfloat>(kLoudest));
        for (Queue& queue : queues) {
            alGenSources(1, &queue.source);
            alSourcef(queue.source, AL_REFERENCE_DISTANCE,
                      static_cast<ALfloat>(kMetresPerMm * kReferenceMm / kLoudest));
            alSourcef(queue.source, AL_ROLLOFF_FACTOR, 1.0f);
        }
        if (const ALenum error = alGetError(); error != AL_NO_ERROR)
            throw core::Error(fmt::format("OpenAL makes no sources (error {:#x})", error), name,
                              "close other programs that play sound");
    }
};

Stage::Stage(StageKind kind, bool headphones) : state_(std::make_unique<State>()) {
    state_->kind = kind;
    state_->open(headphones);
    state_->makeSources();
}

Stage::~Stage() = default;

const std::string& Stage::name() const noexcept {
    return state_->name;
}
int Stage::periodFrames() const noexcept {
    return state_->periodFrames;
}

bool Stage::connected() const noexcept {
    if (!alcIsExtensionPresent(state_->device, "ALC_EXT_disconnect")) return true;
    ALCint value = ALC_TRUE;
    alcGetIntegerv(state_->device, ALC_CONNECTED, 1, &value);
    return value != ALC_FALSE;
}

void Stage::place(const Ear& ear, const core::Vec3& motorMm, const core::Vec3& cuttingMm, double passedS) {
    State& s = *state_;
    const Place to{ear.eyeMm, ear.forward, ear.up, motorMm, cuttingMm};
    const auto usable = [](const core::Vec3& v) { return v.allFinite() && v.squaredNorm() < 1e12; };
    for (const core::Vec3* v : {&to.eye, &to.forward, &to.up, &to.motor, &to.cutting})
        if (!usable(*v)) return;  // stays where it was
    const double share = s.placed ? 1.0 - std::exp(-passedS / kPassS) : 1.0;
    if (!s.placed) s.at = to;
    s.placed = true;
    s.at.eye += share * (to.eye - s.at.eye);
    s.at.forward += share * (to.forward - s.at.forward);
    s.at.up += share * (to.up - s.at.up);
    s.at.motor += share * (to.motor - s.at.motor);
    s.at.cutting += share * (to.cutting - s.at.cutting);
    const Bind bind(s.al, s.context);
    const auto metres = [](const core::Vec3& mm) {
        return std::array<ALfloat, 3>{static_cast<ALfloat>(kMetresPerMm * mm.x()),
                                      static_cast<ALfloat>(kMetresPerMm * mm.y()),
                                      static_cast<ALfloat>(kMetresPerMm * mm.z())};
    };
    alcSuspendContext(s.context);
    alListenerfv(AL_POSITION, metres(s.at.eye).data());
    const std::array<ALfloat, 6> orientation{
        static_cast<ALfloat>(s.at.forward.x()), static_cast<ALfloat>(s.at.forward.y()),
        static_cast<ALfloat>(s.at.forward.z()), static_cast<ALfloat>(s.at.up.x()),
        static_cast<ALfloat>(s.at.up.y()),      static_cast<ALfloat>(s.at.up.z())};
    alListenerfv(AL_ORIENTATION, orientation.data());
    alSourcefv(s.queues[0].source, AL_POSITION, metres(s.at.motor).data());
    alSourcefv(s.queues[1].source, AL_POSITION, metres(s.at.cutting).data());
    alcProcessContext(s.context);
}

void Stage::queue(std::span<const float> motor, std::span<const float> cutting) {
    State& s = *state_;
    const Bind bind(s.al, s.context);
    for (std::size_t i = 0; i < s.queues.size(); ++i) {
        Queue& queue = s.queues[i];
        const std::span<const float> samples = i == 0 ? motor : cutting;
        ALint done = 0;
        alGetSourcei(queue.source, AL_BUFFERS_PROCESSED, &done);
        for (; done > 0 && !queue.blocks.empty(); --done) {
            ALuint buffer = 0;
            alSourceUnqueueBuffers(queue.source, 1, &buffer);
            queue.blocks.pop_front();
            queue.spare.push_back(buffer);
        }
        if (queue.spare.empty()) {
            ALuint buffer = 0;
            alGenBuffers(1, &buffer);
            queue.spare.push_back(buffer);
        }
        const ALuint buffer = queue.spare.back();
        queue.spare.pop_back();
        alBufferData(buffer, AL_FORMAT_MONO_FLOAT32, samples.data(), static_cast<ALsizei>(samples.size_bytes()),
                     static_cast<ALsizei>(kSampleRateHz));
        alSourceQueueBuffers(queue.source, 1, &buffer);
        queue.blocks.push_back({buffer, static_cast<int>(samples.size())});
    }
    if (const ALenum error = alGetError(); error != AL_NO_ERROR)
        throw core::Error(fmt::format("OpenAL takes no more sound (error {:#x})", error), s.name,
                          "close other programs that play sound");
}

void Stage::start() {
    const Bind bind(state_->al, state_->context);
    const std::array<ALuint, 2> sources{state_->queues[0].source, state_->queues[1].source};
    alSourcePlayv(2, sources.data());
}

int Stage::queuedFrames() {
    State& s = *state_;
    const Bind bind(s.al, s.context);
    const Queue& queue = s.queues[0];
    ALint state = 0, offset = 0;
    alGetSourcei(queue.source, AL_SOURCE_STATE, &state);
    if (state == AL_STOPPED) return 0;
    alGetSourcei(queue.source, AL_SAMPLE_OFFSET, &offset);
    int frames = -offset;
    for (const Queue::Block& block : queue.blocks)
        frames += block.frames;
    return std::max(0, frames);
}

bool Stage::ranDry() const {
    const Bind bind(state_->al, state_->context);
    for (const Queue& queue : state_->queues) {
        ALint state = 0;
        alGetSourcei(queue.source, AL_SOURCE_STATE, &state);
        if (state == AL_STOPPED) return true;
    }
    return false;
}

double Stage::deviceLatencyS() const {
    const double period = state_->periodFrames / kSampleRateHz;
    if (!state_->al.getSourceDoubles) return period;
    const Bind bind(state_->al, state_->context);
    std::array<ALdouble, 2> offsetAndLatency{};
    state_->al.getSourceDoubles(state_->queues[0].source, AL_SEC_OFFSET_LATENCY_SOFT, offsetAndLatency.data());
    return std::max(period, offsetAndLatency[1]);
}

void Stage::render(int frames, std::vector<float>& out) {
    const std::size_t before = out.size();
    out.resize(before + 2 * static_cast<std::size_t>(frames));
    const Bind bind(state_->al, state_->context);
    state_->al.render(state_->device, out.data() + before, frames);
}

}  // namespace handpiece::sound
