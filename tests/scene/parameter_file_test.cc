#include "scene/parameter_file.h"

#include "scene/text_print.h"
#include "scene/text_suggest.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace kerf::scene::parameter_file_test {
namespace {

struct Time {
  double step = 0.01;
  int n_steps = 100;
  std::string method = "implicit Euler";
  Vec3 gravity = {0, 0, -9.81};

  void describe(Parameters& p) {
    p.number("Step [s]", step, positive, "Time between two states.");
    p.integer("Steps", n_steps, Range{1, 1e6}, "How many steps (default 100)");
    p.choice("Method", method, {"implicit Euler", "Newmark"}, "How time goes on.");
    p.vector("Gravity [m/s^2]", gravity, "World frame.");
  }
};

struct Body {
  std::string mesh;
  double h = 0;

  void describe(Parameters& p) {
    p.text("Mesh", mesh, "A closed triangle mesh.");
    p.require_last();
    p.number("Cube edge [m]", h, positive, "Of the grid.");
    p.require_last();
  }
};

struct Material {
  double density = 1000;

  void describe(Parameters& p) { p.number("Density [kg/m^3]", density, positive, "At rest."); }
};

struct Support {
  Points box = {{0, 0, 0}, {1, 1, 1}};

  void describe(Parameters& p) { p.points("Box [m]", box, "Two corners."); }
};

std::vector<SectionKind> grammar() {
  return {
    {"Time", Occurrence::once, "How time goes on.", keys_of<Time>(), {}},
    {"Body",
     Occurrence::named,
     "A solid.",
     keys_of<Body>(),
     {{"Material", Occurrence::once, "What it is made of.", keys_of<Material>(), {}},
      {"Support", Occurrence::named, "What holds it.", keys_of<Support>(), {}}}},
    {"Body force", Occurrence::named, "What pulls.", keys_of<Support>(), {}},
    {"Output", Occurrence::once, "Holds sections only.", {}, {{"Frames", Occurrence::once, "Images.", {}, {}}}},
  };
}

Section parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_scene(scan_scene_text(text, "a.prm", overrides), grammar());
}

/// The complaint that parsing ends in.
Complaint complaint_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
  } catch (const ParameterError& error) {
    EXPECT_EQ(std::string(error.what()).find("stack"), std::string::npos) << error.what();
    EXPECT_FALSE(error.complaint().rule.empty());
    EXPECT_FALSE(error.complaint().remedy.empty());
    return error.complaint();
  }
  ADD_FAILURE() << "parsed without a complaint:\n" << text;
  return {};
}

void expect_complaint(const Complaint& c, const int line, const std::string& path, const std::string& value,
                      const std::string& rule, const std::string& remedy) {
  EXPECT_EQ(c.file, "a.prm");
  EXPECT_EQ(c.line, line);
  EXPECT_EQ(c.path, path);
  EXPECT_EQ(c.value, value);
  EXPECT_NE(c.rule.find(rule), std::string::npos) << c.rule;
  EXPECT_NE(c.remedy.find(remedy), std::string::npos) << c.remedy;
}

const std::string liver =
  "subsection Body liver\n"           // 1
  "  set Mesh = liver.off # a mesh\n" // 2
  "  set Cube edge [m] = 0.005\n"     // 3
  "  subsection Material\n"           // 4
  "    set Density [kg/m^3] = 1060\n" // 5
  "  end\n"                           // 6
  "  subsection Support back\n"       // 7
  "    set Box [m] = 0, 0, 0; \\\n"   // 8
  "                  1, 2, 3\n"       // 9
  "  end\n"                           // 10
  "  subsection Support left side\n"; // 11, not closed, not a name

const std::string two_bodies =
  "# two bodies\n\n"
  "subsection Body liver\n  set Mesh = liver.off\n  set Cube edge [m] = 0.005\n"
  "  subsection Support back\n    set Box [m] = 0, 0, 0; \\\n    1, 2, 3\n  end\n"
  "  subsection Support left\n  end\nend\n"
  "subsection Body knife-2\n\tset Mesh=knife.off\n\tset Cube  edge [m]=1e-3\n"
  "  subsection Material\n    set Density [kg/m^3] = 7800\n  end\nend\n"
  "subsection Body force tip\nend\n";

