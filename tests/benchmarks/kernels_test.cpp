// The kernels' benchmark: its checks, and `lobe bench kernels` itself.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "bench_results.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/roofline.h"

using namespace lobe;
using namespace lobe::bench;
using namespace lobe::test;
namespace fs = std::filesystem;

namespace {

int lobe_bench(const std::string& arguments, const fs::path& errors) {
  const int status =
      std::system((LOBE_BIN_DIR "/lobe bench " + arguments + " >/dev/null 2>" + errors.string()).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("every kernel gives the reference's forces, and a wrong force is noticed") {
  std::vector<Kernel> kernels = make_kernels(std::make_shared<Specimen>("cube", cube_setup(384)), {1, 2});
  CHECK(kernels.size() == 1 + 20 * 2 * 2);
  CHECK(kernels.front().name == "reference");
  for (const Kernel& kernel : kernels) {
    INFO(kernel.name << ' ' << kernel.precision << ' ' << kernel.threads);
    CHECK(deviation(kernel) <= allowed_deviation(kernel));
    CHECK(kernel.bytes_per_tet > 0);
  }
  for (Kernel& kernel : kernels) {
    auto wrong = std::make_shared<Mat3X<double>>(*kernel.expected);
    *wrong *= 1 + 10 * allowed_deviation(kernel);
    kernel.expected = wrong;
    if (kernel.name == "step") continue;  // has moved on
    CHECK(deviation(kernel) > allowed_deviation(kernel));
  }
}

TEST_CASE("the kernels give the reference's forces on a cube numbered at random and on the liver, too") {
  for (const auto& body :
       {Specimen("shuffled", shuffled(cube_setup(3000))), Specimen("liver", liver_setup())})
    for (const Kernel& kernel : make_kernels(std::make_shared<Specimen>(body), {2})) {
      INFO(body.mesh << ' ' << kernel.name << ' ' << kernel.precision);
      CHECK(deviation(kernel) <= allowed_deviation(kernel));
    }
}

TEST_CASE("operations are counted as the formulas have them, and what the machine can do is a number") {
  // 9 + 45: differences and gradient; 18 + 45 + 9: E; 3 + 1 + 9 + 3: S; 45 + 9: P; 45 + 6
  // of corner forces, and 12 to add them
  CHECK(flops_svk() == 54 + 72 + 16 + 54 + 51 + 12);
  CHECK(flops_svk_volume() > flops_svk());
  CHECK(flops_tensor_mass_edge() == 3 + 2 * 15 + 6);
  for (double measured :
       {stream_bytes_per_second(), peak_flops_per_second<float>(), peak_flops_per_second<double>()})
    CHECK((std::isfinite(measured) && measured > 0));
}

TEST_CASE("lobe bench kernels writes a table of finite positive ratios, a plot script, and the machine") {
  const Folder folder;
  const fs::path results = folder.path / "it's here";
  const fs::path errors = folder.path / "errors";
  const int status =
      lobe_bench("kernels --tets 384,2000 --quick --threads 2 -o \"" + results.string() + '"', errors);
  CHECK_MESSAGE(status == 0, bytes_of(errors));
  std::istringstream csv(bytes_of(results / "kernels.csv"));
  std::string line;
  REQUIRE(std::getline(csv, line));
  CHECK(line.starts_with("kernel,precision,threads,tets,ns_per_tet,ratio,"));
  std::set<std::string> kernels;
  int rows = 0;
  while (std::getline(csv, line)) {
    INFO(line);
    const std::vector<std::string> cells = cells_of(line);
    REQUIRE(cells.size() ==
            cells_of("kernel,precision,threads,tets,ns_per_tet,ratio,bytes_per_tet,deviation,spread,mesh,"
                     "flops_per_tet,gb_per_s,gflop_per_s,world_bytes_per_tet")
                .size());
    kernels.insert(cells[0]);
    CHECK((cells[3] == "384" || cells[3] == "2058"));
    for (int column : {4, 5, 6}) {
      const double value = std::stod(cells[column]);
      CHECK((std::isfinite(value) && value > 0));
    }
    if (cells[0] == "reference") CHECK(cells[5] == "1");
    ++rows;
  }
  CHECK(rows == 2 * (1 + 20 * 2 * 2));
  CHECK(kernels == std::set<std::string>{"corotational",
                                         "corotational_smoothed",
                                         "holzapfel",
                                         "mooney_rivlin",
                                         "neo_hookean",
                                         "reference",
                                         "step",
                                         "svk",
                                         "svk_fibre",
                                         "svk_guard",
                                         "svk_nodal_pressure",
                                         "svk_prony",
                                         "svk_smoothed",
                                         "svk_smoothed_pressure",
                                         "svk_smoothed_prony",
                                         "svk_smoothed_volume",
                                         "svk_stored",
                                         "svk_volume",
                                         "tensor_mass",
                                         "tensor_mass_smoothed",
                                         "yeoh"});
  CHECK(fs::exists(results / "kernels.gp"));
  CHECK(bytes_of(results / "machine.txt").find("threads") != std::string::npos);
}

TEST_CASE("an unknown benchmark is refused with the list of those there are") {
  const Folder folder;
  const fs::path errors = folder.path / "errors";
  CHECK(lobe_bench("kernel -o " + (folder.path / "out").string(), errors) == 2);
  CHECK(bytes_of(errors).find("kernels:") != std::string::npos);
  CHECK_FALSE(fs::exists(folder.path / "out"));
  CHECK(lobe_bench("kernels --tets 3 -o " + (folder.path / "out").string(), errors) == 2);
}
