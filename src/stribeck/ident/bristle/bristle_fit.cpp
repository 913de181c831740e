#include <ceres/jet.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <stribeck/ident/bristle/bristle_solve.hpp>
#include <stribeck/ident/refused.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stribeck::ident::bristle {
namespace {

constexpr int kIterations = 40;
constexpr int kStartIterations = 10;
constexpr int kPasses = 4;
/// [m/s] The steady map at rest is its limit from either side.
constexpr double kAtRest = 1e-9;
/// Not determinable beyond these.
constexpr double kWidestInterval = 0.35;  ///< of ln σ0
constexpr double kFades = 1.2;            ///< of ln v_d
constexpr double kMostLevel = 1.6;        ///< factor on the level of the steady map
constexpr double kLeastQuanta = 4.0;      ///< encoder steps within the break-away distance
constexpr double kLeastRows = 2.5;        ///< rows within three of them
constexpr std::size_t kFewRows = 20;
/// ln of v_d over the speed δ·√(σ0/m) of a free swing through the break-away distance: what is believed
/// before.
constexpr double kFading = -1.0;
constexpr double kFadingSpread = 1.5;
constexpr double kRootTwelve = 3.4641016151377544;
constexpr const char* kNot = "pre-sliding is not determinable from this log: ";

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char line[256];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

VectorXd unit_vector(Index n, Index at, double value = 1.0) {
  VectorXd g = VectorXd::Zero(n);
  g(at) = value;
  return g;
}

Interval log_interval(double value, double half) { return {value * std::exp(-half), value * std::exp(half)}; }

/// A fitted law with all that is needed to judge it.
struct Fitted {
  Solution solution;
  std::vector<Index> free;
  Prior prior;
  Spread spread;
  int own = 0;
  double break_away = 0.0;
  double half = 0.0;  ///< 95 % half width of its logarithm
};

class Search {
 public:
  Search(const std::vector<log::Record>& records, const friction::AxisModel& known,
         const BristleOptions& options)
      : records_(records), known_(known), options_(options) {
    check();
    prepare();
  }

  BristleFit run() {
    if (data_.reversals == 0) return give_up("the motion has no reversal; record one with reversals");
    const double guess = guess_break_away(records_, data_, known_);
    if (!(guess > 0.0) || !std::isfinite(guess)) return give_up("the axis does not move");
    if (!fit_lugre(guess)) return fit_;
    report_lugre();
    count_rows();
    compare_static();
    if (options_.elements > 0) fit_gms();
    choose();
    answer();
    return fit_;
  }

 private:
  void check() const {
    if (records_.empty()) throw Refused("dynamic friction: no record was given; at least one is needed");
    for (const log::Record& record : records_) {
      const auto bad = log::problems(record);
      if (!bad.empty()) throw Refused(bad.front());
      const double T = records_.front().sample_time;
      if (std::abs(record.sample_time - T) > 1e-6 * T)
        throw Refused(record.source +
                      text(": sampled every %g s, the first record every %g s; records of one fit need one "
                           "sampling time",
                           record.sample_time, T));
    }
    if (options_.elements != 0 && (options_.elements < 2 || options_.elements > kMostElements))
      throw Refused(
          text("dynamic friction: %g GMS elements; expected 2 to 6, or 0 for none", options_.elements));
    for (const double sd : {options_.mass_tolerance.value_or(1.0), options_.level_tolerance,
                            options_.load_tolerance, options_.viscous_tolerance}) {
      if (!(sd > 0.0) || !std::isfinite(sd))
        throw Refused(text("dynamic friction: a tolerance of %g; expected a number above zero", sd));
    }
  }

