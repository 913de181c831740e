// Names in foreign files, and names of files, reach programs that obey what they read: LinuxCNC runs what stands behind HALCMD and
// loadusr. Whatever a name holds, the lines that LinuxCNC obeys are those of a plain name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stribeck/io/printable.hpp>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::foreign_names_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kAxis =
    "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"15 N\"\nalpha2 = \"3 N s/mm\"\n";
constexpr const char* kPlain = "plain";

/// As TOML reads them back, byte by byte.
std::string toml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else if (c == '\r') {
      out += "\\r";
    } else if (c == '\x1b') {
      out += "\\u001B";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + '"';
}

/// Without a line break: LinuxCNC reads an INI in blocks of 255 bytes, each of which it takes for a line.
std::string in_blocks(std::size_t before) {
  std::string text(255 - before, 'x');
  text += "[HAL]" + std::string(250, ' ');
  text += "HALCMD = loadusr touch PWNED";
  return text;
}

std::vector<std::string> attacks() {
  return {"x\n[HAL]\nHALCMD = loadusr touch PWNED\n[DISPLAY]\nDISPLAY = touch PWNED2",
          "x\r[HAL]\rHALCMD = loadusr touch PWNED",
          "x\r\nloadusr touch PWNED\r\n",
          "x\u0085loadusr touch PWNED\u2028loadusr touch PWNED\u2029",
          "x\\",
          "x \\ ",
          in_blocks(std::string("MACHINE = ").size()),
          in_blocks(std::string("# Written by: stribeck export ").size()),
          std::string(3000, '\\'),
          std::string(5000, 'y') + "\n",
          "x) (MSG, hello) M3 S20000 (",
          "x\nM3 S20000\n(",
          "\x1b[2Jx\u202e",
          "\"; loadusr touch PWNED; \"",
          "$(touch PWNED) `touch PWNED` [HAL]HALCMD",
          "\n#INCLUDE /etc/passwd\n"};
}

/// What a file name can hold.
std::string file_name(std::string text) {
  text = text.substr(0, 200);
  std::replace(text.begin(), text.end(), '/', '_');
  return text;
}

/// Lines as the most generous reader splits them: at every kind of break, and after 255 bytes.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = std::string_view(text).substr(i);
    const std::size_t n = rest.starts_with("\u0085")                                        ? 2
                          : rest.starts_with("\u2028") || rest.starts_with("\u2029")        ? 3
                          : std::string_view("\n\r\v\f").find(text[i]) != std::string::npos ? 1
                                                                                            : 0;
    if (n > 0 || lines.back().size() == 255) lines.emplace_back();
    if (n == 0) lines.back() += text[i];
    if (n > 1) i += n - 1;
  }
  return lines;
}

/// What LinuxCNC obeys: no comments, and not the name that the screen shows.
std::vector<std::string> obeyed(const std::string& text) {
  std::vector<std::string> out;
  bool joined = false;
  for (const std::string& line : lines_of(text)) {
    const bool comment = line.starts_with('#') && !line.starts_with("#INCLUDE");
    if ((!line.empty() && !comment && !line.starts_with("MACHINE = ")) || joined) out.push_back(line);
    joined = line.ends_with('\\');
  }
  return out;
}

/// Of every file, by its name.
std::map<std::string, std::vector<std::string>> obeyed_in(const std::string& folder) {
  std::map<std::string, std::vector<std::string>> out;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    // Nobody obeys what these say; they hold the length of the others.
    if (name != "README" && name != "written.txt") out[name] = obeyed(text_of(entry.path().string()));
  }
  return out;
}

std::string machine_called(const std::string& name, const std::string& origin = "made up") {
  std::string text = text_of(std::string(STRIBECK_SOURCE_DIR) + "/machines/uniaxial-drive.toml");
  for (const auto& [key, value] : {std::pair{"name", name}, std::pair{"origin", origin}}) {
    const auto at = text.find(std::string("\n") + key + " =") + 1;
    text.replace(at, text.find('\n', at) - at, std::string(key) + " = " + toml_text(value));
  }
  return text;
}

/// The whole configuration and the drives alone.
std::map<std::string, std::vector<std::string>> machine_export(const Folder& f, const std::string& machine,
                                                               const std::string& out) {
  for (const std::string& to : {f / out, f / (out + ".hal")}) {
    std::vector<std::string> words{"export", machine, "--to", "linuxcnc", "--quiet", "-o", to};
    if (to == f / out) words.insert(words.end(), {"--parameters", "commissioning"});
    const Said said = command(words);
    EXPECT_EQ(said.code, 0) << said.err;
  }
  auto lines = obeyed_in(f / out);
  lines["drives alone"] = obeyed(text_of(f / (out + ".hal")));
  return lines;
}

