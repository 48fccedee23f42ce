#include "output/h5_driver.h"

#include "base/error.h"

#include <hdf5.h>
#if __has_include(<H5FDdevelop.h>) // from HDF5 1.13 on
#include <H5FDdevelop.h>
#endif

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>

namespace kerf::output::h5 {
namespace {

/// What the access list carries.
struct Target {
  JournaledFile* file;
};

/// An open file as HDF5 sees it: the library asks that its own part comes first.
struct Driver {
  H5FD_t library = {};
  JournaledFile* file = nullptr;
  haddr_t allocated = 0;
};

Driver& driver(H5FD_t* file) { return *reinterpret_cast<Driver*>(file); }
const Driver& driver(const H5FD_t* file) { return *reinterpret_cast<const Driver*>(file); }

H5FD_t* open(const char*, unsigned, const hid_t access_list, haddr_t) {
  const auto* target = static_cast<const Target*>(H5Pget_driver_info(access_list));
  if (target == nullptr)
    return nullptr;
  auto opened = std::make_unique<Driver>();
  opened->file = target->file;
  return &opened.release()->library;
}

herr_t close(H5FD_t* file) {
  delete &driver(file);
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const auto *first = driver(a).file, *second = driver(b).file;
  return first == second ? 0 : std::less<>{}(first, second) ? -1 : 1;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t) { return driver(file).allocated; }

herr_t allocate(H5FD_t* file, H5FD_mem_t, const haddr_t address) {
  driver(file).allocated = address;
  return 0;
}

haddr_t end(const H5FD_t* file, H5FD_mem_t) { return driver(file).file->size(); }

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, const haddr_t address, const size_t size, void* buffer) {
  try {
    driver(file).file->read(address, {static_cast<std::byte*>(buffer), size});
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, const haddr_t address, const size_t size, const void* buffer) {
  try {
    driver(file).file->write(address, {static_cast<const std::byte*>(buffer), size});
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

/// The commit gives the file its length; here it must only look as long as HDF5 wants it.
herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  auto& d = driver(file);
  if (d.allocated > d.file->size())
    d.file->grow(d.allocated);
  return 0;
}

H5FD_class_t make_class() {
  H5FD_class_t c = {};
#ifdef H5FD_CLASS_VERSION
  c.version = H5FD_CLASS_VERSION;
  c.value = static_cast<H5FD_class_value_t>(511); // 256 .. 511 is free for drivers that are not registered
#endif
  c.name = "kerf_journal";
  c.maxaddr = HADDR_MAX / 2;
  c.fc_degree = H5F_CLOSE_STRONG;
  c.fapl_size = sizeof(Target);
  c.open = open;
  c.close = close;
  c.cmp = compare;
  c.query = query;
  c.get_eoa = allocated;
  c.set_eoa = allocate;
  c.get_eof = end;
  c.read = read;
  c.write = write;
  c.truncate = truncate;
  constexpr H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;
  std::ranges::copy(free_lists, std::begin(c.fl_map));
  return c;
}

} // namespace

void use_journal(const std::int64_t access_list, JournaledFile& file) {
  static const H5FD_class_t journal_class = make_class();
  static const hid_t journal_driver = H5FDregister(&journal_class);
  const Target target = {&file};
  if (journal_driver < 0 || H5Pset_driver(access_list, journal_driver, &target) < 0)
    throw DataError({.file = file.path().string(), .rule = "HDF5 does not take our file driver"});
}

} // namespace kerf::output::h5
