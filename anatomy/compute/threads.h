// On how many threads a function works.
#pragma once

namespace ecorche::inline v1 {

enum class Threads { one, all };

}  // namespace ecorche::inline v1
