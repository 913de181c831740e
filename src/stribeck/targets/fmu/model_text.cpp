#include <fmt/format.h>

#include <stribeck/io/printable.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/targets/fmu/model_text.hpp>

namespace stribeck::targets {

namespace {

struct Parameter {
  std::string name;
  double value;
  const char* unit;  ///< empty: a pure number
  const char* what;
};

/// One axis as sources/friction.h describes it.
struct FmuAxis {
  const Axis* axis = nullptr;
  std::vector<Parameter> parameters;  ///< in the order of `struct axis`
  const char* steady = "CONVENTIONAL";
  const char* dynamics = "STATIC";
  std::size_t positive_terms = 0;
  std::size_t negative_terms = 0;
  std::size_t elements = 0;
  std::size_t states = 0;

  void add(const std::string& name, double value, const char* unit, const char* what) {
    parameters.push_back({axis->name + "." + name, value, unit, what});
  }
};

void add_map(FmuAxis& a, const friction::Conventional<double>& map) {
  // Without a Stribeck part the static friction is that of Coulomb: the level is the same at every velocity.
  const friction::Stribeck<double> rise =
      map.stribeck.value_or(friction::Stribeck<double>{map.alpha0, 1e-3, 2.0});
  a.add("coulomb", map.alpha0, "N", "Coulomb friction");
  a.add("viscous", map.alpha2, "N.s/m", "viscous coefficient");
  a.add("static", rise.alpha1, "N", "static friction");
  a.add("stribeck_velocity", rise.v0, "m/s", "Stribeck velocity");
  a.add("stribeck_shape", rise.delta, "", "shape of the Stribeck part");
}

void add_map(FmuAxis& a, const friction::Gaussian<double>& map) {
  a.steady = "GAUSSIAN";
  a.add("velocity_lowest", map.velocity_range[0], "m/s", "lowest velocity of the identification");
  a.add("velocity_highest", map.velocity_range[1], "m/s", "highest velocity of the identification");
  a.positive_terms = map.positive.gaussians.size();
  a.negative_terms = map.negative.gaussians.size();
  for (const bool forward : {true, false}) {
    const auto& branch = forward ? map.positive : map.negative;
    const std::string side = forward ? "positive" : "negative";
    a.add(side + ".level", branch.eta0, "N", "nominal Coulomb force, signed");
    a.add(side + ".viscous", branch.eta1, "N.s/m", "viscous coefficient");
    for (std::size_t i = 0; i < branch.gaussians.size(); ++i) {
      const auto& term = branch.gaussians[i];
      a.add(fmt::format("{}.height[{}]", side, i + 1), term.a, "N", "height of a term");
      a.add(fmt::format("{}.centre[{}]", side, i + 1), term.b, "m/s", "centre of a term");
      a.add(fmt::format("{}.width[{}]", side, i + 1), term.c, "m/s", "width of a term");
    }
  }
}

void add_law(FmuAxis&, const friction::Static&) {}

void add_law(FmuAxis& a, const friction::LuGre<double>& law) {
  a.dynamics = "LUGRE";
  a.states = 1;
  a.add("stiffness", law.sigma0, "N/m", "bristle stiffness");
  a.add("damping", law.sigma1, "N.s/m", "bristle damping");
  a.add("damping_velocity", law.damping_velocity.value_or(0.0), "m/s",
        "velocity at which the damping has faded to 1/e; 0: it does not fade");
}

void add_law(FmuAxis& a, const friction::Gms<double>& law) {
  a.dynamics = "GMS";
  a.elements = a.states = law.elements.size();
  a.add("attraction", law.attraction, "N/s", "how fast a slipping element returns to its share");
  a.add("damping", law.damping_coefficient, "N.s/m", "damping of pre-sliding");
  a.add("damping_velocity", law.damping_velocity.value_or(0.0), "m/s",
        "velocity at which the damping has faded to 1/e; 0: it does not fade");
  for (std::size_t i = 0; i < law.elements.size(); ++i) {
    a.add(fmt::format("element.stiffness[{}]", i + 1), law.elements[i].stiffness, "N/m",
          "stiffness of an element");
    a.add(fmt::format("element.share[{}]", i + 1), law.elements[i].share, "", "its share of the level");
  }
}

FmuAxis fmu_axis(const Axis& axis) {
  FmuAxis a;
  a.axis = &axis;
  std::visit([&](const auto& map) { add_map(a, map); }, axis.model.friction.steady);
  const auto& terms = axis.model.friction.eccentric;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    a.add(fmt::format("periodic.amplitude[{}]", i + 1), terms[i].amplitude, "N",
          "amplitude of a term periodic in position");
    a.add(fmt::format("periodic.period[{}]", i + 1), terms[i].period, "m", "its period");
    a.add(fmt::format("periodic.phase[{}]", i + 1), terms[i].phase, "rad", "its phase");
  }
  const friction::Spring spring = axis.model.friction.spring.value_or(friction::Spring{});
  a.add("spring.stiffness", spring.stiffness, "N/m", "force that grows with the position; 0: none");
  a.add("spring.zero_at", spring.zero_at, "m", "position at which that force is zero");
  a.add("spring.from", spring.lowest(), "m", "below this position that force stays");
  a.add("spring.to", spring.highest(), "m", "above this position that force stays");
  std::visit([&](const auto& law) { add_law(a, law); }, axis.model.friction.dynamics);
  return a;
}

/// A line of the table kAxes in axes.h.
std::string line_of_axis(const FmuAxis& a, std::size_t first, std::size_t first_state) {
  std::string proportional;
  for (const auto& term : a.axis->model.friction.eccentric)
    proportional += term.form == friction::EccentricForm::kProportional ? "1, " : "0, ";
  return fmt::format("  {{{}, {}, {}, {}, {}, {}, {{{}}}, {}, {}, {}}}, /* {} */\n", a.steady, a.dynamics,
                     first, a.positive_terms, a.negative_terms, a.axis->model.friction.eccentric.size(),
                     proportional.empty() ? "0" : proportional, a.elements, first_state, a.states,
                     a.axis->name);
}

std::string axes_text(const std::vector<FmuAxis>& axes) {
  std::string table;
  std::string values;
  std::size_t parameters = 0;
  std::size_t states = 0;
  std::size_t indicators = 0;
  for (const FmuAxis& a : axes) {
    table += line_of_axis(a, parameters, states);
    for (const Parameter& p : a.parameters) values += fmt::format("  {:.17g}, /* {} */\n", p.value, p.name);
    parameters += a.parameters.size();
    states += a.states;
    indicators += 1 + a.elements;
  }
  return fmt::format(
      "/* Numbers of the model; modelDescription.xml has the same. */\n"
      "#include \"friction.h\"\n\n"
      "enum {{ AXES = {}, PARAMETERS = {}, STATES = {}, INDICATORS = {} }};\n"
      "static const struct axis kAxes[AXES] = {{\n{}}};\n"
      "static const double kParameters[PARAMETERS] = {{\n{}}};\n"
      "/* Usual size of a deflection [m] and of the force of an element [N]. */\n"
      "#define LUGRE_NOMINAL 1e-5\n#define GMS_NOMINAL 10.0\n",
      axes.size(), parameters, states, indicators, table, values);
}

/// The variables and the structure of modelDescription.xml; counts value references as fmi3_functions.c does.
class Variables {
 public:
  explicit Variables(const std::vector<FmuAxis>& axes) {
    variables_ =
        "    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"/>\n";
    for (const FmuAxis& a : axes)
      add(a.axis->name + ".velocity", "m/s", "velocity of the axis", "causality=\"input\" start=\"0\"");
    for (const FmuAxis& a : axes)
      add(a.axis->name + ".position", "m",
          "position of the axis; without periodic terms and a spring it has no effect",
          "causality=\"input\" start=\"0\"");
    for (const FmuAxis& a : axes) {
      outputs_ += one("Output");
      initial_ += one("InitialUnknown");
      add(a.axis->name + ".friction", "N", "friction force, positive for a positive velocity",
          "causality=\"output\" initial=\"calculated\"");
    }
    const std::uint32_t first_state = next_;
    for (const FmuAxis& a : axes) add_states(a);
    std::uint32_t state = first_state;
    for (const FmuAxis& a : axes) add_rates(a, state);
    for (const FmuAxis& a : axes)
      add_event(a.axis->name + ".event.direction", "m/s", "changes its sign at a reversal");
    for (const FmuAxis& a : axes) {
      for (std::size_t i = 1; i <= a.elements; ++i)
        add_event(fmt::format("{}.event.slip[{}]", a.axis->name, i), "N", "falls to zero where it slips");
    }
    for (const FmuAxis& a : axes) {
      for (const Parameter& p : a.parameters)
        add(p.name, p.unit, p.what, fmt::format("causality=\"parameter\" start=\"{:.17g}\"", p.value),
            "fixed");
    }
  }

