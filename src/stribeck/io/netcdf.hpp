#pragma once
/// Writes netCDF-4 files (HDF5), which Python, MATLAB, Octave and R read with names and units.
///
///   NetcdfFile file("out.nc");
///   const int run = file.dimension("run", 1000);
///   const int mass = file.variable("mass", NetcdfFile::Type::kNumber, {run});
///   file.describe(mass, "units", "kg");
///   file.begin();
///   file.write(mass, {0}, {1000}, masses);
///   file.finish();
///
/// The library of the system (libnetcdf) is loaded when a file is made; the program starts without it. NaN stands for a value that is
/// not there. The file appears under its name at finish(), whole; without finish() nothing is left. The same calls give the same bytes.
/// Not modelled: groups, unlimited dimensions, compression.
/// Threads: one at a time in the program. Real time: no.
/// Errors: InputError with the path, also where the library is missing, with what to install.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace stribeck::io {

class NetcdfFile {
 public:
  enum class Type { kNumber, kFlag, kText };
  using Places = std::vector<std::size_t>;

  explicit NetcdfFile(const std::string& path);
  ~NetcdfFile();
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  /// Number of a dimension.
  int dimension(const std::string& name, std::size_t size);
  /// Number of a variable over these dimensions. A flag is a byte.
  int variable(const std::string& name, Type type, const std::vector<int>& dimensions);
  /// An attribute of a variable, or of the file.
  void describe(int variable, const std::string& name, const std::string& text);
  void describe(const std::string& name, const std::string& text);
  /// The values of a flag and their names.
  void describe_flag(int variable, const std::vector<signed char>& values, const std::string& names);

  /// Everything is declared.
  void begin();
  /// Values from a place on, the last dimension first to change.
  void write(int variable, const Places& from, const Places& count, std::span<const double> values);
  void write(int variable, const Places& from, const Places& count, std::span<const signed char> values);
  void write(int variable, const Places& from, const std::string& text);
  /// Gives the file its name.
  void finish();

 private:
  struct Library;
  static const Library& library(const std::string& path);
  void check(int status) const;

  std::string path_;
  std::string temporary_;
  const Library* library_;
  int id_ = -1;
};

}  // namespace stribeck::io
