/// Bad input gets one clear line, exit code 2, and leaves nothing behind.

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stribeck/io/printable.hpp>

#include "command.hpp"

namespace stribeck::test::bad_input_test {
namespace {

/// The line must name the place and hold every part given.
void expect_refused(const Said& said, const std::vector<std::string>& parts) {
  EXPECT_EQ(said.code, 2) << said.out << said.err;
  EXPECT_EQ(said.err.rfind("stribeck: ", 0), 0U) << said.err;
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  for (const auto& part : parts)
    EXPECT_NE(said.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << said.err;
  EXPECT_EQ(said.out, "");
}

class BadMachine : public testing::Test {
 protected:
  /// The V2 file with one text replaced, once.
  Said changed(const std::string& from, const std::string& to) {
    std::string text = text_of(kMachine);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const Said said = command({"compare", folder.write("m.toml", text), "--json", folder / "out.json"});
    EXPECT_FALSE(std::filesystem::exists(folder / "out.json"));
    return said;
  }
  Folder folder;
};

TEST_F(BadMachine, UnknownKey) {
  expect_refused(changed("sample_time = \"5 ms\"", "sample_time = \"5 ms\"\nsampletime = \"5 ms\""),
                 {"m.toml:", "sampletime", "sample_time"});
}
TEST_F(BadMachine, WrongDimension) {
  expect_refused(changed("mass = \"57.65 N s2/mm\"", "mass = \"57.65 mm\""),
                 {"m.toml:", "axes.x.plant.mass", "57.65 mm", "N s2/mm"});
}
TEST_F(BadMachine, MissingUnit) {
  expect_refused(changed("resolution = \"25 nm\"", "resolution = 25"),
                 {"m.toml:", "axes.x.plant.encoder.resolution", "unit", "nm"});
  expect_refused(changed("resolution = \"25 nm\"", "resolution = \"25\""),
                 {"m.toml:", "axes.x.plant.encoder.resolution", "unit", "nm"});
}
TEST_F(BadMachine, NegativeMass) {
  expect_refused(changed("mass = \"57.65 N s2/mm\"", "mass = \"-57.65 N s2/mm\""),
                 {"m.toml:", "axes.x.plant.mass", "-57.65", "0"});
}
TEST_F(BadMachine, SampleTimeZero) {
  expect_refused(changed("sample_time = \"5 ms\"", "sample_time = \"0 ms\""),
                 {"m.toml:", "sample_time", "0"});
}
TEST_F(BadMachine, NotFinite) {
  expect_refused(changed("eta0 = \"768.6 N\"", "eta0 = \"nan N\""), {"m.toml:", "eta0", "nan"});
  expect_refused(changed("bits = 16", "bits = 1e99"), {"m.toml:", "bits"});
}
TEST_F(BadMachine, BrokenToml) { expect_refused(changed("[axes.x.plant]", "[axes.x.plant"), {"m.toml:"}); }
TEST_F(BadMachine, FrictionWithoutDynamics) {
  expect_refused(changed("[axes.x.plant.friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"3e5 "
                         "N/mm\"\nsigma1 = \"600 N s/mm\"\n"
                         "damping_velocity = \"0.05 mm/s\"",
                         ""),
                 {"m.toml:", "axes.x.plant", "lugre"});
}
// A name "-" means standard output to a shell user: --json takes it, everything else refuses it.
TEST_F(BadMachine, ADashIsStandardOutputOrRefused) {
  const std::vector<std::string> run{"simulate", kMachine, "--parameters", "thesis", "--controller", "f"};
  auto words = run;
  words.insert(words.end(), {"-o", folder / "t.csv", "--json", "-"});
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(said.out.rfind("{", 0), 0U) << said.out;
  EXPECT_EQ(said.out.back(), '\n');
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"-o", "-"}, {"-o", folder / "t.csv", "--report", "-"}}) {
    words = run;
    words.insert(words.end(), bad.begin(), bad.end());
    expect_refused(command(words), {"got \"-\", expected a name (only --json writes to standard output)"});
  }
}
TEST_F(BadMachine, EmptyListOfGains) {
  const std::string file = folder.write(
      "c.toml",
      "id = \"mine\"\nlabel = \"My law\"\nfriction = \"none\"\n\n[law]\nkind = \"contouring\"\nkp = []\nkv = [\"40 1/s\"]\n");
  expect_refused(
      command({"simulate", kMachine, "--parameters", "thesis", "--controller", file, "-o", folder / "t.csv"}),
      {"c.toml:7: law.kp: got a list of 0, expected 1 to", "leave the key out for its default"});
}
TEST_F(BadMachine, DirectoryMissingEmpty) {
  expect_refused(command({"compare", folder / "."}), {"directory"});
  expect_refused(command({"compare", folder / "no.toml"}), {"no.toml"});
  const Said empty = command({"compare", folder.write("empty.toml", "")});
  EXPECT_EQ(empty.code, 2);
  EXPECT_NE(empty.err.find("empty.toml"), std::string::npos);
}

