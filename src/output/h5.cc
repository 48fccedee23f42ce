#include "output/h5.h"

#include "base/error.h"
#include "output/h5_driver.h"

#include <hdf5.h>

#include <algorithm>
#include <type_traits>

namespace kerf::output::h5 {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t> && std::is_same_v<herr_t, int>);

/// HDF5 prints its errors by default; ours go into exceptions.
void be_quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

herr_t take_innermost(const unsigned position, const H5E_error2_t* error, void* text) {
  if (position == 0 && error->desc != nullptr)
    *static_cast<std::string*>(text) = error->desc;
  return 0;
}

std::string innermost_reason() {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_innermost, &reason);
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

/// B-trees with small nodes: most datasets here are one chunk.
constexpr unsigned half_tree_node = 8;

Handle access_list(const Object& place) {
  Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (list.id() < 0 || H5Pset_fclose_degree(list.id(), H5F_CLOSE_STRONG) < 0)
    fail(place, "", "open");
  return list;
}

/// The oldest file format, HDF5's default: the newest marks a file that is being written and refuses it after a kill.
Object open_writable(JournaledFile& journal, const JournaledFile::Mode mode) {
  be_quiet();
  Object root{{}, journal.path().string(), "/"};
  const auto access = access_list(root);
  use_journal(access.id(), journal);
  if (mode == JournaledFile::Mode::create) {
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_istore_k(creation.id(), half_tree_node);
    root.handle = {H5Fcreate(root.file.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose};
  } else {
    root.handle = {H5Fopen(root.file.c_str(), H5F_ACC_RDWR, access.id()), H5Fclose};
  }
  if (root.id() < 0)
    fail(root, "", "open");
  return root;
}

bool is_like(const Handle& attribute, const hid_t type, const hid_t space) {
  const Handle old_type(H5Aget_type(attribute.id()), H5Tclose), old_space(H5Aget_space(attribute.id()), H5Sclose);
  return H5Tequal(old_type.id(), type) > 0 && H5Sextent_equal(old_space.id(), space) > 0;
}

/// Writes in place where it fits, so that an attribute that changes often does not wear out its object's header.
void write_attribute(const Object& object, const std::string& name, const hid_t type, const hid_t space,
                     const void* value) {
  Handle attribute;
  if (H5Aexists(object.id(), name.c_str()) > 0) {
    attribute = {H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), H5Aclose};
    if (!is_like(attribute, type, space)) {
      attribute.reset();
      H5Adelete(object.id(), name.c_str());
    }
  }
  if (attribute.id() < 0)
    attribute = {H5Acreate2(object.id(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  if (attribute.id() < 0 || H5Awrite(attribute.id(), type, value) < 0)
    fail(object, name, "write attribute");
}

Handle open_attribute(const Object& object, const std::string& name) {
  Handle attribute(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (attribute.id() < 0)
    fail(object, name, "open attribute");
  return attribute;
}

template <class T>
T read_attribute(const Object& object, const std::string& name, const hid_t type) {
  const auto attribute = open_attribute(object, name);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  T value = {};
  if (H5Sget_simple_extent_npoints(space.id()) != 1 || H5Aread(attribute.id(), type, &value) < 0)
    fail(object, name, "read attribute");
  return value;
}

herr_t append_link(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

herr_t append_attribute(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

} // namespace

Handle text_type(const std::size_t length, const std::string& sample) {
  const bool ascii = std::ranges::all_of(sample, [](const unsigned char c) { return c < 0x80; });
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(length, 1));
  H5Tset_cset(type.id(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  return type;
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

void Handle::reset() noexcept {
  if (id_ >= 0)
    close_(std::exchange(id_, -1));
}

std::string Object::path_of(const std::string& name) const {
  if (name.empty() || name.front() == '/')
    return name.empty() ? path : name;
  return path == "/" ? "/" + name : path + "/" + name;
}

void fail(const Object& parent, const std::string& name, const std::string& action) {
  throw DataError({.file = parent.file,
                   .path = parent.path_of(name),
                   .rule = "HDF5 cannot " + action + " it: " + innermost_reason(),
                   .remedy = "Check that the file is whole and was written by Kerf"});
}

WritableFile::WritableFile(const std::filesystem::path& path, const JournaledFile::Mode mode)
  : journal_(path, mode), root_(open_writable(journal_, mode)) {}

WritableFile::~WritableFile() {
  root_.handle.reset();
  try {
    if (!journal_.abandoned())
      journal_.commit(journal_.size());
  } catch (const std::exception&) {
    return; // the file is as after the last transaction, which is all that was promised
  }
}

void WritableFile::require_usable() {
  if (journal_.abandoned())
    commit();
}

void WritableFile::commit() {
  if (!journal_.abandoned() && H5Fflush(root_.id(), H5F_SCOPE_LOCAL) < 0)
    fail(root_, "", "write");
  journal_.commit(journal_.size());
}

Object open_read_only(const std::filesystem::path& path) {
  be_quiet();
  recover(path);
  Object root{{}, path.string(), "/"};
  const auto access = access_list(root);
  root.handle = {H5Fopen(root.file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose};
  if (root.id() < 0)
    fail(root, "", "open");
  return root;
}

Object create_group(const Object& parent, const std::string& name) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.id(), 1);
  Object group{{H5Gcreate2(parent.id(), name.c_str(), links.id(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose},
               parent.file,
               parent.path_of(name)};
  if (group.id() < 0)
    fail(parent, name, "create");
  return group;
}

Object open_group(const Object& parent, const std::string& name) {
  Object group{{H5Gopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Gclose}, parent.file, parent.path_of(name)};
  if (group.id() < 0)
    fail(parent, name, "open");
  return group;
}

Object open_any(const Object& parent, const std::string& name) {
  Object object{{H5Oopen(parent.id(), name.c_str(), H5P_DEFAULT), H5Oclose}, parent.file, parent.path_of(name)};
  if (object.id() < 0)
    fail(parent, name, "open");
  return object;
}

bool exists(const Object& parent, const std::string& name) {
  return H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT) > 0;
}

void remove(const Object& parent, const std::string& name) {
  if (H5Ldelete(parent.id(), name.c_str(), H5P_DEFAULT) < 0)
    fail(parent, name, "remove");
}

std::vector<std::string> children(const Object& parent, const std::string& name) {
  const auto group = open_group(parent, name);
  std::vector<std::string> names;
  if (H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, append_link, &names) < 0)
    fail(parent, name, "list");
  return names;
}

void link(const Object& parent, const std::string& name, const std::string& target) {
  if (H5Lcreate_soft(target.c_str(), parent.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0)
    fail(parent, name, "create");
}

void set_attribute(const Object& object, const std::string& name, const std::string& text) {
  const auto type = text_type(text.size(), text);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, type.id(), space.id(), text.c_str());
}

void set_attribute(const Object& object, const std::string& name, const std::int64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, H5T_NATIVE_INT64, space.id(), &value);
}

void set_attribute(const Object& object, const std::string& name, const double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, H5T_NATIVE_DOUBLE, space.id(), &value);
}

void set_attribute(const Object& object, const std::string& name, const std::span<const std::int64_t> values) {
  const hsize_t n = values.size();
  const Handle space(H5Screate_simple(1, &n, nullptr), H5Sclose);
  write_attribute(object, name, H5T_NATIVE_INT64, space.id(), values.data());
}

std::string text_attribute(const Object& object, const std::string& name) {
  const auto attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0)
    fail(object, name, "read text from");
  std::string text(H5Tget_size(type.id()), '\0');
  if (H5Aread(attribute.id(), type.id(), text.data()) < 0)
    fail(object, name, "read attribute");
  return text.substr(0, text.find('\0'));
}

std::int64_t integer_attribute(const Object& object, const std::string& name) {
  return read_attribute<std::int64_t>(object, name, H5T_NATIVE_INT64);
}

double number_attribute(const Object& object, const std::string& name) {
  return read_attribute<double>(object, name, H5T_NATIVE_DOUBLE);
}

std::vector<std::string> attribute_names(const Object& object) {
  std::vector<std::string> names;
  if (H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, append_attribute, &names) < 0)
    fail(object, "", "list the attributes of");
  return names;
}

} // namespace kerf::output::h5
