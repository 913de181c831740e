#include <algorithm>

#include <stribeck/io/log/column_names.hpp>
#include <stribeck/workflow/log/columns.hpp>

namespace stribeck::workflow {
namespace {

const std::vector<KnownColumn>& known_quantities() {
  static const std::vector<KnownColumn> all{
      {LogQuantity::kTime, quantity("s", "s"), {NameFamily(io::kTimeNames.begin(), io::kTimeNames.end())}},
      {LogQuantity::kReference,
       quantity("m", "mm"),
       {{"r"},
        {"ref", "reference"},
        {"q_ref", "q_cmd", "q_des"},
        {"x_ref", "x_cmd", "x_soll"},
        {"pos_ref", "position_ref", "pos_cmd", "pos_soll", "lagesollwert", "sollposition"},
        {"des_pos"},
        {"commandposition"},
        {"s soll", "s nominal", "s nom", "s_soll"},
        {"setpos", "position demand value"},
        {"rpos"}}},
      {LogQuantity::kPosition,
       quantity("m", "mm"),
       {{"x"},
        {"q"},
        {"pos", "position"},
        {"pos_act", "position_act", "x_act", "x_enc", "x_fb", "q_act", "pos_ist", "lageistwert",
         "istposition"},
        {"enc_pos", "enc1_pos", "enc2_pos"},
        {"actualposition"},
        {"s ist", "s actual", "s act", "s_ist"},
        {"actpos", "position actual value"},
        {"fpos"}}},
      {LogQuantity::kMotor, quantity("m", "mm"), {{"motor"}}},
      {LogQuantity::kScale, quantity("m", "mm"), {{"scale"}}},
      {LogQuantity::kVelocity,
       quantity("m/s", "mm/s"),
       {{"v"},
        {"dq", "qd", "q_dot"},
        {"vel", "velocity", "speed"},
        {"vel_act", "velocity_act", "v_act", "vel_ist", "x_rate"},
        {"actualvelocity"},
        {"v ist", "v actual", "v act", "v_ist"},
        {"actvelo", "velocity actual value averaged", "velocity actual value"},
        {"servo motor speed", "motor speed"},
        {"fvel"}}},
      {LogQuantity::kReferenceVelocity,
       quantity("m/s", "mm/s"),
       {{"vel_ref", "velocity_ref", "v_ref", "vel_cmd"},
        {"commandvelocity"},
        {"v soll", "v nominal", "v nom", "v_soll"},
        {"setvelo", "velocity demand value"},
        {"speed command"},
        {"vel_ffw"},
        {"rvel"}}},
      {LogQuantity::kAcceleration,
       quantity("m/s2", "mm/s2"),
       {{"a", "acc", "acceleration"}, {"actualacceleration"}}},
      {LogQuantity::kForce, quantity("N", "N"), {{"f", "force", "kraft"}}},
      {LogQuantity::kTorque,
       quantity("N m", "N m"),
       {{"torque", "moment", "drehmoment", "tau"},
        {"acttorque", "torque actual value averaged", "torque actual value"}}},
      {LogQuantity::kCurrent,
       quantity("A", "A"),
       {{"i", "current", "strom", "iq"},
        {"i_act", "current_act", "iq_act"},
        {"current_ref", "i_ref", "iq_ref"},
        {"current_abs"},
        {"currentfeedback"},
        {"i ist", "i actual", "i act", "i_ist"},
        {"actcurrent", "current actual value averaged", "current actual value"}}},
      {LogQuantity::kVoltage, quantity("V", "V"), {{"u", "voltage", "spannung"}, {"outputvoltage"}}},
      {LogQuantity::kPercent, quantity("", ""), {{"percent", "load"}}},
      {LogQuantity::kPressure, quantity("Pa", "bar"), {}}};
  return all;
}

}  // namespace

const KnownColumn& known_column(LogQuantity what) {
  const auto& all = known_quantities();
  return *std::find_if(all.begin(), all.end(), [&](const KnownColumn& k) { return k.what == what; });
}

}  // namespace stribeck::workflow
