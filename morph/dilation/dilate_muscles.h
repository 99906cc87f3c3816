// Growing the muscles of a fitted anatomy towards the skin, less the layer of fat and skin over
// them.
//
// `paper`: each muscle starts at alpha = 0.4 of its length's scale across and grows by one factor,
//   f = min over slices and rays of (|O S| - layer) / |O E|,   O slice centre, S skin, E ellipse.
// `ecorche`: first the flesh between bones and skin is stretched (or pressed) so that it fills its
// room, all layers in proportion
//   (tissue_stretch.h). Then each slice on its own: every ray gives a plane, the skin's tangent
//   plane at its end moved inwards by the layer; an ellipse (centre, half width, half thickness) is
//   inside when its support in the plane's direction is. Slices of superficial muscles grow
//   outwards until they touch, their inner side held; slices that press into the layer by more than
//   half of it are pressed in, their inner side held, too. Changes are smoothed along the strip;
//   tendons do not grow. Then the drawn surface is looked at: what of it still stands out is moved
//   inside (pull_inside_skin.h). So far sections are ellipses that lie in one another, and bones
//   may pierce them; at last they are lifted off bones (lift_off_bones.h), get outlines and share
//   their room (pack_muscles.h).
#pragma once

#include <optional>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/dilation_record.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

enum class DilateMethod { ecorche, paper };

struct DilateOptions {
  DilateMethod method = DilateMethod::ecorche;
  int rays = 20;  // a slice, 8 .. 64
  // paper: change of a muscle's width and thickness for its change in length, above 0. The factor
  // makes up for it: sections end the same for every alpha, the factor goes with 1 / alpha
  double alpha = 0.4;
  // paper: rays end where they can no longer lower the factor; the result is the same
  bool cut_rays = true;
  double clearance = 0.3e-3;  // ecorche: added to the layer, m
  // ecorche: at last neighbours part and fill what is between them (pack_muscles.h); costs most of
  // the time
  bool share = true;
  int rounds = 4;       // ecorche: times that the flesh is stretched
  double most = 2.2;    // ecorche: a half axis grows to at most this multiple
  double least = 0.35;  // ecorche: and is pressed to no less than this
  // ecorche: what muscles are to hold together, m^3: where the room holds more they are made
  // slimmer (slim_muscles.h). None: all that the room holds.
  std::optional<double> most_volume;
  // ecorche: x of the plane about which skin and carried muscles are even, to a millimetre
  // (FitReport::even_about). Then muscles of the right side become mirror images of the left ones.
  std::optional<double> even_about;
};

struct MuscleDilation {
  double wanted = 0;  // volume before, m^3
  double volume = 0;  // volume after, m^3
  double factor = 1;  // paper: f; ecorche: square root of the volumes' ratio
};

struct DilateReport {
  int slices = 0;
  long long rays = 0;
  long long misses = 0;     // rays that met no skin; 0 where every centre is inside a closed skin
  int pulled_in = 0;        // slices whose centre lay outside the skin
  int pressed = 0;          // slices that stood out and were pressed in
  int grown = 0;            // slices that grew
  int surface_outside = 0;  // ecorche: surface points outside the skin before the last step,
  int surface_left = 0;     // and after it
  // muscles that came out inside out or elsewhere; they keep the sections they were carried with
  int collapsed = 0;
  double target_volume = 0;  // all muscles, m^3
  double volume = 0;
  std::vector<MuscleDilation> muscles;  // #muscles
};

// Gives `anatomy` the muscles `carried`, grown: bones and skeleton are looked at, what muscles it
// has is forgotten. So muscles are grown once, from what was carried; growing again changes
// nothing. `carried`: the muscles of `original` carried into the body (fit_anatomy), same strips
// and slices, with the wanted volumes in their sections; may be anatomy.muscles. Sets slices, and
// Muscle::volume to what the sections now hold. `rays` and `fat` are of the same skin, closed. The
// same bytes at any number of threads. `trace`: of method `ecorche` with `share`, see there. Throws
// std::invalid_argument when the two sets do not match.
DilateReport dilate_muscles(Anatomy& anatomy, const std::vector<Muscle>& carried,
                            const std::vector<Muscle>& original, const SkinRays& rays,
                            const FatLayer& fat, const DilateOptions& options = {},
                            const DilationTrace& trace = {});

}  // namespace ecorche::inline v1
