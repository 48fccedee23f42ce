#include "base/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace kerf::parameters_test {
namespace {

/// One key of each type.
struct Everything {
  double stiffness = 5e4;
  int n_steps = 10;
  bool gravity = true;
  std::string mesh = "liver.off";
  std::string volume = "octants";
  Vec3 force = {0, 0, -9.81};
  Points path = {{0, 0, 0}, {0.1, 0, 1e-9}};
  std::vector<double> ratios = {0.25, 0.5};

  void describe(Parameters& p) {
    p.number("Stiffness [Pa]", stiffness, positive, "Resistance to stretch.");
    p.integer("Steps", n_steps, Range{1, 100}, "How many.");
    p.boolean("Gravity", gravity, "Whether there is gravity.");
    p.text("Mesh", mesh, "A file.");
    p.choice("Volume", volume, {"octants", "full cube"}, "How material is counted.");
    p.vector("Force [N]", force, "On the tip.");
    p.points("Path [m]", path, "Where the blade goes.");
    p.numbers("Ratios [1]", ratios, Range{0, 1, true, false}, "Thresholds.");
  }
};

class ParametersTest : public testing::Test {
 protected:
  ParametersTest() { fields.describe(parameters); }

  const Parameter& key(const std::string& name) const {
    for (const auto& parameter : parameters.list())
      if (parameter.name == name)
        return parameter;
    throw std::out_of_range(name);
  }
  std::string assign(const std::string& name, const std::string& value) const { return key(name).assign(value); }