TEST(ParameterFile, ReadsInstancesAndNestedInstances) {
  const Section scene = parse(two_bodies);
  ASSERT_EQ(scene.all("Body").size(), 2u);
  EXPECT_EQ(scene.all("Time").size(), 0u);
  const Section& body = *scene.find("Body");
  EXPECT_EQ(body.name(), "liver");
  EXPECT_EQ(body.path(), "Body liver");
  EXPECT_EQ(body.origin().line, 3);
  EXPECT_EQ(body.read<Body>().mesh, "liver.off");
  EXPECT_EQ(body.read<Body>().h, 0.005);

  const auto supports = body.all("Support");
  ASSERT_EQ(supports.size(), 2u);
  EXPECT_EQ(supports[0]->path(), "Body liver/Support back");
  EXPECT_EQ(supports[0]->read<Support>().box, Points({{0, 0, 0}, {1, 2, 3}}));
  EXPECT_EQ(supports[1]->read<Support>().box, Support().box);

  const Section& knife = *scene.all("Body")[1];
  EXPECT_EQ(knife.name(), "knife-2");
  EXPECT_EQ(knife.read<Body>().h, 1e-3);
  EXPECT_EQ(knife.require("Material").read<Material>().density, 7800);
  EXPECT_EQ(scene.require("Body force").name(), "tip");
}

TEST(ParameterFile, WhatIsNotWrittenHasItsDefault) {
  const Section scene = parse("subsection Time\n  set Steps = 7\nend\n");
  const Section& section = scene.require("Time");
  const Time time = section.read<Time>();
  EXPECT_EQ(time.n_steps, 7);
  EXPECT_EQ(time.step, 0.01);
  EXPECT_EQ(time.method, "implicit Euler");
  EXPECT_EQ(time.gravity, Time().gravity);
  EXPECT_TRUE(section.writes("Steps"));
  EXPECT_FALSE(section.writes("Step [s]"));
}

TEST(ParameterFile, MisspeltKeys) {
  expect_complaint(complaint_of("subsection Time\n\n  set Stps = 7\nend\n"), 3, "Time/Stps", "7", "no such key",
                   "Did you mean 'Steps'?");
  expect_complaint(complaint_of("subsection Time\n  set Step = 7\nend\n"), 2, "Time/Step", "7", "no such key",
                   "Did you mean 'Step [s]'?");
  expect_complaint(complaint_of("subsection Time\n  set gravity = 7\nend\n"), 2, "Time/gravity", "7", "no such key",
                   "Did you mean 'Gravity [m/s^2]'?");
  expect_complaint(complaint_of("subsection Time\n  set Colour = 7\nend\n"), 2, "Time/Colour", "7", "no such key",
                   "Allowed are 'Step [s]', 'Steps', 'Method', 'Gravity [m/s^2]'");
  expect_complaint(complaint_of("subsection Time\n  set Density [kg/m^3] = 7\nend\n"), 2, "Time/Density [kg/m^3]", "7",
                   "no such key", "It belongs in 'Body NAME/Material'");
  expect_complaint(complaint_of("subsection Output\n  set Colour = 7\nend\n"), 2, "Output/Colour", "7", "no such key",
                   "This section has no keys");
}

