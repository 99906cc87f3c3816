#include "skinning/files/obj_sequence.h"

#include <fmt/format.h>

#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/files/layer_mesh.h"

namespace ecorche::inline v1 {

ObjSequenceWriter::ObjSequenceWriter(const std::filesystem::path& pattern, int vertices,
                                     std::string before, std::string after)
    : ObjSequenceWriter(pattern, Triangles()) {
  head_ += before;
  faces_ = std::move(after);
  highest_ = vertices - 1;
}

ObjSequenceWriter::ObjSequenceWriter(const std::filesystem::path& pattern, const Triangles& F) {
  const std::string text = pattern.filename().string();
  const std::size_t percent = text.find('%');
  std::size_t end = percent == std::string::npos ? text.size() : percent + 1;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9' && width_ < 100)
    width_ = 10 * width_ + (text[end++] - '0');
  if (end >= text.size() || text[end] != 'd' || width_ > 9 ||
      text.find('%', end) != std::string::npos || pattern.extension() != ".obj")
    throw UsageError(
        fmt::format("{}: the files of a sequence are named like DIR/%04d.obj", pattern.string()));
  before_ = (pattern.parent_path() / text.substr(0, percent)).string();
  after_ = text.substr(end + 1);
  make_output_folder(pattern.parent_path());
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    fmt::format_to(std::back_inserter(faces_), "f {} {} {}\n", F(f, 0) + 1, F(f, 1) + 1,
                   F(f, 2) + 1);
  if (F.size() > 0) highest_ = F.maxCoeff();
}

std::filesystem::path ObjSequenceWriter::name(int number) const {
  return fmt::format("{}{:0{}}{}", before_, number, width_, after_);
}

void ObjSequenceWriter::add_frame(std::span<const float> positions, int stride) {
  if (stride < 3 || positions.size() < (std::size_t(highest_) + 1) * std::size_t(stride))
    throw std::invalid_argument(fmt::format("ObjSequenceWriter: {} floats do not hold {} points",
                                            positions.size(), highest_ + 1));
  std::string out = head_;
  append_vertices(positions, stride, out);
  out += faces_;
  write_file_atomically(name(++frames_), out);
}

}  // namespace ecorche::inline v1
