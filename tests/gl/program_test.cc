#include "gl/program.h"

#include "base/error.h"
#include "gl/context.h"
#include "gl/shaders.h"

#include <gtest/gtest.h>

namespace kerf::gl::program_test {
namespace {

const ShaderText vertex = {"flat.vert",
                           "#version 330 core\n"
                           "layout(location = 0) in vec3 p;\n"
                           "void main() { gl_Position = vec4(p, 1.0); }\n"};
const ShaderText fragment = {"flat.frag",
                             "#version 330 core\n"
                             "uniform float grey;\n"
                             "out vec4 colour;\n"
                             "void main() { colour = vec4(grey); }\n"};

std::string message_of(const auto& action) {
  try {
    action();
  } catch (const DataError& e) {
    return e.what();
  }
  return "nothing was thrown";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Program, SaysWhereAShaderDoesNotCompile) {
  const Context context;
  const ShaderText wrong = {"wrong.frag", "#version 330 core\nvoid main() { undeclared_name = 1.0; }\n"};
  const std::string message = message_of([&] { Program(vertex, wrong); });
  EXPECT_TRUE(holds(message, "wrong.frag")) << message;
  EXPECT_TRUE(holds(message, "undeclared_name")) << message;
  EXPECT_TRUE(holds(message, "does not compile")) << message;
}

TEST(Program, SaysWhyShadersDoNotLink) {
  const Context context;
  const ShaderText giving = {"giving.vert",
                             "#version 330 core\n"
                             "out vec2 passed_on;\n"
                             "void main() { passed_on = vec2(1.0); gl_Position = vec4(0.0); }\n"};
  const ShaderText taking = {"taking.frag",
                             "#version 330 core\n"
                             "in vec3 passed_on;\n"
                             "out vec4 colour;\n"
                             "void main() { colour = vec4(passed_on, 1.0); }\n"};
  const std::string message = message_of([&] { Program(giving, taking); });
  EXPECT_TRUE(holds(message, "giving.vert + taking.frag")) << message;
  EXPECT_TRUE(holds(message, "passed_on")) << message;
}

TEST(Program, RefusesAnUnknownUniform) {
  const Context context;
  const Program program(vertex, fragment);
  EXPECT_NO_THROW(program.set("grey", 0.5f));
  const std::string message = message_of([&] { program.set("gray", 0.5f); });
  EXPECT_TRUE(holds(message, "gray")) << message;
}

TEST(Shaders, NamesWhatIsEmbedded) {
  EXPECT_TRUE(holds(std::string(shader_source("solid.frag")), "#version 330 core"));
  const std::string message = message_of([] { shader_source("no_such.frag"); });
  EXPECT_TRUE(holds(message, "no_such.frag")) << message;
  EXPECT_TRUE(holds(message, "solid.frag")) << message;
}

} // namespace
} // namespace kerf::gl::program_test