  void prepare() {
    data_.level = {known_.friction.parts(kAtRest, 0.0).level, known_.friction.parts(-kAtRest, 0.0).level};
    if (!(known_.mass > 0.0) || !(data_.level[0] > 0.0) || !(data_.level[1] > 0.0))
      throw Refused(
          text("dynamic friction: the axis model has mass %g and friction levels %g and %g at rest; all "
               "must be positive, so identify the steady map first",
               known_.mass, data_.level[0], data_.level[1]));
    for (const log::Record& record : records_) {
      log::MotionOptions as_logged;
      as_logged.shift = options_.shift;
      data_.motion.push_back(log::reconstruct(record, as_logged));
      const log::Motion& m = data_.motion.back();
      data_.noise = std::max(data_.noise, m.position_noise);
      data_.reversals += m.reversals.empty() ? 0 : m.reversals.size() - 1;
      open_ = open_ && m.loop == log::Loop::kOpen;
      stroke_ = std::max(stroke_, m.stroke);
    }
    fit_.mass = known_.mass;
    fit_.load = known_.load;
    fit_.reversals = data_.reversals;
    quantum_ = kRootTwelve * data_.noise;
    setting_.mass = known_.mass;
    setting_.load = known_.load;
    setting_.scales.level = 0.5 * (data_.level[0] + data_.level[1]);
    length_ = records_.front().position_unit;
    force_ = records_.front().force_unit;
    metres_ = length_ == "m";
  }

  BristleFit give_up(const std::string& why) {
    fit_.reason = kNot + why;
    return fit_;
  }
  [[nodiscard]] std::string in_words(double length) const {
    if (!metres_) return text("%.3g ", length) + length_;
    return length < 1e-3 ? text("%.3g um", length * 1e6) : text("%.3g mm", length * 1e3);
  }
  [[nodiscard]] std::string shown_length() const { return metres_ ? "mm" : length_; }

  [[nodiscard]] Prior common_prior(int own) const {
    const Index n = own + kCommon + path_.starts;
    Prior prior{VectorXd::Zero(n), VectorXd::Constant(n, 0.7)};
    prior.sd(own + kForward) = prior.sd(own + kBackward) = options_.level_tolerance;
    prior.sd(own + kMass) = options_.mass_tolerance.value_or(open_ ? 0.05 : 0.005);
    prior.sd(own + kLoad) = options_.load_tolerance;
    prior.sd(own + kViscous) = options_.viscous_tolerance;
    return prior;
  }
  /// In closed loop the mass stands as given: least squares would take the noise of the acceleration for less
  /// mass. Its tolerance widens the intervals all the same.
  [[nodiscard]] std::vector<Index> free_of(const Prior& prior, int own) const {
    std::vector<Index> all;
    for (Index i = 0; i < prior.mean.size(); ++i) {
      if (open_ || i != own + kMass) all.push_back(i);
    }
    return all;
  }
  template <class Case>
  Solution solved(const Model<Case>& model, const VectorXd& from, const std::vector<Index>& free,
                  const Prior& prior, int iterations) const {
    return solve(model, {&from, &free, &every_row_, &prior, noise_}, iterations);
  }

  void cut(double break_away) {
    path_ = cut_path(records_, data_, known_, {break_away, options_.shift, open_});
    setting_.path = &path_;
    setting_.scales.break_away = break_away;
    setting_.fastest = 1e-12;
    for (const PathStep& step : path_.steps) setting_.fastest = std::max(setting_.fastest, std::abs(step.v));
    const double root = std::sqrt(setting_.scales.level / break_away * known_.mass);
    setting_.scales.damping = root;
    setting_.scales.fading = break_away * root / known_.mass;
    every_row_.assign(path_.rows.size(), 1);
  }