  [[nodiscard]] std::string text() const {
    return "  <ModelVariables>\n" + variables_ + "  </ModelVariables>\n  <ModelStructure>\n" + outputs_ +
           rates_ + initial_ + events_ + "  </ModelStructure>\n";
  }

 private:
  [[nodiscard]] std::string one(const char* element) const {
    return fmt::format("    <{} valueReference=\"{}\"/>\n", element, next_);
  }
  void add(const std::string& name, const char* unit, const char* what, const std::string& rest,
           const char* variability = "continuous") {
    const std::string of = *unit == '\0' ? "" : fmt::format(" unit=\"{}\"", unit);
    variables_ += fmt::format(
        "    <Float64 name=\"{}\" valueReference=\"{}\" {} variability=\"{}\"{} description=\"{}\"/>\n", name,
        next_++, rest, variability, of, what);
  }
  static std::string state_name(const FmuAxis& a, std::size_t i) {
    return a.elements == 0 ? a.axis->name + ".deflection"
                           : fmt::format("{}.element.force[{}]", a.axis->name, i + 1);
  }
  void add_states(const FmuAxis& a) {
    for (std::size_t i = 0; i < a.states; ++i)
      add(state_name(a, i), a.elements == 0 ? "m" : "N",
          a.elements == 0 ? "deflection of the bristles" : "force of an element",
          a.elements == 0 ? "causality=\"local\" initial=\"exact\" start=\"0\""
                          : "causality=\"local\" initial=\"exact\" start=\"0\" reinit=\"true\"");
  }
  void add_rates(const FmuAxis& a, std::uint32_t& state) {
    for (std::size_t i = 0; i < a.states; ++i) {
      rates_ += one("ContinuousStateDerivative");
      initial_ += one("InitialUnknown");
      add("der(" + state_name(a, i) + ")", a.elements == 0 ? "m/s" : "N/s", "its rate",
          fmt::format("causality=\"local\" initial=\"calculated\" derivative=\"{}\"", state++));
    }
  }
  void add_event(const std::string& name, const char* unit, const char* what) {
    events_ += one("EventIndicator");
    add(name, unit, what, "causality=\"local\" initial=\"calculated\"");
  }

