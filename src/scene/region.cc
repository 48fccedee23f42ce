#include "scene/region.h"

#include "geometry/solid.h"

namespace kerf::scene {

namespace {

/// Keys of one section must differ, and forceps and handles have a `Point [m]` and meshes of their own.
constexpr const char* plane_point = "Plane point [m]";
constexpr const char* plane_normal = "Plane normal [1]";

MeshRegion read_mesh_region(const Section& section, const RegionParameters& parameters) {
  const std::string path = resolved(parameters.mesh, section);
  try {
    const auto mesh = geometry::require_solid(geometry::read_mesh(path, parameters.mesh_unit), path);
    return {std::make_shared<geometry::Inside>(mesh)};
  } catch (const DataError& error) {
    throw DataError(section.complaint("Region mesh", clause(error.what()), "").complaint());
  }
}

} // namespace

const std::vector<std::string>& region_names() {
  static const std::vector<std::string> names = {"box", "half space", "sphere", "mesh"};
  return names;
}

void RegionParameters::describe(Parameters& p) {
  const auto is = [&](const std::string& name) { return region.empty() || region == name; };
  const auto require_of_a_region = [&] {
    if (!region.empty())
      p.require_last();
  };
  if (is("box")) {
    p.vector("Lower [m]", lower, "Box: its lower corner, rest configuration.");
    require_of_a_region();
    p.vector("Upper [m]", upper, "Box: its upper corner.");
    require_of_a_region();
  }
  if (is("half space")) {
    p.vector(plane_point, point, "Half space: a point of its plane, rest configuration.");
    require_of_a_region();
    p.vector(plane_normal, normal, "Half space: normal of the plane, of any length, away from the half space.");
    require_of_a_region();
  }
  if (is("sphere")) {
    p.vector("Centre [m]", centre, "Sphere: its centre, rest configuration.");
    require_of_a_region();
    p.number("Radius [m]", radius, positive, "Sphere: its radius.");
    require_of_a_region();
  }
  if (is("mesh")) {
    p.file("Region mesh", mesh, "Mesh: closed triangles (OFF, OBJ, STL, PLY), rest configuration.");
    require_of_a_region();
    p.number("Region mesh unit [m]", mesh_unit, positive, "Mesh: length of one unit of its file.");
  }
}

Region read_region(const Section& section, const std::string& name) {
  RegionParameters of_region;
  of_region.region = name;
  const RegionParameters parameters = read_of_choice(section, "the region '" + name + "'", of_region);
  if (name == "mesh")
    return read_mesh_region(section, parameters);
  if (name == "sphere")
    return Ball{parameters.centre, parameters.radius};
  if (name == "half space") {
    if (parameters.normal.isZero(0))
      throw section.complaint(plane_normal, "must not be zero", "Write the direction away from the half space");
    return HalfSpace{parameters.point, parameters.normal};
  }
  if ((parameters.lower.array() > parameters.upper.array()).any())
    throw section.complaint("Upper [m]", "must not be below Lower [m] in any direction", "Swap the two");
  return Box{parameters.lower, parameters.upper};
}

} // namespace kerf::scene
