#include "gpu/objects.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

namespace tarn::gpu {

Texture2D::Texture2D(GLenum format, int width_px, int height_px, int levels, Filter filter,
                     const std::string& label)
    : format_(format), width_px_(width_px), height_px_(height_px) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (width_px < 1 || height_px < 1 || width_px > limit || height_px > limit)
        throw Error(text(label, " is ", width_px, " x ", height_px, ", this GPU allows up to ",
                         limit, " a side"),
                    "use a smaller picture, or import a smaller or coarser scene");
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &id);
    name_ = Name<delete_texture>(id);
    glTextureStorage2D(id, levels, format, width_px, height_px);
    if (glGetError() == GL_OUT_OF_MEMORY)
        throw Error(text("out of GPU memory for ", label, " of ", width_px, " x ", height_px),
                    "use a smaller picture, or import a smaller or coarser scene");
    const GLint minify = filter == Filter::nearest
                             ? (levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST)
                         : filter == Filter::linear ? GL_LINEAR
                                                    : GL_LINEAR_MIPMAP_LINEAR;
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, minify);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER,
                        filter == Filter::nearest ? GL_NEAREST : GL_LINEAR);
    glTextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glObjectLabel(GL_TEXTURE, id, static_cast<GLsizei>(label.size()), label.c_str());
}

void Texture2D::upload(GLenum components, GLenum type, const void* texels) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(id(), 0, 0, 0, width_px_, height_px_, components, type, texels);
}

void Texture2D::download(GLenum components, GLenum type, void* out, std::size_t bytes) const {
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glGetTextureImage(id(), 0, components, type, static_cast<GLsizei>(bytes), out);
}

TextureLayers::TextureLayers(GLenum format, int side_px, int layers, const std::string& label)
    : format_(format), side_px_(side_px), layers_(layers), levels_(1) {
    while (side_px >> (levels_ + 2) > 0) // to 4 x 4: fewer texels would say little but the mean
        ++levels_;
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
    name_ = Name<delete_texture>(id);
    glTextureStorage3D(id, levels_, format, side_px, side_px, layers);
    if (glGetError() == GL_OUT_OF_MEMORY)
        throw Error(text("out of GPU memory for ", label, " of ", layers, " x ", side_px, "^2"),
                    "use fewer or smaller ones");
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(id, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(id, GL_TEXTURE_WRAP_T, GL_REPEAT);
    glObjectLabel(GL_TEXTURE, id, static_cast<GLsizei>(label.size()), label.c_str());
}

Sampler::Sampler() {
    GLuint id = 0;
    glCreateSamplers(1, &id);
    name_ = Name<delete_sampler>(id);
    glSamplerParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Buffer::Buffer(std::size_t bytes, const void* data) {
    GLuint id = 0;
    glCreateBuffers(1, &id);
    name_ = Name<delete_buffer>(id);
    glNamedBufferStorage(id, GLsizeiptr(bytes), data, GL_DYNAMIC_STORAGE_BIT);
}

BufferTexture::BufferTexture(GLenum format, const Buffer& buffer) {
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &id);
    name_ = Name<delete_texture>(id);
    glTextureBuffer(id, format, buffer.id());
}

Target::Target(const Texture2D& texture) {
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    name_ = Name<delete_framebuffer>(id);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, texture.id(), 0);
    if (glCheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error("the GL driver cannot draw into a texture that it made",
                    "please report it with tarn doctor's output");
}

NoVertices::NoVertices() {
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    name_ = Name<delete_vertex_array>(id);
}

void NoVertices::draw(int vertices, int instances) const {
    glBindVertexArray(name_.get());
    glDrawArraysInstanced(GL_TRIANGLES, 0, vertices, instances);
    glBindVertexArray(0);
}

Timer::Timer() {
    GLuint id = 0;
    glCreateQueries(GL_TIME_ELAPSED, 1, &id);
    query_ = Name<delete_query>(id);
}

double Timer::milliseconds() const {
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query_.get(), GL_QUERY_RESULT, &nanoseconds);
    return double(nanoseconds) * 1e-6;
}

void check_gl(const std::string& activity) {
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR)
        return;
    if (code == GL_CONTEXT_LOST)
        throw Error("the GPU was lost: its driver has reset it while " + activity,
                    "start tarn again; if it comes back, try a smaller picture");
    const char* word = code == GL_OUT_OF_MEMORY ? "out of GPU memory" : "OpenGL error";
    std::ostringstream out;
    out << word << " (0x" << std::hex << code << ") while " << activity;
    throw Error(out.str(), "run tarn doctor, and try a smaller picture");
}

} // namespace tarn::gpu
