#include <zlib.h>

#include <stdexcept>

#include <stribeck/targets/fmu/zip.hpp>

namespace stribeck::targets {

namespace {

constexpr unsigned kVersionNeeded = 20;  ///< 2.0: folders and deflate
constexpr unsigned kDeflate = 8;
constexpr unsigned kDate = 0x21;  ///< 1980-01-01

void put(std::string& out, std::size_t value, int bytes) {
  for (; bytes > 0; --bytes, value >>= 8) out += static_cast<char>(value & 0xFF);
}

/// A stream of deflate without the head of zlib.
std::string deflated(const std::string& bytes) {
  z_stream z{};
  constexpr int kRawWindow = -15;
  constexpr int kMemory = 8;
  if (deflateInit2(&z, Z_BEST_COMPRESSION, Z_DEFLATED, kRawWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib does not start");
  std::string out(deflateBound(&z, bytes.size()), '\0');
  // zlib does not write to its input; its type is that of a time before const.
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int end = deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  if (end != Z_STREAM_END) throw std::runtime_error("zlib does not compress");
  return out;
}

/// Fields that the local header and the central directory share, from the version on.
std::string common_head(const ZipFile& file, std::size_t compressed) {
  std::string out;
  put(out, kVersionNeeded, 2);
  put(out, 0, 2);
  put(out, kDeflate, 2);
  put(out, 0, 2);
  put(out, kDate, 2);
  put(out,
      crc32(0, reinterpret_cast<const Bytef*>(file.second.data()), static_cast<uInt>(file.second.size())), 4);
  put(out, compressed, 4);
  put(out, file.second.size(), 4);
  put(out, file.first.size(), 2);
  put(out, 0, 2);
  return out;
}

}  // namespace

std::string zip_archive(const std::vector<ZipFile>& files) {
  std::string out;
  std::string directory;
  for (const ZipFile& file : files) {
    const std::string data = deflated(file.second);
    const std::string head = common_head(file, data.size());
    directory += "PK\x01\x02";
    put(directory, kVersionNeeded, 2);
    directory += head;
    put(directory, 0, 10);  // comment, disk, attributes
    put(directory, out.size(), 4);
    directory += file.first;
    out += "PK\x03\x04" + head + file.first + data;
  }
  const std::size_t begin = out.size();
  out += directory + "PK\x05\x06";
  put(out, 0, 4);
  put(out, files.size(), 2);
  put(out, files.size(), 2);
  put(out, directory.size(), 4);
  put(out, begin, 4);
  put(out, 0, 2);
  return out;
}

}  // namespace stribeck::targets
