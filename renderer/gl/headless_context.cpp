#include "renderer/gl/headless_context.h"

#include "assets/base/error.h"
#include "renderer/gl/debug.h"

#include <array>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <spdlog/fmt/fmt.h>

namespace relume::gl {
namespace {

constexpr const char* kMend = "install libegl1 and libgl1-mesa-dri; 'relume bake' needs none";

struct Display {
    EGLDisplay display = EGL_NO_DISPLAY;
    std::string platform;
};

bool has(const char* extensions, std::string_view name) {
    const std::string_view all = extensions != nullptr ? extensions : "";
    for (size_t at = all.find(name); at != std::string_view::npos; at = all.find(name, at + 1)) {
        const size_t end = at + name.size();
        if ((at == 0 || all[at - 1] == ' ') && (end == all.size() || all[end] == ' ')) return true;
    }
    return false;
}

// Tells whether libEGL can be loaded: epoxy ends the program where it cannot.
bool eglExists() {
    void* library = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL);
    return library != nullptr; // stays loaded: epoxy takes the same
}

// Adds a display for each EGL device: those of GPUs, or those of Mesa's software renderer.
void addDevices(bool software, std::vector<Display>& displays) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) return;
    for (EGLint i = 0; i < count; ++i) {
        EGLDeviceEXT device = devices[static_cast<size_t>(i)];
        const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
        if (has(extensions, "EGL_MESA_device_software") != software) continue;
        displays.push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr), "device"});
    }
}

// Returns the displays in the order in which to try them: GPUs, then what Mesa finds by itself, then its
// software device.
std::vector<Display> findDisplays() {
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<Display> displays;
    const bool devices = has(client, "EGL_EXT_platform_device") &&
                         (has(client, "EGL_EXT_device_enumeration") || has(client, "EGL_EXT_device_base"));
    if (devices) addDevices(false, displays);
    if (has(client, "EGL_MESA_platform_surfaceless")) {
        void* native = nullptr; // EGL_DEFAULT_DISPLAY
        displays.push_back(
            {eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, native, nullptr), "surfaceless"});
    }
    if (devices) addDevices(true, displays);
    return displays;
}

// Returns a configuration for OpenGL, or nullptr where the display has none. It is not looked for where none
// is needed.
EGLConfig findConfig(EGLDisplay display) {
    if (has(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_no_config_context")) return EGL_NO_CONFIG_KHR;
    const std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                          EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    eglChooseConfig(display, wanted.data(), &config, 1, &count);
    return count > 0 ? config : nullptr;
}

// Makes a context and makes it current; returns EGL_NO_CONTEXT where this display cannot have one. Version 0
// takes any.
EGLContext makeContext(EGLDisplay display, EGLConfig config, int major, bool debug) {
    std::vector<EGLint> attributes;
    if (major > 0) {
        attributes = {EGL_CONTEXT_MAJOR_VERSION,       major,
                      EGL_CONTEXT_MINOR_VERSION,       5,
                      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
        if (debug) attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
    }
    attributes.push_back(EGL_NONE);
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return context;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

// Returns what the display's driver has instead of OpenGL 4.5, or "" where it has nothing.
std::string describeOlder(EGLDisplay display, EGLConfig config) {
    EGLContext context = makeContext(display, config, 0, false);
    if (context == EGL_NO_CONTEXT) return "";
    std::string text = describeContext();
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
    return text;
}

} // namespace

HeadlessContext::HeadlessContext(const Desc& desc) {
    if (!eglExists())
        throw Error(fmt::format("no EGL (libEGL.so.1) for pictures without a display: {}", kMend));
    std::string older;
    for (const Display& candidate : findDisplays()) {
        if (candidate.display == EGL_NO_DISPLAY) continue;
        if (eglInitialize(candidate.display, nullptr, nullptr) != EGL_TRUE) continue;
        constexpr int kMajor = 4; // of OpenGL 4.5
        const EGLConfig config = findConfig(candidate.display);
        if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE) {
            context_ = makeContext(candidate.display, config, kMajor, desc.debug);
            if (context_ == EGL_NO_CONTEXT && older.empty()) older = describeOlder(candidate.display, config);
        }
        if (context_ != EGL_NO_CONTEXT) {
            display_ = candidate.display;
            platform_ = candidate.platform;
            listenToDebugMessages();
            return;
        }
        eglTerminate(candidate.display);
    }
    if (!older.empty())
        throw Error(
            older +
            ": pictures need OpenGL 4.5: bring the graphics driver up to date; 'relume bake' needs none");
    throw Error(fmt::format("no OpenGL driver for pictures without a display was found by EGL: {}", kMend));
}

HeadlessContext::~HeadlessContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
}

} // namespace relume::gl
