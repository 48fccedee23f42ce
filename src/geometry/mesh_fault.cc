#include "geometry/mesh_fault.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

namespace kerf::geometry {

namespace {

using Words = std::vector<std::string>;

/// What a header promises.
struct Promise {
  double n_vertices = 0, n_faces = 0;
  double least_bytes = 0; ///< that this takes
  bool is_text = true;
  int stray_property = 0; ///< the line of a property of nothing, which some readers do not survive; 0: none
};

/// The lines of a text that say something.
class Lines {
 public:
  explicit Lines(const std::string& path) : in_(path, std::ios::binary) {}

  /// False at the end.
  bool next() {
    while (std::getline(in_, line_)) {
      ++number_;
      std::istringstream words(line_.substr(0, line_.find('#')));
      words_.clear();
      for (std::string word; words_.size() < most_words && words >> word;)
        words_.push_back(word);
      if (!words_.empty())
        return true;
    }
    return false;
  }
  const Words& words() const { return words_; }
  int number() const { return number_; }

 private:
  static constexpr std::size_t most_words = 4096;

  std::ifstream in_;
  std::string line_;
  Words words_;
  int number_ = 0;
};

double number_of(const std::string& word) { return std::strtod(word.c_str(), nullptr); }

bool is_finite_number(const std::string& word) {
  char* end = nullptr;
  return std::isfinite(std::strtod(word.c_str(), &end)) && end != word.c_str() && *end == '\0';
}

std::string suffix_of(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](const unsigned char c) { return std::tolower(c); });
  return text;
}

/// "OFF", perhaps with the counts on the same line.
std::optional<Promise> off_header(Lines& lines) {
  if (!lines.next() || !lines.words()[0].ends_with("OFF"))
    return std::nullopt;
  Words counts(lines.words().begin() + 1, lines.words().end());
  if (!counts.empty() && counts[0] == "BINARY")
    return Promise{.is_text = false};
  if (counts.empty() && lines.next())
    counts = lines.words();
  if (counts.size() < 2)
    return std::nullopt;
  const double n_vertices = number_of(counts[0]), n_faces = number_of(counts[1]);
  return Promise{n_vertices, n_faces, 6 * n_vertices + 8 * n_faces}; // "0 0 0", "3 0 1 2", with their ends
}

std::optional<Promise> ply_header(Lines& lines) {
  if (!lines.next() || lines.words()[0] != "ply")
    return std::nullopt;
  Promise promise;
  bool has_element = false;
  while (lines.next() && lines.words()[0] != "end_header") {
    const Words& words = lines.words();
    if (words[0] == "format" && words.size() > 1)
      promise.is_text = words[1] == "ascii";
    has_element = has_element || words[0] == "element";
    if (words[0] == "property" && !has_element && promise.stray_property == 0)
      promise.stray_property = lines.number();
    if (words[0] == "element" && words.size() > 2)
      (words[1] == "vertex" ? promise.n_vertices : promise.n_faces) += std::max(0.0, number_of(words[2]));
  }
  promise.least_bytes = 3 * promise.n_vertices + 4 * promise.n_faces; // three coordinates; a count and three vertices
  return promise;
}

/// Of a binary one: 80 bytes, the number of triangles, 50 bytes each. A text begins with "solid" and has another
/// length.
std::optional<Promise> stl_header(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 80> title{};
  std::array<unsigned char, 4> count{};
  in.read(title.data(), title.size());
  in.read(reinterpret_cast<char*>(count.data()), count.size());
  const double n = count[0] + 256.0 * (count[1] + 256.0 * (count[2] + 256.0 * count[3]));
  const bool begins_as_text = std::string(title.data(), 5) == "solid";
  if (!in || (begins_as_text && 84 + 50 * n != double(std::filesystem::file_size(path))))
    return begins_as_text ? std::optional(Promise{}) : std::nullopt;
  return Promise{3 * n, n, 84 + 50 * n, false};
}

std::string in_line(const int number, const std::string& what) {
  return "line " + std::to_string(number) + ": " + what;
}

/// `n` numbers from word `first` on.
std::optional<std::string> fault_of_numbers(const Lines& lines, const std::size_t first, const std::size_t n) {
  const Words& words = lines.words();
  for (std::size_t i = first; i < std::min(first + n, words.size()); ++i)
    if (!is_finite_number(words[i]))
      return in_line(lines.number(), "'" + words[i].substr(0, 40) + "' is no finite number");
  if (words.size() < first + n)
    return in_line(lines.number(),
                   std::to_string(words.size() - first) + " numbers stand where there must be " + std::to_string(n));
  return std::nullopt;
}

