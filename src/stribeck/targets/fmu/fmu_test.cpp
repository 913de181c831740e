#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <regex>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/targets/target.hpp>
#include <string>

namespace stribeck::test::fmu_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kStatic =
    "mass = \"800 kg\"\nload = \"30 N\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0.5 N s/mm\"\n"
    "stribeck = { alpha1 = \"100 N\", v0 = \"5 mm/s\", delta = 1.3 }\n"
    "[[friction.eccentric]]\namplitude = \"7 N\"\nperiod = \"5 mm\"\nphase = \"0.4 rad\"\nform = \"proportional\"\n"
    "[[friction.eccentric]]\namplitude = \"3 N\"\nperiod = \"1.1 mm\"\nphase = \"-1 rad\"\n";
constexpr const char* kLuGre =
    "mass = \"500 kg\"\n[friction.steady]\nkind = \"gaussian\"\nvelocity_range = [\"-40 mm/s\", \"50 mm/s\"]\n"
    "positive = { eta0 = \"80 N\", eta1 = \"0.3 N s/mm\", gaussians = [{ a = \"20 N\", b = \"1 mm/s\", c = \"4 mm/s\" }, "
    "{ a = \"9 N\", b = \"20 mm/s\", c = \"9 mm/s\" }] }\n"
    "negative = { eta0 = \"-90 N\", eta1 = \"0.4 N s/mm\", gaussians = [{ a = \"-15 N\", b = \"-2 mm/s\", c = \"5 mm/s\" }] }\n"
    "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"9000 N/mm\"\nsigma1 = \"20 N s/mm\"\ndamping_velocity = \"2 mm/s\"\n";
constexpr const char* kGms =
    "mass = \"500 kg\"\n[friction]\n"
    "steady = { kind = \"conventional\", alpha0 = \"60 N\", alpha2 = \"0.5 N s/mm\", stribeck = { alpha1 = \"100 N\", v0 = \"5 mm/s\" } }\n"
    "dynamics = { kind = \"gms\", attraction = \"4000 N/s\", damping = \"3 N s/mm\", elements = [{ stiffness = \"9000 N/mm\", share = 0.3 }, "
    "{ stiffness = \"2000 N/mm\", share = 0.3 }, { stiffness = \"700 N/mm\", share = 0.4 }] }\n"
    "spring = { stiffness = \"2 N/mm\", zero_at = \"1 mm\", from = \"-1 mm\", to = \"3 mm\" }\n";

/// Files of a zip archive by name: read by the directory at its end, as an importer does.
std::map<std::string, std::string> unzipped(const std::string& bytes) {
  const auto number = [&](std::size_t at, int size) {
    std::size_t n = 0;
    for (int i = size - 1; i >= 0; --i) n = n << 8 | static_cast<unsigned char>(bytes.at(at + i));
    return n;
  };
  std::map<std::string, std::string> files;
  const std::size_t end = bytes.size() - 22;
  std::size_t at = number(end + 16, 4);
  for (std::size_t k = 0; k < number(end + 10, 2); ++k) {
    EXPECT_EQ(bytes.substr(at, 4), "PK\x01\x02");
    const std::size_t local = number(at + 42, 4);
    EXPECT_EQ(bytes.substr(local, 4), "PK\x03\x04");
    std::string out(number(at + 24, 4), '\0');
    const std::size_t packed = number(at + 20, 4);
    std::string data = bytes.substr(local + 30 + number(local + 26, 2) + number(local + 28, 2), packed);
    z_stream z{};
    inflateInit2(&z, -15);
    z.next_in = reinterpret_cast<Bytef*>(data.data());
    z.avail_in = static_cast<uInt>(data.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END);
    inflateEnd(&z);
    EXPECT_EQ(crc32(0, reinterpret_cast<const Bytef*>(out.data()), static_cast<uInt>(out.size())),
              number(at + 16, 4));
    files[bytes.substr(at + 46, number(at + 28, 2))] = out;
    at += 46 + number(at + 28, 2);
  }
  return files;
}

