#include "benchmarks/machine.h"
#include "lobe/file/atomic_file.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "lobe/instruction_set.h"

namespace lobe::bench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) {
      const std::size_t name = line.find_first_not_of(" \t", line.find(':') + 1);
      if (name != std::string::npos) return line.substr(name);
    }
  return "unknown processor";
}

std::string compiler() {
#ifdef __clang__
  std::string name = __VERSION__;
#else
  std::string name = std::string("GCC ") + __VERSION__;
#endif
#ifndef NDEBUG
  name += " with assertions";
#endif
  return name;
}

}  // namespace

std::string machine_line() {
  char date[32] = "";
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  double load = 0;
  const bool known = getloadavg(&load, 1) == 1;
  char load_text[32];
  std::snprintf(load_text, sizeof load_text, known ? "%.1f" : "unknown", load);
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " hardware threads; " +
         compiler() + ", " + name(chosen_instruction_set()) + "; " + date + ", load " + load_text;
}

std::string begin_results(const std::filesystem::path& directory, const std::string& benchmark) {
  std::filesystem::create_directories(directory);
  const std::string machine = machine_line(), own = benchmark + ": ";
  std::string text;
  std::ifstream before(directory / "machine.txt");
  for (std::string line; std::getline(before, line);)
    if (line.find(": ") != line.npos && !line.starts_with(own)) text += line + '\n';
  before.close();
  io::write_file(directory / "machine.txt", text + own + machine + '\n');
  std::printf("%s\n", machine.c_str());
  return machine;
}

double resident_bytes() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ifstream pages("/proc/self/statm");
  double all = 0, resident = 0;
  return pages >> all >> resident ? resident * double(sysconf(_SC_PAGESIZE)) : 0;
}

double allocated_bytes() {
#ifdef __GLIBC__
  const struct mallinfo2 now = mallinfo2();
  return double(now.uordblks) + double(now.hblkhd);
#else
  return 0;
#endif
}

}  // namespace lobe::bench
