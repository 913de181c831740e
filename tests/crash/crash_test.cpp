// The program is killed, or the disk is full, at every single call that changes a file (shim.c): each file is the earlier one or the
// new one, whole, and nothing is left lying about.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <sstream>
#include <stribeck/io/test_folder.hpp>
#include <string>
#include <vector>

extern char** environ;

namespace stribeck::test::crash_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using Texts = std::map<std::string, std::string>;

/// Status of waitpid; what it prints is in `said`.
int run(const Folder& f, std::vector<std::string> words, std::vector<std::string> settings = {}) {
  words.insert(words.begin(), STRIBECK_PROGRAM);
  std::vector<char*> argv;
  for (auto& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  const std::string said = f / "said";
  std::fflush(stdout);  // what is in the buffer is not the child's
  const pid_t child = fork();
  if (child == 0) {
    if (!settings.empty()) setenv("LD_PRELOAD", STRIBECK_SHIM, 1);
    for (const std::string& s : settings) {
      const auto at = s.find('=');
      setenv(s.substr(0, at).c_str(), s.substr(at + 1).c_str(), 1);
    }
    if (std::freopen(said.c_str(), "w", stdout) == nullptr || dup2(STDOUT_FILENO, STDERR_FILENO) < 0)
      _exit(99);
    execv(argv[0], argv.data());
    _exit(98);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

/// The next call to try: each of the first 14, then every 11th, because further files are written by the same calls over and over.
int next_call(int k) { return k + (k < 14 ? 1 : 11); }

/// Every file below a folder.
Texts texts_in(const std::string& folder) {
  Texts texts;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      texts[fs::relative(entry.path(), folder).string()] = text_of(entry.path().string());
  }
  return texts;
}

/// A verb and what it writes, all below "out".
struct Verb {
  std::string name;
  std::vector<std::string> words;
};

class Crash : public testing::Test {
 protected:
  void SetUp() override {
    machine_ = std::string(STRIBECK_SOURCE_DIR) + "/machines/uniaxial-drive.toml";
    ASSERT_EQ(run(f, {"excite", machine_, "--axis", "x", "--method", "sine", "-o", f / "ref.csv"}), 0)
        << text_of(f / "said");
    ASSERT_EQ(
        run(f, {"simulate", machine_, "--reference", f / "ref.csv", "--axis", "x", "-o", f / "all.csv"}), 0)
        << text_of(f / "said");
    thin(8);
    ASSERT_EQ(run(f, {"identify", f / "log.csv", "-o", f / "x.toml"}), 0) << text_of(f / "said");
    std::string circle = "t [s],x [mm],y [mm]\n";
    for (int k = 0; k < 400; ++k) {
      const double phi = 2.0 * M_PI * k / 400.0;
      circle += std::to_string(0.01 * k) + ',' + std::to_string(10.0 * std::cos(phi)) + ',' +
                std::to_string(10.01 * std::sin(phi)) + '\n';
    }
    static_cast<void>(f.write("circle.csv", circle));
  }

  /// log.csv: the head of all.csv and every n-th row. The verbs run some three hundred times, and the files are what counts.
  void thin(int n) const {
    std::istringstream all(text_of(f / "all.csv"));
    std::string log, line;
    for (int row = 0; std::getline(all, line);) {
      const bool head = line.starts_with('#') || line.starts_with("t [");
      if (head || row++ % n == 0) log += line + '\n';
    }
    static_cast<void>(f.write("log.csv", log));
  }

  [[nodiscard]] std::string out(const std::string& name) const { return f / ("out/" + name); }

  [[nodiscard]] std::vector<Verb> verbs() const {
    const std::string json = out("r.json");
    const std::string page = out("page");
    return {{"excite",
             {"excite", machine_, "--axis", "x", "--method", "jog", "-o", out("a.csv"), "--gcode",
              out("a.ngc"), "--json", json}},
            {"simulate",
             {"simulate", machine_, "--reference", f / "ref.csv", "--axis", "x", "-o", out("a.csv"), "--json",
              json, "--report", page}},
            {"identify", {"identify", f / "log.csv", "-o", out("a.toml"), "--json", json, "--report", page}},
            {"evaluate", {"evaluate", f / "circle.csv", "--json", json, "--report", page}},
            {"verify", {"verify", f / "x.toml", f / "log.csv", "--json", json, "--report", page}},
            {"export",
             {"export", machine_, "--to", "linuxcnc", "--parameters", "commissioning", "-o", out("c"),
              "--json", json}},
            {"reference", {"reference", "-o", f / "out"}}};
  }

  /// The state before: what an earlier run of the verb left, with every file changed except those that export would refuse.
  Texts set_up(const Verb& verb) const {
    fs::remove_all(f / "out");
    fs::create_directories(f / "out/page");
    std::vector<std::string> words = verb.words;
    if (verb.name == "export") words.insert(words.end(), {"--omega", "20 rad/s"});
    EXPECT_EQ(run(f, words), 0) << verb.name << ": " << text_of(f / "said");
    if (verb.name != "export") {
      for (const auto& [name, unused] : texts_in(f / "out"))
        static_cast<void>(f.write("out/" + name, "earlier " + name));
    }
    return texts_in(f / "out");
  }

  /// The same again, without a run.
  void restore(const Texts& earlier) const {
    fs::remove_all(f / "out");
    fs::create_directories(f / "out/page");
    for (const auto& [name, text] : earlier) {
      fs::create_directories(fs::path(out(name)).parent_path());
      static_cast<void>(f.write("out/" + name, text));
    }
  }

  /// What a whole run makes of it.
  Texts after(const Verb& verb) const {
    EXPECT_EQ(run(f, verb.words), 0) << verb.name << ": " << text_of(f / "said");
    return texts_in(f / "out");
  }

  void kill_everywhere(const Verb& verb, bool named) const;

  Folder f;
  std::string machine_;
};

void Crash::kill_everywhere(const Verb& verb, bool named) const {
  const Texts earlier = set_up(verb);
  const Texts whole = after(verb);
  ASSERT_GE(whole.size(), 2U) << verb.name;
  for (int k = 1;; k = next_call(k)) {
    ASSERT_LT(k, 1000);
    restore(earlier);
    std::vector<std::string> settings{"STRIBECK_TEST_KILL=" + std::to_string(k)};
    if (named) settings.emplace_back("STRIBECK_TEST_NAMED=1");
    const int status = run(f, verb.words, settings);
    if (WIFEXITED(status)) {
      EXPECT_EQ(WEXITSTATUS(status), 0);
      EXPECT_GT(k, 5) << verb.name << " was never killed";
      break;
    }
    ASSERT_EQ(WTERMSIG(status), SIGKILL);
    std::size_t left = 0;
    for (const auto& [name, text] : texts_in(f / "out")) {
      if (fs::path(name).filename().string().starts_with(".stribeck-")) {
        ++left;
        continue;
      }
      ASSERT_TRUE(earlier.contains(name)) << verb.name << " at call " << k << ": " << name;
      EXPECT_TRUE(text == earlier.at(name) || text == whole.at(name))
          << verb.name << " at call " << k << ": " << name << " is neither the earlier nor the new one";
    }
    // A file without a name has one for two calls only.
    if (!named) {
      EXPECT_LE(left, 1U) << verb.name << " at call " << k;
    }
    // The next run mends what there is, and clears away.
    EXPECT_EQ(after(verb), whole) << verb.name << " after call " << k;
  }
}

TEST_F(Crash, KilledAnywhereLeavesEarlierOrNewFiles) {
  for (const Verb& verb : verbs()) {
    SCOPED_TRACE(verb.name);
    kill_everywhere(verb, false);
  }
}

TEST_F(Crash, WhereEveryFileHasAName) {
  const auto all = verbs();
  kill_everywhere(all[0], true);
  const auto folder = std::find_if(all.begin(), all.end(), [](const Verb& v) { return v.name == "export"; });
  kill_everywhere(*folder, true);
}

TEST_F(Crash, AFullDiskLeavesWhatWasThere) {
  for (const Verb& verb : verbs()) {
    const Texts earlier = set_up(verb);
    for (int k = 1;; k = next_call(k)) {
      const int status = run(f, verb.words, {"STRIBECK_TEST_FULL=" + std::to_string(k)});
      ASSERT_TRUE(WIFEXITED(status));
      const Texts now = texts_in(f / "out");
      // The names are given when all is on the disk: all are new then.
      if (WEXITSTATUS(status) == 0 || now != earlier) {
        EXPECT_EQ(now, after(verb)) << verb.name << " at call " << k;
        EXPECT_GT(k, 3) << verb.name;
        break;
      }
      EXPECT_EQ(WEXITSTATUS(status), 2) << verb.name << " at call " << k;
      EXPECT_THAT(text_of(f / "said"), HasSubstr("No space left")) << verb.name << " at call " << k;
    }
  }
}

// Several at once on the same files: one of them wins, whole.
TEST_F(Crash, SeveralAtOnceLeaveOneWholeFile) {
  const Verb verb = verbs()[0];
  static_cast<void>(set_up(verb));
  const Texts whole = after(verb);
  std::vector<pid_t> children;
  for (int i = 0; i < 8; ++i) {
    const pid_t child = fork();
    if (child == 0)
      _exit(
          WEXITSTATUS(run(f, verb.words, {i % 2 == 0 ? "STRIBECK_TEST_NAMED=1" : "STRIBECK_TEST_NAMED=0"})));
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0) << text_of(f / "said");
  }
  EXPECT_EQ(texts_in(f / "out"), whole);
}

// Random moments of the verbs that compute for seconds.
TEST_F(Crash, KilledAtRandomMomentsOfTheLongVerbs) {
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  const std::string biaxial = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  const std::vector<Verb> longer{
      {"compare",
       {"compare", biaxial, "--speed", "9.5 mm/s", "--trials", "1", "--controller", "contouring",
        "--parameters", "thesis", "--json", out("r.json"), "--report", out("page")}},
      {"tune",
       {"tune", biaxial, "--controller", "contouring", "--parameters", "thesis", "--trials", "1",
        "--evaluations", "10", "-o", out("tuned.toml"), "--json", out("r.json"), "--report", out("page")}},
      {"reproduce",
       {"reproduce", "uni-sim", "--trials", "1", "--json", out("r.json"), "--report", out("page"),
        "--markdown", out("r.md")}}};
  for (const Verb& verb : longer) {
    const Texts earlier = set_up(verb);
    const Texts whole = after(verb);
    for (int i = 0; i < 6; ++i) {
      restore(earlier);
      const int k = 1 + static_cast<int>(random() % 16);
      static_cast<void>(run(f, verb.words, {"STRIBECK_TEST_KILL=" + std::to_string(k)}));
      for (const auto& [name, text] : texts_in(f / "out")) {
        if (fs::path(name).filename().string().starts_with(".stribeck-")) continue;
        EXPECT_TRUE(text == earlier.at(name) || text == whole.at(name))
            << verb.name << ", seed " << kSeed << ", call " << k << ": " << name;
      }
    }
  }
}

/// A study that is stopped goes on: with the same bytes as one that was not.
class StoppedStudy : public testing::Test {
 protected:
  void SetUp() override {
    file_ = f.write("study.toml", "machine = \"" + std::string(STRIBECK_SOURCE_DIR) +
                                      "/machines/uniaxial-drive.toml\"\n"
                                      "controllers = [\"a\", \"pid\"]\nparameters = \"thesis\"\n"
                                      "sampling = \"sobol\"\nsamples = 64\nindices = true\n"
                                      "[[factors]]\nkey = \"x.friction\"\n"
                                      "scale = { kind = \"uniform\", low = 0.7, high = 1.3 }\n"
                                      "[[factors]]\nkey = \"x.mass\"\n"
                                      "scale = { kind = \"normal\", mean = 1.0, sd = 0.05 }\n");
    fs::create_directories(f / "whole");
    ASSERT_EQ(run(f, words("whole", 1)), 0) << text_of(f / "said");
    whole_ = results("whole");
    ASSERT_EQ(whole_.size(), 4U);
    fs::create_directories(f / "out");
  }
  [[nodiscard]] std::vector<std::string> words(const std::string& folder, int threads) const {
    return {"study",     file_,
            "-o",        f / folder,
            "--json",    f / (folder + "/s.json"),
            "--report",  f / (folder + "/page"),
            "--threads", std::to_string(threads)};
  }
  /// All files, page and JSON without the line that tells the command.
  [[nodiscard]] Texts results(const std::string& folder) const {
    Texts texts = texts_in(f / folder);
    for (auto& [name, text] : texts) {
      const auto at = text.find("stribeck study ");
      if ((name.ends_with(".html") || name.ends_with(".json")) && at != std::string::npos)
        text.erase(at, text.find('\n', at) - at);
    }
    return texts;
  }
  Folder f;
  std::string file_;
  Texts whole_;
};

TEST_F(StoppedStudy, GoesOnAfterFiftyKills) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  int kills = 0;
  for (int round = 0; kills < 50; ++round) {
    ASSERT_LT(round, 50);
    fs::remove_all(f / "out");
    fs::create_directories(f / "out");
    for (;;) {
      // A study writes some three times for each of its 256 runs.
      const int k = 1 + static_cast<int>(random() % 120);
      const int status = run(f, words("out", 1 + static_cast<int>(random() % 2)),
                             {"STRIBECK_TEST_KILL=" + std::to_string(k), "STRIBECK_TEST_PIECE=150"});
      if (WIFEXITED(status)) {
        ASSERT_EQ(WEXITSTATUS(status), 0) << text_of(f / "said");
        break;
      }
      ASSERT_EQ(WTERMSIG(status), SIGKILL);
      ++kills;
    }
    EXPECT_EQ(results("out"), whole_) << "seed " << kSeed << ", after kill " << kills;
  }
}