TEST(ParameterFile, UnknownSections) {
  expect_complaint(complaint_of("\nsubsection Tme\nend\n"), 2, "Tme", "", "no such section", "Did you mean 'Time'?");
  expect_complaint(complaint_of("subsection Boby liver\nend\n"), 1, "Boby liver", "", "no such section",
                   "Did you mean 'Body liver'?");
  expect_complaint(complaint_of("subsection Weather\nend\n"), 1, "Weather", "", "no such section",
                   "Allowed are 'Time', 'Body NAME', 'Body force NAME', 'Output'");
  expect_complaint(complaint_of("subsection Material\nend\n"), 1, "Material", "", "no such section",
                   "It belongs in 'Body NAME'");
  expect_complaint(complaint_of("subsection Time\n  subsection Zone\n  end\nend\n"), 2, "Time/Zone", "",
                   "no such section", "No sections are allowed here");
  expect_complaint(complaint_of("subsection Time of day\nend\n"), 1, "Time of day", "", "takes no name",
                   "Write 'subsection Time'");
  expect_complaint(complaint_of("subsection Body\nend\n"), 1, "Body", "", "must have a name", "subsection Body first");
}

TEST(ParameterFile, NamesArePlain) {
  expect_complaint(complaint_of(liver + "end\nend\n"), 11, "Body liver/Support left side", "left side",
                   "a name must be letters", "subsection Support first");
}

TEST(ParameterFile, BadValues) {
  expect_complaint(complaint_of("subsection Time\n  set Step [s] = 0\nend\n"), 2, "Time/Step [s]", "0", "must be > 0",
                   "Time between two states (default 0.01)");
  expect_complaint(complaint_of("subsection Time\n  set Steps = 1.5\nend\n"), 2, "Time/Steps", "1.5",
                   "is not written as a whole number; must be a whole number >= 1 and <= 1e6", "How many steps (default 100)");
  for (const std::string value : {"abc", "1e"})
    expect_complaint(complaint_of("subsection Time\n  set Step [s] = " + value + "\nend\n"), 2, "Time/Step [s]", value,
                     "is no number; must be > 0", "Time between two states (default 0.01)");
  expect_complaint(complaint_of("subsection Time\n  set Method = Newmarc\nend\n"), 2, "Time/Method", "Newmarc",
                   "must be one of implicit Euler, Newmark", "Did you mean 'Newmark'?");
  expect_complaint(complaint_of("subsection Time\n  set Gravity [m/s^2] = 0, \\\n 1\nend\n"), 2, "Time/Gravity [m/s^2]",
                   "0, 1", "must be three numbers x, y, z", "(default 0, 0, -9.81)");
}

TEST(ParameterFile, MissingKeys) {
  const std::string text = "\nsubsection Body liver\n  set Mesh = liver.off\nend\n";
  expect_complaint(complaint_of(text), 2, "Body liver/Cube edge [m]", "", "must set this key, which must be > 0",
                   "Write 'set Cube edge [m] = ...': Of the grid.");
  expect_complaint(complaint_of("subsection Body liver\n  set Mesh =\n  set Cube edge [m] = 1\nend\n"), 1,
                   "Body liver/Mesh", "", "must set this key", "A closed triangle mesh.");
}

