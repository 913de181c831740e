#pragma once
/// Small logs of every format, made up by hand, for tests: nothing here was recorded. Every log has eight rows;
/// positions go up and down, so that they cannot pass for a time.

#include <string>
#include <vector>

namespace stribeck::io::test {

struct SampleLog {
  const char* name;
  std::string text;
  char separator;                       ///< of the cells of a row; 0: not in lines of cells
  std::vector<std::string> names = {};  ///< to be given by the caller
  double sample_time = 0.0;             ///< [s], to be given by the caller; 0: not
};

inline std::string csv_sample() {
  return "# machine: rig 7\n"
         "t [s],phase,x [mm],f_N\n"
         "0,start,1.5,-10.25\n0.001,run,2.5,-11.5\n0.002,run,3.25,-9.75\n0.003,run,2.75,12.5\n"
         "0.004,run,1.25,13.5\n0.005,run,0.5,11.25\n0.006,run,1.125,-12.5\n0.007,end,1.875,-10.5\n";
}

inline std::string csv_decimal_comma_sample() {
  return "Zeit [ms];x [\xC2\xB5m];I [A]\r\n"
         "0;10,5;-1,25\r\n1;20,5;-1,5\r\n2;30,25;-1,75\r\n3;20,75;2,5\r\n"
         "4;10,25;2,25\r\n5;5,5;1,25\r\n6;12,125;-2,5\r\n7;11,875;-1,5\r\n";
}

inline std::string tncscope_sample() {
  std::string text =
      "%TNCscopeNT data file\r\n% \r\n%[GLOBAL]\r\n%VERSION=2.0\r\n%CONTROL=iTNC530\r\n%SAMPLING=3000\r\n% "
      "\r\n";
  const char* curves[3][4] = {{"s ist/Y", "mm", " 1.000000e+001", " 1.450000e+001"},
                              {"v ist/Y", "mm/min", "-2.500000e+001", " 3.050000e+001"},
                              {"I ist/Y", "Ampere", "", " 2.500000e+000"}};
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i + 1);
    text += "%[CURVE" + n + "]\r\n%NAME=" + curves[i][0] + "\r\n%AXISTYPE=Y\r\n%DIMENSION=" + curves[i][1] +
            "\r\n%COUNT=8\r\n%CYCLETIME=3000\r\n%COLUMN=" + n + "\r\n";
    if (curves[i][2][0] != 0) text += std::string("%MINVAL=") + curves[i][2] + "\r\n";
    text += std::string("%MAXVAL=") + curves[i][3] + "\r\n% \r\n";
  }
  text += "%[DATA]\r\n";
  const char* rows[8] = {" 0.000000000e+000;  1.000000000e+001;  0.000000000e+000;  1.250000000e+000; ",
                         " 3.000000000e+003;  1.050000000e+001;  1.050000000e+001;  1.500000000e+000; ",
                         " 6.000000000e+003;  1.250000000e+001;  3.050000000e+001;  2.500000000e+000; ",
                         " 9.000000000e+003;  1.450000000e+001;  2.000000000e+001;  2.250000000e+000; ",
                         " 1.200000000e+004;  1.425000000e+001; -1.050000000e+001;  1.750000000e+000; ",
                         " 1.500000000e+004;  1.325000000e+001; -2.500000000e+001;  1.125000000e+000; ",
                         " 1.800000000e+004;  1.275000000e+001; -1.250000000e+001;  1.375000000e+000; ",
                         " 2.100000000e+004;  1.300000000e+001;  0.000000000e+000;  1.250000000e+000; "};
  for (const char* row : rows) text += std::string(row) + "\r\n";
  return text;
}