/// The body of OFF and PLY: a line a vertex, then a line a face.
std::optional<std::string> fault_of_lists(Lines& lines, const Promise& promise) {
  double n_vertices = 0, n_faces = 0;
  while (n_faces < promise.n_faces && lines.next()) {
    const bool is_vertex = n_vertices < promise.n_vertices;
    const double n = is_vertex ? 3 : 1 + number_of(lines.words()[0]);
    if (!is_vertex && !(n >= 4 && n <= 4096))
      return in_line(lines.number(), "a face must begin with the number of its corners, 3 and more");
    if (const auto fault = fault_of_numbers(lines, 0, static_cast<std::size_t>(n)))
      return fault;
    for (int i = 1; !is_vertex && i < n; ++i)
      if (const double v = number_of(lines.words()[i]); !(v >= 0 && v < promise.n_vertices))
        return in_line(lines.number(), "there is no vertex " + lines.words()[i]);
    (is_vertex ? n_vertices : n_faces) += 1;
  }
  if (n_faces < promise.n_faces)
    return "it ends in line " + std::to_string(lines.number()) + ", after " + std::to_string(std::int64_t(n_vertices)) +
           " of " + std::to_string(std::int64_t(promise.n_vertices)) + " vertices and " +
           std::to_string(std::int64_t(n_faces)) + " of " + std::to_string(std::int64_t(promise.n_faces)) + " faces";
  return std::nullopt;
}

/// A face of an OBJ, whose vertices count from 1, or back from the last with a minus: "f 1/4/2 2//5 -1".
std::optional<std::string> fault_of_face(const Lines& lines, const double n_vertices) {
  const Words& words = lines.words();
  if (words.size() < 4)
    return in_line(lines.number(), "a face must have 3 corners and more");
  for (std::size_t i = 1; i < words.size(); ++i)
    if (const double v = number_of(words[i]); !(v >= 1 && v <= n_vertices) && !(v >= -n_vertices && v <= -1))
      return in_line(lines.number(), "there is no vertex " + words[i].substr(0, 40));
  return std::nullopt;
}

/// Vertices may stand behind the faces that name them.
std::optional<std::string> fault_of_obj(const std::string& path) {
  double n_vertices = 0;
  for (Lines lines(path); lines.next();)
    if (lines.words()[0] == "v") {
      n_vertices += 1;
      if (const auto fault = fault_of_numbers(lines, 1, 3))
        return fault;
    }
  for (Lines lines(path); lines.next();)
    if (lines.words()[0] == "f")
      if (const auto fault = fault_of_face(lines, n_vertices))
        return fault;
  return std::nullopt;
}

/// STL in text: vertices are named.
std::optional<std::string> fault_of_stl(Lines& lines) {
  bool has_ended = false;
  while (lines.next()) {
    if (lines.words()[0] == "vertex")
      if (const auto fault = fault_of_numbers(lines, 1, 3))
        return fault;
    has_ended = has_ended || lines.words()[0] == "endsolid";
  }
  if (!has_ended)
    return "it ends in line " + std::to_string(lines.number()) + ", without 'endsolid'";
  return std::nullopt;
}

bool begins_with_byte_order_mark(const std::string& path) {
  std::array<char, 3> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  return std::string_view(head.data(), head.size()) == "\xEF\xBB\xBF";
}

std::optional<Promise> header_of(const std::string& path, Lines& lines) {
  const std::string suffix = suffix_of(path);
  return suffix == ".off"   ? off_header(lines)
         : suffix == ".ply" ? ply_header(lines)
         : suffix == ".stl" ? stl_header(path)
                            : std::optional(Promise{});
}

} // namespace

void require_room_for_header(const std::string& path) {
  Lines lines(path);
  const auto promise = header_of(path, lines);
  const auto n_bytes = double(std::filesystem::file_size(path));
  if (promise && promise->stray_property > 0)
    throw DataError(Complaint{.file = path,
                              .line = promise->stray_property,
                              .rule = "a property stands before any element in the header",
                              .remedy = "The file is damaged: export it again"});
  if (promise && !(promise->least_bytes <= n_bytes + 2)) // the last line need not end
    throw DataError(
      Complaint{.file = path,
                .line = promise->is_text ? lines.number() : 0,
                .rule = "the header promises " + std::to_string(std::int64_t(std::min(promise->n_vertices, 1e18))) +
                        " vertices and " + std::to_string(std::int64_t(std::min(promise->n_faces, 1e18))) +
                        " faces, which do not fit into the file's " + std::to_string(std::int64_t(n_bytes)) + " bytes",
                .remedy = "The file is damaged or not whole: export it again"});
}

std::optional<std::string> find_fault(const std::string& path) {
  if (begins_with_byte_order_mark(path))
    return "line 1: it begins with a byte order mark, which the readers of meshes do not know: save it as plain text";
  Lines lines(path);
  const std::string suffix = suffix_of(path);
  const auto promise = header_of(path, lines);
  if (!promise)
    return "line 1: there is no header of such a file";
  if (!promise->is_text)
    return std::nullopt;
  if (suffix == ".obj")
    return fault_of_obj(path);
  if (suffix == ".stl")
    return fault_of_stl(lines);
  return fault_of_lists(lines, *promise);
}

} // namespace kerf::geometry