/// An instance of an FMU, compiled from its sources by the system's C compiler and driven through the functions of FMI 3.0.
class Imported {
 public:
  Imported(const std::map<std::string, std::string>& files, bool co_simulation) {
    std::string command = "cc -std=c99 -O1 -Wall -Wextra -Werror -ffp-contract=off -fPIC -shared -o '" +
                          folder_ / "model.so" + "'";
    for (const auto& [path, text] : files) {
      if (!path.starts_with("sources/")) continue;
      const std::string file = folder_.write(path.substr(8), text);
      if (file.ends_with(".c")) command += " '" + file + "'";
    }
    EXPECT_EQ(std::system((command + " -lm").c_str()), 0);
    library_ = ::dlopen((folder_ / "model.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    EXPECT_NE(library_, nullptr) << ::dlerror();
    description_ = files.at("modelDescription.xml");
    std::smatch token;
    EXPECT_TRUE(std::regex_search(description_, token, std::regex("instantiationToken=\"([^\"]+)\"")));
    instance_ = made(co_simulation, token[1].str().c_str());
  }
  ~Imported() {
    call<void (*)(void*)>("fmi3FreeInstance")(instance_);
    ::dlclose(library_);
  }
  Imported(const Imported&) = delete;
  Imported& operator=(const Imported&) = delete;

  template <class F>
  F call(const char* name) const {
    const auto f = reinterpret_cast<F>(::dlsym(library_, name));
    EXPECT_NE(f, nullptr) << name;
    return f;
  }
  void* made(bool co_simulation, const char* token) {
    using Me = void* (*)(const char*, const char*, const char*, bool, bool, void*,
                         void (*)(void*, int, const char*, const char*));
    using Cs = void* (*)(const char*, const char*, const char*, bool, bool, bool, bool, const std::uint32_t*,
                         std::size_t, void*, void (*)(void*, int, const char*, const char*), void (*)());
    return co_simulation
               ? call<Cs>("fmi3InstantiateCoSimulation")("a", token, nullptr, false, false, false, false,
                                                         nullptr, 0, &said, log, nullptr)
               : call<Me>("fmi3InstantiateModelExchange")("a", token, nullptr, false, false, &said, log);
  }
  void start() {
    EXPECT_EQ((call<int (*)(void*, bool, double, double, bool, double)>("fmi3EnterInitializationMode")(
                  instance_, false, 0.0, 0.0, false, 0.0)),
              0);
    EXPECT_EQ(call<int (*)(void*)>("fmi3ExitInitializationMode")(instance_), 0);
  }
  /// Value reference by the name in modelDescription.xml.
  [[nodiscard]] std::uint32_t of(const std::string& name) const {
    const std::string mark = "<Float64 name=\"" + name + "\" valueReference=\"";
    const std::size_t at = description_.find(mark);
    EXPECT_NE(at, std::string::npos) << name;
    return static_cast<std::uint32_t>(std::stoul(description_.substr(at + mark.size(), 9)));
  }
  int set(const std::string& name, double value) {
    const std::uint32_t r = of(name);
    return call<int (*)(void*, const std::uint32_t*, std::size_t, const double*, std::size_t)>(
        "fmi3SetFloat64")(instance_, &r, 1, &value, 1);
  }
  [[nodiscard]] double get(const std::string& name) const {
    const std::uint32_t r = of(name);
    double value = NAN;
    EXPECT_EQ((call<int (*)(void*, const std::uint32_t*, std::size_t, double*, std::size_t)>(
                  "fmi3GetFloat64")(instance_, &r, 1, &value, 1)),
              0);
    return value;
  }
  int step(double time, double dt) {
    bool flags[3];
    double last = 0.0;
    return call<int (*)(void*, double, double, bool, bool*, bool*, bool*, double*)>("fmi3DoStep")(
        instance_, time, dt, true, &flags[0], &flags[1], &flags[2], &last);
  }
  std::vector<double> several(const char* function, std::size_t n) const {
    std::vector<double> out(n);
    EXPECT_EQ((call<int (*)(void*, double*, std::size_t)>(function)(instance_, out.data(), n)), 0);
    return out;
  }
  void set_states(const std::vector<double>& states) {
    EXPECT_EQ((call<int (*)(void*, const double*, std::size_t)>("fmi3SetContinuousStates")(
                  instance_, states.data(), states.size())),
              0);
  }
  void event() {
    bool flags[5];
    double next = 0.0;
    EXPECT_EQ((call<int (*)(void*, bool*, bool*, bool*, bool*, bool*, double*)>("fmi3UpdateDiscreteStates")(
                  instance_, &flags[0], &flags[1], &flags[2], &flags[3], &flags[4], &next)),
              0);
  }

  void* instance() const { return instance_; }

  std::string said;

 private:
  static void log(void* environment, int, const char*, const char* message) {
    *static_cast<std::string*>(environment) = message;
  }

  Folder folder_;
  void* library_ = nullptr;
  void* instance_ = nullptr;
  std::string description_;
};

struct FmuExport {
  Folder folder;
  targets::ExportRequest request;
  std::vector<friction::AxisModel> models;

  explicit FmuExport(const std::vector<const char*>& axes) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      request.files.push_back(folder.write(std::to_string(i) + ".toml", axes[i]));
      models.push_back(io::read_toml<friction::AxisModel>(request.files.back()));
    }
    request.output = folder / "out.fmu";
    request.speed = "40 mm/s";
    request.command = "test <&\"";
  }
  targets::Exported write() { return targets::find_target("fmu")->write(request); }
  std::map<std::string, std::string> files() {
    static_cast<void>(write());
    return unzipped(text_of(request.output));
  }
};