class BadLog : public testing::Test {
 protected:
  /// A good log, except for what `spoil` does to its lines.
  template <class Spoil>
  Said with(Spoil&& spoil, std::vector<std::string> more = {}) {
    std::vector<std::string> lines{"t [s],x [mm],f [N]"};
    for (int k = 0; k < 3000; ++k) {
      std::ostringstream row;
      row.precision(12);
      row << 0.005 * k << ',' << 5 * std::sin(0.002 * k) << ','
          << (std::cos(0.002 * k) > 0 ? 100 : -100) + 0.01 * (k % 7);
      lines.push_back(row.str());
    }
    spoil(lines);
    std::string text;
    for (const auto& l : lines) text += l + '\n';
    std::vector<std::string> words{"identify", folder.write("log.csv", text), "-o", folder / "axis.toml"};
    words.insert(words.end(), more.begin(), more.end());
    const Said said = command(words);
    EXPECT_FALSE(std::filesystem::exists(folder / "axis.toml"));
    return said;
  }
  Folder folder;
};

using Lines = std::vector<std::string>;

TEST_F(BadLog, MissingColumn) {
  expect_refused(with([](Lines& l) { l[0] = "t [s],y [K],f [N]"; }), {"log.csv", "x", "y [K]", "--map"});
}
TEST_F(BadLog, MissingUnit) {
  expect_refused(with([](Lines& l) { l[0] = "t [s],x,f [N]"; }), {"log.csv", "x", "unit"});
}
TEST_F(BadLog, WrongDimension) {
  expect_refused(with([](Lines& l) { l[0] = "t [s],x [kg],f [N]"; }), {"log.csv", "x", "kg"});
}
TEST_F(BadLog, TextInANumber) {
  expect_refused(with([](Lines& l) { l[42] = "0.205,abc,100"; }), {"log.csv:43", "abc", "x"});
}
// A NaN is an absent sample (docs/log-formats.md), an infinite number is damage.
TEST_F(BadLog, Infinite) {
  expect_refused(with([](Lines& l) { l[42] = "0.205,inf,100"; }), {"log.csv:43", "x"});
}
TEST_F(BadLog, Empty) {
  expect_refused(with([](Lines& l) { l.clear(); }), {"log.csv", "empty"});
}
TEST_F(BadLog, OneRow) {
  expect_refused(with([](Lines& l) { l.resize(2); }), {"log.csv", "row"});
}
TEST_F(BadLog, TimeThatDoesNotIncrease) {
  expect_refused(with([](Lines& l) { std::swap(l[10], l[11]); }), {"log.csv", "t", "row"});
}
TEST_F(BadLog, Gap) {
  // Cut there and gone on; what it was is said.
  std::string text = "t [s],x [mm],f [N]\n";
  for (int k = 0; k < 1000; ++k) {
    if (k >= 400 && k < 440) continue;
    text += std::to_string(0.005 * k) + ',' + std::to_string(std::sin(0.01 * k)) + ',' +
            std::to_string(100.0 * std::cos(0.01 * k)) + '\n';
  }
  const Said said = command({"identify", folder.write("log.csv", text), "--inspect"});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("row 401 (2.2 s): a gap of 0.205 s"), std::string::npos) << said.out;
}
TEST_F(BadLog, Directory) { expect_refused(command({"identify", folder / "."}), {"directory"}); }
TEST_F(BadLog, GainOfAnotherDimension) {
  expect_refused(with([](Lines& l) { l[0] = "t [s],x [mm],u [V]"; }, {"--gain", "1048 N"}),
                 {"--gain", "1048 N"});
}
TEST_F(BadLog, AxisThatStandsStill) {
  // Nothing to identify: one line, not a crash.
  const Said said = with([](Lines& l) {
    for (std::size_t k = 1; k < l.size(); ++k)
      l[k] = std::to_string(0.005 * static_cast<double>(k)) + ",1,100";
  });
  EXPECT_EQ(said.code, 2) << said.err;
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
}