  /// The pieces follow the break-away distance that is found.
  bool fit_lugre(double guess) {
    constexpr int kOwn = LuGreCase::kMostOwn;
    lugre_.own = kOwn;
    guess = std::clamp(guess, std::max(0.5 * quantum_, 1e-6 * stroke_), stroke_);
    for (int pass = 0; pass < kPasses; ++pass) {
      cut(guess);
      if (path_.rows.size() < kFewRows) {
        give_up("only " + std::to_string(path_.rows.size()) + " rows lie near its reversals");
        return false;
      }
      const Model<LuGreCase> model(setting_, kOwn);
      Prior& prior = lugre_.prior = common_prior(kOwn);
      prior.sd(0) = 3.0;
      prior.sd(1) = 3.0;
      prior.mean(2) = kFading;
      prior.sd(2) = kFadingSpread;
      lugre_.free = free_of(prior, kOwn);
      // First the stiffness alone, so that noise gets a scale; then everything, from several fading velocities.
      std::vector<Index> first = lugre_.free;
      first.erase(first.begin() + 1, first.begin() + 3);
      noise_ = 0.05 * setting_.scales.level;
      const Solution coarse = solved(model, prior.mean, first, prior, kIterations);
      weigh(model, coarse.p);
      Solution& best = lugre_.solution = {};
      for (const double fading : {-2.5, -1.0, 0.5}) {
        VectorXd from = coarse.p;
        from(2) = fading;
        Solution s = solved(model, from, lugre_.free, prior, kFoldIterations);
        if (s.cost < best.cost) best = std::move(s);
      }
      if (std::isfinite(best.cost)) best = solved(model, VectorXd(best.p), lugre_.free, prior, kIterations);
      if (!std::isfinite(best.cost)) {
        give_up("no stiffness describes its reversals");
        return false;
      }
      if (std::abs(best.p(0)) < 0.3 || pass + 1 == kPasses) break;
      guess = std::clamp(guess * std::exp(-best.p(0)), std::max(0.1 * quantum_, 1e-7 * stroke_), stroke_);
    }
    finish(Model<LuGreCase>(setting_, kOwn), lugre_, 1);
    fit_.rows = path_.rows.size();
    return true;
  }

  /// Whitening, and the noise of a row that would be independent of its neighbours, so that what is believed
  /// before has its weight.
  void weigh(const Model<LuGreCase>& model, const VectorXd& p) {
    VectorXd e;
    model.evaluate(p, e, nullptr);
    // Programmed forces leave the axis ringing within a few encoder steps; whitening would weigh those highest
    // (σ0 +0.7 % instead of +0.1 % on pulses of the biaxial table).
    if (!open_) path_.whitening = whitening_of(path_, e.data());
    model.evaluate(p, e, nullptr);
    const double square =
        e.squaredNorm() / static_cast<double>(e.size()) * 2.0 * memory_of_rows(path_, e).rows;
    noise_ = std::max(1e-9 * setting_.scales.level, std::sqrt(square));
  }

  /// Damping (number `damping`, its velocity behind it) that comes out negative is none; then mass and spread.
  template <class Case>
  void finish(const Model<Case>& model, Fitted& f, Index damping) {
    VectorXd& p = f.solution.p;
    std::vector<Index> spread_over = f.free;
    if (p(damping) <= 0.0) {
      VectorXd at = p;
      at(damping) = 0.0;
      f.free.erase(f.free.begin() + damping, f.free.begin() + damping + 2);
      const Solution s = solved(model, at, f.free, f.prior, kIterations);
      p = std::isfinite(s.cost) ? s.p : at;
    }
    const Index mass = f.own + kMass;
    if (open_) {
      correct_mass(model, p, f.free, f.prior, noise_);
    } else {
      spread_over.push_back(mass);
    }
    f.spread = spread_of(model, p, spread_over, f.prior, noise_, open_ ? mass : -1);
  }
  [[nodiscard]] static bool has_damping(const Fitted& f, Index damping) {
    return f.solution.p(damping) > 0.0;
  }

  /// g/σ0 or g/Σk; `slope` are the derivatives of ln of the stiffness.
  void set_break_away(Fitted& f, double stiffness, const VectorXd& slope) const {
    const VectorXd& p = f.solution.p;
    const double forward = 0.5 * data_.level[0] * (1.0 + p(f.own + kForward));
    const double backward = 0.5 * data_.level[1] * (1.0 + p(f.own + kBackward));
    VectorXd g = -slope;
    g(f.own + kForward) += 0.5 * data_.level[0] / (forward + backward);
    g(f.own + kBackward) += 0.5 * data_.level[1] / (forward + backward);
    f.half = f.spread.half_width(g);
    f.break_away = (forward + backward) / stiffness;
  }

