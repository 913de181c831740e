/* Friction force of an axis from its velocity and position, with the state of its bristles.
 *
 *   steady    level g(v) against the motion, viscous part, part periodic in position
 *   static    F = g sgn v + viscous + additive
 *   lugre     dz/dt = v - s0 |v| / g z,   F = s0 z + s1(v) dz/dt + viscous + additive
 *   gms       elements that stick (dF/dt = k v) or slip (dF/dt = C (a sgn v - F / g)),
 *             F = sum + s(v) v + viscous + additive
 *
 * Velocity [m/s], position [m], force [N], positive for v > 0. Nothing is allocated; no file, no clock.
 */
#ifndef STRIBECK_FRICTION_H
#define STRIBECK_FRICTION_H

enum { MOST_ELEMENTS = 8, MOST_PERIODIC = 4 };

enum steady_kind { CONVENTIONAL, GAUSSIAN };
enum dynamics_kind { STATIC, LUGRE, GMS };

/* What an axis consists of. Its numbers begin at `first` of the parameters, in this order:
 *   conventional  coulomb, viscous, static, Stribeck velocity, shape
 *   gaussian      lowest and highest velocity; for each direction level, viscous, then height, centre, width of each term
 *   periodic      amplitude, period, phase of each term
 *   spring        stiffness, position without force, lowest and highest position
 *   lugre         s0, s1, velocity at which s1 has faded (0: it does not fade)
 *   gms           C, s, velocity at which s has faded, then stiffness and share of each element */
struct axis {
  enum steady_kind steady;
  enum dynamics_kind dynamics;
  int first;
  int positive_terms; /* gaussian */
  int negative_terms;
  int periodic;
  int proportional[MOST_PERIODIC]; /* 1: the term follows the direction of the motion */
  int elements;                    /* gms */
  int first_state;                 /* among the continuous states */
  int states;
};

/* Bristle deflection [m] (lugre) or forces of the elements [N] and whether they slip (gms). */
struct bristles {
  double value[MOST_ELEMENTS];
  double slips[MOST_ELEMENTS];
};

struct parts {
  double level;
  double viscous;
  double additive;
};

struct parts steady_parts(const struct axis* a, const double* parameters, double v, double x);
double friction_force(const struct axis* a, const double* parameters, const struct bristles* s, double v,
                      double x);
/* Rates of the states, for an integrator. */
void bristle_rates(const struct axis* a, const double* parameters, const struct bristles* s, double v,
                   double x, double* rates);
/* Exact over a step of dt [s] with v and x held. */
void advance_bristles(const struct axis* a, const double* parameters, struct bristles* s, double v, double x,
                      double dt);
/* Distance of an element from slipping [N]; 0 or less: it is to slip. */
double distance_from_slip(const struct axis* a, const double* parameters, const struct bristles* s,
                          int element, double v, double x);
/* Lets elements stick or slip; returns 1 where a state changed. */
int settle_bristles(const struct axis* a, const double* parameters, struct bristles* s, double v_before,
                    double v, double x);
/* A reason why the parameters are none, or a null pointer. */
const char* parameter_fault(const struct axis* a, const double* parameters);

#endif
