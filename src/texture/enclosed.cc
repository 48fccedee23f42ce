#include "texture/enclosed.h"

#include "geometry/inside.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace kerf::texture {

namespace {

/// The half spaces that have faces, one each and in their order; empty if some face is not a plane's only one.
std::vector<HalfSpace> planes_of_faces(const Cell& cell) {
  std::vector<HalfSpace> planes;
  for (const Face& face : cell.faces)
    for (std::size_t h = 0; h < cell.halves.size(); ++h)
      if (cell.exemplars[h] == face.exemplar)
        planes.push_back(cell.halves[h]);
  for (std::size_t i = 0; i + 1 < cell.faces.size(); ++i)
    if (cell.faces[i].exemplar == cell.faces[i + 1].exemplar)
      return {};
  return planes;
}

bool allowed(const std::vector<HalfSpace>& planes, const Vec3& p, const Triple& but) {
  for (int i = 0; i < static_cast<int>(planes.size()); ++i)
    if (i != but[0] && i != but[1] && i != but[2] && !planes[i].contains(p))
      return false;
  return true;
}

/// A closed polyhedron with three planes a corner has 2 n - 4 corners.
bool closed(const std::vector<Triple>& triangles, const std::size_t n_planes) {
  return n_planes >= 4 && triangles.size() == 2 * n_planes - 4;
}

} // namespace

std::vector<Triple> enclosing_triangles(const Cell& cell, const geometry::TriangleMesh& body) {
  const auto planes = planes_of_faces(cell);
  const int n = static_cast<int>(planes.size());
  std::vector<Triple> triangles;
  Points corners;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        Mat3 normals;
        normals << planes[i].normal.transpose(), planes[j].normal.transpose(), planes[k].normal.transpose();
        const double determinant = normals.determinant();
        if (std::abs(determinant) < 1e-9)
          continue;
        const Vec3 corner = normals.inverse() * Vec3(planes[i].offset, planes[j].offset, planes[k].offset);
        if (!allowed(planes, corner, {i, j, k}))
          continue;
        triangles.push_back(determinant > 0 ? Triple{i, j, k} : Triple{i, k, j});
        corners.push_back(corner);
      }
  if (!closed(triangles, planes.size()))
    return {};
  const geometry::Inside inside(body);
  for (const Vec3& corner : corners)
    if (!inside.contains(corner))
      return {};
  for (const Vec3& v : body.vertices)
    if (allowed(planes, v, {-1, -1, -1}))
      return {};
  return triangles;
}

} // namespace kerf::texture
