#include "friction.h"

#include <math.h>

static double sign_of(double v) { return (double)((v > 0.0) - (v < 0.0)); }

static const double* gaussian_branch(const struct axis* a, const double* p, double v) {
  return v < 0.0 ? p + 4 + 3 * a->positive_terms : p + 2;
}

static int steady_count(const struct axis* a) {
  return a->steady == CONVENTIONAL ? 5 : 6 + 3 * (a->positive_terms + a->negative_terms);
}

static const double* law_of(const struct axis* a, const double* parameters) {
  return parameters + a->first + steady_count(a) + 3 * a->periodic + 4;
}

struct parts steady_parts(const struct axis* a, const double* parameters, double v, double x) {
  const double* p = parameters + a->first;
  const double* term;
  struct parts out = {0.0, 0.0, 0.0};
  int i;
  if (a->steady == CONVENTIONAL) {
    const double ratio = fabs(v / p[3]) + 1e-300;
    out.level = p[0] + (p[2] - p[0]) * exp(-exp(p[4] * log(ratio)));
    out.viscous = p[1] * v;
  } else {
    const double* branch = gaussian_branch(a, p, v);
    const double border = v < p[0] ? p[0] : v > p[1] ? p[1] : v;
    const int terms = v < 0.0 ? a->negative_terms : a->positive_terms;
    double sum = branch[0];
    for (i = 0; i < terms; ++i) {
      const double d = (border - branch[3 + 3 * i]) / branch[4 + 3 * i];
      sum += branch[2 + 3 * i] * exp(-(d * d));
    }
    out.level = v < 0.0 ? -sum : sum;
    out.viscous = branch[1] * v;
  }
  term = p + steady_count(a);
  for (i = 0; i < a->periodic; ++i) {
    const double s = term[3 * i] * sin(2.0 * 3.14159265358979323846 * x / term[3 * i + 1] - term[3 * i + 2]);
    if (a->proportional[i])
      out.level += s;
    else
      out.additive += s;
  }
  term += 3 * a->periodic;
  out.additive += term[0] * ((x < term[2] ? term[2] : x > term[3] ? term[3] : x) - term[1]);
  return out;
}

static double faded(double sigma, double fade, double v) {
  if (fade <= 0.0) return sigma;
  return v * v < 40.0 * fade * fade ? sigma * exp(-(v * v / (fade * fade))) : 0.0;
}

static double lugre_rate(const double* law, double z, double v, double level) {
  return v - law[0] * fabs(v) * z / level;
}

double friction_force(const struct axis* a, const double* parameters, const struct bristles* s, double v,
                      double x) {
  const struct parts p = steady_parts(a, parameters, v, x);
  const double* law = law_of(a, parameters);
  double force = p.viscous + p.additive;
  int i;
  if (a->dynamics == STATIC) return p.level * sign_of(v) + force;
  if (a->dynamics == LUGRE) {
    const double z = s->value[0];
    return law[0] * z + faded(law[1], law[2], v) * lugre_rate(law, z, v, p.level) + force;
  }
  for (i = 0; i < a->elements; ++i) force += s->value[i];
  return force + faded(law[1], law[2], v) * v;
}

void bristle_rates(const struct axis* a, const double* parameters, const struct bristles* s, double v,
                   double x, double* rates) {
  const struct parts p = steady_parts(a, parameters, v, x);
  const double* law = law_of(a, parameters);
  int i;
  if (a->dynamics == LUGRE) rates[0] = lugre_rate(law, s->value[0], v, p.level);
  if (a->dynamics != GMS) return;
  for (i = 0; i < a->elements; ++i) {
    const double stiffness = law[3 + 2 * i];
    const double share = law[4 + 2 * i];
    if (s->slips[i] > 0.5 && s->value[i] * v > 0.0)
      rates[i] = law[0] * (share * sign_of(v) - s->value[i] / p.level);
    else
      rates[i] = stiffness * v;
  }
}

/* (1 - exp(-y)) / y */
static double hold_gain(double y) {
  if (y < 1e-3) return 1.0 - y * (0.5 - y * (1.0 / 6.0 - y * (1.0 / 24.0 - y * (1.0 / 120.0))));
  return (1.0 - exp(-y)) / y;
}

