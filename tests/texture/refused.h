#pragma once

/// What an interior must not be made from.

#include "base/error.h"
#include "tests/texture/solids.h"

#include <gtest/gtest.h>

namespace kerf::texture {

inline void expect_refused(const std::vector<Exemplar>& exemplars, const std::string& key, const std::string& rule,
                           const InteriorOptions& options = {}, const geometry::TriangleMesh& body = ball(3)) {
  try {
    const Interior inside(exemplars, body, options);
    FAIL() << rule;
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.complaint().path, key) << error.what();
    EXPECT_NE(error.complaint().rule.find(rule), std::string::npos) << error.what();
    EXPECT_FALSE(error.complaint().remedy.empty());
  }
}

} // namespace kerf::texture