/// Two groups: two channels at 1 ms, one at 2 ms. `s` stands between the cells, `decimal` in the numbers.
inline std::string twincat_sample(char s = '\t', char decimal = '.') {
  const std::string lines =
      "Name|rig_7\nFile|C:\\rig 7\\run.svdx\nStarttime of export|133000000000000000|Dienstag, 5. "
      "M\xC3\xA4rz|10:00:00.000\n"
      "Endtime of export|133000000000070000|Dienstag, 5. M\xC3\xA4rz|10:00:00.007\n\n\n"
      "Name|act pos|torque|Name|temp (1)\n"
      "SymbolComment|||SymbolComment|\n"
      "Data-Type|REAL64|INT16|Data-Type|REAL32\n"
      "SampleTime[ms]|1|1|SampleTime[ms]|2\n"
      "SymbolName|MAIN.x|MAIN.m|SymbolName|MAIN.T\n"
      "Offset|0|0|Offset|0\nScaleFactor|1|1|ScaleFactor|1\n"
      "Unit|mm (Position)|(None)|Unit|V (Voltage)\n"
      "Unit ScaleFactor|1|1|Unit ScaleFactor|1\nUnit Offset|0|0|Unit Offset|0\n\n"
      "0|1.5|10|0|20.5\n1|2.5|12|2|20.25\n2|3.25|-3|4|20.75\n3|2.75|-7|6|21.5\n"
      "4|1.25|-9\n5|0.5|-8\n6|1.125|4\n7|1.875|9\n";
  std::string out;
  bool data = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines.compare(i, 3, "\n\n0") == 0) data = true;
    out += lines[i] == '|' ? s : data && lines[i] == '.' ? decimal : lines[i];
  }
  return out;
}

inline std::string epos_sample() {
  return "Date:;2024-03-05 10:00:00\r\nFirmware Version:;0x0120\r\nEPOS Studio Version:;3.6.1.0\r\n"
         "Recorded samples:;8\r\nSampling period:;12.800\r\n"
         "Trigger:;1;0.000000;\"Parameter values\"\r\n"
         ";Velocity actual value averaged;Torque actual value averaged\r\nms;rpm;%\r\n"
         "0.000;101;-24.1\r\n12.800;100;-24.8\r\n25.600;99;-27.1\r\n38.400;98;-30.2\r\n"
         "51.200;-97;31.0\r\n64.000;-99;28.5\r\n76.800;-100;28.0\r\n89.600;-101;26.8\r\n";
}

/// The same after a spreadsheet saved it and a user edited it.
inline std::string epos_resaved_sample() {
  return "Date:;2024-03-05 10:00:00,,\nFirmware Version:;0x0120,,\nEPOS Studio Version:;3.6.1.0,,\n"
         "Recorded samples:;8,,\nSampling period:;12.800,,\n"
         "\"Trigger:;1;0.000000;\"\"Parameter values\"\"\",,\n"
         ";Velocity actual value averaged;Torque actual value averaged,,\nms;rpm;%,,\n"
         "0.000;101;-24.1,,\n12.800;100;-400,,was -24.8\n25.600;99;-27.1,,\n38.400;98;-30.2,,\n"
         "51.200;-97;31.0,,\n64.000;-99;28.5,,\n76.800;-100;28.0,,\n89.600;-101;26.8,,\n";
}

inline std::string mr_sample() {
  return "Axis1\r\nNumber of sampling data,8\r\nSampling time interval(ms),0.667\r\n"
         "Time,Analog 1,Analog 2,Analog 3,Analog 4,Digital 1,Digital 2\r\n"
         "ms,Servo motor speed,Torque,Droop pulses (by 100 pls.),Not selected,INP,Not selected\r\n"
         "0.000000,10.000000,-1.000000,-11.000000,0.000000,2.500000,0.000000\r\n"
         "0.666666,11.000000,-1.500000,-12.000000,0.000000,2.500000,0.000000\r\n"
         "1.333332,12.000000,-2.000000,-13.000000,0.000000,2.500000,0.000000\r\n"
         "1.999998,11.500000,3.000000,-12.500000,0.000000,0.000000,0.000000\r\n"
         "2.666664,10.500000,3.500000,14.000000,0.000000,0.000000,0.000000\r\n"
         "3.333330,9.500000,2.500000,13.000000,0.000000,0.000000,0.000000\r\n"
         "3.999996,-10.000000,-1.250000,12.000000,0.000000,2.500000,0.000000\r\n"
         "4.666662,-10.500000,-1.125000,11.000000,0.000000,2.500000,0.000000\r\n\r\n";
}