TEST_F(BadLog, NumberOfNoMachine) {
  expect_refused(with([](Lines& l) { l[42] = "0.205,1,1e300"; }), {"log.csv", "row 42", "force"});
}
TEST_F(BadLog, OptionsThatChangeNothing) {
  const auto refused = [&](std::vector<std::string> words, std::vector<std::string> parts) {
    expect_refused(with([](Lines&) {}, std::move(words)), parts);
  };
  refused({"--gain", ""}, {"--gain", "expected a value"});
  refused({"--axis", " "}, {"--axis", "expected a value"});
  refused({"--lead", "5 mm"}, {"--lead", "no column of this log is an angle"});
  refused({"--turn", "5 mm"}, {"--turn", "--method auto does not take it"});
  refused({"--method", "position-map", "--turn", "1e300 mm"}, {"--turn", "1e300 mm", "expected between"});
  refused({"--method", "position-map", "--turn", "-5 mm"}, {"--turn", "-5 mm", "above 0"});
  refused({"--model", "conventional", "--terms", "2"}, {"--terms", "no Gaussians"});
  refused({"--method", "gravity", "--mass", "1 kg"}, {"--mass", "--method gravity"});
  refused({"--mass", "0 kg"}, {"--mass", "0 kg"});
  refused({"--mass", "1e300 kg"}, {"--mass", "1e300 kg"});
  refused({"--cut-off", "1e300 Hz"}, {"--cut-off", "1e300 Hz", "below 100 Hz"});
  refused({"--cut-off", "1e-300 Hz"}, {"--cut-off", "1e-300 Hz", "one period of the log"});
  refused({"--gain", "2"}, {"--gain", "has a scale already"});
  refused({"--gain", "1048 N/V"}, {"--gain", "has a scale already"});
  refused({folder / "log.csv"}, {"LOG", "twice"});
  refused({folder / "./log.csv"}, {"LOG", "twice"});
}
TEST_F(BadLog, InspectTakesNothingOfAnIdentification) {
  const std::string log = folder.write("log.csv", "t [s],x [mm],f [N]\n");
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--mass", "1 kg"},
                                             {"--method", "jog"},
                                             {"--report", folder / "page"},
                                             {"-o", folder / "axis.toml"}}) {
    std::vector<std::string> all{"identify", log, "--inspect"};
    all.insert(all.end(), words.begin(), words.end());
    expect_refused(command(all), {words[0] == "-o" ? "--output" : words[0], "--inspect"});
  }
}
TEST_F(BadLog, UnitOfAnotherQuantity) {
  const auto spoil = [](Lines& l) { l[0] = "t [s],x [mm/s2],f [N]"; };
  expect_refused(with(spoil, {"--map", "x=x mm"}), {"--map", "x [mm/s2]", "cannot be converted to mm"});
  expect_refused(with([](Lines&) {}, {"--map", "force=x N", "--map", "x=f mm"}),
                 {"--map", "x [mm]", "cannot be converted to N"});
}

