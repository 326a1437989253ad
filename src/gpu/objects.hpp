#pragma once
/// @file objects.hpp  Move-only owners of GL objects. A default-constructed owner is empty (id 0).
///
/// All of them need the context that made them to be current, also when they are destroyed.
#include "gpu/gl.hpp"

#include <cstddef>
#include <string>
#include <utility>

namespace tarn::gpu {

/// Owns one GL name and destroys it with `Destroy`.
template <auto Destroy>
class Name {
public:
    Name() = default;
    explicit Name(GLuint id) : id_(id) {}
    ~Name() {
        if (id_ != 0)
            Destroy(id_);
    }
    Name(Name&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Name& operator=(Name&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    GLuint get() const { return id_; }

private:
    GLuint id_ = 0;
};

inline void delete_texture(GLuint id) { glDeleteTextures(1, &id); }
inline void delete_buffer(GLuint id) { glDeleteBuffers(1, &id); }
inline void delete_sampler(GLuint id) { glDeleteSamplers(1, &id); }
inline void delete_vertex_array(GLuint id) { glDeleteVertexArrays(1, &id); }
inline void delete_framebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
inline void delete_query(GLuint id) { glDeleteQueries(1, &id); }
inline void delete_program(GLuint id) { glDeleteProgram(id); }

/// How texels are looked up between their centres, and beyond the edge.
enum class Filter { nearest, linear, trilinear };

/// Immutable-storage 2D texture; row 0 first in memory; edges clamp.
class Texture2D {
public:
    Texture2D() = default;
    /// @param format  sized internal format, e.g. GL_RG16
    /// @param levels  mip levels, >= 1
    /// @param label   named in errors and shown in GL debug messages
    /// @throws tarn::Error  if a side is outside [1, GL_MAX_TEXTURE_SIZE] or memory runs out
    Texture2D(GLenum format, int width_px, int height_px, int levels, Filter filter,
              const std::string& label);

    /// Uploads all of level 0, tightly packed.
    void upload(GLenum components, GLenum type, const void* texels);
    /// Reads all of level 0 into `bytes` bytes at `out`.
    void download(GLenum components, GLenum type, void* out, std::size_t bytes) const;
    void bind(GLuint unit) const { glBindTextureUnit(unit, name_.get()); }
    void bind_image(GLuint unit, GLenum access, int level = 0) const {
        glBindImageTexture(unit, name_.get(), level, GL_FALSE, 0, access, format_);
    }
    GLuint id() const { return name_.get(); }
    int width_px() const { return width_px_; }
    int height_px() const { return height_px_; }

private:
    Name<delete_texture> name_;
    GLenum format_ = 0;
    int width_px_ = 0, height_px_ = 0;
};

/// Square layers of one size with their mip levels down to 4 x 4; look-ups are trilinear and wrap
/// around.
class TextureLayers {
public:
    TextureLayers() = default;
    /// @throws tarn::Error  if memory runs out
    TextureLayers(GLenum format, int side_px, int layers, const std::string& label);
    void bind(GLuint unit) const { glBindTextureUnit(unit, name_.get()); }
    /// All layers of a level at once.
    void bind_image(GLuint unit, GLenum access, int level) const {
        glBindImageTexture(unit, name_.get(), level, GL_TRUE, 0, access, format_);
    }
    /// Reads all layers of a level into `bytes` bytes at `out`.
    void download(int level, GLenum components, GLenum type, void* out, std::size_t bytes) const {
        glGetTextureImage(name_.get(), level, components, type, GLsizei(bytes), out);
    }
    GLuint id() const { return name_.get(); }
    int levels() const { return levels_; }
    int side_px() const { return side_px_; }
    int layers() const { return layers_; }

private:
    Name<delete_texture> name_;
    GLenum format_ = 0;
    int side_px_ = 0, layers_ = 0, levels_ = 0;
};

/// Bilinear look-up, edges clamped, for a texture that is made without: bound to a unit it takes
/// precedence.
class Sampler {
public:
    Sampler();
    void bind(GLuint unit) const { glBindSampler(unit, name_.get()); }
    static void unbind(GLuint unit) { glBindSampler(unit, 0); }

private:
    Name<delete_sampler> name_;
};

/// Immutable buffer that the CPU may rewrite.
class Buffer {
public:
    Buffer() = default;
    Buffer(std::size_t bytes, const void* data);
    void write(const void* data, std::size_t bytes) {
        glNamedBufferSubData(name_.get(), 0, GLsizeiptr(bytes), data);
    }
    GLuint id() const { return name_.get(); }

private:
    Name<delete_buffer> name_;
};

/// A buffer as shaders look it up: one texel after the other.
class BufferTexture {
public:
    BufferTexture() = default;
    /// @param buffer  must outlive this
    BufferTexture(GLenum format, const Buffer& buffer);
    void bind(GLuint unit) const { glBindTextureUnit(unit, name_.get()); }

private:
    Name<delete_texture> name_;
};

/// A texture that triangles are drawn into.
class Target {
public:
    Target() = default;
    /// @param texture  must outlive this
    /// @throws tarn::Error  if the driver cannot draw into its format
    explicit Target(const Texture2D& texture);
    void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, name_.get()); }

private:
    Name<delete_framebuffer> name_;
};

/// Triangles whose vertices the vertex shader works out from their numbers.
class NoVertices {
public:
    NoVertices();
    void draw(int vertices, int instances) const;

private:
    Name<delete_vertex_array> name_;
};

/// GPU time between start() and stop().
class Timer {
public:
    Timer();
    void start() { glBeginQuery(GL_TIME_ELAPSED, query_.get()); }
    void stop() { glEndQuery(GL_TIME_ELAPSED); }
    /// Waits for the result [ms]. Software GL answers next to nothing: see docs/limits.md.
    double milliseconds() const;

private:
    Name<delete_query> query_;
};

/// @throws tarn::Error  if GL has noted an error since the last call; says while doing what
void check_gl(const std::string& activity);

} // namespace tarn::gpu
