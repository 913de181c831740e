/// The whole board with entries of others: good ones, and ones that fail in every way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/board/board_parts.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/board/board.hpp>
#include <stribeck/workflow/board/machines.hpp>

namespace stribeck::test::board_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace workflow;

const std::string kExamples = std::string(STRIBECK_SOURCE_DIR) + "/examples/board/";

/// A controller in Python in which `answer` gives the line for the numbers of a period, `n` being its number. Its level is the friction
/// that it is told at −0.9 mm/s.
std::string controller(const std::string& answer) {
  return "import sys, time, os\n"
         "for line in sys.stdin:\n"
         "  if line == 'start\\n': break\n"
         "  if line.startswith('axis 0'): known = line.split(); mass = float(known[3])\n"
         "  if line.startswith('friction 0'): level = abs(float(line.split()[32]))\n"
         "print('ready', flush=True)\n"
         "last = None\n"
         "def pd(k, t):\n"
         "  global last\n"
         "  out = []\n"
         "  for i in range(2):\n"
         "    r, v, a, x = t[4*i+1:4*i+5]\n"
         "    e = x - r\n"
         "    d = (e - last[i]) / 0.005 if last else 0.0\n"
         "    sign = (v > 0) - (v < 0)\n"
         "    out.append((mass * (a - 80.0 * d - 1600.0 * e) + k * level * sign, e))\n"
         "  last = [e for _, e in out]\n"
         "  return '%r %r' % tuple(f for f, _ in out)\n"
         "for n, line in enumerate(sys.stdin):\n"
         "  if line == 'end\\n': break\n"
         "  t = [float(w) for w in line.split()]\n"
         "  print(" +
         answer + ", flush=True)\n";
}

BoardEntry program(const Folder& f, const std::string& name, const std::string& text,
                   const std::string& option = "--controller") {
  BoardEntry e = entry_of(option, "python3 '" + f.write(name + ".py", text) + "'");
  EXPECT_EQ(e.name, name);
  return e;
}

/// One machine, the biaxial table; its own entries only where `only` names them.
BoardOptions one_machine(std::vector<BoardEntry> entries, std::vector<std::string> only = {}) {
  BoardOptions o;
  o.machines = 1;
  o.threads = 1;
  o.entries = std::move(entries);
  o.built_in = !only.empty();
  for (const BoardEntry& e : o.entries) only.push_back(e.name);
  o.only = std::move(only);
  o.answer_seconds = 2.0;
  o.host = {STRIBECK_PROGRAM, "board-host"};
  return o;
}

std::string children_of_this_process() {
  std::string all;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    all += text_of(task.path().string() + "/children");
  return all;
}

const report::ControlRow& row_of(const report::BoardResult& r, const std::string& id) {
  const auto found = std::find_if(r.control.begin(), r.control.end(),
                                  [&](const report::ControlRow& row) { return row.entrant.id == id; });
  EXPECT_NE(found, r.control.end()) << id;
  return *found;
}

std::vector<std::string> order_of(const report::BoardResult& r) {
  std::vector<std::string> ids;
  for (const report::ControlRow& row : r.control) {
    if (row.motion == r.control.front().motion) ids.push_back(row.entrant.id);
  }
  return ids;
}

TEST(Board, GivesTheSameBytesOnAnyNumberOfThreads) {
  BoardOptions o;
  o.machines = 2;
  o.seed = 5;
  o.entries = {read_entry(kExamples + "coulomb-viscous.toml"), read_entry(kExamples + "lugre-observer.toml")};
  o.only = {"least-squares", "coulomb-viscous", "lugre-observer", "c", "h"};
  o.threads = 1;
  const std::string one = report::to_json(run_board(o)).dump();
  o.threads = 2;
  EXPECT_EQ(report::to_json(run_board(o)).dump(), one);
  EXPECT_THAT(one, HasSubstr("\"costs\":null"));
  const auto mass = [](std::uint64_t seed) {
    return board_machines(seed, 1)[0].machine.axes[0].second.plant.total_mass();
  };
  EXPECT_NE(mass(6), mass(5));
}

// Right, none, wrong: the sign of the friction alone decides the order. Three steps of 1 : 0 : −1 times the level.
TEST(Board, TheWrongSignOfFrictionComesLast) {
  const Folder f;
  const auto r = run_board(one_machine({program(f, "wrong", controller("pd(-1.0, t)")),
                                        program(f, "right", controller("pd(1.0, t)")),
                                        program(f, "without", controller("pd(0.0, t)"))}));
  EXPECT_THAT(order_of(r), ElementsAre("right", "without", "wrong"));
  EXPECT_EQ(row_of(r, "right").lost + row_of(r, "right").failed(), 0U);
}

