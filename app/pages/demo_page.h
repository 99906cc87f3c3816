// The demo's report page: every stage in pictures, times beside the template paper's Table 1,
// quality figures and curves.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "app/pages/html_page.h"
#include "app/report.h"

namespace ecorche {

struct Picture {
  std::vector<unsigned char> png;
  std::string caption;
};

// One muscle followed through a motion.
struct MuscleCurve {
  std::string label;
  std::vector<double> length;     // of rest, a value a frame
  std::vector<double> thickness;  // of the thickest slice at rest, of rest, a value a frame
};

struct DemoRecord {
  std::vector<Picture> fit_pictures, motion_pictures;
  std::vector<std::string> missed;  // accuracy targets, in words
  std::vector<MuscleCurve> curves;
  std::vector<double> seconds;                         // of the curves' frames
  std::vector<std::pair<double, std::string>> events;  // take-off, landing
};

std::string demo_page(const DemoRecord& record, const Report& report);

}  // namespace ecorche
