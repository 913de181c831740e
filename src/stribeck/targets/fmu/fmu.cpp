// --to fmu: the friction of axes with their bristles as a functional mock-up unit after FMI 3.0.
#include <fmt/format.h>

#include <stribeck/targets/fmu/binary.hpp>
#include <stribeck/targets/fmu/model_text.hpp>
#include <stribeck/targets/fmu/sources.hpp>

namespace stribeck::targets {

namespace {

constexpr const char* kBuildDescription =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<fmiBuildDescription fmiVersion=\"3.0\">\n"
    "  <BuildConfiguration modelIdentifier=\"{}\">\n"
    "    <SourceFileSet language=\"C99\">\n"
    "      <SourceFile name=\"friction.c\"/>\n"
    "      <SourceFile name=\"fmi3_functions.c\"/>\n"
    "      <SourceFile name=\"fmi3_unused.c\"/>\n"
    "    </SourceFileSet>\n"
    "    <Library name=\"m\" external=\"true\" description=\"mathematical functions of the C library, where they are apart\"/>\n"
    "  </BuildConfiguration>\n"
    "</fmiBuildDescription>\n";

Form fmu_form(const Axis& axis) {
  Form form;
  form.held = [axis](double v) { return axis.friction(v); };
  form.periodic = form.pre_sliding = true;
  form.to_do =
      "Import the FMU, connect velocity and position of the axis, and let the friction act against its motion. Mass and load belong "
      "to the model around it. Check first that at a constant positive velocity the friction is positive and brakes.";
  return form;
}

Packed pack(const std::vector<Axis>& axes, const SteadyText& /*known*/, const std::string& command) {
  std::vector<ZipFile> sources{{"friction.h", std::string(kFrictionHeader)},
                               {"friction.c", std::string(kFrictionSource)},
                               {"fmi3.h", std::string(kFmiHeader)},
                               {"fmi3_functions.c", std::string(kFmiFunctions)},
                               {"fmi3_unused.c", std::string(kFmiUnused)}};
  std::string all;
  for (const auto& [name, text] : sources) all += text;
  const FmuTexts texts = fmu_texts(axes, command, all);
  sources.emplace_back("axes.h", texts.axes);
  const FmuBinary binary = fmu_binary(texts.identifier, sources);
  std::vector<ZipFile> files{
      {"modelDescription.xml", texts.description},
      {"sources/buildDescription.xml", fmt::format(kBuildDescription, texts.identifier)}};
  for (const auto& [name, text] : sources) files.emplace_back("sources/" + name, text);
  Packed out;
  if (binary.why_not.empty()) {
    files.emplace_back(fmt::format("binaries/{}/{}.so", binary.platform, texts.identifier), binary.bytes);
    out.words = fmt::format("FMI 3.0, model exchange and co-simulation, with sources and the binary for {}.",
                            binary.platform);
  } else {
    out.words = fmt::format(
        "FMI 3.0, model exchange and co-simulation, with sources alone: {}. The importer compiles them.",
        binary.why_not);
  }
  out.bytes = zip_archive(files);
  return out;
}

}  // namespace

extern const SteadyTarget kFmu;
const SteadyTarget kFmu{.name = "fmu",
                        .what = "FMU after FMI 3.0 with sources: friction with pre-sliding",
                        .write = fmu_form,
                        .extension = ".fmu",
                        .pack = pack,
                        .simulator = true,
                        .linear_only = true};

}  // namespace stribeck::targets
