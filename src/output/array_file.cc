#include "output/array_file.h"

#include "base/error.h"
#include "output/h5_array.h"
#include "output/run_info.h"

#include <functional>
#include <numeric>

namespace kerf::output {
namespace {

void check_size(const std::string& file, const NamedArray& array) {
  const auto wanted =
    std::accumulate(array.extent.begin(), array.extent.end(), std::size_t{1}, std::multiplies<std::size_t>());
  if (array.values.size() != wanted)
    throw DataError({.file = file,
                     .path = array.name,
                     .value = std::to_string(array.values.size()),
                     .rule = "must have " + std::to_string(wanted) + " entries",
                     .remedy = "Nothing was written; hand over arrays that fit their extent"});
}

/// Every group above a dataset.
void create_groups(const h5::Object& root, const std::string& name) {
  for (auto slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1))
    if (!h5::exists(root, "/" + name.substr(0, slash)))
      h5::create_group(root, "/" + name.substr(0, slash));
}

} // namespace

void write_array_file(const std::filesystem::path& path, const std::string& title, const std::string& source,
                      const std::span<const NamedArray> arrays, const RunInfo& info) {
  for (const NamedArray& array : arrays)
    check_size(path.string(), array);
  h5::WritableFile file(path, JournaledFile::Mode::create);
  file.transaction([&] {
    const h5::Object& root = file.root();
    write_info(root, info);
    h5::set_attribute(root, "title", title);
    h5::set_attribute(root, "source", source);
    for (const NamedArray& array : arrays) {
      create_groups(root, array.name);
      const auto dataset =
        h5::write_array(root, "/" + array.name, {h5::Number::float64, array.extent}, array.values.data());
      h5::set_attribute(dataset, "unit", array.unit);
      h5::set_attribute(dataset, "description", array.description);
    }
  });
}

} // namespace kerf::output
