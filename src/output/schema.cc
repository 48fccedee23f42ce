#include "output/schema.h"

#include <utility>

namespace kerf::output {
namespace {

std::vector<std::string> in_order(const h5::Object& root, const std::string& group) {
  auto names = h5::children(root, group);
  std::vector<std::string> sorted(names.size());
  for (auto& name : names) {
    const auto dataset = h5::open_dataset(root, group + "/" + name);
    sorted.at(h5::integer_attribute(dataset, "index")) = std::move(name);
  }
  return sorted;
}

} // namespace

void write_order(const h5::Object& root, const Schema& schema) {
  const auto number = [&](const std::string& path, const std::size_t index) {
    h5::set_attribute(h5::open_dataset(root, path), "index", static_cast<std::int64_t>(index));
  };
  for (std::size_t i = 0; i < schema.stages.size(); ++i)
    number("/timing/" + schema.stages[i], i);
  for (std::size_t i = 0; i < schema.observables.size(); ++i)
    number("/observables/" + schema.observables[i].name, i);
}

Schema read_schema(const h5::Object& root) {
  Schema schema;
  schema.stages = in_order(root, "/timing");
  for (const auto& name : in_order(root, "/observables")) {
    const auto dataset = h5::open_dataset(root, "/observables/" + name);
    schema.observables.push_back({name, h5::text_attribute(dataset, "unit"), h5::text_attribute(dataset, "source")});
  }
  return schema;
}

} // namespace kerf::output
