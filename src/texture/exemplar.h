#pragma once

/// Exemplars: pictures of sections on planes in the body's rest frame (thesis §3.4.2.3), and their charts, which is
/// what they become once they fit the body.

#include "texture/mask.h"
#include "texture/slice.h"
#include "warp/fit.h"

#include <optional>
#include <string>

namespace kerf::texture {

/// What becomes of a picture that does not quite cover the body's own section.
enum class Fit {
  none,    ///< pixels stay where the plane puts them; what lacks goes on from its border
  rigid,   ///< the mask's boundary goes to the section's, the inside as rigidly as possible
  harmonic ///< the same, the inside harmonic
};

/// How an exemplar's plane is swept through the body to find source points (§3.4.2.2).
struct Sweep {
  enum class Path {
    normal,  ///< along the normal, from the barycentre
    middles, ///< along the normal, through the barycentres of the parallel sections
    arc,     ///< the barycentre runs on a great circle around `point`
    axis     ///< the plane turns about a line in it, through `point` along `axis`
  };
  Path path = Path::normal;
  Vec3 point = Vec3::Zero(); ///< rest frame [m]
  Vec3 axis = Vec3::UnitZ(); ///< of any length
};

struct Exemplar {
  std::string name;
  image::Image picture;
  Background background = Background::alpha;
  SectionPlane plane;
  Fit fit = Fit::none;
  Sweep sweep = {};
};

/// A fitted exemplar. Its pixels are those of the picture's plane, moved by whole pixels so that they cover the
/// section; where the picture is drawn to the section, they lie along the section instead (section_pixels.h).
struct Chart {
  SectionPlane plane;                    ///< pixel (0, 0) of the chart is its origin
  image::Raster<Eigen::Array4f> colours; ///< red, green, blue, luminance; defined everywhere
  image::Raster<Eigen::Array4f> spline;  ///< coefficients of the cubic spline through them
  image::Grey luminance;                 ///< luminance alone
  image::Grey shown;                     ///< 1 where the picture shows the section
  image::Grey inside;                    ///< 1 where the body's own section is
  std::vector<Segment> outline;          ///< of the body's section, local coordinates [m]
  double shown_share = 1;                ///< of the body's own section, what the picture shows
  warp::Gap fit_error;                   ///< between the fitted outlines [pixels]; 0 without a fit
  Mat3 body_axes = Mat3::Identity();     ///< columns: axes that turn along with the body
};

/// Axes that turn along with a body, whatever is in it: of its first triangle.
Mat3 axes_of(const geometry::TriangleMesh& body);

/// The unit vector in a plane with that normal that lies along the first of some axes, or where that is nearly the
/// normal along the second.
Vec3 in_plane(const Mat3& axes, const Vec3& normal);

/// 1 or -1, by which side of the axes a vector points to: the same for both normals of a plane once either has been
/// multiplied by its own.
double sense(const Mat3& axes, const Vec3& v);

/// Fits an exemplar to the body. `known` is the map found earlier for the same input; the map that was used is left in
/// `used` (none for Fit::none). Throws ParameterError about the key "Origin [m]" if the plane misses the body, and as
/// mask_of().
Chart make_chart(const Exemplar& exemplar, const geometry::TriangleMesh& body,
                 const std::optional<warp::LatticeMap>& known, std::optional<warp::LatticeMap>& used);

} // namespace kerf::texture
