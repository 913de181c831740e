#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/text.hpp>
#include <variant>
#include <vector>

namespace stribeck::report {
namespace {

using Figure = double sim::Metrics::*;
using sim::Metrics;

std::string with_micrometres(double metres) { return micrometres(metres) + "\u00A0µm"; }
std::string millivolts(double volts) { return significant(volts * 1e3, 3) + "\u00A0mV"; }

bool is_plain(const sim::CompareRow& r) {
  return r.controller.friction == sim::FrictionUse::kNone &&
         r.controller.observer == control::Observer::kNone;
}

bool is_beyond(const sim::CompareRow& r) { return r.controller.looks_ahead(); }

/// Experiments name their own controllers by letters; controllers that a user adds have names.
bool is_of_thesis(const sim::CompareRow& r) { return r.controller.id.size() == 1; }

const sim::CompareRow* least(const Rows& rows, Figure figure) {
  const sim::CompareRow* best = nullptr;
  for (const sim::CompareRow* r : rows) {
    if (std::isfinite(r->mean.*figure) && (best == nullptr || r->mean.*figure < best->mean.*figure)) best = r;
  }
  return best;
}

/// Whether a difference of means may be chance: below two standard errors.
bool alike(const sim::CompareRow& a, const sim::CompareRow& b, Figure figure, double trials) {
  const double sa = a.spread.*figure;
  const double sb = b.spread.*figure;
  if (!std::isfinite(sa) || !std::isfinite(sb)) return false;
  return std::abs(a.mean.*figure - b.mean.*figure) < 2.0 * std::sqrt((sa * sa + sb * sb) / trials);
}

/// "91 % less"; empty where no percentage can be given.
std::string change(double value, double against) {
  const double percent = 100.0 * (value / against - 1.0);
  if (!std::isfinite(percent)) return {};
  if (std::abs(percent) < 0.5) return "the same";
  // 0.03 of 14.8 is 99.8 % less, not all of it.
  constexpr double kNearlyAll = 99.99;
  if (value > 0.0 && percent < -kNearlyAll) return fmt::format("over {}\u00A0% less", kNearlyAll);
  int decimals = 0;
  while (value > 0.0 && percent < -(100.0 - 0.5 * std::pow(10.0, -decimals))) ++decimals;
  return fmt::format("{:.{}f}\u00A0% {}", std::abs(percent), decimals, percent < 0.0 ? "less" : "more");
}

std::string change_from(double value, double against) {
  const std::string words = change(value, against);
  if (words.empty()) return "not comparable with";
  return words + (words == "the same" ? " as" : " than");
}

std::string maximum_and_rms(const sim::CompareRow& r) {
  return fmt::format("{} and {} RMS", with_micrometres(r.mean.max_contour_error),
                     with_micrometres(r.mean.rms));
}

std::string against_thesis(const Rows& rows, const Rivals& rivals, const std::string& pace,
                           const sim::CompareResult& result) {
  const sim::CompareRow& ours = *rivals.ours;
  const sim::CompareRow& other = *rivals.against;
  const double trials = result.spec.trials;
  const std::string error = error_name(result);
  std::string text = fmt::format("At {} {}{} has a largest {} of {}", pace, full_name(ours),
                                 rivals.is_default ? ", the default," : "", error, maximum_and_rms(ours));
  text += fmt::format("; {}, the last controller of the thesis, leaves {}", full_name(other),
                      maximum_and_rms(other));
  const std::string max = change(ours.mean.max_contour_error, other.mean.max_contour_error);
  const std::string rms = change(ours.mean.rms, other.mean.rms);
  if (!max.empty() && !rms.empty()) text += fmt::format(": {} and {}", max, rms);
  text += ".";
  if (std::isfinite(ours.mean.quadrant_ratio) && std::isfinite(other.mean.quadrant_ratio)) {
    text += fmt::format(
        " The largest error around a reversal is {} times that of equally long windows elsewhere (quadrant "
        "ratio), under {} {} times.",
        decimals(ours.mean.quadrant_ratio, 2), name_of(other), decimals(other.mean.quadrant_ratio, 2));
  }
  if (const std::string words = change_from(ours.mean.input_variation, other.mean.input_variation);
      std::isfinite(ours.mean.input_variation) && std::isfinite(other.mean.input_variation)) {
    text += fmt::format(" The control input varies by {} from period to period, {} under {} ({}).",
                        millivolts(ours.mean.input_variation), words, name_of(other),
                        millivolts(other.mean.input_variation));
  }
  const sim::CompareRow* flattest = least(rows, &Metrics::max_contour_error);
  const sim::CompareRow* quietest = least(rows, &Metrics::rms);
  const auto chance = [&](const sim::CompareRow& best, Figure figure) {
    return alike(best, ours, figure, trials)
               ? "; the difference to " + name_of(ours) + " is within the scatter"
               : "";
  };
  if (flattest == quietest && flattest != &ours) {
    const bool within = alike(*flattest, ours, &Metrics::max_contour_error, trials) &&
                        alike(*flattest, ours, &Metrics::rms, trials);
    text +=
        fmt::format(" {} leaves the smallest errors: {}{}.", full_name(*flattest), maximum_and_rms(*flattest),
                    within ? "; the difference to " + name_of(ours) + " is within the scatter" : "");
  } else {
    if (flattest != &ours) {
      text += fmt::format(" {} has the smallest maximum, {}{}.", full_name(*flattest),
                          with_micrometres(flattest->mean.max_contour_error),
                          chance(*flattest, &Metrics::max_contour_error));
    }
    if (quietest != &ours) {
      text += fmt::format(" {} has the smallest RMS, {}{}.", full_name(*quietest),
                          with_micrometres(quietest->mean.rms), chance(*quietest, &Metrics::rms));
    }
  }
  std::vector<std::string> learned;
  for (const sim::CompareRow* r : rows) {
    if (r != &ours && r != flattest && std::holds_alternative<control::LearningParams>(r->controller.law))
      learned.push_back(full_name(*r) + " leaves " + maximum_and_rms(*r));
  }
  if (!learned.empty()) text += " " + listed(learned) + ".";
  const auto plain = std::find_if(rows.begin(), rows.end(), [](const auto* r) { return is_plain(*r); });
  if (plain != rows.end() && *plain != &other && (*plain)->refused.empty())
    text += fmt::format(" {} leaves {}.", full_name(**plain), maximum_and_rms(**plain));
  return text;
}

/// Compares the best controller with no compensation and with the conventional model.
std::string best_in_words(const Rows& rows, const std::string& pace, const sim::CompareResult& result) {
  const double trials = result.spec.trials;
  const sim::CompareRow* best = least(rows, &Metrics::rms);
  std::string text = fmt::format("At {} {} leaves the smallest RMS {}, {}", pace, full_name(*best),
                                 error_name(result), with_micrometres(best->mean.rms));
  std::vector<std::string> as_good;
  for (const sim::CompareRow* r : rows) {
    if (r != best && alike(*r, *best, &Metrics::rms, trials)) as_good.push_back(name_of(*r));
  }
  if (!as_good.empty()) text += "; the difference to " + listed(as_good) + " is within the scatter";

  const sim::CompareRow* plain = nullptr;
  const sim::CompareRow* conventional = nullptr;
  for (const sim::CompareRow* r : rows) {
    if (r == best || !r->refused.empty()) continue;
    if (is_plain(*r) && plain == nullptr) plain = r;
    if (r->controller.friction == sim::FrictionUse::kConventional) {
      if (conventional == nullptr || r->controller.observer == best->controller.observer) conventional = r;
    }
  }
  Rows others;
  for (const sim::CompareRow* r : {plain, conventional}) {
    if (r != nullptr) others.push_back(r);
  }
  const auto compared = [&](Figure figure) {
    std::vector<std::string> parts;
    for (const sim::CompareRow* r : others) {
      parts.push_back(fmt::format("{} {} ({})", change_from(best->mean.*figure, r->mean.*figure),
                                  full_name(*r), with_micrometres(r->mean.*figure)));
    }
    return listed(parts);
  };
  if (!others.empty()) text += ": " + compared(&Metrics::rms);
  text += fmt::format(". Its largest error is {}", with_micrometres(best->mean.max_contour_error));
  if (!others.empty()) text += ", " + compared(&Metrics::max_contour_error);
  text += ".";
  const sim::CompareRow* flattest = least(rows, &Metrics::max_contour_error);
  if (flattest != nullptr && flattest != best) {
    const bool chance = alike(*flattest, *best, &Metrics::max_contour_error, trials);
    text += fmt::format(" {} has the smallest maximum: {}{}.", full_name(*flattest),
                        with_micrometres(flattest->mean.max_contour_error),
                        chance ? "; the difference is within the scatter" : "");
  }
  const double glitch = best->mean.quadrant_glitch;
  if (std::isfinite(glitch)) {
    const double largest = best->mean.max_contour_error;
    constexpr double kHardlyMore = 0.98;
    text +=
        fmt::format(" What remains at the {} is {} within the first {:g}\u00A0mm after an axis reverses{}.",
                    result.axes.size() == 1 ? "reversals" : "quadrants", with_micrometres(glitch),
                    1e3 * sim::kGlitchTravel,
                    micrometres(glitch) == micrometres(largest) ? ", and that is the largest error of all"
                    : glitch > kHardlyMore * largest            ? "; the largest error is hardly more"
                                                                : "; the largest error lies elsewhere");
  }
  return text;
}

}  // namespace

std::optional<Rivals> rivals_of(const Rows& rows) {
  const auto finite = [](const sim::CompareRow* r) {
    return std::isfinite(r->mean.rms) && std::isfinite(r->mean.max_contour_error);
  };
  const auto first = std::find_if(rows.begin(), rows.end(), [](const auto* r) { return is_beyond(*r); });
  if (first == rows.end() || first == rows.begin() || !finite(*(first - 1)) || !is_of_thesis(**(first - 1)))
    return std::nullopt;
  Rivals rivals;
  rivals.against = *(first - 1);
  Rows beyond;
  for (auto at = first; at != rows.end(); ++at) {
    if (is_beyond(**at) && finite(*at)) beyond.push_back(*at);
  }
  const auto adapts = [](const auto* r) {
    const auto& id = r->controller.id;
    return r->controller.adaptation.enabled && (id == "h" || id == "dynamic");
  };
  const auto chosen = std::find_if(beyond.begin(), beyond.end(), adapts);
  rivals.is_default = chosen != beyond.end();
  rivals.ours = rivals.is_default ? *chosen : least(beyond, &Metrics::max_contour_error);
  if (rivals.ours == nullptr) return std::nullopt;
  return rivals;
}

std::string verdict(const Rows& rows, const std::string& pace, const sim::CompareResult& result) {
  if (const auto rivals = rivals_of(rows)) return against_thesis(rows, *rivals, pace, result);
  if (least(rows, &Metrics::rms) == nullptr) return "At " + pace + " no controller gave a finite result.";
  return best_in_words(rows, pace, result);
}

}  // namespace stribeck::report
