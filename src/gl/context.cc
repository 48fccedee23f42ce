#include "gl/context.h"

#include "base/error.h"
#include "gl/api.h"

#include <vector>

#if defined(__SANITIZE_ADDRESS__)
/// What Mesa keeps of a context that is destroyed, 480 bytes, is no leak of ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa"; }
#endif

namespace kerf::gl {

namespace {

const char* const remedy =
  "Install Mesa's off-screen library (Debian: libosmesa6) or leave the images out of the scene";

// OSMesa wants a default image for every context; ours draw into framebuffers only.
constexpr int default_image_size = 16;

OSMesaContext create() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  return OSMesaCreateContextAttribs(attributes, nullptr);
}

} // namespace

struct Context::Handle {
  Handle() : context(create()), image(4 * default_image_size * default_image_size) {}
  ~Handle() {
    if (context)
      OSMesaDestroyContext(context);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  OSMesaContext context;
  std::vector<unsigned char> image;
};

Context::Context() : handle_(std::make_unique<Handle>()) {
  if (!handle_->context)
    throw DataError({.path = "OpenGL",
                     .value = "OSMesa",
                     .rule = "no context of OpenGL 3.3, core profile, could be made",
                     .remedy = remedy});
  make_current();
  glEnable(GL_DEPTH_TEST);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

Context::~Context() = default;

void Context::make_current() const {
  if (!OSMesaMakeCurrent(handle_->context, handle_->image.data(), GL_UNSIGNED_BYTE, default_image_size,
                         default_image_size))
    throw DataError({.path = "OpenGL", .value = "OSMesa", .rule = "the context cannot be used", .remedy = remedy});
}

void Context::release() const { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

void Context::clip(const int n) const {
  make_current();
  for (int i = 0; i < 8; ++i)
    (i < n ? glEnable : glDisable)(GL_CLIP_DISTANCE0 + static_cast<GLenum>(i));
}

Version Context::version() const {
  make_current();
  Version v;
  glGetIntegerv(GL_MAJOR_VERSION, &v.major);
  glGetIntegerv(GL_MINOR_VERSION, &v.minor);
  return v;
}

std::string Context::device() const {
  make_current();
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

} // namespace kerf::gl
