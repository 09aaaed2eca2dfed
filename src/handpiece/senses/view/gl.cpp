// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::view::gl {
namespace {

constexpr const char* kRemedy =
    "install a driver: 'apt install libegl1 libegl-mesa0 libgl1-mesa-dri' brings one that needs no graphics card";

const char* eglErrorName(EGLint error) {
    switch (error) {
        case EGL_SUCCESS:
            return "no error told";
        case EGL_NOT_INITIALIZED:
            return "EGL_NOT_INITIALIZED";
        case EGL_BAD_ALLOC:
            return "EGL_BAD_ALLOC";
        case EGL_BAD_CONFIG:
            return "EGL_BAD_CONFIG";
        case EGL_BAD_DISPLAY:
            return "EGL_BAD_DISPLAY";
        case EGL_BAD_MATCH:
            return "EGL_BAD_MATCH";
        case EGL_BAD_PARAMETER:
            return "EGL_BAD_PARAMETER";
        default:
            return "another EGL error";
    }
}

std::string lastEglError() {
    return eglErrorName(eglGetError());
}

/// A display and a context on it, current; or why not, added to `tried`.
bool open(EGLDisplay display, const char* name, std::string& tried, EGLContext& context) {
    const auto failed = [&](const std::string& why) {
        tried += fmt::format("{}{}: {}", tried.empty() ? "" : "; ", name, why);
        return false;
    };
    if (display == EGL_NO_DISPLAY) return failed("not there");
    EGLint major = 0, minor = 0;
    if (eglInitialize(display, &major, &minor) == EGL_FALSE) return failed(lastEglError());
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return failed("it has OpenGL ES only");
    const std::array<EGLint, 5> configWants = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (extensions == nullptr || std::strstr(extensions, "EGL_KHR_no_config_context") == nullptr) {
        EGLint count = 0;
        if (eglChooseConfig(display, configWants.data(), &config, 1, &count) == EGL_FALSE || count == 0)
            return failed("no configuration for OpenGL");
    }
    const std::array<EGLint, 7> wants = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, wants.data());
    if (context == EGL_NO_CONTEXT) return failed(fmt::format("no OpenGL 3.3 core ({})", lastEglError()));
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE) {
        const std::string why = lastEglError();
        eglDestroyContext(display, context);
        return failed(fmt::format("it cannot draw without a window ({})", why));
    }
    return true;
}

GLuint compile(std::string_view name, GLenum kind, std::string_view text) {
    const GLuint shader = glCreateShader(kind);
    const std::string whole = fmt::format("#version 330 core\n{}", text);
    const char* source = whole.c_str();
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint ok = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok == GL_TRUE) return shader;
    std::array<char, 2048> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteShader(shader);
    throw core::Error(
        fmt::format("the {} shader does not compile: {}", kind == GL_VERTEX_SHADER ? "vertex" : "fragment", log.data()),
        fmt::format("shader '{}'", name), "report it with the graphics driver's name");
}

}  // namespace

Context::Context() {
    std::string tried;
    EGLContext context = EGL_NO_CONTEXT;
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    bool opened = open(display, "EGL without display", tried, context);
    if (!opened) {
        display = EGL_NO_DISPLAY;
        const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
        std::array<EGLDeviceEXT, 8> devices{};
        EGLint count = 0;
        if (queryDevices != nullptr &&
            queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE)
            for (EGLint i = 0; i < count && !opened; ++i) {
                display = eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr);
                opened = open(display, "EGL device", tried, context);
            }
    }
    if (!opened) {
        display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
        opened = open(display, "EGL's default display", tried, context);
    }
    if (!opened) throw core::Error("there is no OpenGL 3.3 to draw with", tried, kRemedy).as("no-opengl");
    display_ = display;
    context_ = context;
    const auto text = [](GLenum what) {
        const GLubyte* value = glGetString(what);
        return std::string(value != nullptr ? reinterpret_cast<const char*>(value) : "?");
    };
    const std::string renderer = text(GL_RENDERER), version = text(GL_VERSION);
    description_ = fmt::format("{}, OpenGL {}", renderer, version.substr(0, version.find(' ')));
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
        if (renderer.find(name) != std::string::npos) isSoftware_ = true;
}

Context::~Context() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    // The display is the process's: another context may live on it, so it is not terminated.
    eglDestroyContext(display_, context_);
    eglReleaseThread();
}

void Context::makeCurrent() const {
    if (eglGetCurrentContext() == context_) return;
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
        throw core::Error(fmt::format("the OpenGL context cannot be used on this thread ({})", lastEglError()),
                          description_, "use it on the thread that made it");
}

GLuint BufferTraits::make() {
    GLuint name = 0;
    glGenBuffers(1, &name);
    return name;
}
void BufferTraits::drop(GLuint name) {
    glDeleteBuffers(1, &name);
}
GLuint VertexArrayTraits::make() {
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    return name;
}
void VertexArrayTraits::drop(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
GLuint TextureTraits::make() {
    GLuint name = 0;
    glGenTextures(1, &name);
    return name;
}
void TextureTraits::drop(GLuint name) {
    glDeleteTextures(1, &name);
}
GLuint FramebufferTraits::make() {
    GLuint name = 0;
    glGenFramebuffers(1, &name);
    return name;
}
void FramebufferTraits::drop(GLuint name) {
    glDeleteFramebuffers(1, &name);
}

void Buffer::fill(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
    glBindBuffer(target, name());
    glBufferData(target, static_cast<GLsizeiptr>(bytes), data, usage);
}

void VertexArray::bind() const {
    glBindVertexArray(name());
}

void VertexArray::attach(const Buffer& vertices, std::size_t stride, std::initializer_list<Attribute> attributes) {
    bind();
    glBindBuffer(GL_ARRAY_BUFFER, vertices.name());
    for (const Attribute& a : attributes) {
        const auto* offset = reinterpret_cast<const void*>(a.offset);
        glEnableVertexAttribArray(a.location);
        if (a.integer)
            glVertexAttribIPointer(a.location, a.components, a.type, static_cast<GLsizei>(stride), offset);
        else
            glVertexAttribPointer(a.location, a.components, a.type, a.normalised ? GL_TRUE : GL_FALSE,
                                  static_cast<GLsizei>(stride), offset);
        glVertexAttribDivisor(a.location, a.divisor);
    }
}

void VertexArray::attachIndices(const Buffer& indices) {
    bind();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.name());
}