TEST(Report, AFailedCommandLeavesNoFolderBehind) {
  namespace fs = std::filesystem;
  Folder folder;
  expect_refused(command({"compare", folder / "nothing.toml", "--report", folder / "deep/er"}),
                 {"nothing.toml"});
  EXPECT_FALSE(std::filesystem::exists(folder / "deep"));
  expect_refused(command({"tune", kMachine, "--controller", "f", "--axis-file", "x=" + (folder / "no.toml"),
                          "-o", folder / "tuned", "--report", folder / "page"}),
                 {"no.toml"});
  EXPECT_FALSE(std::filesystem::exists(folder / "tuned"));
  EXPECT_FALSE(std::filesystem::exists(folder / "page"));
  // What was there before stays.
  std::filesystem::create_directory(folder / "mine");
  expect_refused(command({"compare", folder / "nothing.toml", "--report", folder / "mine"}),
                 {"nothing.toml"});
  EXPECT_TRUE(std::filesystem::exists(folder / "mine"));
}

// One direction only: what can be told is told, and what cannot is not written.
TEST(OneDirection, IsIdentifiedAsFarAsItGoes) {
  Folder folder;
  std::string text = "t [s],x [mm],f [N]\n";
  for (int k = 0; k < 8000; ++k) {
    const double t = 0.001 * k;
    const double mid = t + 0.0005;  // the force is held
    std::ostringstream row;
    row.precision(12);
    row << t << ',' << 5 * t + 2 * (1 - std::cos(2 * t)) << ','
        << 100 + 2 * (5 + 4 * std::sin(2 * mid)) + 0.5 * 8 * std::cos(2 * mid) + 0.1 * std::sin(997.0 * k * k)
        << '\n';
    text += row.str();
  }
  const std::string log = folder.write("one.csv", text);
  const Said said = command({"identify", log, "--json", folder / "o.json"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(folder / "o.json"));
  EXPECT_NEAR(json["mass_kg"].get<double>(), 500.0, 5.0);
  EXPECT_NE(said.out.find("one direction only"), std::string::npos);
  expect_refused(command({"identify", log, "-o", folder / "axis.toml"}), {"--output", "both directions"});
  // An axis that settles moves back a little: no second direction, of which there would be too few rows.
  const double end = 5 * 7.999 + 2 * (1 - std::cos(2 * 7.999));
  for (int k = 0; k < 60; ++k) {
    std::ostringstream row;
    row.precision(12);
    row << 8.0 + 0.001 * k << ',' << end - 0.001 * k << ',' << -60 << '\n';
    text += row.str();
  }
  const Said settled = command({"identify", folder.write("settles.csv", text)});
  EXPECT_EQ(settled.code, 0) << settled.err;
  EXPECT_NE(settled.out.find("one direction only"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "axis.toml"));
}

// Nothing is begun that takes hours or fills a disk.
TEST(BadUsage, ExcitationsHaveAnEnd) {
  Folder folder;
  const auto refused = [&](std::vector<std::string> words, std::vector<std::string> parts) {
    words.insert(words.begin(), {"excite", kMachine, "--axis", "x", "-o", folder / "r.csv", "--method"});
    expect_refused(command(words), parts);
    EXPECT_EQ(folder.files(), 0U);
  };
  refused({"ramp", "--rise", "1e9 s"}, {"--rise", "1e+09 s", "2000000 rows", "shorter"});
  refused({"ramp", "--rise", "1e-9 s"}, {"--rise", "1e-09 s", "at least 0.5 s"});
  refused({"ramp", "--repeats", "1000"}, {"--repeats", "1000", "fewer repeats"});
  refused({"jog", "--speeds", "1e-12 mm/s"}, {"--speeds", "1e-12 mm/s", "rows", "leave out"});
  refused({"jog", "--speeds", "1 m/s"}, {"--speeds", "1000 mm/s", "limit"});
  refused({"jog", "--lead", "1e12 mm"}, {"--lead", "1e+12 mm", "expected between"});
  refused({"sine", "--periods", "1000"}, {"--periods", "1000", "fewer periods"});
  refused({"sine", "--known", ""}, {"--known", "expected a value"});
}

TEST(BadUsage, IsOneLineAndTwo) {
  Folder folder;
  expect_refused(command({}), {"--help"});
  expect_refused(command({"compar"}), {"--help"});
  expect_refused(command({"compare"}), {"machine"});
  expect_refused(command({"compare", kMachine, "--experiment", "no"}), {"--experiment", "bi-table"});
  expect_refused(command({"compare", kMachine, "--trials", "0"}), {"--trials"});
  expect_refused(command({"compare", kMachine, "--seed", "-1"}), {"--seed", "-1", "from 0"});
  expect_refused(command({"compare", kMachine, "--speed", "3"}), {"--speed", "unit"});
  expect_refused(command({"compare", kMachine, "--speed", "0 mm/s"}), {"--speed"});
  expect_refused(command({"compare", kMachine, "--speed", "500 mm/s"}), {"--speed", "limit"});
  expect_refused(command({"compare", kMachine, "--size", "1 m"}), {"--size", "travel"});
  expect_refused(command({"compare", kMachine, "--axis-file", "x"}), {"--axis-file"});
  expect_refused(command({"excite", kMachine, "--method", "sine", "--axis", "q", "-o", folder / "r.csv"}),
                 {"\"q\"", "x, y"});
  expect_refused(command({"excite", kMachine, "--method", "sine", "--axis", "x", "--periods", "-3", "-o",
                          folder / "r.csv"}),
                 {"--periods"});
  EXPECT_EQ(folder.files(), 0U);
}

// A machine file in the place of another file is called so; among the logs of identify it may stand anywhere.
TEST(BadUsage, FilesInTheWrongPlace) {
  const Folder folder;
  const std::string log = folder.write("log.csv", "[Scope]\nt [s],x [mm],f [N]\n0,1,2\n1,2,3\n2,3,4\n");
  expect_refused(command({"verify", kMachine, log}), {"is a machine file", "expected an axis file"});
  expect_refused(command({"excite", log, "--method", "sine", "--axis", "x", "-o", folder / "r.csv"}),
                 {"log.csv", "expected a machine file"});
  const Said last = command({"identify", log, kMachine}), first = command({"identify", kMachine, log});
  EXPECT_EQ(last.err, first.err);
  EXPECT_EQ(last.code, first.code);
}

TEST(BadUsage, WhatCannotBeSimulatedIsSaidInItsRow) {
  // Unstable, too slow: the rows that cannot be simulated say so, the others stand.
  Folder folder;
  for (const auto& gains : {"4000 rad/s", "0.001 rad/s"}) {
    const Said said = command({"compare", kMachine, "--parameters", "thesis", "--trials", "1", "--omega-t",
                               gains, "--omega-n", gains, "--json", folder / "o.json"});
    EXPECT_EQ(said.code, 0);
    EXPECT_THAT(said.err + said.out, ::testing::HasSubstr("(d) at 3 mm/s: not simulated: the "));
    EXPECT_THAT(text_of(folder / "o.json"), ::testing::HasSubstr("\"refused\": \"the "));
    std::filesystem::remove(folder / "o.json");
  }
  // Too stiff for any: one line, exit code 1, nothing written.
  std::string stiff = text_of(kMachine);
  const auto at = stiff.find("sigma0 = \"3e5 N/mm\"");
  stiff.replace(at, 19, "sigma0 = \"3e12 N/mm\"");
  const Said said =
      command({"compare", folder.write("stiff.toml", stiff), "--trials", "1", "--json", folder / "o.json"});
  EXPECT_EQ(said.code, 1);
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "o.json"));
}

