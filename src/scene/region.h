#pragma once

/// Parts of the rest configuration, by which a scene says what is held, gripped or loaded.

#include "geometry/inside.h"
#include "scene/composing.h"

#include <memory>
#include <variant>

namespace kerf::scene {

struct Ball {
  Vec3 centre = Vec3::Zero(); ///< [m]
  double radius = 0.01;       ///< [m]

  bool contains(const Vec3& p) const { return (p - centre).squaredNorm() <= radius * radius; }
};

/// What lies on a plane or on the side that its normal points away from.
struct HalfSpace {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ(); ///< [m], any length [1]

  bool contains(const Vec3& p) const { return (p - point).dot(normal) <= 0; }
};

/// What a closed mesh encloses.
struct MeshRegion {
  std::shared_ptr<const geometry::Inside> mesh;

  bool contains(const Vec3& p) const { return mesh->contains(p); }
};

using Region = std::variant<Box, Ball, HalfSpace, MeshRegion>; ///< rest configuration, world frame

inline bool contains(const Region& region, const Vec3& p) {
  return std::visit([&](const auto& shape) { return shape.contains(p); }, region);
}

/// The words for regions.
const std::vector<std::string>& region_names();

/// The region `name` from the section's keys. Throws ParameterError for keys that are missing or of another region,
/// DataError for a mesh that cannot be used.
Region read_region(const Section& section, const std::string& name);

/// A part of the rest configuration. Describes the keys of `region`, all of which must be set but a mesh's unit; those
/// of all regions while it is empty.
struct RegionParameters {
  std::string region;
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero(); ///< [m]
  Vec3 centre = Vec3::Zero();                      ///< [m]
  double radius = 0.01;                            ///< [m]
  Vec3 point = Vec3::Zero();                       ///< [m]
  Vec3 normal = Vec3::UnitZ();                     ///< any length [1]
  std::string mesh;
  double mesh_unit = 1; ///< [m]
  void describe(Parameters& p);
};

} // namespace kerf::scene
