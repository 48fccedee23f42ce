#include "output/run_file.h"

#include "base/error.h"
#include "output/body_output.h"
#include "output/names.h"
#include "output/run_info.h"
#include "output/schema.h"

#include <algorithm>
#include <map>

namespace kerf::output {
namespace {

constexpr std::size_t series_chunk = 512; // rows; one page for doubles

template <class T>
void append_one(const h5::Object& series, const T value) {
  h5::append_rows(series, {h5::number_of<T>, 1}, &value, 1);
}

/// Creates a growing dataset of one number per output step.
template <class T>
void create_numbers(const h5::Object& root, const std::string& path, const std::string& unit,
                    const std::string& source) {
  const auto series = h5::create_series(root, path, {h5::number_of<T>, 1}, series_chunk);
  h5::set_attribute(series, "unit", unit);
  h5::set_attribute(series, "source", source);
}

void check_name(const std::string& file, const std::string& kind, const std::string& name) {
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw DataError({.file = file,
                     .path = kind,
                     .value = name,
                     .rule = "must be a name without a slash, and not empty",
                     .remedy = "Rename it"});
}

void create_series(const h5::Object& root, const Schema& schema) {
  create_numbers<double>(root, "/time", "s", "simulated time");
  create_numbers<std::int64_t>(root, "/step", "1", "number of the time step");
  for (const auto* group : {"/timing", "/observables", "/bodies"})
    h5::create_group(root, group);
  for (const auto& stage : schema.stages) {
    check_name(root.file, "/timing", stage);
    create_numbers<double>(root, "/timing/" + stage, "s", "wall-clock time since the output step before");
  }
  for (const auto& observable : schema.observables) {
    check_name(root.file, "/observables", observable.name);
    create_numbers<double>(root, "/observables/" + observable.name, observable.unit, observable.source);
  }
}

BodyCounts count_body(const h5::Object& root, const std::string& body) {
  const auto count = [&](const char* part) {
    return h5::exists(root, body_path(body, part)) ? h5::children(root, body_path(body, part)).size() : 0;
  };
  BodyCounts counts = {count("frames"), count("complex"), count("surface"), 0};
  const auto last = body_path(body, "complex/") + index_name(counts.n_complexes - 1);
  counts.n_corners = h5::n_rows(h5::open_dataset(root, last + "/rest_position"));
  return counts;
}

} // namespace

struct RunFile::Contents {
  h5::WritableFile file;
  Schema schema;
  h5::Object time = {}, step = {};
  std::vector<h5::Object> timing = {}, observables = {};
  std::map<std::string, BodyCounts> bodies = {};

  const h5::Object& root() const { return file.root(); }

  void open_series() {
    time = h5::open_dataset(root(), "/time");
    step = h5::open_dataset(root(), "/step");
    for (const auto& stage : schema.stages)
      timing.push_back(h5::open_dataset(root(), "/timing/" + stage));
    for (const auto& observable : schema.observables)
      observables.push_back(h5::open_dataset(root(), "/observables/" + observable.name));
  }

  void check(const StepRecord& record) const {
    if (record.observables.size() != observables.size())
      throw DataError({.file = root().file,
                       .path = "/observables",
                       .value = std::to_string(record.observables.size()),
                       .rule = "must be " + std::to_string(observables.size()) + " values, one each",
                       .remedy = "Nothing was written; compute those that the file was created with"});
    for (const auto& [stage, seconds] : record.seconds)
      if (std::ranges::find(schema.stages, stage) == schema.stages.end())
        throw DataError({.file = root().file,
                         .path = "/timing",
                         .value = stage,
                         .rule = "is no stage of this file",
                         .remedy = "Nothing was written; name it when the file is created"});
    for (const auto& body : record.bodies) {
      check_name(root().file, "/bodies", body.body);
      const auto found = bodies.find(body.body);
      output::check(body, found == bodies.end() ? BodyCounts{} : found->second, root().file);
    }
  }

