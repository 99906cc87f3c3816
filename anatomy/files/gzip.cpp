#include "anatomy/files/gzip.h"

#include <zlib.h>

#include <array>
#include <memory>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

std::string gunzip(std::string_view bytes, const std::string& name, std::size_t limit) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK)
    throw LimitError(name + ": not enough memory to decompress");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  std::array<char, 1 << 16> chunk;
  for (int state = Z_OK; state != Z_STREAM_END;) {
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    state = inflate(&stream, Z_NO_FLUSH);
    if (state == Z_BUF_ERROR || (state == Z_OK && stream.avail_in == 0 && stream.avail_out != 0)) {
      throw InputError(name + ": the gzip data is truncated");
    }
    if (state != Z_OK && state != Z_STREAM_END)
      throw InputError(name + ": the gzip data is damaged");
    out.append(chunk.data(), chunk.size() - stream.avail_out);
    if (out.size() > limit)
      throw LimitError(fmt::format("{}: decompresses to more than {} bytes", name, limit));
  }
  return out;
}

}  // namespace ecorche::inline v1