TEST(BadUsage, NeverWritesOverItsInput) {
  Folder folder;
  const std::string machine = folder.write("m.toml", text_of(kMachine));
  expect_refused(command({"compare", machine, "--json", machine}), {"m.toml", "overwritten"});
  expect_refused(command({"simulate", machine, "-o", machine}), {"m.toml", "overwritten"});
  EXPECT_EQ(text_of(machine), text_of(kMachine));
}

TEST_F(BadMachine, AxisNameThatIsAPath) {
  std::string text = text_of(kMachine);
  for (auto at = text.find("axes.x"); at != std::string::npos; at = text.find("axes.x", at + 1))
    text.replace(at, 6, "axes.\"../x\"");
  expect_refused(command({"compare", folder.write("m.toml", text)}), {"m.toml", "axes", "letters"});
}

TEST_F(BadLog, ForceAndMotionThatOppose) {
  const Said said = with([](Lines& l) {
    // A mass of one tonne, but pushed the wrong way.
    for (std::size_t k = 1; k < l.size(); ++k) {
      const double t = 0.005 * static_cast<double>(k);
      std::ostringstream row;
      row.precision(15);
      row << t << ',' << 5 * std::sin(3 * t) << ','
          << 1000 * 45e-3 * std::sin(3 * t) + (std::cos(3 * t) > 0 ? -100 : 100);
      l[k] = row.str();
    }
  });
  EXPECT_EQ(said.code, 1) << said.err;
}

