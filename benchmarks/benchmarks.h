// The benchmarks behind `lobe bench NAME -o DIR`. Each checks its results, prints a table, and writes
// DIR/NAME.csv, DIR/NAME.gp (gnuplot) and DIR/machine.txt.
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace lobe::bench {

struct Options {
  std::filesystem::path output;  // made if it does not exist
  std::vector<int> tets;         // numbers of tetrahedra; empty: the benchmark's own
  bool quick = false;            // below 60 s, less precise
  int threads = 1;      // kernels, realtime: if above 1, timed as well as one thread; accuracy: of every run;
                        // huge: most ranks
  bool single = false;  // accuracy: only in single precision
  bool reduced = false;      // hybrid: only gestures, all non-linear and all reduced, and natural frequencies
  bool loop = false;         // haptic: only how punctual the loop is
  bool predictions = false;  // haptic: only what is felt between frames
  std::string model;         // stress: only this one; empty: all
  std::string family;        // validation: only this one; empty: all
  double minutes = 10;       // soak: of wall time; live: simulated
  int frames = 1'000'000;    // soak: of each session
  std::vector<std::filesystem::path> scenes;  // accuracy, hybrid, realtime: in place of the shipped ones
  // accuracy, hybrid, realtime: of the one scene, beside its own; elements, haptic, scalpel: beside the
  // shipped liver
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path refine;  // accuracy, of one scene: the mesh to refine; empty: the largest
};

// A kernel whose result is not the reference's, so that it is not timed; a reference that did not run to its
// end; failed rows of the validation.
class WrongResult : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Benchmark {
  const char* name;
  const char* help;
  void (*run)(const Options& options);  // throws InputError, WrongResult
  bool takes_meshes = false, takes_scenes = false;
};

std::span<const Benchmark> all_benchmarks();

void bench_kernels(const Options& options);
void bench_accuracy(const Options& options);
void bench_validation(const Options& options);
void bench_cut(const Options& options);
void bench_elements(const Options& options);
void bench_features(const Options& options);
void bench_realtime(const Options& options);
void bench_hybrid(const Options& options);
void bench_steps(const Options& options);
void bench_own_steps(const Options& options);
void bench_own_pairs(const Options& options);
void bench_stress(const Options& options);
void bench_surface(const Options& options);
void bench_live(const Options& options);
void bench_haptic(const Options& options);
void bench_skin(const Options& options);
void bench_scalpel(const Options& options);
void bench_contact(const Options& options);
void bench_palpation(const Options& options);
void bench_huge(const Options& options);
void bench_soak(const Options& options);

}  // namespace lobe::bench