/// The library's model over samples with velocity and position held: what a step of co-simulation is.
class LibraryModel {
 public:
  explicit LibraryModel(const friction::AxisModel& model) : model_(model.friction) {}
  double step(double v, double x, double dt) {
    return std::visit(
        [&](const auto& map) {
          const auto whole = friction::composed(map, model_);
          return friction::with_law(model_.dynamics, state_, [&]<class Law>(const Law& law, auto& s) {
            if constexpr (friction::PreSlidingLaw<Law>) {
              return law.step(whole, s, v, x, dt);
            } else {
              return friction::steady_force(whole, v, x);
            }
          });
        },
        model_.steady);
  }

 private:
  friction::Model model_;
  friction::StateOf<friction::DynamicsVariant>::Type state_;
};

/// Velocity with reversals, standstill, slow and fast parts [m/s].
double velocity_at(double t) {
  if (t > 0.9 && t < 0.95) return 0.0;
  return 0.045 * std::sin(7.0 * t) * std::sin(1.3 * t + 0.1) + 2e-4 * std::sin(90.0 * t);
}

// The third axis has a spring, whose ends the position passes.
TEST(Fmu, InCoSimulationItsForceIsThatOfTheLibrary) {
  FmuExport x({kStatic, kLuGre, kGms});
  Imported fmu(x.files(), true);
  fmu.start();
  const std::array<std::string, 3> names{"x", "y", "z"};
  std::vector<LibraryModel> library;
  for (const auto& m : x.models) library.emplace_back(m);
  double t = 0.0;
  double position = 0.0, lowest = 0.0, highest = 0.0;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(2e-4, 2e-3);
  std::array<double, 3> worst{};
  for (int k = 0; k < 3000; ++k) {
    const double dt = any(random);
    const double v = velocity_at(t);
    position += v * dt;
    lowest = std::min(lowest, position), highest = std::max(highest, position);
    for (const auto& name : names) {
      ASSERT_EQ(fmu.set(name + ".velocity", v), 0);
      ASSERT_EQ(fmu.set(name + ".position", position), 0);
    }
    ASSERT_EQ(fmu.step(t, dt), 0) << fmu.said;
    t += dt;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double expected = library[i].step(v, position, dt);
      const double off = std::abs(fmu.get(names[i] + ".friction") - expected);
      // The functions of the C library round in the last digit, with forces of 100 N.
      ASSERT_LE(off, 1e-12 * std::max(std::abs(expected), 100.0)) << names[i] << " at " << t;
      worst[i] = std::max(worst[i], off);
    }
  }
  EXPECT_GT(t, 3.0);
  EXPECT_LT(lowest, -1e-3);
  EXPECT_GT(highest, 3e-3);
  for (std::size_t i = 0; i < names.size(); ++i)
    RecordProperty("worst_N_" + names[i], std::to_string(worst[i] * 1e15) + "e-15");
}

