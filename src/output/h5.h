#pragma once

/// A thin layer over the HDF5 C API: handles that close themselves; errors as DataError with file, object and HDF5's
/// own innermost reason. Everything is addressed by an open object and a path below it.

#include "output/journaled_file.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace kerf::output::h5 {

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = int (*)(std::int64_t);

  Handle() = default;
  Handle(std::int64_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }

  std::int64_t id() const { return id_; }
  void reset() noexcept;

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// An open file, group or dataset that can say where it is.
struct Object {
  Handle handle;
  std::string file; ///< file name, for errors
  std::string path; ///< inside the file, "/" for its root

  std::int64_t id() const { return handle.id(); }
  std::string path_of(const std::string& name) const;
};

/// Throws DataError: file, path, what was tried, HDF5's reason. Called at once after the call that failed.
[[noreturn]] void fail(const Object& parent, const std::string& name, const std::string& action);

/// A file that is written by transactions.
class WritableFile {
 public:
  WritableFile(const std::filesystem::path& path, JournaledFile::Mode mode);
  ~WritableFile();

  const Object& root() const { return root_; }

  /// Runs `changes` and makes them durable, all or, when anything throws, none; then the file takes no more.
  template <class Function>
  void transaction(const Function& changes) {
    require_usable();
    try {
      changes();
      commit();
    } catch (const std::exception& error) {
      journal_.abandon(error.what());
      throw;
    }
  }

 private:
  void require_usable();
  void commit();

  JournaledFile journal_;
  Object root_;
};

Object open_read_only(const std::filesystem::path& path);

Object create_group(const Object& parent, const std::string& name);
Object open_group(const Object& parent, const std::string& name);
/// A group or a dataset.
Object open_any(const Object& parent, const std::string& name);
bool exists(const Object& parent, const std::string& name);
void remove(const Object& parent, const std::string& name);
/// Names of the links in a group, sorted.
std::vector<std::string> children(const Object& parent, const std::string& name);
/// Makes `name` stand for the object at an absolute path.
void link(const Object& parent, const std::string& name, const std::string& target);

/// The type of texts of a fixed length [bytes]: ASCII when `sample` is, which more readers take, else UTF-8.
Handle text_type(std::size_t length, const std::string& sample);

/// Attributes; writing replaces.
void set_attribute(const Object& object, const std::string& name, const std::string& text);
void set_attribute(const Object& object, const std::string& name, std::int64_t value);
void set_attribute(const Object& object, const std::string& name, double value);
void set_attribute(const Object& object, const std::string& name, std::span<const std::int64_t> values);
std::string text_attribute(const Object& object, const std::string& name);
std::int64_t integer_attribute(const Object& object, const std::string& name);
double number_attribute(const Object& object, const std::string& name);
std::vector<std::string> attribute_names(const Object& object);

} // namespace kerf::output::h5
