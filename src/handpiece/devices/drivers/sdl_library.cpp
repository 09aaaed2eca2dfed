// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/sdl_library.h"

#include <fmt/format.h>

#include <mutex>

#include "handpiece/base/core/error.h"

namespace handpiece::drivers {
namespace {

constexpr std::uint32_t kInitJoystick = 0x200, kInitController = 0x2000;
constexpr int kIgnore = 0;
constexpr const char* kRemedy = "install SDL 2 (apt install libsdl2-2.0-0), or name it in HANDPIECE_SDL_LIBRARY";

struct Version {
    std::uint8_t major, minor, patch;
};

}  // namespace

const SdlLibrary& SdlLibrary::get() {
    static std::mutex mutex;
    static const SdlLibrary* one = nullptr;  // never freed: threads that read a pad may outlive main's statics
    const std::lock_guard lock(mutex);
    if (one == nullptr) one = new SdlLibrary;
    return *one;
}

SdlLibrary::SdlLibrary() : library_("SDL 2", {"libSDL2-2.0.so.0", "libSDL2.so"}, "HANDPIECE_SDL_LIBRARY", kRemedy) {
    library_.require(update, "SDL_GameControllerUpdate");
    library_.require(count, "SDL_NumJoysticks");
    library_.require(nameAt, "SDL_JoystickNameForIndex");
    library_.require(isController, "SDL_IsGameController");
    library_.require(idAt, "SDL_JoystickGetDeviceInstanceID");
    library_.require(openController, "SDL_GameControllerOpen");
    library_.require(closeController, "SDL_GameControllerClose");
    library_.require(controllerAttached, "SDL_GameControllerGetAttached");
    library_.require(controllerAxis, "SDL_GameControllerGetAxis");
    library_.require(controllerButton, "SDL_GameControllerGetButton");
    library_.require(rumble, "SDL_GameControllerRumble");
    library_.require(openJoystick, "SDL_JoystickOpen");
    library_.require(closeJoystick, "SDL_JoystickClose");
    library_.require(joystickAttached, "SDL_JoystickGetAttached");
    library_.require(joystickAxis, "SDL_JoystickGetAxis");
    library_.require(joystickButton, "SDL_JoystickGetButton");
    library_.require(axisCount, "SDL_JoystickNumAxes");
    library_.require(buttonCount, "SDL_JoystickNumButtons");
    int (*hint)(const char*, const char*) = nullptr;
    int (*init)(std::uint32_t) = nullptr;
    const char* (*error)() = nullptr;
    int (*joystickEvents)(int) = nullptr;
    int (*controllerEvents)(int) = nullptr;
    library_.require(hint, "SDL_SetHint");
    library_.require(init, "SDL_InitSubSystem");
    library_.require(error, "SDL_GetError");
    library_.require(joystickEvents, "SDL_JoystickEventState");
    library_.require(controllerEvents, "SDL_GameControllerEventState");
    (void)hint("SDL_NO_SIGNAL_HANDLERS", "1");
    (void)hint("SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", "1");  // there is no window of SDL's to have the focus
    if (init(kInitJoystick | kInitController) != 0)
        throw core::Error(fmt::format("SDL does not start ({})", error()), library_.name(), kRemedy)
            .as("sdl-start", {error()});
    (void)joystickEvents(kIgnore);  // nobody empties its queue: states are read
    (void)controllerEvents(kIgnore);
}

std::string SdlLibrary::version() const {
    void (*tell)(Version*) = nullptr;
    library_.find(tell, "SDL_GetVersion");
    Version v{};
    if (tell == nullptr) return library_.name();
    tell(&v);
    return fmt::format("SDL {}.{}.{}", v.major, v.minor, v.patch);
}

std::string SdlLibrary::nameOf(int index) const {
    const char* const name = nameAt(index);
    return name != nullptr && *name != '\0' ? name : fmt::format("joystick {}", index + 1);
}

}  // namespace handpiece::drivers
