#include "output/reader.h"

#include "base/error.h"
#include "output/h5_array.h"
#include "output/names.h"
#include "output/run_info.h"
#include "output/schema.h"

#include <algorithm>

namespace kerf::output {
namespace {

Field read_field(const h5::Object& frame, const std::string& name) {
  const auto dataset = h5::open_dataset(frame, "fields/" + name);
  Field field = {name, h5::text_attribute(dataset, "unit"), h5::n_columns(dataset), {}};
  field.values = h5::read_vector<double>(frame, "fields/" + name);
  return field;
}

} // namespace

struct Reader::Contents {
  h5::Object root;

  std::size_t count(const std::string& body, const char* part) const {
    h5::open_group(root, "/bodies/" + body);
    const auto path = body_path(body, part);
    return h5::exists(root, path) ? h5::children(root, path).size() : 0;
  }
  h5::Object item(const std::string& body, const char* part, const std::size_t index) const {
    return h5::open_group(root, body_path(body, part) + "/" + index_name(index));
  }
};

Reader::Reader(const std::filesystem::path& path) : contents_(new Contents{h5::open_read_only(path)}) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

RunInfo Reader::info() const { return read_info(contents_->root); }

Outcome Reader::outcome() const { return read_outcome(contents_->root); }

std::optional<Failure> Reader::failure() const {
  if (!h5::exists(contents_->root, "/failure"))
    return std::nullopt;
  const auto dataset = h5::open_dataset(contents_->root, "/failure");
  return Failure{h5::read_text(contents_->root, "/failure"), h5::integer_attribute(dataset, "step"),
                 h5::number_attribute(dataset, "time")};
}

std::string Reader::scene() const { return h5::read_text(contents_->root, "/scene"); }

bool Reader::has_scene() const { return h5::exists(contents_->root, "/scene"); }

bool Reader::has_checkpoint() const {
  return std::ranges::count(h5::attribute_names(contents_->root), "has_checkpoint") > 0 &&
         h5::integer_attribute(contents_->root, "has_checkpoint") != 0;
}

std::vector<std::string> Reader::inputs() const { return h5::read_lines(contents_->root, "/inputs"); }

std::vector<std::string> Reader::composition() const { return h5::read_lines(contents_->root, "/composition"); }

Schema Reader::schema() const { return read_schema(contents_->root); }

std::size_t Reader::n_steps() const { return h5::n_rows(h5::open_dataset(contents_->root, "/time")); }

std::vector<double> Reader::times() const { return h5::read_vector<double>(contents_->root, "/time"); }

std::vector<std::int64_t> Reader::steps() const { return h5::read_vector<std::int64_t>(contents_->root, "/step"); }

std::vector<double> Reader::observable(const std::string& name) const {
  return h5::read_vector<double>(contents_->root, "/observables/" + name);
}

std::vector<double> Reader::timing(const std::string& stage) const {
  return h5::read_vector<double>(contents_->root, "/timing/" + stage);
}

std::vector<std::string> Reader::bodies() const { return h5::children(contents_->root, "/bodies"); }

std::size_t Reader::n_frames(const std::string& body) const { return contents_->count(body, "frames"); }

Frame Reader::frame(const std::string& body, const std::size_t index) const {
  const auto group = contents_->item(body, "frames", index);
  Frame frame;
  frame.time = h5::number_attribute(group, "time");
  frame.step = h5::integer_attribute(group, "step");
  frame.complex = static_cast<std::size_t>(h5::integer_attribute(group, "complex_index"));
  frame.positions = h5::read_items<double, Vec3>(group, "position");
  if (h5::exists(group, "velocity"))
    frame.velocities = h5::read_items<double, Vec3>(group, "velocity");
  if (h5::exists(group, "fields"))
    for (const auto& name : h5::children(group, "fields"))
      frame.fields.push_back(read_field(group, name));
  return frame;
}

std::size_t Reader::n_complexes(const std::string& body) const { return contents_->count(body, "complex"); }

Complex Reader::complex(const std::string& body, const std::size_t index) const {
  const auto group = contents_->item(body, "complex", index);
  return {h5::read_items<std::uint32_t, std::array<std::uint32_t, 8>>(group, "corners"),
          h5::read_items<std::int32_t, Index3>(group, "cell"), h5::read_vector<std::uint8_t>(group, "nodes"),
          h5::read_vector<std::uint32_t>(group, "skin"), h5::read_items<double, Vec3>(group, "rest_position")};
}

std::size_t Reader::n_surfaces(const std::string& body) const { return contents_->count(body, "surface"); }

Surface Reader::surface(const std::string& body, const std::size_t index) const {
  const auto group = contents_->item(body, "surface", index);
  return {h5::read_items<std::uint32_t, Triangle>(group, "triangles"),
          h5::read_vector<std::uint16_t>(group, "label"),
          h5::read_items<double, Vec3>(group, "rest_position"),
          {h5::read_vector<std::uint32_t>(group, "weights/row_start"),
           h5::read_vector<std::uint32_t>(group, "weights/column"), h5::read_vector<double>(group, "weights/value")}};
}

std::string Reader::attribute(const std::string& object, const std::string& name) const {
  return h5::text_attribute(h5::open_any(contents_->root, object), name);
}

} // namespace kerf::output
