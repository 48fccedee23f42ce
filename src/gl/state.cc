#include "gl/state.h"

#include "gl/api.h"

namespace kerf::gl {

Within::Within(const Rectangle& rectangle) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(rectangle.left, rectangle.lower, rectangle.right - rectangle.left, rectangle.upper - rectangle.lower);
}
Within::~Within() { glDisable(GL_SCISSOR_TEST); }

DepthsAlone::DepthsAlone() { glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE); }
DepthsAlone::~DepthsAlone() { glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE); }

EqualDepthsPass::EqualDepthsPass() { glDepthFunc(GL_LEQUAL); }
EqualDepthsPass::~EqualDepthsPass() { glDepthFunc(GL_LESS); }

} // namespace kerf::gl
