#include "visibility/cut_faces.h"

#include "base/error.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <string>

namespace kerf::visibility {

namespace {

void require_finite(const std::span<const Face> faces, const std::size_t first) {
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const Vec3& p : faces[i])
      if (!p.allFinite())
        throw NumericalError("visibility: a corner of face " + std::to_string(first + i) +
                             " of the cut is not at a finite position");
}

} // namespace

void CutFaces::add(const std::span<const Face> faces) {
  require_finite(faces, faces_.size());
  if (faces.empty())
    return;
  auto begin = static_cast<std::uint32_t>(faces_.size());
  faces_.insert(faces_.end(), faces.begin(), faces.end());
  const auto end = static_cast<std::uint32_t>(faces_.size());
  while (!ranges_.empty() && ranges_.back().end - ranges_.back().begin <= end - begin) {
    begin = ranges_.back().begin;
    ranges_.pop_back();
  }
  index(begin, end);
}

void CutFaces::archive(Archive& a) {
  a(faces_);
  if (!a.reads())
    return;
  ranges_.clear();
  if (!faces_.empty())
    index(0, static_cast<std::uint32_t>(faces_.size()));
}

void CutFaces::index(const std::uint32_t begin, const std::uint32_t end) {
  std::vector<Box> boxes;
  boxes.reserve(end - begin);
  for (std::uint32_t i = begin; i < end; ++i)
    boxes.push_back(geometry::box_around(faces_[i]));
  ranges_.push_back({begin, end, geometry::BoxTree(std::move(boxes))});
}

std::vector<std::uint32_t> CutFaces::crossed(const Vec3& p, const Vec3& q) const {
  std::vector<std::uint32_t> found;
  for_each({p.cwiseMin(q), p.cwiseMax(q)}, [&](const std::uint32_t i) {
    if (geometry::crosses(p, q, faces_[i]))
      found.push_back(i);
  });
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace kerf::visibility