  void append(const StepRecord& record) {
    append_one(time, record.time);
    append_one(step, record.step);
    for (std::size_t i = 0; i < timing.size(); ++i) {
      const auto found = record.seconds.find(schema.stages[i]);
      append_one(timing[i], found == record.seconds.end() ? 0.0 : found->second);
    }
    for (std::size_t i = 0; i < observables.size(); ++i)
      append_one(observables[i], record.observables[i]);
    for (const auto& body : record.bodies)
      write_body(root(), body, record.time, record.step, bodies[body.body]);
  }
};

RunFile::RunFile(const std::filesystem::path& path, const RunInfo& info, const Schema& schema)
  : contents_(new Contents{.file = {path, JournaledFile::Mode::create}, .schema = schema}) {
  contents_->file.transaction([&] {
    write_info(contents_->root(), info);
    create_series(contents_->root(), schema);
    write_order(contents_->root(), schema);
    h5::set_attribute(contents_->root(), "outcome", to_string(Outcome::running));
    contents_->open_series();
  });
}

RunFile::RunFile(const std::filesystem::path& path)
  : contents_(new Contents{.file = {path, JournaledFile::Mode::modify}, .schema = {}}) {
  auto& c = *contents_;
  c.schema = read_schema(c.root());
  c.open_series();
  for (const auto& body : h5::children(c.root(), "/bodies"))
    c.bodies[body] = count_body(c.root(), body);
  c.file.transaction([&] {
    const bool again = std::ranges::count(h5::attribute_names(c.root()), "n_resumed") > 0;
    h5::set_attribute(c.root(), "n_resumed",
                      again ? h5::integer_attribute(c.root(), "n_resumed") + 1 : std::int64_t{1});
    h5::set_attribute(c.root(), "outcome", to_string(Outcome::running));
    if (h5::exists(c.root(), "/failure"))
      h5::remove(c.root(), "/failure");
  });
}

RunFile::RunFile(RunFile&&) noexcept = default;
RunFile& RunFile::operator=(RunFile&&) noexcept = default;
RunFile::~RunFile() = default;

void RunFile::write_scene(const std::string& text) {
  contents_->file.transaction([&] { h5::write_text(contents_->root(), "/scene", text); });
}

void RunFile::write_inputs(const std::vector<std::string>& lines) {
  contents_->file.transaction([&] { h5::write_lines(contents_->root(), "/inputs", lines); });
}

void RunFile::write_composition(const std::vector<std::string>& lines) {
  contents_->file.transaction([&] { h5::write_lines(contents_->root(), "/composition", lines); });
}

void RunFile::append(const StepRecord& record) {
  contents_->check(record);
  contents_->file.transaction([&] { contents_->append(record); });
}

void RunFile::note_checkpoint() {
  contents_->file.transaction([&] { h5::set_attribute(contents_->root(), "has_checkpoint", std::int64_t{1}); });
}

void RunFile::complete() {
  contents_->file.transaction([&] {
    h5::set_attribute(contents_->root(), "outcome", to_string(Outcome::completed));
    h5::set_attribute(contents_->root(), "has_checkpoint", std::int64_t{0});
  });
}

std::vector<std::int64_t> RunFile::steps() const { return h5::read_vector<std::int64_t>(contents_->root(), "/step"); }

std::vector<double> RunFile::observable(const std::string& name) const {
  return h5::read_vector<double>(contents_->root(), "/observables/" + name);
}

const Schema& RunFile::schema() const { return contents_->schema; }

void RunFile::fail(const Failure& failure) { end(failure, Outcome::failed); }

void RunFile::interrupt(const Failure& failure) { end(failure, Outcome::interrupted); }

void RunFile::end(const Failure& failure, const Outcome outcome) {
  contents_->file.transaction([&] {
    const auto text = h5::write_text(contents_->root(), "/failure", failure.text);
    h5::set_attribute(text, "step", failure.step);
    h5::set_attribute(text, "time", failure.time);
    h5::set_attribute(contents_->root(), "outcome", to_string(outcome));
  });
}

} // namespace kerf::output
