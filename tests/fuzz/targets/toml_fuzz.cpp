// Machine, axis and controller files: what is accepted is written and read back the same; all else is an InputError with the file.
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/machine.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {
namespace {

template <class T>
void read(std::string_view text) {
  try {
    const T read = io::read_toml_text<T>(text, "fuzz.toml");
    const std::string written = io::write_toml(read, "fuzz");
    const std::string again = io::write_toml(io::read_toml_text<T>(written, "written.toml"), "fuzz");
    demand(written == again, "what was written reads back as something else");
  } catch (const io::InputError& e) {
    check(e, "fuzz.toml");
  }
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  for (const char* name : {"uniaxial-drive", "biaxial-table", "triaxial-tool"})
    all.push_back('\0' + file_of(std::string("machines/") + name + ".toml"));
  for (const char* name : {"biaxial/x", "biaxial/y", "triaxial/x"})
    all.push_back('\1' + file_of(std::string("hal/examples/") + name + ".toml"));
  for (const char* name :
       {"cascade", "contouring", "cross-coupled", "dynamic", "kalman", "learning", "pid", "predictive",
        "repetitive", "reversal", "sliding-mode-adaptive", "sliding-mode", "zpetc"})
    all.push_back('\2' + file_of(std::string("controllers/") + name + ".toml"));
  return all;
}

std::vector<std::string> words() {
  return {"[axes.x]",
          "[axes.x.plant]",
          "[friction]",
          "[friction.steady]",
          "kind = \"gaussian\"",
          "kind = \"lugre\"",
          "\"5 mm\"",
          "\"1 N\"",
          "\"on\"",
          "true",
          "name",
          ".",
          "a.a.a.a.a.a.a.a",
          "\"\"\"",
          "'''",
          "\\u0000",
          "1979-05-27",
          "[[axes]]",
          " = ",
          "{ a = 1 }"};
}

void one(std::string_view input) {
  switch (mode_of(input) % 3) {
    case 0:
      return read<sim::Machine>(input);
    case 1:
      return read<sim::AxisFile>(input);
    default:
      return read<sim::ControllerSpec>(input);
  }
}

}  // namespace stribeck::fuzz