TEST(ParameterFile, BrokenSyntax) {
  expect_complaint(complaint_of("subsection Time\nset Steps = 1\nset  Steps = 2\nend\n"), 3, "Time/Steps", "2",
                   "set twice, first in line 2", "Keep one");
  expect_complaint(complaint_of("subsection Time\nend\nsubsection Time\nend\n"), 3, "Time", "",
                   "written twice, first in line 1", "Put its keys together");
  expect_complaint(complaint_of(two_bodies + "subsection Body liver\nend\n"), 22, "Body liver", "",
                   "written twice, first in line 3", "another name");
  expect_complaint(complaint_of("subsection Output\n subsection Frames\n"), 2, "Output/Frames", "", "never closed",
                   "Write 'end'");
  expect_complaint(complaint_of("subsection Time\nend\nend\n"), 3, "", "end", "no open subsection", "Remove this line");
  expect_complaint(complaint_of("subsection Time\nend Time\n"), 2, "Time", "end Time", "must stand alone", "next line");
  expect_complaint(complaint_of("subsection Body " + std::string(101, 'x') + "\nend\n"), 1,
                   "Body " + std::string(101, 'x'), "", "at most 100 characters", "shorter");
  expect_complaint(complaint_of("subsection\nend\n"), 1, "", "", "must have a heading", "subsection Time");
  expect_complaint(complaint_of("subsection Time\nset Steps 7\nend\n"), 2, "Time", "set Steps 7",
                   "must be 'set KEY = VALUE'", "Write the missing part");
  expect_complaint(complaint_of("subsection Time\nset = 7\nend\n"), 2, "Time", "set = 7", "must be 'set KEY = VALUE'",
                   "Write the missing part");
  expect_complaint(complaint_of("set Steps = 7\n"), 1, "Steps", "7", "must stand in a section", "subsection");
  expect_complaint(complaint_of("subsection Time\nStes = 7\nend\n"), 2, "Time", "Stes = 7",
                   "must begin with subsection, set or end", "Did you mean 'set'?");
  expect_complaint(complaint_of("endgame\n"), 1, "", "endgame", "must begin with", "Allowed are");
  expect_complaint(complaint_of("\ninclude other.prm\n"), 2, "", "include other.prm", "include is not allowed",
                   "Copy the other file's text");
  expect_complaint(complaint_of("subsection Time # now \\\nset Steps = 7\nend\n"), 1, "", "subsection Time # now \\",
                   "must not swallow", "Remove the backslash");
  expect_complaint(complaint_of("subsection Time\nend \\"), 2, "", "end \\", "cannot be continued", "backslash");
}

TEST(ParameterFile, LinesAreThoseOfTheFile) {
  const auto c =
    complaint_of("# one\r\n\r\nsubsection Time # three\r\n  set \\\r\n    Method \\\r\n = \\\r\n none\r\nend\r\n");
  expect_complaint(c, 4, "Time/Method", "none", "must be one of", "How time goes on (default implicit Euler)");
}

TEST(Overrides, WinOverTheFile) {
  const Section scene = parse("subsection Time\n  set Steps = 7\nend\n" + two_bodies,
                              {"Time/Steps=8", "Time/Gravity [m/s^2] = 1, 2, 3", "Body liver/Support back/Box [m]=",
                               "Body knife-2/Material/Density [kg/m^3]=1", "Body knife-2/Material/Density [kg/m^3]=2"});
  EXPECT_EQ(scene.require("Time").read<Time>().n_steps, 8);
  EXPECT_EQ(scene.require("Time").read<Time>().gravity, Vec3(1, 2, 3));
  EXPECT_TRUE(scene.find("Body")->find("Support")->read<Support>().box.empty());
  EXPECT_EQ(scene.all("Body")[1]->find("Material")->read<Material>().density, 2);
}

TEST(Overrides, MayAddSections) {
  const Section scene =
    parse("", {"Body ball/Mesh=ball.off", "Body ball/Cube edge [m]=1", "Body ball/Material/Density [kg/m^3]=3"});
  EXPECT_EQ(scene.require("Body").read<Body>().mesh, "ball.off");
  EXPECT_EQ(scene.require("Body").require("Material").read<Material>().density, 3);
}

/// Else a slip in a name adds a second load, or a floor, that nobody sees.
TEST(Overrides, AddNoSectionThatLooksLikeASlip) {
  const std::string scene = "subsection Body ball\n  set Mesh = ball.off\n  set Cube edge [m] = 1\nend\n";
  const auto c = complaint_of(scene, {"Body bll/Cube edge [m]=2"});
  EXPECT_EQ(c.path, "Body bll");
  EXPECT_NE(c.remedy.find("Did you mean 'Body ball'?"), std::string::npos) << c.remedy;
  EXPECT_NO_THROW(parse(scene, {"Body ball2/Mesh=ball.off", "Body ball2/Cube edge [m]=2"}));
  EXPECT_NO_THROW(parse(scene, {"Body other/Mesh=ball.off", "Body other/Cube edge [m]=2"}));
}