  Everything fields;
  Parameters parameters;
};

TEST_F(ParametersTest, DefaultsAreReadable) {
  EXPECT_EQ(key("Stiffness [Pa]").fallback, "50000");
  EXPECT_EQ(key("Steps").fallback, "10");
  EXPECT_EQ(key("Gravity").fallback, "yes");
  EXPECT_EQ(key("Mesh").fallback, "liver.off");
  EXPECT_EQ(key("Force [N]").fallback, "0, 0, -9.81");
  EXPECT_EQ(key("Path [m]").fallback, "0, 0, 0; 0.1, 0, 1e-9");
  EXPECT_EQ(key("Ratios [1]").fallback, "0.25, 0.5");
}

TEST_F(ParametersTest, DefaultsReadBackAsTheyAre) {
  Everything other{1, 1, false, "", "full cube", Vec3::Zero(), {}, {}};
  Parameters p;
  other.describe(p);
  for (std::size_t i = 0; i < p.list().size(); ++i)
    EXPECT_EQ(p.list()[i].assign(parameters.list()[i].fallback), "") << p.list()[i].name;
  EXPECT_EQ(other.stiffness, fields.stiffness);
  EXPECT_EQ(other.n_steps, fields.n_steps);
  EXPECT_EQ(other.gravity, fields.gravity);
  EXPECT_EQ(other.mesh, fields.mesh);
  EXPECT_EQ(other.volume, fields.volume);
  EXPECT_EQ(other.force, fields.force);
  EXPECT_EQ(other.path, fields.path);
  EXPECT_EQ(other.ratios, fields.ratios);
}

TEST_F(ParametersTest, ValuesAreAssigned) {
  EXPECT_EQ(assign("Stiffness [Pa]", " 2.5e3 "), "");
  EXPECT_EQ(fields.stiffness, 2500);
  EXPECT_EQ(assign("Steps", "+7"), "");
  EXPECT_EQ(fields.n_steps, 7);
  EXPECT_EQ(assign("Gravity", "false"), "");
  EXPECT_FALSE(fields.gravity);
  EXPECT_EQ(assign("Gravity", "yes"), "");
  EXPECT_TRUE(fields.gravity);
  EXPECT_EQ(assign("Volume", "full cube"), "");
  EXPECT_EQ(fields.volume, "full cube");
  EXPECT_EQ(assign("Force [N]", "1,2 , -3"), "");
  EXPECT_EQ(fields.force, Vec3(1, 2, -3));
  EXPECT_EQ(assign("Path [m]", "1, 2, 3"), "");
  EXPECT_EQ(fields.path, Points({{1, 2, 3}}));
  EXPECT_EQ(assign("Path [m]", ""), "");
  EXPECT_TRUE(fields.path.empty());
  EXPECT_EQ(assign("Ratios [1]", "1"), "");
  EXPECT_EQ(fields.ratios, std::vector<double>{1});
}

TEST_F(ParametersTest, BadNumbersBreakTheirRule) {
  for (const std::string value : {"0", "-1", "-1e300"})
    EXPECT_EQ(assign("Stiffness [Pa]", value), "must be > 0") << value;
  for (const std::string value : {"0", "101", "-7"})
    EXPECT_EQ(assign("Steps", value), "must be a whole number >= 1 and <= 100") << value;
  EXPECT_EQ(fields.stiffness, 5e4);
  EXPECT_EQ(fields.n_steps, 10);
}

TEST_F(ParametersTest, WhatIsNoNumberIsToldAsSuch) {
  const auto expect = [&](const std::string& name, const std::string& value, const std::string& fault) {
    EXPECT_EQ(assign(name, value), fault + "; " + key(name).rule) << value;
    EXPECT_EQ(key(name).check(value), fault + "; " + key(name).rule) << value;
  };
  for (const std::string value : {"abc", "1e", "1 2", "5e4Pa", "0x10", "+-1", "--1", "1,2,3"})
    expect("Stiffness [Pa]", value, "is no number");
  expect("Stiffness [Pa]", "1,5", "is no number, as decimals begin with a point");
  expect("Stiffness [Pa]", " ", "is empty");
  for (const std::string value : {"nan", "inf", "-inf"})
    expect("Stiffness [Pa]", value, "is no finite number");
  for (const std::string value : {"1e999", "1e-999"})
    expect("Stiffness [Pa]", value, "is beyond what numbers can be");
  for (const std::string value : {"3.5", "1e1", "one", "1,5"})
    expect("Steps", value, "is not written as a whole number");
  expect("Steps", "", "is empty");
  expect("Steps", "99999999999", "is beyond what numbers can be");
  EXPECT_EQ(fields.stiffness, 5e4);
  EXPECT_EQ(fields.n_steps, 10);
}

TEST_F(ParametersTest, ListsSayWhichPartIsNoNumber) {
  const std::string vector = "must be three numbers x, y, z, all finite", one = "one of them ";
  for (const auto& [value, fault] : std::vector<std::pair<std::string, std::string>>{
         {"", "is empty"}, {"1 2 3", "'1 2 3' is no number"}, {"1, 2, nan", "'nan' is no finite number"},
         {"1, 2, ", one + "is empty"}, {"1, " + std::string(41, 'a'), one + "is no number"}})
    EXPECT_EQ(assign("Force [N]", value), fault + "; " + vector) << value;
  EXPECT_EQ(assign("Path [m]", "1, 2, 3;"), one + "is empty; must be points x, y, z; x, y, z, all finite");
  EXPECT_EQ(assign("Ratios [1]", "0.5, half"),
            "'half' is no number; must be numbers separated by commas, each > 0 and <= 1");
}

TEST_F(ParametersTest, BadWordsAndListsBreakTheirRule) {
  for (const std::string value : {"", "Yes", "1", "yes no"})
    EXPECT_EQ(assign("Gravity", value), "must be yes or no") << value;
  for (const std::string value : {"", "octant", "full", "octants, full cube"})
    EXPECT_EQ(assign("Volume", value), "must be one of octants, full cube") << value;
  for (const std::string value : {"1, 2", "1, 2, 3, 4"})
    EXPECT_EQ(assign("Force [N]", value), "must be three numbers x, y, z, all finite") << value;
  for (const std::string value : {"1, 2", "1, 2, 3; 4, 5"})
    EXPECT_EQ(assign("Path [m]", value), "must be points x, y, z; x, y, z, all finite") << value;
  for (const std::string value : {"0", "0.5, 1.1"})
    EXPECT_EQ(assign("Ratios [1]", value), "must be numbers separated by commas, each > 0 and <= 1") << value;
  EXPECT_EQ(fields.force, Vec3(0, 0, -9.81));
  EXPECT_EQ(fields.path.size(), 2u);
}

TEST_F(ParametersTest, CheckDoesNotAssign) {
  EXPECT_EQ(key("Steps").check("50"), "");
  EXPECT_EQ(key("Steps").check("0"), key("Steps").rule);
  EXPECT_EQ(fields.n_steps, 10);
}

TEST_F(ParametersTest, RequireLast) {
  EXPECT_FALSE(key("Ratios [1]").required);
  parameters.require_last();
  EXPECT_TRUE(key("Ratios [1]").required);
  EXPECT_FALSE(key("Path [m]").required);
}

TEST(Range, RulesSayTheBounds) {
  EXPECT_EQ(positive.rule(), "must be > 0");
  EXPECT_EQ(non_negative.rule(), "must be >= 0");
  EXPECT_EQ(any_number.rule(), "must be a number");
  EXPECT_EQ((Range{0, 0.5, false, true}).rule(), "must be >= 0 and < 0.5");
  EXPECT_EQ((Range{.max = 3}).rule(), "must be <= 3");
}

TEST(Range, ContainsRespectsOpenEnds) {
  const Range half_open{0, 0.5, false, true};
  EXPECT_TRUE(half_open.contains(0));
  EXPECT_FALSE(half_open.contains(0.5));
  EXPECT_FALSE(half_open.contains(-1e-300));
  EXPECT_FALSE(positive.contains(0));
  EXPECT_FALSE(any_number.contains(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(any_number.contains(std::numeric_limits<double>::quiet_NaN()));
}

TEST(ToText, IsShort) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(0), "0");
  EXPECT_EQ(to_text(-9.81), "-9.81");
  EXPECT_EQ(to_text(50000), "50000");
  EXPECT_EQ(to_text(1e5), "1e5");
  EXPECT_EQ(to_text(-2.5e-9), "-2.5e-9");
  EXPECT_EQ(to_text(1e100), "1e100");
}

TEST(ToText, ReadsBackAsTheSameBits) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-300, 300);
  double field = 0;
  Parameters p;
  p.number("x", field, any_number, "");
  for (int i = 0; i < 2000; ++i) {
    const double x = mantissa(random) * std::pow(10, exponent(random));
    ASSERT_EQ(p.list()[0].assign(to_text(x)), "") << to_text(x);
    ASSERT_EQ(field, x);
  }
}

} // namespace
} // namespace kerf::parameters_test