// At any instant, not at a call.
TEST_F(StoppedStudy, GoesOnAfterAKillFromOutside) {
  constexpr unsigned kSeed = 6;
  std::mt19937 random(kSeed);
  int kills = 0;
  for (bool done = false; !done;) {
    const pid_t child = fork();
    if (child == 0) {
      std::vector<std::string> all = words("out", 2);
      all.insert(all.begin(), STRIBECK_PROGRAM);
      std::vector<char*> argv;
      for (auto& w : all) argv.push_back(w.data());
      argv.push_back(nullptr);
      if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(99);
      execv(argv[0], argv.data());
      _exit(98);
    }
    // Longer each time: on a busy computer the first ones do not reach the first run.
    usleep(static_cast<useconds_t>(30000 + random() % (120000 + 20000 * static_cast<unsigned>(kills))));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    done = WIFEXITED(status);
    if (done) {
      ASSERT_EQ(WEXITSTATUS(status), 0);
    }
    ASSERT_LT(++kills, 200);
  }
  EXPECT_EQ(results("out"), whole_) << "seed " << kSeed << ", after kill " << kills;
}

TEST_F(StoppedStudy, GoesOnAfterAFullDisk) {
  for (const int k : {1, 2, 3, 4, 10, 100, 262, 264, 266}) {
    fs::remove_all(f / "out");
    fs::create_directories(f / "out");
    const int status = run(f, words("out", 2), {"STRIBECK_TEST_FULL=" + std::to_string(k)});
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 2) << k;
    EXPECT_THAT(text_of(f / "said"), HasSubstr("No space left")) << k;
    ASSERT_EQ(run(f, words("out", 2)), 0) << text_of(f / "said");
    EXPECT_EQ(results("out"), whole_) << k;
  }
}