inline std::string ni_sample() {
  return "\xEF\xBB\xBFTimestamp,2024-03-05 10:00:00,Timestamp,2024-03-05 10:00:00\r\n"
         "Interval,0.0005,Interval,0.001\r\nChannel name,\"Force\",Channel name,\"Input 1\"\r\n"
         "Unit,\"V\",Unit,\"V\"\r\n"
         "0,-0.129,0,-3.215\r\n0.0005,-0.131,0.001,-3.22\r\n0.001,-0.1237,0.002,3.2125\r\n"
         "0.0015,0.1269,0.003,3.2143\r\n0.002,0.13,,\r\n0.0025,0.1332,,\r\n0.003,-0.125,,\r\n0.0035,-0.128,,\r\n";
}

inline std::string halsampler_sample() {
  return "0 1.500000 -10.250000 1 \n1 2.500000 -11.500000 1 \n2 3.250000 -9.750000 0 \noverrun\n"
         "3 2.750000 12.500000 0 \n4 1.250000 13.500000 0 \n5 0.500000 11.250000 1 \n"
         "9 1.125000 -12.500000 1 \n10 1.875000 -10.500000 1 \n";
}

inline std::string sinumerik_json_sample() {
  return "{\n\"Header\":\n{\n  \"Version\" : { \"RecorderVersion\" : \"3.1\" },\n"
         "  \"MachineInfo\" : { \"MachineName\" : \"rig_7\" },\n"
         "  \"SignalListHFData\" : [ { \"Name\" : \"CYCLE\", \"Type\" : \"INTEGER\", \"Axis\" : \"Cycle\" "
         "},\n"
         "    { \"Name\" : \"ENC_POS|1\", \"Type\" : \"DOUBLE\", \"Axis\" : \"X1\" },\n"
         "    { \"Name\" : \"CURRENT|1\", \"Type\" : \"DOUBLE\", \"Axis\" : \"X1\" },\n"
         "    { \"Name\" : \"ENC_POS|4\", \"Type\" : \"DOUBLE\", \"Axis\" : \"C1\" } ],\n"
         "  \"CycleTimeMs\" : 2,\n  \"Initial\" : { \"Time\" : \"2024-03-05T10:00:00Z\" "
         "}\n},\n\"Payload\":\n[\n"
         "{\"HFTimestamp\":{\"Time\":\"2024-03-05T10:00:00Z\",\"HFProbeCounter\":100}},\n"
         "{\"HFData\":[[100,1.5,-10.25,90.0],[101,2.5,-11.5,90.5],[102,3.25,-9.75,91.25]]},\n"
         "{\"HFBlockEvent\":{\"HFProbeCounter\":103,\"GCode\":\"G1 X1\",\"ipoReadError\":null}},\n"
         "{\"HFData\":[[103,2.75,12.5,90.75],\n[150,1.25,1.35E1,90.25],[151,0.5,11.25,89.5]]},\n"
         "{\"LFData\":[{\"value\":\"6\"}]},\n"
         "{\"HFData\":[[152,1.125,-12.5,90.125],[153,1.875,-1.05E1,90.0]]}\n],\n\"Footer\":{\"ErrorMessages\":[]}}\n";
}

inline std::string sinumerik_csv_sample() {
  return "CYCLE,ENC_POS|1,CURRENT|1,LOAD|1\n"
         "100,1.5,-10.25,1\n101,2.5,-11.5,2\n102,3.25,-9.75,3\n103,2.75,12.5,2.5\n"
         "150,1.25,13.5,1.5\n151,0.5,11.25,-1\n152,1.125,-12.5,-2\n153,1.875,-10.5,0.5\n";
}