TEST(Overrides, ErrorsNameTheirText) {
  const auto expect = [](const std::string& override_text, const std::string& path, const std::string& value,
                         const std::string& rule, const std::string& remedy) {
    auto c = complaint_of("subsection Time\nend\n", {override_text});
    EXPECT_EQ(c.file, "--set \"" + override_text + "\"");
    c.file = "a.prm";
    expect_complaint(c, 0, path, value, rule, remedy);
  };
  expect("Time/Stps=7", "Time/Stps", "7", "no such key", "Did you mean 'Steps'?");
  expect("Time/Steps=none", "Time/Steps", "none", "must be a whole number", "How many steps");
  expect("Tine/Steps=7", "Tine", "", "no such section", "Did you mean 'Time'?");
  expect("Body ball/Mesh=ball.off", "Body ball/Cube edge [m]", "", "must set this key", "Of the grid");
  expect("Steps=7", "", "", "must be \"Section/Key=value\"", "from the top");
  expect("Time/Steps", "", "", "must be \"Section/Key=value\"", "from the top");
  expect("Time//Steps=1", "", "", "must be \"Section/Key=value\"", "from the top");
  expect("Time/Steps=1 # one", "", "", "must have no '#'", "one plain value");
  expect("Time/Method=a\\", "", "", "no backslash at the end", "one plain value");
  expect("Time/Method=a\nend", "", "", "no line break", "one plain value");
}

TEST(Unread, SectionsAndKeysThatNothingReads) {
  const Section scene =
    parse("subsection Time\n  set Steps = 7\nend\nsubsection Output\n  subsection Frames\n  end\nend\n" + two_bodies);
  scene.require("Time").read<Time>();
  for (const auto* body : scene.all("Body"))
    body->read<Body>();
  scene.find("Body")->find("Support")->read<Support>();

  const auto unread = scene.unread();
  ASSERT_EQ(unread.size(), 4u);
  expect_complaint(unread[0], 5, "Output/Frames", "", "nothing reads this section", "Remove it");
  expect_complaint(unread[1], 17, "Body liver/Support left", "", "nothing reads this section", "Remove it");
  expect_complaint(unread[2], 23, "Body knife-2/Material", "", "nothing reads this section", "Remove it");
  expect_complaint(unread[3], 27, "Body force tip", "", "nothing reads this section", "Remove it");
  EXPECT_THROW(scene.require_all_read(), ParameterError);

  scene.require("Output").require("Frames").mark_read();
  scene.find("Body")->all("Support")[1]->mark_read();
  scene.all("Body")[1]->find("Material")->read<Material>();
  scene.find("Body force")->mark_read();
  EXPECT_NO_THROW(scene.require_all_read());
}

TEST(Unread, KeysOfASectionThatIsReadInPart) {
  struct StepOnly {
    double step = 0;
    void describe(Parameters& p) { p.number("Step [s]", step, positive, ""); }
  };
  const Section scene = parse("subsection Time\n  set Step [s] = 1\n  set Steps = 7\nend\n");
  scene.require("Time").read<StepOnly>();
  const auto unread = scene.unread();
  ASSERT_EQ(unread.size(), 1u);
  expect_complaint(unread[0], 3, "Time/Steps", "7", "nothing reads this key", "Remove it");
}

TEST(Section, ComplainsAboutWhatIsSeenLater) {
  const Section scene = parse("\nsubsection Time\n  set Steps = 7\nend\n");
  const Section& time = scene.require("Time");
  expect_complaint(time.complaint("Steps", "must be even", "Add one").complaint(), 3, "Time/Steps", "7", "must be even",
                   "Add one");
  expect_complaint(time.complaint("Step [s]", "is too large", "Halve it").complaint(), 2, "Time/Step [s]", "0.01",
                   "is too large", "Halve it");
  expect_complaint(time.complaint("is of no use", "Remove it").complaint(), 2, "Time", "", "is of no use", "Remove it");
  try {
    scene.require("Body");
    FAIL() << "a missing section was found";
  } catch (const ParameterError& error) {
    expect_complaint(error.complaint(), 0, "Body", "", "must be written", "subsection Body");
  }
}