/// Whether a file may hold it as a name; what it may not hold is refused by every verb, in one clear line.
bool is_plain(const Folder& f, const std::string& attack) {
  if (io::printable(attack) == attack) return true;
  for (const std::string& text : {machine_called(attack), machine_called(kPlain, attack)}) {
    const Said said =
        command({"export", f.write("odd.toml", text), "--to", "linuxcnc", "--quiet", "-o", f / "odd.hal"});
    EXPECT_EQ(said.code, 2) << attack;
    EXPECT_THAT(said.err, HasSubstr("odd.toml:")) << attack;
    EXPECT_THAT(said.err,
                HasSubstr("with line breaks or control characters in it, expected plain text on one line"))
        << attack;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    EXPECT_FALSE(fs::exists(f / "odd.hal")) << attack;
  }
  return false;
}

TEST(ForeignNames, OfAMachineAreNoCommands) {
  const Folder f;
  const auto plain = machine_export(f, f.write("m.toml", machine_called(kPlain)), "plain");
  ASSERT_GE(plain.size(), 14U);
  std::size_t i = 0;
  for (const std::string& attack : attacks()) {
    if (!is_plain(f, attack)) continue;
    const std::string out = "out" + std::to_string(i++);
    EXPECT_EQ(machine_export(f, f.write("m.toml", machine_called(attack)), out), plain) << attack;
    EXPECT_EQ(machine_export(f, f.write("m.toml", machine_called(kPlain, attack)), out + "b"), plain)
        << attack;
  }
  EXPECT_GE(i, 6U);
}

TEST(ForeignNames, OfFilesAreNoCommands) {
  const Folder f;
  const std::string x = f.write("x.toml", kAxis);
  const auto exported = [&](const std::string& axis_file, const std::string& out, bool table) {
    std::vector<std::string> words{"export", axis_file, "--to", "linuxcnc", "--quiet", "-o", out};
    if (table) words.insert(words.end(), {"--lincurve", "--speed", "100 mm/s"});
    const Said said = command(words);
    EXPECT_EQ(said.code, 0) << said.err;
    return obeyed(text_of(out));
  };
  const std::string m = f.write("m.toml", machine_called(kPlain));
  const auto configuration = machine_export(f, m, "plain");
  std::size_t i = 0;
  for (const bool table : {false, true}) {
    const auto plain = exported(x, f / "plain2.hal", table);
    for (const std::string& attack : attacks()) {
      const std::string odd = f.write(file_name(attack) + ".toml", kAxis);
      EXPECT_EQ(exported(odd, f / "out.hal", table), plain) << attack;
      EXPECT_EQ(exported(x, f / (file_name(attack) + ".hal"), table), plain) << attack;
      if (table) continue;
      const std::string odd_machine = f.write(file_name(attack) + "m.toml", machine_called(kPlain));
      EXPECT_EQ(machine_export(f, odd_machine, "out" + std::to_string(i++)), configuration) << attack;
    }
  }
}

TEST(ForeignNames, OfAxisFilesInAConfigurationAreNoCommands) {
  const Folder f;
  const std::string m = f.write("m.toml", machine_called(kPlain));
  const auto exported = [&](const std::string& axis_file, const std::string& omega, const std::string& out) {
    const Said said = command({"export", m, "--to", "linuxcnc", "--quiet", "--axis-file", "x=" + axis_file,
                               "--omega", omega, "-o", f / out});
    EXPECT_EQ(said.code, 0) << said.err;
    return obeyed_in(f / out);
  };
  const auto plain = exported(f.write("x.toml", kAxis), "40 rad/s", "plain");
  std::size_t i = 0;
  for (const std::string& attack : attacks()) {
    EXPECT_EQ(exported(f.write(file_name(attack) + ".toml", kAxis), "40 rad/s", "o" + std::to_string(i++)),
              plain)
        << attack;
  }
  // An option's text as it was typed.
  EXPECT_EQ(exported(f / "x.toml", "40 rad/s\n\n", "last"), plain);
}

TEST(ForeignNames, HalNamesAreLettersAndDigits) {
  const Folder f;
  const std::string x = f.write("x.toml", kAxis);
  for (const char* name : {"a\nb", "a b", "a#", "a\\", "a;b", "$(x)", "a\u0085"}) {
    const Said said = command({"export", x, "--to", "linuxcnc", "--name", name, "-o", f / "n.hal"});
    EXPECT_EQ(said.code, 2) << name;
    EXPECT_THAT(said.err, HasSubstr("--name: got")) << name;
  }
  EXPECT_FALSE(fs::exists(f / "n.hal"));
}

TEST(ForeignNames, OfAMachineStayInTheCommentOfAProgram) {
  const Folder f;
  const auto program = [&](const std::string& name) {
    const Said said = command({"excite", f.write("m.toml", machine_called(name)), "--axis", "x", "--method",
                               "jog", "--quiet", "-o", f / "jog.ngc"});
    EXPECT_EQ(said.code, 0) << said.err;
    std::vector<std::string> lines = lines_of(text_of(f / "jog.ngc"));
    EXPECT_THAT(lines.front(), testing::MatchesRegex("\\([^()%;]*\\)"));
    lines.erase(lines.begin());
    return lines;
  };
  const auto plain = program(kPlain);
  for (const std::string& attack : attacks()) {
    if (is_plain(f, attack)) {
      EXPECT_EQ(program(attack), plain) << attack;
    }
  }
}

}  // namespace
}  // namespace stribeck::test::foreign_names_test