  static void add(std::vector<Parameter>& to, std::string name, double value, std::string si,
                  std::string people, Interval i, bool identifiable) {
    to.push_back({std::move(name), value, std::move(si), std::move(people), i.low, i.high, identifiable});
  }
  /// σ and v_d of either law; true when the damping is more than nothing.
  bool add_damping(std::vector<Parameter>& to, const Fitted& f, Index at, const std::string& name,
                   double damping, double fading) const {
    const Index n = f.solution.p.size();
    const double half = f.spread.half_width(unit_vector(n, at, setting_.scales.damping));
    const double fade = f.spread.half_width(unit_vector(n, at + 1));
    const bool damped = has_damping(f, at) && damping > half;
    add(to, name, damping, force_ + " s/" + length_, force_ + " s/" + shown_length(),
        {std::max(0.0, damping - half), damping + half}, damped);
    add(to, "damping_velocity", fading, length_ + "/s", shown_length() + "/s",
        has_damping(f, at) ? log_interval(fading, fade) : Interval{}, damped && fade < kFades);
    return damped;
  }

  void report_lugre() {
    const Index n = lugre_.solution.p.size();
    fit_.lugre = LuGreCase::make<double>(lugre_.solution.p.data(), lugre_.own, setting_.scales).law;
    const double half = lugre_.spread.half_width(unit_vector(n, 0));
    add(fit_.lugre_parameters, "sigma0", fit_.lugre->sigma0, force_ + "/" + length_,
        force_ + "/" + shown_length(), log_interval(fit_.lugre->sigma0, half), half < kWidestInterval);
    if (!add_damping(fit_.lugre_parameters, lugre_, 1, "sigma1", fit_.lugre->sigma1,
                     *fit_.lugre->damping_velocity)) {
      fit_.lugre->sigma1 = 0.0;
      fit_.lugre->damping_velocity.reset();
    }
    set_break_away(lugre_, fit_.lugre->sigma0, unit_vector(n, 0));
  }

  void count_rows() {
    std::vector<double> per_turn;
    for (const log::Motion& m : data_.motion) {
      for (std::size_t i = 1; i < m.reversals.size(); ++i) {
        const std::size_t turn = m.reversals[i];
        double count = 0.0;
        for (std::size_t k = turn;
             k < m.rows() && m.stretch[k] == m.stretch[turn] && m.distance[k] < 3.0 * lugre_.break_away; ++k)
          count += 1.0;
        per_turn.push_back(count);
      }
    }
    const auto middle = per_turn.begin() + static_cast<std::ptrdiff_t>(per_turn.size() / 2);
    std::nth_element(per_turn.begin(), middle, per_turn.end());
    fit_.rows_per_reversal = *middle;
  }

  template <class Case>
  void score(const std::string& name, const Model<Case>& model, const Fitted& f) {
    scores_.push_back(hold_out(model, f.solution.p, f.free, f.prior, noise_, path_));
    fit_.models.push_back(
        {name, 0, static_cast<int>(f.free.size()) - path_.starts, scores_.back().rms(), 0.0, false});
  }

  void compare_static() {
    const Model<StaticCase> model(setting_, 0);
    Fitted plain;
    plain.prior = common_prior(0);
    plain.free = free_of(plain.prior, 0);
    plain.solution = solved(model, plain.prior.mean, plain.free, plain.prior, kIterations);
    score("static", model, plain);
    score("LuGre", Model<LuGreCase>(setting_, lugre_.own), lugre_);
  }

