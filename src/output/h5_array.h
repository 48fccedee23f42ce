#pragma once

/// Arrays in HDF5: datasets of rows x columns, written once or growing by rows; and texts.

#include "output/h5.h"

#include <cstddef>

namespace kerf::output::h5 {

enum class Number { float64, float32, int64, int32, uint64, uint32, uint16, uint8 };

template <class T>
inline constexpr Number number_of = [] { static_assert(sizeof(T) == 0, "not a number that we store"); }();
template <>
inline constexpr Number number_of<double> = Number::float64;
template <>
inline constexpr Number number_of<float> = Number::float32;
template <>
inline constexpr Number number_of<std::int64_t> = Number::int64;
template <>
inline constexpr Number number_of<std::int32_t> = Number::int32;
template <>
inline constexpr Number number_of<std::uint64_t> = Number::uint64;
template <>
inline constexpr Number number_of<std::uint32_t> = Number::uint32;
template <>
inline constexpr Number number_of<std::uint16_t> = Number::uint16;
template <>
inline constexpr Number number_of<std::uint8_t> = Number::uint8;

/// What an array in memory looks like: numbers, row by row. One column makes a one-dimensional dataset.
struct Layout {
  Number number = Number::float64;
  std::size_t n_columns = 1;
};

/// Plain: positions and velocities of a body that moves. Compression would leave three quarters of them and more, at
/// 70 MB/s: as long as explicit steps take where each tenth is recorded.
enum class Storage { compressed, plain };

/// Creates a dataset with the given rows; compressed ones are chunked and shuffled, too.
Object write_rows(const Object& parent, const std::string& name, const Layout& layout, const void* rows,
                  std::size_t n_rows, Storage storage = Storage::compressed);

/// Numbers of any rank, the last index fastest.
struct Shape {
  Number number = Number::float64;
  std::vector<std::size_t> extent;
};

/// Creates a dataset of that shape, in one piece, shuffled and compressed.
Object write_array(const Object& parent, const std::string& name, const Shape& shape, const void* values);

/// Creates an empty dataset that grows by rows; uncompressed, so that a chunk never moves when it grows.
Object create_series(const Object& parent, const std::string& name, const Layout& layout, std::size_t chunk_rows);
void append_rows(const Object& series, const Layout& layout, const void* rows, std::size_t n_rows);

Object open_dataset(const Object& parent, const std::string& name);
std::size_t n_rows(const Object& dataset);
std::size_t n_columns(const Object& dataset);
/// Reads all rows; throws DataError unless the dataset has these columns.
void read_rows(const Object& dataset, const Layout& layout, void* rows);

/// Creates a dataset that is one text, or one text a row.
Object write_text(const Object& parent, const std::string& name, const std::string& text);
Object write_lines(const Object& parent, const std::string& name, const std::vector<std::string>& lines);
std::string read_text(const Object& parent, const std::string& name);
std::vector<std::string> read_lines(const Object& parent, const std::string& name);

template <class T>
Object write_vector(const Object& parent, const std::string& name, const std::vector<T>& values) {
  return write_rows(parent, name, {number_of<T>, 1}, values.data(), values.size());
}

template <class T>
std::vector<T> read_vector(const Object& parent, const std::string& name) {
  const auto dataset = open_dataset(parent, name);
  std::vector<T> values(n_rows(dataset) * n_columns(dataset));
  read_rows(dataset, {number_of<T>, n_columns(dataset)}, values.data());
  return values;
}

/// Rows as items of fixed size: Row holds n_columns numbers of type T and nothing else.
template <class T, class Row>
std::vector<Row> read_items(const Object& parent, const std::string& name) {
  static_assert(sizeof(Row) % sizeof(T) == 0);
  const auto dataset = open_dataset(parent, name);
  std::vector<Row> rows(n_rows(dataset));
  read_rows(dataset, {number_of<T>, sizeof(Row) / sizeof(T)}, rows.data());
  return rows;
}

template <class T, class Row>
Object write_items(const Object& parent, const std::string& name, const std::span<const Row> rows,
                   const Storage storage = Storage::compressed) {
  static_assert(sizeof(Row) % sizeof(T) == 0);
  return write_rows(parent, name, {number_of<T>, sizeof(Row) / sizeof(T)}, rows.data(), rows.size(), storage);
}

} // namespace kerf::output::h5
