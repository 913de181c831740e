// The face of libFuzzer. STRIBECK_FUZZ_SEEDS names a folder that the good inputs are written to.
#include <filesystem>
#include <tests/fuzz/targets/fuzz.hpp>

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* folder = std::getenv("STRIBECK_FUZZ_SEEDS");
  if (folder == nullptr) return 0;
  std::filesystem::create_directories(folder);
  int i = 0;
  for (const std::string& good : stribeck::fuzz::seeds())
    std::ofstream(std::string(folder) + "/seed-" + std::to_string(i++), std::ios::binary) << good;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stribeck::fuzz::one({reinterpret_cast<const char*>(data), size});
  return 0;
}