/// A process of the program that is not waited for; its words are not kept.
pid_t started(std::vector<std::string> words) {
  words.insert(words.begin(), STRIBECK_PROGRAM);
  std::vector<char*> argv;
  for (auto& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  const int none = open("/dev/null", O_WRONLY);
  if (none < 0 || dup2(none, STDOUT_FILENO) < 0 || dup2(none, STDERR_FILENO) < 0) _exit(99);
  execv(argv[0], argv.data());
  _exit(98);
}

/// A study of 160 machines, as one process computes it.
std::string study_file(const Folder& f) {
  return f.write("study.toml",
                 "machine = \"" + std::string(STRIBECK_SOURCE_DIR) +
                     "/machines/biaxial-table.toml\"\ncontrollers = [\"f\"]\nfigures = [\"rms_um\"]\n"
                     "sampling = \"random\"\nsamples = 160\nseed = 3\n"
                     "[motion]\nsize = \"10 mm\"\nlaps = 1\nsettle_laps = 1\nspeeds = [\"9.5 mm/s\"]\n"
                     "[[factors]]\nkey = \"*.friction\"\n"
                     "scale = { kind = \"uniform\", low = 0.7, high = 1.3 }\n");
}

// Two of the three are killed, whether they lead or help; the third ends the study, and nothing of the sharing is left.
TEST(CrashOfAStudy, SharedByThreeOfWhichTwoAreKilled) {
  const Folder f;
  const std::string study = study_file(f);
  ASSERT_EQ(run(f, {"study", study, "-o", f / "alone", "--quiet"}), 0) << text_of(f / "said");
  const std::string whole = text_of(f / "alone/results.csv");
  std::vector<pid_t> processes;
  for (int k = 0; k < 3; ++k)
    processes.push_back(started({"study", study, "-o", f / "shared", "--shared", "--threads", "1"}));
  const auto rows = [&] {
    const std::string path = f / "shared/results.csv";
    return fs::exists(path) ? fs::file_size(path) : 0;
  };
  for (std::size_t k = 0; k < 2; ++k) {
    // Some rows further, or at the end, whatever the computer is doing.
    const std::uintmax_t goal = std::min<std::uintmax_t>(whole.size(), rows() + whole.size() / 5);
    for (int wait = 0; wait < 60000 && rows() < goal; ++wait) usleep(2000);
    EXPECT_GE(rows(), goal);
    kill(processes[k], SIGKILL);
    waitpid(processes[k], nullptr, 0);
  }
  int status = -1;
  waitpid(processes[2], &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(text_of(f / "shared/results.csv"), whole);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(f / "shared"))
    names.push_back(entry.path().filename().string());
  EXPECT_THAT(names, testing::UnorderedElementsAre("inputs.txt", "results.csv"));
}

TEST(CrashOfAStudy, UnderMpirunItIsTheSameBytes) {
  if (std::system("command -v mpirun > /dev/null") != 0) GTEST_SKIP() << "there is no mpirun here";
  const Folder f;
  const std::string study = study_file(f);
  ASSERT_EQ(run(f, {"study", study, "-o", f / "alone", "--quiet"}), 0) << text_of(f / "said");
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  // Several times: they end in another order each time, and the folders of the outputs are made by one of them.
  for (int k = 0; k < 4; ++k) {
    const std::string folder = f / ("shared-" + std::to_string(k));
    const std::string command = "mpirun --oversubscribe -n 3 '" + std::string(STRIBECK_PROGRAM) +
                                "' study '" + study + "' -o '" + folder + "' --report '" + folder +
                                "-page' --json '" + folder + "-page/x.json' --plots '" + folder +
                                "-plots' > '" + f / "said" + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << text_of(f / "said");
    EXPECT_EQ(text_of(folder + "/results.csv"), text_of(f / "alone/results.csv"));
    EXPECT_THAT(text_of(f / "said"), HasSubstr("160 machines"));
    EXPECT_TRUE(fs::exists(folder + "-page/index.html"));
    EXPECT_TRUE(fs::exists(folder + "-page/x.json"));
    EXPECT_TRUE(fs::exists(folder + "-plots"));
  }
}

// It ended with an exception that nobody caught.
TEST(Messages, ThatNobodyCanReadDoNotChangeTheExitCode) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const int status = std::system("'" STRIBECK_PROGRAM "' machine no-such-file.toml 2>/dev/full");
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

}  // namespace
}  // namespace stribeck::test::crash_test