TEST(Board, AControllerThatFailsIsARowWithItsReason) {
  const Folder f;
  // As an entry file may name it; at the command it is refused before anything runs.
  BoardEntry missing = entry_of("--controller", "python3 no-such-program");
  missing.command = missing.name = "no-such-program";
  EXPECT_THAT([] { entry_of("--controller", "no-such-program x"); },
              ::testing::ThrowsMessage<io::InputError>(HasSubstr("\"no-such-program\": no such program")));
  BoardOptions o = one_machine(
      {program(f, "crash", controller("pd(1.0, t) if n < 9 else os.abort()")),
       program(f, "hang", controller("pd(1.0, t) if n < 9 else time.sleep(60)")),
       program(f, "nan", controller("'nan 0'")), program(f, "words", controller("'as much as you like'")),
       program(f, "quits", controller("pd(1.0, t) if n < 9 else sys.exit(3)")),
       program(f, "closes", controller("os.close(1) or os.close(0) or time.sleep(60)")),
       program(f, "mute", "import time\ntime.sleep(60)\n"), program(f, "huge", controller("'1e300 -1e300'")),
       missing, program(f, "sound", controller("pd(1.0, t)"))});
  o.answer_seconds = 2.0;  // Python may need a second to begin
  const auto r = run_board(o);
  const auto reason = [&](const char* id) { return row_of(r, id).failures.front(); };
  EXPECT_THAT(reason("crash"), HasSubstr("was ended by signal 6"));
  EXPECT_THAT(reason("hang"), HasSubstr("did not answer within 2 s"));
  EXPECT_THAT(reason("nan"), HasSubstr("answered \"nan 0\" in period 0, expected two finite numbers"));
  EXPECT_THAT(reason("words"), HasSubstr("answered \"as much as you like\""));
  EXPECT_THAT(reason("quits"), HasSubstr("ended with exit code 3"));
  EXPECT_THAT(reason("closes"), HasSubstr("closed its output"));
  EXPECT_THAT(reason("mute"), HasSubstr("did not answer within 8 s"));
  EXPECT_THAT(reason("no-such-program"), HasSubstr("cannot be run"));
  // Beyond the limit it is cut: the axis runs away, which is a lost path and no failure.
  EXPECT_EQ(reason("huge"), "");
  EXPECT_EQ(row_of(r, "huge").lost, 1U);
  EXPECT_EQ(reason("sound"), "");
  EXPECT_EQ(order_of(r).front(), "sound");
  EXPECT_TRUE(std::isinf(row_of(r, "hang").max_error.median.value));
  EXPECT_EQ(children_of_this_process(), "");
  // In the tables as well.
  EXPECT_THAT(report::text_table(r), HasSubstr("hang *"));
  EXPECT_THAT(report::failures_in_words(r), testing::Contains(HasSubstr("crash on the circle")));
  const auto json = report::to_json(r);
  EXPECT_EQ(json["control"].size(), 20U);
  EXPECT_EQ(json.dump().find("nan,"), std::string::npos);
}

TEST(Board, ASharedObjectRunsInAProcessOfItsOwn) {
  std::vector<BoardEntry> entries;
  for (const char* file :
       {STRIBECK_BOARD_PID, STRIBECK_BOARD_CRASH, STRIBECK_BOARD_REFUSE, STRIBECK_BOARD_OLD})
    entries.push_back(entry_of("--controller", file));
  entries[0].name = "linuxcnc-pid";
  BoardOptions o = one_machine(entries, {"a"});
  o.cost = true;
  const auto r = run_board(o);
  const report::ControlRow& pid = row_of(r, "linuxcnc-pid");
  EXPECT_EQ(pid.lost + pid.failed(), 0U);
  // Its integral takes most of the Coulomb friction, which controller (a) leaves alone.
  EXPECT_LT(pid.rms.median.value, row_of(r, "a").rms.median.value);
  const auto reason = [&](std::size_t i) { return row_of(r, entries[i].name).failures.front(); };
  EXPECT_THAT(reason(1), HasSubstr("was ended by signal 11"));
  EXPECT_THAT(reason(2), HasSubstr("refuses the setup"));
  EXPECT_THAT(reason(3), HasSubstr("was compiled for version 2 of stribeck/board.h, expected 1"));
  ASSERT_EQ(r.costs.size(), 5U);
  for (const report::BoardCost& cost : r.costs) {
    EXPECT_FALSE(cost.over_a_pipe) << cost.id;
    if (cost.id == "linuxcnc-pid") {
      EXPECT_GT(cost.seconds, 0.0);
    }
  }
}