/// Integrates an axis by model exchange over a time with its velocity held: classical Runge-Kutta, events at the ends of steps.
void integrate(Imported& fmu, std::size_t states, std::size_t indicators, double dt, int steps) {
  const double h = dt / steps;
  std::vector<double> before = fmu.several("fmi3GetEventIndicators", indicators);
  for (int k = 0; k < steps; ++k) {
    const std::vector<double> q = fmu.several("fmi3GetContinuousStates", states);
    std::vector<double> sum(states, 0.0);
    std::vector<double> rate(states, 0.0);
    constexpr std::array kAt{0.0, 0.5, 0.5, 1.0};
    constexpr std::array kShare{1.0, 2.0, 2.0, 1.0};
    for (std::size_t stage = 0; stage < 4; ++stage) {
      std::vector<double> there = q;
      for (std::size_t i = 0; i < states; ++i) there[i] += kAt[stage] * h * rate[i];
      fmu.set_states(there);
      rate = fmu.several("fmi3GetContinuousStateDerivatives", states);
      for (std::size_t i = 0; i < states; ++i) sum[i] += kShare[stage] * rate[i];
    }
    std::vector<double> next = q;
    for (std::size_t i = 0; i < states; ++i) next[i] += h / 6.0 * sum[i];
    fmu.set_states(next);
    const std::vector<double> after = fmu.several("fmi3GetEventIndicators", indicators);
    for (std::size_t i = 0; i < indicators; ++i) {
      if ((before[i] > 0.0) == (after[i] > 0.0)) continue;
      fmu.event();
      break;
    }
    before = fmu.several("fmi3GetEventIndicators", indicators);
  }
}

// The same motion by two interfaces: exact steps with the inputs held, and an integrator over the rates with events.
TEST(Fmu, ModelExchangeAndCoSimulationAgree) {
  const std::array<std::pair<const char*, std::array<std::size_t, 2>>, 2> cases{
      {{kLuGre, {1, 1}}, {kGms, {3, 4}}}};
  for (const auto& [axis, counts] : cases) {
    FmuExport x({axis});
    const auto files = x.files();
    Imported exact(files, true);
    Imported integrated(files, false);
    exact.start();
    integrated.start();
    integrated.event();
    double largest = 0.0;
    for (int k = 0; k < 400; ++k) {
      constexpr double kStep = 1e-3;
      const double v = velocity_at(k * kStep + 0.05);
      for (Imported* fmu : {&exact, &integrated}) ASSERT_EQ(fmu->set("x.velocity", v), 0);
      integrated.event();
      ASSERT_EQ(exact.step(k * kStep, kStep), 0);
      integrate(integrated, counts[0], counts[1], kStep, 400);
      const double force = exact.get("x.friction");
      largest = std::max(largest, std::abs(force));
      // An element begins to slip up to one of the 400 parts of a step too late: 4 mm/s · 12 N/µm · 2.5 µs.
      ASSERT_NEAR(integrated.get("x.friction"), force, 0.2) << axis << k;
    }
    EXPECT_GT(largest, 60.0);
  }
}

TEST(Fmu, TheArchiveHasWhatTheStandardAsksFor) {
  FmuExport x({kLuGre, kGms});
  // As in a command, whose files appear together at its end.
  targets::Exported written;
  {
    io::WriteTogether together;
    written = x.write();
    together.commit();
  }
  const std::string bytes = text_of(x.request.output);
  const auto files = unzipped(bytes);
  const std::string& description = files.at("modelDescription.xml");
  EXPECT_THAT(description, HasSubstr("fmiVersion=\"3.0\" modelName=\"friction_x_y\""));
  EXPECT_THAT(description, HasSubstr("test &lt;&amp;&quot;"));
  EXPECT_THAT(description, HasSubstr("name=\"y.element.share[3]\""));
  EXPECT_THAT(files.at("sources/buildDescription.xml"), HasSubstr("modelIdentifier=\"friction_x_y\""));
  // One value reference each, counted without a gap.
  std::uint32_t expected = 0;
  const std::regex reference("<Float64 name=\"[^\"]*\" valueReference=\"([0-9]+)\"");
  for (std::sregex_iterator at(description.begin(), description.end(), reference), end; at != end; ++at)
    EXPECT_EQ(std::stoul((*at)[1]), expected++);
  // 2·3 inputs and outputs, 4 states with rates, 5 indicators, 14 + 3 and 5 + 3 + 6 parameters, 4 of each spring; the time.
  EXPECT_EQ(expected, 1U + 6 + 8 + 5 + 18 + 14 + 8);
  EXPECT_THAT(written.text, HasSubstr("with sources and the binary for "));
  EXPECT_EQ(std::count_if(files.begin(), files.end(),
                          [](const auto& f) { return f.first.starts_with("binaries/"); }),
            1);
  EXPECT_EQ(written.json["axes"][0]["max_error_N"], 0.0);
  EXPECT_THAT(written.text, Not(HasSubstr("pre-sliding")));
  // The same bytes again.
  static_cast<void>(x.write());
  EXPECT_EQ(text_of(x.request.output), bytes);
}