  void fit_gms() {
    const int N = options_.elements;
    const int own = gms_.own = 2 * N + 2;
    const Index damping = 2 * N;
    const Model<GmsCase> model(setting_, own);
    Prior& prior = gms_.prior = common_prior(own);
    prior.sd(0) = 3.0;
    for (int i = 1; i < N; ++i) {
      prior.mean(i) = std::log(0.7);
      prior.sd(i) = 0.7;
      prior.sd(N + i - 1) = 1.5;
    }
    prior.sd(damping - 1) = 1.0;
    prior.sd(damping) = 3.0;
    prior.mean(damping + 1) = kFading;
    prior.sd(damping + 1) = kFadingSpread;
    gms_.free = free_of(prior, own);
    Solution& best = gms_.solution;
    for (const auto& [scale, fading] : {std::pair{0.25, -2.0}, std::pair{0.6, -0.5}}) {
      VectorXd from = prior.mean;
      from.tail(kCommon + path_.starts) = lugre_.solution.p.tail(kCommon + path_.starts);
      from(0) = std::log(scale) - lugre_.solution.p(0);
      from(damping + 1) = fading;
      Solution s = solved(model, from, gms_.free, prior, kStartIterations);
      if (s.cost < best.cost) best = std::move(s);
    }
    if (!std::isfinite(best.cost)) return;
    best = solved(model, VectorXd(best.p), gms_.free, prior, kIterations);
    if (!std::isfinite(best.cost)) return;
    finish(model, gms_, damping);
    report_gms(damping);
    score("GMS, " + std::to_string(N) + " elements", model, gms_);
  }

  void report_gms(Index damping) {
    using Jet = ceres::Jet<double, GmsCase::kMostOwn>;
    const VectorXd& p = gms_.solution.p;
    std::array<Jet, GmsCase::kMostOwn> jets;
    for (int i = 0; i < gms_.own; ++i) jets[static_cast<std::size_t>(i)] = Jet(p(i), i);
    const auto law = GmsCase::make<Jet>(jets.data(), gms_.own, setting_.scales).law;
    const auto slope = [&](const Jet& x) {
      VectorXd g = VectorXd::Zero(p.size());
      g.head(gms_.own) = ceres::log(x).v.head(gms_.own);
      return g;
    };
    const auto positive = [&](const std::string& name, const Jet& x, const std::string& si,
                              const std::string& people) {
      const double half = gms_.spread.half_width(slope(x));
      add(fit_.gms_parameters, name, x.a, si, people, log_interval(x.a, half), half < kWidestInterval);
    };
    const std::string si = force_ + "/" + length_;
    const std::string people = force_ + "/" + shown_length();
    positive("stiffness", law.stiffness(), si, people);
    for (std::size_t i = 0; i < law.elements.size(); ++i) {
      positive("stiffness_" + std::to_string(i + 1), law.elements[i].stiffness, si, people);
      positive("share_" + std::to_string(i + 1), law.elements[i].share, "1", "1");
    }
    positive("attraction", law.attraction, force_ + "/s", force_ + "/s");
    fit_.gms = GmsCase::make<double>(p.data(), gms_.own, setting_.scales).law;
    if (!add_damping(fit_.gms_parameters, gms_, damping, "damping", fit_.gms->damping_coefficient,
                     *fit_.gms->damping_velocity)) {
      fit_.gms->damping_coefficient = 0.0;
      fit_.gms->damping_velocity.reset();
    }
    set_break_away(gms_, fit_.gms->stiffness(), slope(law.stiffness()));
  }

  /// The simplest within one standard error of the best.
  void choose() {
    std::vector<Candidate>& models = fit_.models;
    for (std::size_t i = 1; i < models.size(); ++i) {
      if (models[i].held_out_rms < models[best_].held_out_rms) best_ = i;
    }
    chosen_ = best_;
    for (std::size_t i = 0; i < models.size(); ++i)
      models[i].standard_error = i == best_ ? 0.0 : error_of_difference(scores_[i], scores_[best_]);
    for (std::size_t i = best_; i-- > 0;) {
      if (models[i].held_out_rms <= models[best_].held_out_rms + models[i].standard_error) chosen_ = i;
    }
    models[chosen_].chosen = true;
  }

