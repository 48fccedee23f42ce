#include "texture/cache.h"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace kerf::texture {

namespace {

constexpr std::uint64_t version = 10;                  ///< of the file and of the methods that find maps
constexpr std::uint64_t magic = 0x5350414d4652454bull; // "KERFMAPS"

class Hash {
 public:
  void add_bytes(const void* data, const std::size_t n) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < n; ++i)
      value_ = (value_ ^ bytes[i]) * 1099511628211ull;
  }
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    add_bytes(&value, sizeof(T));
  }
  void add(const std::string& text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  void add(const Vec3& v) { add_bytes(v.data(), 3 * sizeof(double)); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

void add(Hash& hash, const Exemplar& exemplar) {
  hash.add(exemplar.name);
  hash.add(exemplar.picture.width());
  hash.add(exemplar.picture.height());
  const auto& values = exemplar.picture.colours.values;
  hash.add_bytes(values.data(), values.size() * sizeof(values[0]));
  hash.add_bytes(exemplar.picture.alpha.values.data(), exemplar.picture.alpha.values.size() * sizeof(float));
  hash.add(exemplar.background);
  hash.add(exemplar.plane.origin());
  hash.add(exemplar.plane.point(exemplar.plane.to_local(Vec2(1, 0))));
  hash.add(exemplar.plane.point(exemplar.plane.to_local(Vec2(0, 1))));
  hash.add(exemplar.fit);
}

void add(Hash& hash, const InteriorOptions& options) {
  const warp::MatchOptions& match = options.warps.match;
  hash.add(options.components);
  hash.add(options.warps.partners);
  hash.add(options.warps.pixels);
  for (const int value : {match.n_levels, match.n_cells, match.n_iterations, static_cast<int>(match.global)})
    hash.add(value);
  for (const double value : {match.edges, match.brightness, match.outline, match.stiffness})
    hash.add(value);
  for (const ExemplarPin& pin : options.warps.pins)
    for (const int end : {0, 1}) {
      hash.add(pin.exemplars[end]);
      hash.add(pin.points[end]);
    }
}

using FileBytes = std::vector<char>;

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    const std::size_t end = bytes.size();
    bytes.resize(end + sizeof(T));
    std::memcpy(bytes.data() + end, &value, sizeof(T));
  }
  void put(const warp::LatticeMap& map) {
    for (const double x : {map.lower[0], map.lower[1], map.upper[0], map.upper[1]})
      put(x);
    put(map.n_columns);
    put(map.n_rows);
    for (const Vec2& node : map.nodes) {
      put(node[0]);
      put(node[1]);
    }
  }
  FileBytes bytes;
};

/// Reads what a Writer wrote; `good` turns false where bytes lack.
class Reader {
 public:
  explicit Reader(const FileBytes& bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    T value{};
    good = good && bytes_.size() - at_ >= sizeof(T);
    if (good) {
      std::memcpy(&value, bytes_.data() + at_, sizeof(T));
      at_ += sizeof(T);
    }
    return value;
  }
  warp::LatticeMap get_map() {
    warp::LatticeMap map;
    for (double* const x : {&map.lower[0], &map.lower[1], &map.upper[0], &map.upper[1]})
      *x = get<double>();
    map.n_columns = get<int>();
    map.n_rows = get<int>();
    good = good && map.n_columns >= 2 && map.n_rows >= 2 && map.n_columns < 5000 && map.n_rows < 5000;
    for (int i = 0; good && i < map.n_columns * map.n_rows; ++i) {
      const double x = get<double>();
      map.nodes.emplace_back(x, get<double>());
    }
    return map;
  }
  bool good = true;

 private:
  const FileBytes& bytes_;
  std::size_t at_ = 0;
};

std::uint64_t hash_of(const FileBytes& bytes, const std::size_t n) {
  Hash hash;
  hash.add_bytes(bytes.data(), n);
  return hash.value();
}

FileBytes encode(const std::uint64_t hash, const Maps& maps) {
  Writer out;
  out.put(magic);
  out.put(hash);
  out.put(maps.fits.size());
  for (const auto& fit : maps.fits) {
    out.put(static_cast<char>(fit.has_value()));
    if (fit)
      out.put(*fit);
  }
  out.put(maps.warps.size());
  for (const auto& cell : maps.warps) {
    out.put(cell.size());
    for (const BothWays& pair : cell) {
      out.put(pair.there);
      out.put(pair.back);
    }
  }
  out.put(hash_of(out.bytes, out.bytes.size()));
  return out.bytes;
}

std::optional<Maps> decode(const FileBytes& bytes, const std::uint64_t hash) {
  Reader in(bytes);
  if (in.get<std::uint64_t>() != magic || in.get<std::uint64_t>() != hash)
    return std::nullopt;
  Maps maps;
  for (auto n = in.get<std::size_t>(); in.good && n > 0; --n)
    maps.fits.push_back(in.get<char>() != 0 ? std::optional(in.get_map()) : std::nullopt);
  for (auto n = in.get<std::size_t>(); in.good && n > 0; --n) {
    maps.warps.emplace_back();
    for (auto m = in.get<std::size_t>(); in.good && m > 0; --m)
      maps.warps.back().push_back({in.get_map(), in.get_map()});
  }
  return in.good ? std::optional(std::move(maps)) : std::nullopt;
}

} // namespace

std::uint64_t input_hash(const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body,
                         const InteriorOptions& options) {
  Hash hash;
  hash.add(version);
  for (const Exemplar& exemplar : exemplars)
    add(hash, exemplar);
  for (const Vec3& v : body.vertices)
    hash.add(v);
  for (const Triangle& t : body.triangles)
    hash.add_bytes(t.data(), sizeof(t));
  add(hash, options);
  return hash.value();
}

std::filesystem::path cache_file(const std::filesystem::path& folder, const std::uint64_t hash) {
  std::array<char, 40> name;
  std::snprintf(name.data(), name.size(), "interior-%016llx.maps", static_cast<unsigned long long>(hash));
  return folder / name.data();
}

std::optional<Maps> load_maps(const std::filesystem::path& file, const std::uint64_t hash) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    return std::nullopt;
  const FileBytes bytes(std::istreambuf_iterator<char>(in), {});
  std::uint64_t written = 0;
  if (bytes.size() < sizeof(written))
    return std::nullopt;
  const std::size_t n = bytes.size() - sizeof(written);
  std::memcpy(&written, bytes.data() + n, sizeof(written));
  return written == hash_of(bytes, n) ? decode(bytes, hash) : std::nullopt;
}

bool save_maps(const std::filesystem::path& file, const std::uint64_t hash, const Maps& maps) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  // Written aside and renamed: whoever reads at the same time sees all of it or nothing.
  const std::filesystem::path aside = file.string() + "." + std::to_string(getpid());
  const FileBytes bytes = encode(hash, maps);
  {
    std::ofstream out(aside, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      std::filesystem::remove(aside, error);
      return false;
    }
  }
  std::filesystem::rename(aside, file, error);
  if (!error)
    return true;
  std::filesystem::remove(aside, error);
  return false;
}

} // namespace kerf::texture
