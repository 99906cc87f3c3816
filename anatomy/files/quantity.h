// Lengths and masses as people write them.
#pragma once

#include <string>
#include <string_view>

namespace ecorche::inline v1 {

struct LengthRange {
  double low = 0, high = 0;  // m
};

// "178cm", "1.78 m", "1780mm", "70in", "70\"", "5ft10", "5'10", "5 ft 10.5 in": metres.
//
// `what` names the quantity in messages ("--height", "waist_girth"). `possible`: outside of it the
// length is refused. A number without a unit counts as metres where it can be nothing else: it is
// possible as metres, and none of cm, mm, in and ft would make it `usual`. Throws UsageError that
// names the quantity, the text and what to write instead.
double parse_length(std::string_view text, const std::string& what, const LengthRange& possible,
                    const LengthRange& usual);

// "70kg", "70 kg", "154lb", "11st", "11st4", "70000g", or a number: kilograms. Throws UsageError as
// parse_length.
double parse_mass(std::string_view text, const std::string& what, double low, double high);

}  // namespace ecorche::inline v1