  std::uint32_t next_ = 1;
  std::string variables_;
  std::string outputs_;
  std::string rates_;
  std::string initial_;
  std::string events_;
};

constexpr const char* kUnits =
    "  <UnitDefinitions>\n"
    "    <Unit name=\"m\"><BaseUnit m=\"1\"/></Unit>\n"
    "    <Unit name=\"m/s\"><BaseUnit m=\"1\" s=\"-1\"/></Unit>\n"
    "    <Unit name=\"N\"><BaseUnit kg=\"1\" m=\"1\" s=\"-2\"/></Unit>\n"
    "    <Unit name=\"N/m\"><BaseUnit kg=\"1\" s=\"-2\"/></Unit>\n"
    "    <Unit name=\"N/s\"><BaseUnit kg=\"1\" m=\"1\" s=\"-3\"/></Unit>\n"
    "    <Unit name=\"N.s/m\"><BaseUnit kg=\"1\" s=\"-1\"/></Unit>\n"
    "    <Unit name=\"rad\"><BaseUnit rad=\"1\"/></Unit>\n"
    "  </UnitDefinitions>\n";

/// Other numbers or sources: another token.
std::string token_of(const std::string& bytes) {
  const std::string h = io::hexadecimal(io::sha256(bytes));
  return fmt::format("{{{}-{}-{}-{}-{}}}", h.substr(0, 8), h.substr(8, 4), h.substr(12, 4), h.substr(16, 4),
                     h.substr(20, 12));
}

}  // namespace

FmuTexts fmu_texts(const std::vector<Axis>& axes, const std::string& command, const std::string& sources) {
  std::vector<FmuAxis> all;
  FmuTexts t;
  t.identifier = "friction";
  for (const Axis& axis : axes) {
    all.push_back(fmu_axis(axis));
    t.identifier += "_" + axis.name;
  }
  t.axes = axes_text(all);
  const std::string variables = Variables(all).text();
  const std::string token = token_of(sources + t.axes + variables);
  t.axes += fmt::format("#define TOKEN \"{}\"\n", token);
  constexpr std::size_t kLongest = 1000;
  t.description = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{0}\" instantiationToken=\"{1}\" generationTool=\"Stribeck\"\n"
      "    variableNamingConvention=\"structured\" description=\"Friction of feed drives. Written by: {2}\">\n"
      "  <ModelExchange modelIdentifier=\"{0}\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n"
      "  <CoSimulation modelIdentifier=\"{0}\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"\n"
      "      canHandleVariableCommunicationStepSize=\"true\"/>\n"
      "{3}  <LogCategories>\n    <Category name=\"error\"/>\n  </LogCategories>\n"
      "  <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"0.001\"/>\n{4}</fmiModelDescription>\n",
      t.identifier, token, report::escape_html(io::one_line(command, kLongest)), kUnits, variables);
  return t;
}

}  // namespace stribeck::targets
