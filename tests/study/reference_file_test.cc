// References that other programs have computed: separated values, and CalculiX's files.

#include "study/reference_file.h"

#include "study/grammar.h"
#include "tests/study/study_text.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace kerf::study::reference_file_test {
namespace {

class ReferenceFile : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  Reference read(const std::string& keys, const std::string& unit = "m") const {
    const std::string text = "subsection Reference file\n" + keys + "end\n";
    const auto path = (folder_ / "study.prm").string();
    const scene::Section root = scene::parse_scene(scene::scan_scene_text(text, path), {reference_file_grammar()});
    return read_reference_file(root.require("Reference file"), unit);
  }

  void expect_refused(const std::string& keys, const std::string& words) const {
    try {
      read(keys);
      ADD_FAILURE() << "was read: " << keys;
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      EXPECT_TRUE(error.complaint().file.ends_with("study.prm")) << error.what();
      EXPECT_GT(error.complaint().line, 0);
    }
  }

  output::TemporaryFolder folder_;
};

TEST_F(ReferenceFile, OfSeparatedValues) {
  write("a.csv", "time [s], \"tip, z [m]\",force [N]\r\n0,0,1\n0.5, -2.5e-3 ,2\n1,-4e-3,x\n");
  EXPECT_EQ(read("  set File = a.csv\n  set Column = tip, z\n").value, -4e-3) << "the last line";
  EXPECT_EQ(read("  set File = a.csv\n  set Column = tip, z\n  set Line [1] = 2\n").value, -2.5e-3);
  EXPECT_EQ(read("  set File = a.csv\n  set Column = time\n  set Factor [1] = 2\n").value, 2);
  EXPECT_EQ(read("  set File = a.csv\n  set Column = tip, z\n").source, "a.csv, column tip, z");
  write("tones.csv", "mode,tone [Hz]\n1,16.7\n");
  EXPECT_EQ(read("  set File = tones.csv\n  set Column = tone\n", "1/s").value, 16.7) << "another name of the unit";
  expect_refused("  set File = a.csv\n  set Column = tip\n", "Name one of the file's: time, tip, z, force");
  expect_refused("  set File = a.csv\n  set Column = time\n", "has the unit s, and the study m");
  expect_refused("  set File = a.csv\n  set Column = tip, z\n  set Line [1] = 4\n", "3 lines");
  expect_refused("  set File = a.csv\n  set Column = tip, z\n  set Line [1] = 1\n", "is 0");
  expect_refused("  set File = a.csv\n  set Column = force\n  set Factor [1] = 1\n", "line 3 has no number");
  EXPECT_THROW(read("  set File = none.csv\n  set Column = a\n"), DataError);
}

/// As CalculiX 2.20 prints and stores: two increments, the last of which counts, and forces, which do not.
TEST_F(ReferenceFile, OfCalculix) {
  write("job.dat",
        "\n displacements (vx,vy,vz) for set PROBE and time  0.5000000E+00\n\n"
        "         7  1.000000E-03  2.000000E-03 -3.000000E-03\n"
        "\n displacements (vx,vy,vz) for set PROBE and time  0.1000000E+01\n\n"
        "         7  1.500000E-03  2.500000E-03 -3.500000E-03\n         8  0.000000E+00  1.000000E-03  5.000000E-04\n"
        "\n forces (fx,fy,fz) for set PROBE and time  0.1000000E+01\n\n"
        "         7  9.000000E+00  9.000000E+00  9.000000E+00\n");
  EXPECT_EQ(read("  set File = job.dat\n  set Node [1] = 7\n").value, -3.5e-3);
  EXPECT_EQ(read("  set File = job.dat\n  set Node [1] = 7\n  set Axis = x\n").value, 1.5e-3);
  EXPECT_EQ(read("  set File = job.dat\n  set Node [1] = 7\n  set Minus node [1] = 8\n").value, -4e-3);
  expect_refused("  set File = job.dat\n  set Node [1] = 9\n", "no displacement of this node");
  write("job.frd",
        "    1C\n -4  DISP        4    1\n -5  D1          1    2    1    0\n"
        " -1         7 1.50000E-03-2.50000E-03-3.50000E-03\n -3\n"
        " -4  STRESS      6    1\n -1         7 9.00000E+00 9.00000E+00 9.00000E+00\n -3\n 9999\n");
  EXPECT_EQ(read("  set File = job.frd\n  set Node [1] = 7\n").value, -3.5e-3);
  EXPECT_EQ(read("  set File = job.frd\n  set Node [1] = 7\n  set Axis = y\n").source, "CalculiX, job.frd, node 7, y");
}

/// A cube of E = 100 Pa that is drawn by 5 Pa becomes longer by a twentieth.
TEST_F(ReferenceFile, OfARunOfCalculix) {
  if (std::system("command -v ccx > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "CalculiX (ccx) is not installed";
  write("job.inp",
        "*NODE, NSET=NALL\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
        "*ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,2,3,4,5,6,7,8\n*MATERIAL, NAME=M\n*ELASTIC\n100, 0.25\n"
        "*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*BOUNDARY\n1,1,3\n2,2,3\n3,3,3\n4,3,3\n4,1,1\n*STEP\n*STATIC\n"
        "*CLOAD\n5,3,1.25\n6,3,1.25\n7,3,1.25\n8,3,1.25\n*NODE PRINT, NSET=NALL\nU\n*NODE FILE\nU\n*END STEP\n");
  const std::string command = "cd '" + (folder_ / "").string() + "' && ccx -i job > log 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_NEAR(read("  set File = job.dat\n  set Node [1] = 7\n").value, 0.05, 1e-8);
  EXPECT_NEAR(read("  set File = job.frd\n  set Node [1] = 7\n").value, 0.05, 1e-7);
}

TEST_F(ReferenceFile, IsTheReferenceOfAStudy) {
  const CubeStudy study;
  std::ofstream(study / "fall.csv") << "momentum [kg m/s]\n-4\n";
  const std::string head =
    "subsection Study\n  set Scene = scene.prm\n  set Answer = momentum z\n  set Unit = kg m/s\nend\n";
  const std::string file = "subsection Reference file\n  set File = fall.csv\n  set Column = momentum\nend\n";
  EXPECT_EQ(study.plan(head + file + CubeStudy::variant("fem", "")).rows[0].reference.value, -4);
  EXPECT_THROW(study.plan(CubeStudy::head() + file + CubeStudy::variant("fem", "")), ParameterError) << "two";
}

} // namespace
} // namespace kerf::study::reference_file_test