TEST(BadOutput, IsSaidBeforeTheWork) {
  Folder folder;
  const std::string file = folder.write("file", "x");
  expect_refused(command({"compare", kMachine, "--json", folder / "no/such/out.json"}),
                 {"out.json", "folder"});
  expect_refused(command({"compare", kMachine, "--json", folder / "."}), {"directory"});
  expect_refused(command({"compare", kMachine, "--report", file + "/below"}), {"below"});
  expect_refused(command({"excite", kMachine, "--method", "sine", "--axis", "x", "-o", "/proc/no.csv"}),
                 {"/proc/no.csv"});
  EXPECT_EQ(text_of(file), "x");
}

TEST(BadOutput, OneThatCannotBeWrittenLeavesTheOthersAsTheyWere) {
  const Folder folder;
  const std::string old = folder.write("a.csv", "old");
  std::filesystem::create_directories(folder / "page/index.html");
  expect_refused(
      command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", old, "--report", folder / "page"}),
      {"index.html", "directory"});
  EXPECT_EQ(text_of(old), "old");
  // A device that takes nothing is found when it is written to: after the table is made.
  if (std::filesystem::exists("/dev/full")) {
    expect_refused(
        command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", old, "--json", "/dev/full"}),
        {"/dev/full: cannot be written", "No space left"});
    EXPECT_EQ(text_of(old), "old");
  }
  EXPECT_EQ(folder.files(), 2U);
}

TEST(BadOutput, LinksThatLeadNowhere) {
  const Folder folder;
  std::filesystem::create_symlink("loop", folder / "loop");
  expect_refused(command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", folder / "loop"}),
                 {"loop: cannot be written", "Too many levels"});
  // A link to what will be there is followed, so these two are one file.
  std::filesystem::create_symlink("a.csv", folder / "link");
  expect_refused(command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", folder / "a.csv",
                          "--json", folder / "link"}),
                 {"would be overwritten"});
}

TEST(BadOutput, AnAxisFileIsReadBeforeTheWork) {
  const Folder folder;
  const std::string broken = folder.write("x.toml",
                                          "mass = \"heavy\"\n[friction.steady]\nkind = \"conventional\"\n"
                                          "alpha0 = \"15 N\"\nalpha2 = \"3 N s/mm\"\n");
  // Identification of this machine says no, with code 1: it has not begun.
  std::string stiff = text_of(kMachine);
  stiff.replace(stiff.find("sigma0 = \"3e5 N/mm\""), 19, "sigma0 = \"3e12 N/mm\"");
  const std::string machine = folder.write("stiff.toml", stiff);
  for (const char* verb : {"simulate", "compare"}) {
    std::vector<std::string> words{verb, machine, "--axis-file", "x=" + broken};
    if (std::string_view(verb) == "simulate") words.insert(words.end(), {"-o", folder / "t.csv"});
    expect_refused(command(words), {"x.toml:1: mass"});
  }
}