TEST(Section, AStructMustFitTheGrammar) {
  const Section scene = parse("subsection Time\nend\n");
  EXPECT_THROW(scene.require("Time").read<Material>(), std::logic_error);
}

TEST(Print, ReadsBackAsTheDefaults) {
  std::vector<SectionKind> once;
  for (const auto& kind : grammar())
    if (kind.occurrence == Occurrence::once)
      once.push_back(kind);
  const Section scene = parse_scene(scan_scene_text(print_parameters(once), "printed"), once);
  const Section& section = scene.require("Time");
  const Time time = section.read<Time>(), initial;
  EXPECT_TRUE(section.writes("Step [s]") && section.writes("Gravity [m/s^2]"));
  EXPECT_EQ(time.step, initial.step);
  EXPECT_EQ(time.n_steps, initial.n_steps);
  EXPECT_EQ(time.method, initial.method);
  EXPECT_EQ(time.gravity, initial.gravity);
  EXPECT_TRUE(scene.require("Output").find("Frames"));
}

TEST(Print, SaysRuleTextAndDefault) {
  const std::string page = print_parameters(grammar());
  for (const std::string part :
       {"# How time goes on.\nsubsection Time\n  # Time between two states.\n  # must be > 0.\n  set Step [s] = 0.01\n",
        "subsection Body NAME\n", "  # Must be set; must be > 0.\n  set Cube edge [m] =\n",
        "  subsection Support NAME\n", "    set Box [m] = 0, 0, 0; 1, 1, 1\n"})
    EXPECT_NE(page.find(part), std::string::npos) << part << "\nin\n" << page;
}

TEST(EffectiveText, ReadsBackAsTheSameScene) {
  const Section scene = parse(two_bodies, {"Time/Steps=8"});
  const std::string text = effective_text(scene);
  EXPECT_NE(text.find("set Step [s] = 0.01"), std::string::npos); // a default, written out
  const Section again = parse(text);
  EXPECT_EQ(effective_text(again), text);
  EXPECT_EQ(again.require("Time").read<Time>().n_steps, 8);
  EXPECT_EQ(again.find("Body")->find("Support")->read<Support>().box, Points({{0, 0, 0}, {1, 2, 3}}));
}

TEST(ReadSceneText, ReadsAFileAndNamesItInErrors) {
  const auto path = std::filesystem::temp_directory_path() / "kerf_parameter_file_test.prm";
  std::ofstream(path) << "subsection Time\n  set Steps = 0\nend\n";
  const SceneText scene = read_scene_text(path, {});
  EXPECT_EQ(scene.text, "subsection Time\n  set Steps = 0\nend\n");
  try {
    parse_scene(scene, grammar());
    FAIL() << "0 steps were parsed";
  } catch (const ParameterError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + ":2: Time/Steps = '0': must be"));
  }
  std::filesystem::remove(path);
  EXPECT_THROW(read_scene_text(path, {}), DataError);
  EXPECT_THROW(read_scene_text(std::filesystem::temp_directory_path(), {}), DataError);
}

TEST(Nearest, FindsWhatWasMeant) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("ABC", "abc"), 0);
  EXPECT_EQ(edit_distance("Mehs", "Mesh"), 1) << "neighbours exchanged";
  EXPECT_EQ(edit_distance("ca", "abc"), 3) << "nothing between those that were exchanged";
  EXPECT_EQ(edit_distance("badc", "abcd"), 2);
  EXPECT_EQ(nearest("Mehs", {"Mass", "Mesh"}), "Mesh");
  EXPECT_EQ(nearest("Densty", {"Damping", "Density [kg/m^3]"}), "Density [kg/m^3]");
  EXPECT_EQ(nearest("Edge [mm]", {"Edge [1]", "Edge [m]"}), "Edge [m]");
  EXPECT_EQ(nearest("xy", {"ab"}), std::nullopt);
  EXPECT_EQ(nearest("anything", {}), std::nullopt);
}

} // namespace
} // namespace kerf::scene::parameter_file_test
