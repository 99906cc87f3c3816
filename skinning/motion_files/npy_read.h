// Arrays of NumPy (.npy, format versions 1 to 3), read without trust.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

struct NumberArray {
  std::vector<std::size_t> shape;  // none of a single number
  std::vector<double> values;      // by rows

  std::size_t rows() const { return shape.empty() ? 1 : shape[0]; }
  std::size_t row_size() const { return rows() == 0 ? 0 : values.size() / rows(); }
};

// Little-endian floats of 4 and 8 bytes and signed whole numbers of 4 and 8, stored by rows. Throws
// InputError that begins with `name`: another type (objects, big-endian), stored by columns, cut
// short, of more than 4 dimensions, a number that is not finite; LimitError for more than `most`
// numbers.
NumberArray parse_npy(std::string_view bytes, const std::string& name, std::size_t most);

}  // namespace ecorche::inline v1