/// A folder of answers: the truth of each axis, its friction and mass times a factor.
void write_truth(const Folder& f, const BoardMachine& m, double factor) {
  for (const auto& [name, axis] : m.machine.axes) {
    sim::AxisFile file;
    file.model.mass = factor * axis.plant.total_mass();
    file.model.friction = axis.plant.friction;
    file.model.delay = m.machine.sample_time * axis.plant.delay_periods;
    std::visit([&](auto& map) { map = map.scaled(factor); }, file.model.friction.steady);
    f.write(m.name + "-" + name + ".toml", io::write_toml(file, "the truth"));
  }
}

TEST(Board, ThePerfectAnswerHasNoErrorAndComesFirst) {
  const Folder truth;
  const Folder double_truth;
  const Folder nothing;
  const auto machines = board_machines(1, 1);
  write_truth(truth, machines[0], 1.0);
  write_truth(double_truth, machines[0], 2.0);
  std::vector<BoardEntry> entries;
  for (const auto& [folder, name] :
       {std::pair(&double_truth, "double"), std::pair(&truth, "truth"), std::pair(&nothing, "nothing")}) {
    entries.push_back(entry_of("--answers", *folder / "."));
    entries.back().name = name;
  }
  const auto r = run_board(one_machine(entries, {"auto"}));
  ASSERT_EQ(r.identification.size(), 4U);
  const auto& best = r.identification[0];
  EXPECT_EQ(best.entrant.id, "truth");
  // Both files hold the same numbers to the last digit.
  EXPECT_EQ(best.curve_error.median.value, 0.0);
  EXPECT_EQ(best.mass_error.median.value, 0.0);
  // Force noise of 20 N beside 1300 N, and the encoder, are all that the truth does not tell.
  EXPECT_LT(best.held_out_error.median.value, 3.0);
  EXPECT_TRUE(std::isnan(best.covered.value));
  EXPECT_EQ(r.identification[1].entrant.id, "auto");
  EXPECT_GT(r.identification[1].covered.value, 0.0);
  const auto& twice = r.identification[2];
  EXPECT_EQ(twice.entrant.id, "double");
  EXPECT_NEAR(twice.mass_error.median.value, 100.0, 1e-9);
  const auto& missing = r.identification[3];
  EXPECT_EQ(missing.failed(), 2U);
  EXPECT_THAT(missing.failures.front(), HasSubstr("no answer: there is no biaxial-table-1-x.toml"));
}

TEST(Board, AnIdentifierThatFailsIsARowWithItsReason) {
  const Folder f;
  const auto identifier = [&](const char* name, const std::string& text) {
    return program(f, name, "import sys, time\nout = sys.argv[1]\n" + text + "\n", "--identifier");
  };
  const std::string axis_file =
      "open(out, 'w').write('mass = \"1 kg\"\\n[friction.steady]\\nkind = \"conventional\"\\n"
      "alpha0 = \"%s\"\\nalpha2 = \"0 N s/m\"\\n')";
  const auto with_level = [&](std::string level) {
    std::string text = axis_file;
    return text.replace(text.find("%s"), 2, level);
  };
  BoardOptions o = one_machine(
      {identifier("hangs", "time.sleep(60)"), identifier("raises", "raise ValueError('no fit')"),
       identifier("silent", ""), identifier("garbage", "open(out, 'w').write('x = = 1')"),
       identifier("negative", with_level("-5 N")), identifier("not-finite", with_level("nan N")),
       identifier("bad-json",
                  with_level("5 N") + "\nopen(out[:-4] + 'json', 'w').write('{\"mass_ci95_kg\": [2, 1]}')"),
       identifier("sound", with_level("5 N"))});
  o.identifier_seconds = 5.0;  // Python may need a second to begin
  const auto r = run_board(o);
  const auto reason = [&](const std::string& id) {
    for (const auto& row : r.identification) {
      if (row.entrant.id == id) return row.failures.front();
    }
    return std::string("no row");
  };
  EXPECT_THAT(reason("hangs"), HasSubstr("did not end within 5 s"));
  EXPECT_THAT(reason("raises"), HasSubstr("ended with exit code 1; it says: ValueError: no fit"));
  EXPECT_THAT(reason("silent"), HasSubstr("no answer"));
  EXPECT_THAT(reason("garbage"), HasSubstr("biaxial-table-1-x-garbage.toml"));
  EXPECT_THAT(reason("negative"), HasSubstr("alpha0"));
  EXPECT_THAT(reason("not-finite"), HasSubstr("alpha0"));
  EXPECT_THAT(reason("bad-json"), HasSubstr("expected the lower end first"));
  EXPECT_EQ(reason("sound"), "");
  EXPECT_EQ(children_of_this_process(), "");
}