/// s1 every 2 ms on change, s2 every 4 ms, s3 a signal of the PLC.
inline std::string sinumerik_trace_sample() {
  return "<?xml version=\"1.0\" encoding=\"utf-8\" ?>\n<traceSession version=\"01.00\">\n"
         "<traceDisplaySetup_V20>\n <signals>\n"
         "  <signal key=\"s1\" name=\"/Nck/current [u1, 1]\" description=\"Current i(q)\" "
         "unitsType=\"current\"/>\n"
         "  <signal key=\"s2\" name=\"/Nck/pos [u1, 1]\" description=\"Position &lt;1&gt;\" "
         "unitsType=\"posn\"/>\n"
         "  <signal key=\"s3\" name=\"/Plc/M1.0\" description=\"Brake\" unitsType=\"none\"/>\n"
         " </signals>\n</traceDisplaySetup_V20>\n<traceData>\n <dataFrame>\n"
         "  <frameHeader startTime=\"2024-03-05T10:00:00Z\" dropOuts=\"0\" stopInc=\"0.014\"/>\n"
         "  <dataSignal id=\"f1\" key=\"s1\" interval=\"0.002000\" datapointCount=\"8\" "
         "unitsType=\"current\"/>\n"
         "  <dataSignal id=\"f2\" key=\"s2\" interval=\"0.004000\" datapointCount=\"4\" "
         "unitsType=\"posn\"/>\n"
         "  <dataSignal id=\"f3\" key=\"s3\" interval=\"0.002000\" datapointCount=\"8\" "
         "unitsType=\"none\"/>\n"
         "  <rec time=\"0.000000\" f1=\"-1.250000\" f3=\"false\"/>\n"
         "  <rec time=\"0.002000\" f1=\"-1.500000\" f2=\"10.500000\"/>\n"
         "  <rec time=\"0.004000\" f3=\"true\"/>\n"
         "  <rec time=\"0.006000\" f1=\"2.250000\" f2=\"11.500000\"/>\n"
         "  <rec time=\"0.010000\" f1=\"2.500000\" f2=\"11.250000\"/>\n"
         "  <rec time=\"0.012000\" f1=\"-1.750000\"/>\n"
         "  <rec time=\"0.014000\" f1=\"-1.500000\" f2=\"10.750000\" f3=\"true\"/>\n"
         " </dataFrame>\n</traceData>\n</traceSession>\n";
}

/// No column of times.
inline std::string untimed_sample() {
  return "X1_ActualPosition,X1_CurrentFeedback,Machining_Process\n"
         "1.98E+02,1.80E-01,Starting\n1.99E+02,-2.50E-01,Prep\n2.01E+02,3.10E-01,Prep\n1.97E+02,-4.00E-01,Layer 1\n"
         "1.95E+02,5.00E-01,Layer 1\n1.96E+02,-6.20E-01,Layer 2\n1.98E+02,7.10E-01,Layer "
         "2\n1.99E+02,8.00E-01,end\n";
}

inline std::vector<SampleLog> sample_logs() {
  const std::vector<std::string> pins{"x mm", "f N", "in-position"};
  return {{"CSV", csv_sample(), ','},
          {"CSV with decimal comma", csv_decimal_comma_sample(), ';'},
          {"TNCscope", tncscope_sample(), ';'},
          {"TwinCAT with tabs", twincat_sample(), '\t'},
          {"TwinCAT with semicolons", twincat_sample(';', ','), ';'},
          {"TwinCAT with commas", twincat_sample(','), ','},
          {"EPOS", epos_sample(), ';'},
          {"EPOS saved again", epos_resaved_sample(), ';'},
          {"MR Configurator2", mr_sample(), ','},
          {"NI DAQ", ni_sample(), ','},
          {"halsampler", halsampler_sample(), ' ', pins, 1e-3},
          {"SINUMERIK JSON", sinumerik_json_sample(), 0},
          {"SINUMERIK CSV", sinumerik_csv_sample(), ',', {}, 2e-3},
          {"SINUMERIK trace", sinumerik_trace_sample(), 0},
          {"CSV without times", untimed_sample(), ',', {}, 0.1}};
}

}  // namespace stribeck::io::test
