#pragma once
/// The archive of repeated tests: a folder of small TOML files, one for each test of an axis or of a circle.
///
///   FOLDER/2026-11-23-x.toml          the test of axis x on that day
///   FOLDER/2026-11-23-x-2.toml        a second one on the same day
///   FOLDER/2026-11-23-circle.toml     a circle
///
/// A file is never changed or replaced: a new test takes the next free name, and the folder is locked while a command adds tests.
/// Files appear whole or not at all (io::write_atomically). Logs that are in the archive are not added again.
/// Real time: no.
/// Errors: InputError naming the file and its key.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/health/date.hpp>
#include <stribeck/ident/health/findings.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// The content of a file of the archive.
struct ArchivedTest {
  std::string format{kFormat};
  std::string date;     ///< 2026-11-23
  std::string machine;  ///< its name
  std::string axis;     ///< or "circle"
  std::vector<std::string> logs;
  std::string checksum;                 ///< of the logs
  std::optional<double> temperature{};  ///< [°C]
  std::optional<ident::health::Measured> measured{};
  std::optional<ident::health::CircleMeasured> circle{};

  static constexpr std::string_view kFormat = "stribeck health 1";
  static constexpr std::string_view kCircle = "circle";

  static constexpr auto fields() {
    using A = ArchivedTest;
    return std::tuple{
        field("format", &A::format, "what this file is, with the number of its format"),
        field("date", &A::date, "day of the test, e.g. 2026-11-23"),
        field("machine", &A::machine, "name of the machine"),
        field("axis", &A::axis, "name of the axis; circle: a circle of two axes"),
        field("logs", &A::logs, "logs from which it was measured"),
        field("checksum", &A::checksum,
              "SHA-256 of the log; of several logs that of their checksums, one behind the other"),
        field("temperature", &A::temperature, pure_number().at_least(-50.0).at_most(150.0),
              "temperature as it was given, in degrees Celsius")
            .or_default(),
        field("measured", &A::measured, "numbers of an axis").or_default(),
        field("circle", &A::circle, "numbers of a circle").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (format != kFormat) report("format", "expected \"stribeck health 1\"");
    if (!ident::health::day_of(date)) report("date", "expected a day as 2026-11-23");
    if (measured.has_value() == circle.has_value()) report("measured", "expected either this or circle");
    if (circle.has_value() != (axis == kCircle))
      report("axis", "expected \"circle\" for a circle, and for nothing else");
    if (measured && measured->friction.empty()) report("measured.friction", "expected at least one speed");
  }
};

struct ArchiveFile {
  std::string path;
  ArchivedTest test;
  double day = 0.0;  ///< as ident::health::HealthTest::day
};

/// The folder, locked against other commands until the end of this object. It is made if it does not exist.
class ArchiveFolder {
 public:
  ArchiveFolder() = default;
  explicit ArchiveFolder(std::string path);
  ~ArchiveFolder();
  ArchiveFolder(ArchiveFolder&& other) noexcept;
  ArchiveFolder& operator=(ArchiveFolder&& other) noexcept;
  ArchiveFolder(const ArchiveFolder&) = delete;
  ArchiveFolder& operator=(const ArchiveFolder&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// Every test, ascending in time; of another machine: refused.
  [[nodiscard]] std::vector<ArchiveFile> read(const std::string& machine) const;
  /// Writes a test under the next free name, and enters it in `files`.
  void add(const ArchivedTest& test, std::vector<ArchiveFile>& files) const;

 private:
  std::string path_;
  int lock_ = -1;
};

/// SHA-256 of the file; of several files that of their checksums.
std::string checksum_of(const std::vector<std::string>& files);

}  // namespace stribeck::workflow