TEST(Fmu, WithoutACompilerItHasSourcesAlone) {
  FmuExport x({kLuGre});
  const char* const before = std::getenv("CC");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("CC", "no-such-compiler", 1);
  const targets::Exported written = x.write();
  ::setenv("CC", "env cc", 1);  // as "ccache cc"
  const targets::Exported launched = x.write();
  EXPECT_THAT(launched.text, Not(HasSubstr("with sources alone")));
  ::setenv("CC", "false", 1);
  const targets::Exported failed = x.write();
  before == nullptr ? ::unsetenv("CC") : ::setenv("CC", kept.c_str(), 1);
  EXPECT_THAT(
      written.text,
      HasSubstr(
          "with sources alone: the C compiler \"no-such-compiler\" cannot be run: No such file or directory."));
  EXPECT_THAT(failed.text, HasSubstr("the C compiler \"false\" ended with code 1 and no message"));
  for (const auto& [path, text] : unzipped(text_of(x.request.output)))
    EXPECT_FALSE(path.starts_with("binaries"));
}

TEST(Fmu, WrongCallsAreRefusedWithAReason) {
  FmuExport x({kGms});
  Imported fmu(x.files(), true);
  EXPECT_EQ(fmu.made(true, "{another}"), nullptr);
  EXPECT_THAT(fmu.said, HasSubstr("the instantiation token is not that of this model"));
  EXPECT_EQ(fmu.step(0.0, 1e-3), 3);
  EXPECT_EQ(fmu.said, "fmi3DoStep: the initialization has not ended");
  EXPECT_EQ(fmu.set("x.element.share[1]", 0.5), 0);
  EXPECT_EQ(fmu.call<int (*)(void*)>("fmi3ExitInitializationMode")(fmu.instance()), 3);
  EXPECT_EQ(fmu.said, "the shares of the elements must add up to 1");
  EXPECT_EQ(fmu.set("x.element.share[1]", 0.3), 0);
  fmu.start();
  EXPECT_EQ(fmu.set("x.coulomb", 70.0), 3);
  EXPECT_EQ(fmu.said, "fmi3SetFloat64: after the initialization only velocity and position can be set");
  EXPECT_EQ(fmu.set("x.velocity", NAN), 3);
  EXPECT_EQ(fmu.step(0.0, -1.0), 3);
  EXPECT_EQ(fmu.said, "fmi3DoStep: expected a step above zero");
}

TEST(Fmu, AStateIsKeptAndComesBack) {
  FmuExport x({kGms});
  Imported fmu(x.files(), true);
  fmu.start();
  ASSERT_EQ(fmu.set("x.velocity", 1e-3), 0);
  ASSERT_EQ(fmu.step(0.0, 5e-3), 0);
  const double there = fmu.get("x.friction");
  void* state = nullptr;
  ASSERT_EQ((fmu.call<int (*)(void*, void**)>("fmi3GetFMUState")(fmu.instance(), &state)), 0);
  ASSERT_EQ(fmu.step(5e-3, 5e-3), 0);
  const double further = fmu.get("x.friction");
  EXPECT_NE(further, there);
  ASSERT_EQ((fmu.call<int (*)(void*, void*)>("fmi3SetFMUState")(fmu.instance(), state)), 0);
  EXPECT_EQ(fmu.get("x.friction"), there);
  ASSERT_EQ(fmu.step(5e-3, 5e-3), 0);
  EXPECT_EQ(fmu.get("x.friction"), further);
  ASSERT_EQ((fmu.call<int (*)(void*, void**)>("fmi3FreeFMUState")(fmu.instance(), &state)), 0);
  ASSERT_EQ(fmu.call<int (*)(void*)>("fmi3Reset")(fmu.instance()), 0);
  EXPECT_EQ(fmu.get("x.velocity"), 0.0);
}

}  // namespace
}  // namespace stribeck::test::fmu_test