TEST(Board, TheExamplesRun) {
  std::vector<BoardEntry> entries;
  for (const char* name : {"coulomb-viscous", "stribeck-curve", "lugre-observer"})
    entries.push_back(read_entry(kExamples + name + ".toml"));
  const auto r = run_board(one_machine(entries, {"a"}));
  for (const auto& row : r.identification) {
    EXPECT_EQ(row.failed(), 0U) << row.entrant.id << ": " << row.failures.front();
    // Coulomb and viscous friction cannot follow the Gaussians of the table, whose height is a third of it.
    EXPECT_LT(row.curve_error.median.value, 25.0) << row.entrant.id;
    EXPECT_LT(row.mass_error.median.value, 15.0) << row.entrant.id;
  }
  const report::ControlRow& lugre = row_of(r, "lugre-observer");
  EXPECT_EQ(lugre.lost + lugre.failed(), 0U);
  EXPECT_LT(lugre.max_error.median.value, 0.7 * row_of(r, "a").max_error.median.value);
}

TEST(Board, LogsForAnswersAreThoseThatTheBoardScores) {
  const Folder f;
  const auto names = write_board_logs(f / "logs", 1, 1, 1);
  ASSERT_EQ(names.size(), 4U);
  BoardOptions o = one_machine({read_entry(kExamples + "coulomb-viscous.toml")});
  o.folder = f / "kept";
  static_cast<void>(run_board(o));
  for (const std::string& name : names) {
    const std::string file = std::filesystem::path(name).filename().string();
    EXPECT_EQ(text_of(name), text_of(f / "kept/" + file)) << file;
  }
  EXPECT_TRUE(std::filesystem::exists(f / "kept/biaxial-table-1-x-coulomb-viscous.toml"));
}

TEST(Board, RefusesEntriesThatMeanNothing) {
  const Folder f;
  const auto refused = [&](const std::string& text, const char* part) {
    try {
      static_cast<void>(run_board(one_machine({read_entry(f.write("e.toml", text))})));
      ADD_FAILURE() << text;
    } catch (const io::InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(part));
    }
  };
  const std::string head = "label = \"one\"\ntrack = \"control\"\n";
  refused(head + "name = \"mine\"\n", "expected one of command, shared_object, controller and answers");
  refused(head + "name = \"mine\"\ncommand = \"a\"\nanswers = \"b\"\n", "expected one of command");
  refused(head + "name = \"mine\"\nanswers = \"b\"\n", "belongs to track = \"identification\"");
  refused(head + "name = \"a name\"\ncommand = \"a\"\n", "letters, digits and hyphens");
  refused(head + "name = \"h\"\ncommand = \"a\"\n", "is the name of an entry that is built in");
  refused(head + "name = \"mine\"\ncommand = \"'a\"\n", "a quote is not closed");
  refused(head + "name = \"mine\"\nshared_object = \"none.so\"\n", "there is no file");
  BoardOptions twice =
      one_machine({entry_of("--controller", "python3 mine.py"), entry_of("--controller", "python3 mine.py")});
  EXPECT_THROW(static_cast<void>(run_board(twice)), io::InputError);
  BoardOptions unknown = one_machine({entry_of("--controller", "python3 mine.py")}, {"auti"});
  try {
    static_cast<void>(run_board(unknown));
    ADD_FAILURE();
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean auto?"));
  }
}

TEST(BoardPage, ShowsEveryEntry) {
  const auto r =
      run_board(one_machine({read_entry(kExamples + "coulomb-viscous.toml")}, {"least-squares", "a", "c"}));
  const std::string page = report::board_report({r, "stribeck bench", "0"});
  for (const char* text : {"coulomb-viscous *", "least-squares", "no friction compensation", "textbook"})
    EXPECT_THAT(page, HasSubstr(text));
}

}  // namespace
}  // namespace stribeck::test::board_test
