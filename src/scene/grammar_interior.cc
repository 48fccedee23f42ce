#include "scene/grammar_interior.h"

namespace kerf::scene {

void InteriorParameters::describe(Parameters& p) {
  p.number("Resolution [m]", resolution, positive,
           "Revealed faces are as fine as pictures with square pixels of this side.");
  p.require_last();
  p.choice(
    "Morph", morph, {"first order", "exact inverse", "blend", "nearest"},
    "How source points become a colour: by warps in first order (thesis, 3.14); by their exact inverse (3.13); by "
    "mixing without warps; by the nearest alone.");
  p.choice(
    "Weights", weights, {"Shepard", "mean value"},
    "Of source points. Mean value coordinates where these enclose the point, in cells that do not touch the skin; "
    "Shepard's elsewhere; in between a mixture of both.");
  p.number("Weight power [1]", power, positive, "Of the distances in Shepard's weights.");
  p.choice(
    "Warps", warps, {"all", "facing"},
    "Between all exemplars that bound a cell, or only between those that face each other within 45 degrees or are "
    "joined by a pin.");
  p.choice("Components", components, {"one", "each", "together"},
           "When an exemplar's section has several components in a cell: refused; an exemplar each; one exemplar.");
  p.boolean("Small features", small_features,
            "Put back what blending loses, by matching histograms of 7 x 7 pixels on the surface.");
  p.number("Relief [m]", relief, any_number,
           "Height of white above black, which bends the normals of revealed faces in images; 0: smooth.");
  p.file("Skin image", skin_image,
         "A picture of the whole skin, unrolled around an axis as on a map of the earth; empty: one colour.");
  p.vector("Skin axis [1]", skin_axis, "Through the middle of the body, to where the picture's first row lies.");
  p.integer("Match levels [1]", levels, {1, 8}, "Levels of the Gaussian stack in which features are matched.");
  p.integer("Match cells [1]", cells, {2, 128}, "Cells of the finest lattice of a warp along its longer side.");
  p.integer("Match pixels [1]", match_pixels, {16, 1024},
            "Pixels that are matched along the longer side of a section.");
  p.number("Edges [1]", edges, non_negative, "Weight of edges in the matching of features.");
  p.number("Brightness [1]", brightness, non_negative, "Weight of brightness in it.");
  p.number("Outline [1]", outline, non_negative, "Weight of the sections' outlines in it.");
  p.number("Stiffness [1]", stiffness, positive, "Of a warp's triangles, against features of mean square 1.");
  p.choice("Global motion", global, {"none", "rotation", "rotation and scale"},
           "What is taken out of a warp before its deformation counts.");
}

void ExemplarParameters::describe(Parameters& p) {
  p.file("Image", image, "Picture of a section (PNG, JPEG); a relative path starts at the scene file.");
  p.require_last();
  p.choice(
    "Background", background, {"alpha", "black", "none"},
    "What of the picture is no section: what is transparent; what is black and connected to its border; nothing.");
  p.vector("Origin [m]", origin, "Where the middle of the first pixel lies, rest configuration.");
  p.require_last();
  p.vector("Column [m]", column, "The step from a pixel to the next one on its right.");
  p.require_last();
  p.vector("Row [m]", row, "The step from a pixel to the one below it.");
  p.require_last();
  p.choice(
    "Fit", fit, {"none", "rigid", "harmonic"},
    "Whether the picture's boundary is drawn to that of the body's own section; its inside then goes along as "
    "rigidly as possible, or harmonically. Without, what the picture does not show of the section goes on from its "
    "border; the run says how much that is.");
  p.choice(
    "Sweep", sweep, {"normal", "middles", "arc", "axis"},
    "How the plane is swept to a point: along its normal from the barycentre; along it through the barycentres of "
    "the parallel sections; along a great circle about the centre; about an axis in the plane.");
  p.vector("Centre [m]", centre, "Of the great circle, or a point of the axis; on the plane.");
  p.vector("Axis [1]", axis, "Of sweep axis.");
}

void PinParameters::describe(Parameters& p) {
  p.text("From exemplar", from_exemplar, "Name of an exemplar.");
  p.require_last();
  p.vector("From [m]", from, "A point of it, rest configuration.");
  p.require_last();
  p.text("To exemplar", to_exemplar, "Name of another one.");
  p.require_last();
  p.vector("To [m]", to, "The point that shows the same.");
  p.require_last();
}

SectionKind interior_kind() {
  return {
    "Interior",
    Occurrence::once,
    "What is inside: colours of revealed faces from pictures of sections.",
    keys_of<InteriorParameters>(),
    {{"Exemplar",
      Occurrence::named,
      "A section. Their order matters: each divides what those before it have left whole.",
      keys_of<ExemplarParameters>(),
      {}},
     {"Pin", Occurrence::named, "Two points of two exemplars that show the same.", keys_of<PinParameters>(), {}}}};
}

} // namespace kerf::scene
