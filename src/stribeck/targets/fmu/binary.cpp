#include <fcntl.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/process/child_process.hpp>
#include <stribeck/targets/fmu/binary.hpp>

namespace stribeck::targets {

namespace {

constexpr double kMostProcessorSeconds = 60.0;

/// A new folder for the compiler, removed at the end.
class CompilerFolder {
 public:
  CompilerFolder() {
    std::error_code failed;
    std::string name = (std::filesystem::temp_directory_path(failed) / "stribeck-fmu-XXXXXX").string();
    if (!failed && ::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~CompilerFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  CompilerFolder(const CompilerFolder&) = delete;
  CompilerFolder& operator=(const CompilerFolder&) = delete;

  [[nodiscard]] bool exists() const noexcept { return !path_.empty(); }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

std::string platform_here() {
  utsname here{};
  if (::uname(&here) != 0) return "unknown";
  const std::string machine = here.machine;
  const bool x86 = machine.size() == 4 && machine[0] == 'i' && machine.ends_with("86");
  return (x86 ? "x86" : machine) + "-linux";
}

/// An open file for the compiler's messages.
class Messages {
 public:
  explicit Messages(const std::string& path)
      : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR)) {}
  ~Messages() {
    if (file_ >= 0) ::close(file_);
  }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  [[nodiscard]] int file() const noexcept { return file_; }

 private:
  int file_;
};

}  // namespace

FmuBinary fmu_binary(const std::string& identifier, const std::vector<ZipFile>& sources) {
  FmuBinary out;
  out.platform = platform_here();
  const CompilerFolder folder;
  if (!folder.exists()) {
    out.why_not = "there is no folder for temporary files";
    return out;
  }
  const char* const chosen = std::getenv("CC");
  const bool has_one =
      chosen != nullptr && std::string_view(chosen).find_first_not_of(" \t") != std::string_view::npos;
  const std::string compiler = has_one ? chosen : "cc";
  const std::string library = folder / (identifier + ".so");
  // No fused multiplication: the force is that of the library to the last digits on every processor.
  std::vector<std::string> words;
  // CC may be "ccache cc".
  std::istringstream parts(compiler);
  for (std::string part; parts >> part;) words.push_back(part);
  for (const char* word :
       {"-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-s", "-fvisibility=hidden", "-o"})
    words.emplace_back(word);
  words.push_back(library);
  for (const auto& [name, text] : sources) {
    // At once: write_atomically() waits for the end of the command.
    std::ofstream(folder / name, std::ios::binary) << text;
    if (name.ends_with(".c")) words.push_back(folder / name);
  }
  words.emplace_back("-lm");
  const Messages messages(folder / "messages");
  if (messages.file() < 0) {
    out.why_not = "the folder for temporary files cannot be written";
    return out;
  }
  io::ChildProcess child(words, {messages.file(), messages.file()}, kMostProcessorSeconds);
  constexpr std::size_t kLongest = 200;
  if (child.error() != 0) {
    out.why_not = fmt::format("the C compiler {} cannot be run: {}", io::in_quotes(compiler),
                              std::strerror(child.error()));
  } else if (const int status = child.wait(); status != 0) {
    const std::string said = io::one_line(io::read_text(folder / "messages"), kLongest);
    out.why_not = said.empty()
                      ? fmt::format("the C compiler {} ended with code {} and no message",
                                    io::in_quotes(compiler), WIFEXITED(status) ? WEXITSTATUS(status) : -1)
                      : fmt::format("the C compiler {} says: {}", io::in_quotes(compiler), said);
  } else {
    out.bytes = io::read_text(library);
  }
  return out;
}

}  // namespace stribeck::targets