  void answer() {
    const Fitted& f = chosen_ == 2 ? gms_ : lugre_;
    const VectorXd& p = f.solution.p;
    fit_.mass = known_.mass * (1.0 + p(f.own + kMass));
    const double half = f.spread.half_width(unit_vector(p.size(), f.own + kMass, known_.mass));
    fit_.mass_interval = {fit_.mass - half, fit_.mass + half};
    fit_.load = known_.load + setting_.scales.level * p(f.own + kLoad);
    fit_.level_factor = {1.0 + p(f.own + kForward), 1.0 + p(f.own + kBackward)};
    fit_.break_away = f.break_away;
    fit_.break_away_interval = log_interval(f.break_away, f.half);
    const std::string why_not = objection(f);
    fit_.determinable = why_not.empty();
    if (!fit_.determinable) {
      fit_.reason = kNot + why_not;
      return;
    }
    if (chosen_ == 2) {
      fit_.best = *fit_.gms;
    } else {
      fit_.best = *fit_.lugre;
    }
    fit_.reason = "break-away distance " + in_words(fit_.break_away) + " (" +
                  in_words(fit_.break_away_interval.low) + " to " + in_words(fit_.break_away_interval.high) +
                  ") from " + std::to_string(fit_.reversals) + " reversals";
  }

  /// Why this log does not determine pre-sliding; empty: it does.
  [[nodiscard]] std::string objection(const Fitted& f) const {
    const auto& [low, high] = fit_.break_away_interval;
    const auto& level = fit_.level_factor;
    if (f.break_away < kLeastQuanta * quantum_)
      return "the encoder, with steps of about " + in_words(quantum_) +
             ", is too coarse for a break-away distance of at most " +
             in_words(std::max(high, kLeastQuanta * quantum_));
    if (fit_.rows_per_reversal < kLeastRows)
      return text("the axis passes it in %.0f samples; sample faster or turn more slowly",
                  fit_.rows_per_reversal);
    if (data_.reversals < 2)
      return "it has one reversal, so that nothing found there can be checked on another";
    if (!std::isfinite(fit_.models[best_].held_out_rms)) return "too few rows follow its reversals";
    if (chosen_ == 0)
      return text("the static model predicts reversals that were left out as well (%.3g against %.3g ",
                  fit_.models[0].held_out_rms, fit_.models[best_].held_out_rms) +
             force_ + ")";
    if (std::min(level[0], level[1]) < 1.0 / kMostLevel || std::max(level[0], level[1]) > kMostLevel)
      return text(
          "its reversals ask for %.2f and %.2f times the level of friction that was given; either it never "
          "slides or the steady map belongs to another day",
          level[0], level[1]);
    if (!(f.half < kWidestInterval))
      return "its reversals allow any break-away distance from " + in_words(low) + " to " + in_words(high);
    return "";
  }

  const std::vector<log::Record>& records_;
  const friction::AxisModel& known_;
  const BristleOptions& options_;
  BristleFit fit_;
  BristleData data_;
  bool open_ = true;  ///< every log is of open loop
  double stroke_ = 0.0;
  double quantum_ = 0.0;  ///< step of the encoder, from its noise
  std::string length_;
  std::string force_;
  bool metres_ = true;

  BristlePath path_;
  Setting setting_;
  std::vector<char> every_row_;
  double noise_ = 1.0;
  Fitted lugre_;
  Fitted gms_;
  std::vector<HeldOut> scores_;
  std::size_t best_ = 0;
  std::size_t chosen_ = 0;
};

}  // namespace

BristleFit fit_bristle(const std::vector<log::Record>& records, const friction::AxisModel& known,
                       const BristleOptions& options) {
  return Search(records, known, options).run();
}

}  // namespace stribeck::ident::bristle
