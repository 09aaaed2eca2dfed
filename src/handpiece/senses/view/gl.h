// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// OpenGL 3.3 core without a display, and owners of what lives in it. Private to this room; one thread.

#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES 1
#endif
#include <GL/glcorearb.h>

#include <Eigen/Core>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

namespace handpiece::view::gl {

using Mat3f = Eigen::Matrix3f;
using Mat4f = Eigen::Matrix4f;  ///< column by column in memory, as OpenGL wants it
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Vec4f = Eigen::Vector4f;

/// A context of OpenGL 3.3 core, made current on the thread that makes it: EGL's surfaceless platform, else its default
/// display. Throws core::Error saying what was tried and what to install.
class Context {
  public:
    Context();
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
    [[nodiscard]] const std::string& description() const noexcept { return description_; }
    [[nodiscard]] bool isSoftware() const noexcept { return isSoftware_; }
    /// Again on this thread, after somebody else's context was.
    void makeCurrent() const;

  private:
    void* display_ = nullptr;
    void* context_ = nullptr;
    std::string description_;
    bool isSoftware_ = false;
};

/// A name of OpenGL and how it is given back. `Traits::make()` and `Traits::drop(name)`.
template <class Traits>
class Owner {
  public:
    Owner() : name_(Traits::make()) {}
    ~Owner() {
        if (name_ != 0) Traits::drop(name_);
    }
    Owner(Owner&& other) noexcept : name_(other.name_) { other.name_ = 0; }
    Owner& operator=(Owner&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    Owner(const Owner&) = delete;
    Owner& operator=(const Owner&) = delete;
    [[nodiscard]] GLuint name() const noexcept { return name_; }

  private:
    GLuint name_;
};

struct BufferTraits {
    static GLuint make();
    static void drop(GLuint name);
};
struct VertexArrayTraits {
    static GLuint make();
    static void drop(GLuint name);
};
struct TextureTraits {
    static GLuint make();
    static void drop(GLuint name);
};
struct FramebufferTraits {
    static GLuint make();
    static void drop(GLuint name);
};

class Buffer : public Owner<BufferTraits> {
  public:
    /// Bound to `target`, filled, as GL_STATIC_DRAW, GL_STREAM_DRAW...
    void fill(GLenum target, const void* data, std::size_t bytes, GLenum usage);
};

/// How one attribute lies in a buffer's vertices.
struct Attribute {
    GLuint location;
    GLint components;
    GLenum type;
    bool normalised;
    std::size_t offset;
    bool integer = false;  ///< read as int or uint by the shader
    GLuint divisor = 0;
};
class VertexArray : public Owner<VertexArrayTraits> {
  public:
    void bind() const;
    /// Says where attributes come from. Leaves the array bound.
    void attach(const Buffer& vertices, std::size_t stride, std::initializer_list<Attribute> attributes);
    void attachIndices(const Buffer& indices);
};

/// Two-dimensional, without mipmaps, clamped at its edges.
class Texture : public Owner<TextureTraits> {
  public:
    /// Storage of this size, its content undefined; nothing happens when it is that already. `internal` as GL_RGBA8.
    void allocate(int width, int height, GLenum internal, bool linear = false);
    /// The same and filled; rows tightly packed.
    void fill(int width, int height, GLenum internal, GLenum format, GLenum type, const void* pixels,
              bool linear = false);
    void bind(int unit) const;
    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }

  private:
    int width_ = 0, height_ = 0;
    GLenum internal_ = 0;
};

/// Bind, attach, draw. The textures must outlive it.
class Framebuffer : public Owner<FramebufferTraits> {
  public:
    /// Null: without. Throws core::Error when OpenGL cannot draw into such a set.
    void attach(std::initializer_list<const Texture*> colours, const Texture* depth);
    void bind() const;
};

/// A vertex and a fragment shader, GLSL 330 (the version line is added), linked.
class Program {
  public:
    /// Throws core::Error with the compiler's log. `name` is for that message.
    Program(std::string_view name, std::string_view vertex, std::string_view fragment);
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void use() const;
    // Uniforms of the program in use; names that the shader does not have count for nothing.
    void set(const char* uniform, int value);
    void set(const char* uniform, float value);
    void set(const char* uniform, const Vec2f& value);
    void set(const char* uniform, const Vec3f& value);
    void set(const char* uniform, const Vec4f& value);
    void set(const char* uniform, const Mat3f& value);
    void set(const char* uniform, const Mat4f& value);
    void set(const char* uniform, const Vec3f* values, int count);
    void set(const char* uniform, const Vec4f* values, int count);
    void set(const char* uniform, const float* values, int count);
    /// Binds the texture to the unit and the sampler to it.
    void set(const char* uniform, const Texture& texture, int unit);

  private:
    [[nodiscard]] GLint location(const char* uniform);
    GLuint name_ = 0;
    std::map<std::string, GLint, std::less<>> locations_;
};

/// Vertex shader of a pass over the whole viewport, drawn by drawFullScreen(): `out vec2 uv`, 0..1.
extern const char* const kFullScreenVertex;
/// Three vertices without a buffer.
void drawFullScreen();

/// Throws core::Error when OpenGL has an error to tell; `what` was being done.
void check(const char* what);

}  // namespace handpiece::view::gl