// A terminal obeys control characters, in whatever a file or an argument holds.
TEST(BadOutput, NothingThatIsSaidCommandsTheTerminal) {
  const Folder folder;
  const std::string odd = "\u001b[31m\u009b\u202e\xff\a";
  folder.write("log.csv", "0,1,0\n0.001,2,0\n0.002,3,0\n0.003,5,0\n");
  folder.write("log.csv.toml", "columns = [\"t s\", \"a\\u001B[31m\\u0000\\u009B\\u202E mm\", \"" +
                                   std::string(20000, 'c') + " N\"]\n");
  std::string long_name(5000, 'k');
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"identify", folder / "log.csv", "--inspect"},
        {"identify", folder / (odd + ".csv")},
        {odd},
        {"compare", kMachine, "--" + odd},
        {"compare", kMachine, "--" + long_name},
        {"compare", long_name},
        {long_name},
        {"excite", kMachine, "--axis", odd + long_name, "--method", "jog", "-o", folder / "a.csv"},
        {"compare", kMachine, "--speed", long_name + odd},
        {"simulate", folder.write("m.toml", long_name + " = 1\n\"" + long_name + "\" = 2\n"), "-o",
         folder / "t.csv"}}) {
    const Said said = command(words);
    for (const std::string& text : {said.out, said.err}) {
      EXPECT_EQ(io::printable_lines(text), text);
      for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        EXPECT_LE(end - begin, 4000U) << text.substr(begin, 200);
        begin = end + 1;
      }
    }
    EXPECT_LT(said.err.size(), 4000U);
  }
}

TEST(BadOutput, AReaderThatIsGoneIsSaid) {
  const Folder folder;
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  const std::string to = "/proc/self/fd/" + std::to_string(ends[1]);
  expect_refused(command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", to}),
                 {"cannot be written: Broken pipe"});
  close(ends[1]);
}

/// Every option that is a number or a word says what it got, what it expects and where help is.
TEST(BadOption, SaysGotExpectedAndWhereHelpIs) {
  const struct {
    std::vector<std::string> words;
    std::string part;
  } cases[] = {
      {{"compare", "m.toml", "--laps", "0.1"}, "--laps: got \"0.1\", expected a number from 0.25 to 1000"},
      {{"compare", "m.toml", "--laps", "nan"}, "--laps: got \"nan\", expected a number"},
      {{"compare", "m.toml", "--laps", "2 laps"}, "--laps: got \"2 laps\", expected a number"},
      {{"compare", "m.toml", "--trials", "2.5"},
       "--trials: got \"2.5\", expected a whole number from 1 to 100000"},
      {{"compare", "m.toml", "--threads", "-1"},
       "--threads: got \"-1\", expected a whole number from 0 to 4096"},
      {{"compare", "m.toml", "--observer", "kalmann"},
       "--observer: got \"kalmann\", expected one of disturbance and kalman, did you mean kalman"},
      {{"compare", "m.toml", "--path"}, "--path: got nothing, expected a value"},
      {{"compare", "m.toml", "--trials", "1", "--trials", "2"}, "--trials: given more than once"},
      {{"compare", "m.toml", "--trails", "3"}, "unknown option \"--trails\", did you mean --trials"},
      {{"compare", "m.toml", "n.toml"}, "got \"n.toml\", expected no further argument"},
      {{"compare", "m.toml", "--experiment", "x"}, "--experiment: got \"x\", expected one of uni-sim"},
      {{"simulate", "m.toml", "-o", "t.csv", "--trial", "-1"},
       "--trial: got \"-1\", expected a whole number from 0"},
      {{"excite", "m.toml", "--method", "sine", "--axis", "x", "-o", "r.csv", "--periods", "0"},
       "--periods: got \"0\", expected a whole number from 1 to 1000"},
      {{"identify", "l.csv", "--terms", "7"}, "--terms: got \"7\", expected a whole number from 0 to 6"},
      {{"export", "x.toml", "-o", "x.hal", "--to", "linux"}, "--to: got \"linux\", expected "},
      {{"tune", "m.toml", "--evaluations", "1e9"},
       "--evaluations: got \"1e9\", expected a whole number from 10 to 100000"},
  };
  for (const auto& c : cases)
    expect_refused(command(c.words), {c.part, "(stribeck " + c.words.front() + " --help lists the options)"});
}

}  // namespace
}  // namespace stribeck::test::bad_input_test