namespace {
struct PixelFormat {
    GLenum format, type;
};
/// One that fits an internal format, for storage without content.
PixelFormat formatFor(GLenum internal) {
    switch (internal) {
        case GL_DEPTH_COMPONENT24:
        case GL_DEPTH_COMPONENT32F:
            return {GL_DEPTH_COMPONENT, GL_FLOAT};
        case GL_R8:
        case GL_R16F:
        case GL_R32F:
            return {GL_RED, GL_FLOAT};
        default:
            return {GL_RGBA, GL_FLOAT};
    }
}
}  // namespace

void Texture::allocate(int width, int height, GLenum internal, bool linear) {
    if (width == width_ && height == height_ && internal == internal_) return;
    const PixelFormat format = formatFor(internal);
    fill(width, height, internal, format.format, format.type, nullptr, linear);
}

void Texture::fill(int width, int height, GLenum internal, GLenum format, GLenum type, const void* pixels,
                   bool linear) {
    glBindTexture(GL_TEXTURE_2D, name());
    const GLint filter = linear ? GL_LINEAR : GL_NEAREST;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, format, type, pixels);
    width_ = width;
    height_ = height;
    internal_ = internal;
}

void Texture::bind(int unit) const {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, name());
}

void Framebuffer::attach(std::initializer_list<const Texture*> colours, const Texture* depth) {
    bind();
    std::vector<GLenum> buffers;
    for (const Texture* colour : colours) {
        const GLenum at = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size());
        glFramebufferTexture2D(GL_FRAMEBUFFER, at, GL_TEXTURE_2D, colour->name(), 0);
        buffers.push_back(at);
    }
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth != nullptr ? depth->name() : 0, 0);
    if (buffers.empty()) buffers.push_back(GL_NONE);
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw core::Error(fmt::format("OpenGL cannot draw into a texture of this kind (status 0x{:x})", status),
                          "framebuffer", "choose a smaller picture, or report it with the graphics driver's name");
}

void Framebuffer::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, name());
}

Program::Program(std::string_view name, std::string_view vertex, std::string_view fragment) {
    const GLuint v = compile(name, GL_VERTEX_SHADER, vertex);
    GLuint f = 0;
    try {
        f = compile(name, GL_FRAGMENT_SHADER, fragment);
    } catch (const core::Error&) {
        glDeleteShader(v);
        throw;
    }
    name_ = glCreateProgram();
    glAttachShader(name_, v);
    glAttachShader(name_, f);
    glLinkProgram(name_);
    glDeleteShader(v);
    glDeleteShader(f);
    GLint ok = GL_FALSE;
    glGetProgramiv(name_, GL_LINK_STATUS, &ok);
    if (ok == GL_TRUE) return;
    std::array<char, 2048> log{};
    glGetProgramInfoLog(name_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteProgram(name_);
    throw core::Error(fmt::format("the shaders do not fit together: {}", log.data()), fmt::format("shader '{}'", name),
                      "report it with the graphics driver's name");
}

Program::~Program() {
    glDeleteProgram(name_);
}

void Program::use() const {
    glUseProgram(name_);
}

GLint Program::location(const char* uniform) {
    const auto known = locations_.find(std::string_view(uniform));
    if (known != locations_.end()) return known->second;
    return locations_[uniform] = glGetUniformLocation(name_, uniform);
}

void Program::set(const char* uniform, int value) {
    glUniform1i(location(uniform), value);
}
void Program::set(const char* uniform, float value) {
    glUniform1f(location(uniform), value);
}
void Program::set(const char* uniform, const Vec2f& value) {
    glUniform2fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Vec3f& value) {
    glUniform3fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Vec4f& value) {
    glUniform4fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Mat3f& value) {
    glUniformMatrix3fv(location(uniform), 1, GL_FALSE, value.data());
}
void Program::set(const char* uniform, const Mat4f& value) {
    glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}
void Program::set(const char* uniform, const Vec3f* values, int count) {
    glUniform3fv(location(uniform), count, values->data());
}
void Program::set(const char* uniform, const Vec4f* values, int count) {
    glUniform4fv(location(uniform), count, values->data());
}
void Program::set(const char* uniform, const float* values, int count) {
    glUniform1fv(location(uniform), count, values);
}
void Program::set(const char* uniform, const Texture& texture, int unit) {
    texture.bind(unit);
    glUniform1i(location(uniform), unit);
}

const char* const kFullScreenVertex = R"(
out vec2 uv;
void main() {
    vec2 corner = vec2(float((gl_VertexID & 1) << 2) - 1.0, float((gl_VertexID & 2) << 1) - 1.0);
    uv = 0.5 * corner + 0.5;
    gl_Position = vec4(corner, 1.0, 1.0);  // at the very back
}
)";

void drawFullScreen() {
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void check(const char* what) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    throw core::Error(
        error == GL_OUT_OF_MEMORY ? "OpenGL has no memory left" : fmt::format("OpenGL reports error 0x{:x}", error),
        what, "choose a lower picture quality or a smaller window")
        .as("opengl-failed");
}

}  // namespace handpiece::view::gl
