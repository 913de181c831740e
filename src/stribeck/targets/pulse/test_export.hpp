#pragma once
/// An export to a target with a pulse, for the tests of these targets.

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/target.hpp>
#include <string>

namespace stribeck::test {

/// An axis of 1000 kg under the built-in cascade, on its way to a target with a pulse.
struct PulseExport {
  Folder folder;
  targets::ExportRequest request;
  std::string target;
  PulseExport(const char* to, const std::string& dynamics) : target(to) {
    request.files = {folder.write(
        "x.toml",
        ("mass = \"1000 kg\"\n[friction]\nsteady = { kind = \"conventional\", alpha0 = \"20 N\", alpha2 = \"4 N s/mm\" }\n" +
         dynamics)
            .c_str())};
    request.output = folder / "pulse.txt";
    request.speed = "10 mm/s";
    request.period = "5 ms";
    request.command = "test";
  }
  targets::Exported write() { return targets::find_target(target)->write(request); }
  std::string refusal() {
    try {
      static_cast<void>(write());
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return "accepted";
  }
};
inline constexpr const char* kBristles =
    "dynamics = { kind = \"lugre\", sigma0 = \"8000 N/mm\", sigma1 = \"80 N s/mm\", damping_velocity = \"0.05 mm/s\" }\n";

}  // namespace stribeck::test