static void advance_element(double* force, double* slips, double v, double limit, double stiffness,
                            double decay_rate, double dt) {
  const double direction = sign_of(v);
  const int slipped = *slips > 0.5 && *force * direction > 0.0;
  double slip_from;
  double begin;
  if (v == 0.0) return;
  slip_from = slipped ? 0.0 : (limit - *force * direction) / (stiffness * fabs(v));
  if (slip_from < 0.0) slip_from = 0.0;
  *slips = slip_from <= dt ? 1.0 : 0.0;
  if (slip_from > dt) {
    *force += stiffness * v * dt;
    return;
  }
  begin = slipped ? *force : limit * direction;
  *force = limit * direction + (begin - limit * direction) * exp(-decay_rate * (dt - slip_from));
}

void advance_bristles(const struct axis* a, const double* parameters, struct bristles* s, double v, double x,
                      double dt) {
  const struct parts p = steady_parts(a, parameters, v, x);
  const double* law = law_of(a, parameters);
  int i;
  if (a->dynamics == LUGRE) {
    const double y = law[0] * fabs(v) / p.level * dt;
    s->value[0] = exp(-y) * s->value[0] + v * dt * hold_gain(y);
  }
  for (i = 0; i < a->elements; ++i)
    advance_element(&s->value[i], &s->slips[i], v, law[4 + 2 * i] * p.level, law[3 + 2 * i], law[0] / p.level,
                    dt);
}

double distance_from_slip(const struct axis* a, const double* parameters, const struct bristles* s,
                          int element, double v, double x) {
  const double limit = law_of(a, parameters)[4 + 2 * element] * steady_parts(a, parameters, v, x).level;
  return s->slips[element] > 0.5 ? limit : limit - s->value[element] * sign_of(v);
}

int settle_bristles(const struct axis* a, const double* parameters, struct bristles* s, double v_before,
                    double v, double x) {
  const double* law = law_of(a, parameters);
  const double direction = sign_of(v);
  int changed = 0;
  int i;
  for (i = 0; i < a->elements; ++i) {
    const double limit = law[4 + 2 * i] * steady_parts(a, parameters, v, x).level;
    if (v_before * v <= 0.0) s->slips[i] = 0.0;
    if (s->slips[i] > 0.5 || s->value[i] * direction < limit) continue;
    changed = changed || s->value[i] != limit * direction;
    s->value[i] = limit * direction;
    s->slips[i] = 1.0;
  }
  return changed;
}

static const char* steady_fault(const struct axis* a, const double* p) {
  int i;
  if (a->steady == CONVENTIONAL) {
    if (!(p[0] > 0.0 && p[2] > 0.0)) return "coulomb and static friction must be above zero";
    if (!(p[1] >= 0.0)) return "the viscous coefficient must not be below zero";
    if (!(p[3] > 0.0 && p[4] > 0.0)) return "Stribeck velocity and shape must be above zero";
    return 0;
  }
  if (!(p[0] < 0.0 && p[1] > 0.0)) return "the range of velocities must contain zero";
  for (i = 0; i < a->positive_terms; ++i)
    if (!(p[6 + 3 * i] > 0.0)) return "the width of a term must be above zero";
  for (i = 0; i < a->negative_terms; ++i)
    if (!(p[8 + 3 * (a->positive_terms + i)] > 0.0)) return "the width of a term must be above zero";
  return 0;
}

const char* parameter_fault(const struct axis* a, const double* parameters) {
  const double* p = parameters + a->first;
  const double* law = law_of(a, parameters);
  const char* fault = steady_fault(a, p);
  double shares = 0.0;
  double periodic = 0.0;
  int i;
  if (fault) return fault;
  for (i = 0; i < a->periodic; ++i) {
    if (!(p[steady_count(a) + 3 * i + 1] > 0.0)) return "a period must be above zero";
    periodic += a->proportional[i] ? fabs(p[steady_count(a) + 3 * i]) : 0.0;
  }
  for (i = -100; i <= 100; ++i) {
    struct axis steady = *a;
    steady.periodic = 0;
    if (!(steady_parts(&steady, parameters, 1e-3 * i, 0.0).level > periodic))
      return "the level of friction must stay above zero at every velocity";
  }
  if (a->dynamics == LUGRE && !(law[0] > 0.0 && law[1] >= 0.0 && law[2] >= 0.0))
    return "the stiffness must be above zero, damping and its velocity not below";
  if (a->dynamics != GMS) return 0;
  if (!(law[0] > 0.0 && law[1] >= 0.0 && law[2] >= 0.0))
    return "the attraction must be above zero, damping and its velocity not below";
  for (i = 0; i < a->elements; ++i) {
    if (!(law[3 + 2 * i] > 0.0 && law[4 + 2 * i] > 0.0)) return "stiffness and share must be above zero";
    shares += law[4 + 2 * i];
  }
  return fabs(shares - 1.0) <= 1e-9 ? 0 : "the shares of the elements must add up to 1";
}
