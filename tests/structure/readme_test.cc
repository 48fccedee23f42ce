/// What the README shows is what the checkout holds: its scene is a scene that runs, and its links lead somewhere.

#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace kerf::readme_test {
namespace {

namespace fs = std::filesystem;

const fs::path root = support::checkout();

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// As Markdown quotes it: four spaces before every line that is not empty.
std::string quoted(const fs::path& file) {
  std::ifstream in(file);
  std::string all, line;
  while (std::getline(in, line))
    all += (line.empty() ? "" : "    ") + line + "\n";
  return all;
}

TEST(Readme, ShowsTheFirstSceneAsItIs) {
  EXPECT_NE(text_of(root / "README.md").find("\n\n" + quoted(root / "params" / "first.prm") + "\n"), std::string::npos);
}

/// Links inside of a page, and pages elsewhere, are not looked at.
void expect_links(const fs::path& page) {
  const std::string text = text_of(page);
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  std::size_t n = 0;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), link); match != std::sregex_iterator(); ++match, ++n)
    EXPECT_TRUE(fs::exists(page.parent_path() / (*match)[1].str())) << page << " names " << (*match)[1];
  EXPECT_GT(n, 0u) << page;
}

TEST(Readme, LinksLeadSomewhere) {
  expect_links(root / "README.md");
  expect_links(root / "results" / "README.md");
  expect_links(root / "results" / "limits.md");
}

/// Every section of the results that the README names by its heading is there.
TEST(Readme, SectionsOfResultsAreThere) {
  const std::string readme = text_of(root / "README.md"), results = text_of(root / "results" / "README.md");
  const std::regex link(R"(results/README\.md#([a-z-]+))");
  std::size_t n = 0;
  for (auto match = std::sregex_iterator(readme.begin(), readme.end(), link); match != std::sregex_iterator();
       ++match, ++n) {
    std::string words = (*match)[1];
    std::replace(words.begin(), words.end(), '-', '.');
    EXPECT_TRUE(std::regex_search(
      results, std::regex("\n## " + std::regex_replace(words, std::regex("\\."), "[: ]+") + "\n", std::regex::icase)))
      << words;
  }
  EXPECT_EQ(n, 8u);
}

/// Files of a room are compiled together: helpers of tests have names like `h` in many of them.
TEST(Tests, EachFileHasANamespaceOfItsOwn) {
  std::size_t n = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root / "tests")) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".cc" || !name.ends_with("_test"))
      continue;
    ++n;
    EXPECT_NE(text_of(entry.path()).find("::" + name + " {\n"), std::string::npos) << entry.path();
  }
  EXPECT_GT(n, 200u);
}

} // namespace
} // namespace kerf::readme_test
