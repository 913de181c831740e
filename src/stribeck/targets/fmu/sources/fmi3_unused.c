/* Functions of FMI 3.0 that every model must have, and that this one has no use for: modes in which there is nothing to do, types
 * other than Float64, clocks, derivatives.
 */
#include "fmi3.h"

#define NOTHING_TO_DO(name)                     \
  EXPORT fmi3Status FMI(name)(void* instance) { \
    (void)instance;                             \
    return fmi3OK;                              \
  }
NOTHING_TO_DO(fmi3EnterEventMode)
NOTHING_TO_DO(fmi3EnterContinuousTimeMode)
NOTHING_TO_DO(fmi3EnterStepMode)
NOTHING_TO_DO(fmi3Terminate)
NOTHING_TO_DO(fmi3EnterConfigurationMode)
NOTHING_TO_DO(fmi3ExitConfigurationMode)
NOTHING_TO_DO(fmi3EvaluateDiscreteStates)

/* No variable has this type: only an empty list can be read or written. */
#define NO_VARIABLES(type, c_type)                                                                      \
  EXPORT fmi3Status FMI(fmi3Get##type)(void* instance, const fmi3ValueReference references[], size_t n, \
                                       c_type values[], size_t n_values) {                              \
    (void)instance, (void)references, (void)values;                                                     \
    return n == 0 && n_values == 0 ? fmi3OK : fmi3Error;                                                \
  }                                                                                                     \
  EXPORT fmi3Status FMI(fmi3Set##type)(void* instance, const fmi3ValueReference references[], size_t n, \
                                       const c_type values[], size_t n_values) {                        \
    (void)instance, (void)references, (void)values;                                                     \
    return n == 0 && n_values == 0 ? fmi3OK : fmi3Error;                                                \
  }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(Boolean, bool)
typedef const char* text;
NO_VARIABLES(String, text)

/* These differ in their arguments; none has anything to give. */
#define UNAVAILABLE(name, ...)              \
  EXPORT fmi3Status FMI(name)(__VA_ARGS__); \
  EXPORT fmi3Status FMI(name)(__VA_ARGS__)
typedef const fmi3ValueReference* list;

UNAVAILABLE(fmi3GetBinary, void* i, list r, size_t n, size_t sizes[], const uint8_t* values[], size_t m) {
  (void)i, (void)r, (void)sizes, (void)values;
  return n == 0 && m == 0 ? fmi3OK : fmi3Error;
}
UNAVAILABLE(fmi3SetBinary, void* i, list r, size_t n, const size_t sizes[], const uint8_t* const values[],
            size_t m) {
  (void)i, (void)r, (void)sizes, (void)values;
  return n == 0 && m == 0 ? fmi3OK : fmi3Error;
}
UNAVAILABLE(fmi3GetClock, void* i, list r, size_t n, bool values[]) {
  (void)i, (void)r, (void)values;
  return n == 0 ? fmi3OK : fmi3Error;
}
UNAVAILABLE(fmi3SetClock, void* i, list r, size_t n, const bool values[]) {
  (void)i, (void)r, (void)values;
  return n == 0 ? fmi3OK : fmi3Error;
}
UNAVAILABLE(fmi3GetNumberOfVariableDependencies, void* i, fmi3ValueReference r, size_t* n) {
  (void)i, (void)r;
  *n = 0;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetVariableDependencies, void* i, fmi3ValueReference r, size_t a[], fmi3ValueReference b[],
            size_t c[], int kinds[], size_t n) {
  (void)i, (void)r, (void)a, (void)b, (void)c, (void)kinds, (void)n;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetDirectionalDerivative, void* i, list unknowns, size_t n, list knowns, size_t m,
            const double seed[], size_t n_seed, double sensitivity[], size_t n_sensitivity) {
  (void)i, (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)n_seed, (void)sensitivity;
  (void)n_sensitivity;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetAdjointDerivative, void* i, list unknowns, size_t n, list knowns, size_t m,
            const double seed[], size_t n_seed, double sensitivity[], size_t n_sensitivity) {
  (void)i, (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)n_seed, (void)sensitivity;
  (void)n_sensitivity;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetIntervalDecimal, void* i, list r, size_t n, double intervals[], int qualifiers[]) {
  (void)i, (void)r, (void)n, (void)intervals, (void)qualifiers;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetIntervalFraction, void* i, list r, size_t n, uint64_t counters[], uint64_t resolutions[],
            int qualifiers[]) {
  (void)i, (void)r, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetShiftDecimal, void* i, list r, size_t n, double shifts[]) {
  (void)i, (void)r, (void)n, (void)shifts;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetShiftFraction, void* i, list r, size_t n, uint64_t counters[], uint64_t resolutions[]) {
  (void)i, (void)r, (void)n, (void)counters, (void)resolutions;
  return fmi3Error;
}
UNAVAILABLE(fmi3SetIntervalDecimal, void* i, list r, size_t n, const double intervals[]) {
  (void)i, (void)r, (void)n, (void)intervals;
  return fmi3Error;
}
UNAVAILABLE(fmi3SetIntervalFraction, void* i, list r, size_t n, const uint64_t counters[],
            const uint64_t resolutions[]) {
  (void)i, (void)r, (void)n, (void)counters, (void)resolutions;
  return fmi3Error;
}
UNAVAILABLE(fmi3SetShiftDecimal, void* i, list r, size_t n, const double shifts[]) {
  (void)i, (void)r, (void)n, (void)shifts;
  return fmi3Error;
}
UNAVAILABLE(fmi3SetShiftFraction, void* i, list r, size_t n, const uint64_t counters[],
            const uint64_t resolutions[]) {
  (void)i, (void)r, (void)n, (void)counters, (void)resolutions;
  return fmi3Error;
}
UNAVAILABLE(fmi3GetOutputDerivatives, void* i, list r, size_t n, const int32_t orders[], double values[],
            size_t m) {
  (void)i, (void)r, (void)n, (void)orders, (void)values, (void)m;
  return fmi3Error;
}
UNAVAILABLE(fmi3ActivateModelPartition, void* i, fmi3ValueReference clock, double time) {
  (void)i, (void)clock, (void)time;
  return fmi3Error;
}
