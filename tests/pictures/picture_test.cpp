// lobe-picture as its callers use it: a request and meshes in, PNG files, messages and exit statuses out.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "folder.h"

namespace {

namespace fs = std::filesystem;

struct Folder : lobe::test::Folder {
  std::string read(const std::string& name) const { return lobe::test::bytes_of(path / name); }
};

// Two tetrahedra on one face, the first in region 0, the second in region 2; `moved` is the displacement of
// the last vertex.
std::string two_tetrahedra(const std::string& moved = "0 0 0.2", int count = 2) {
  const bool both = count == 2;
  std::ostringstream vtu;
  vtu << R"(<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>)"
      << R"(<Piece NumberOfPoints="5" NumberOfCells=")" << count << R"("><PointData>)"
      << R"(<DataArray type="Float64" Name="displacement" NumberOfComponents="3" format="ascii">)"
      << "0 0 0 0 0 0 0 0 0 0 0 0 " << moved << "</DataArray></PointData><CellData>"
      << R"(<DataArray type="Int32" Name="region" format="ascii">)" << (both ? "0 2" : "0")
      << R"(</DataArray></CellData><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">)"
      << "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points><Cells>"
      << R"(<DataArray type="Int32" Name="connectivity" format="ascii">)"
      << (both ? "0 1 2 3 1 2 3 4" : "0 1 2 3") << "</DataArray>"
      << R"(<DataArray type="Int32" Name="offsets" format="ascii">)" << (both ? "4 8" : "4")
      << R"(</DataArray><DataArray type="UInt8" Name="types" format="ascii">)" << (both ? "10 10" : "10")
      << "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n";
  return vtu.str();
}

// Runs the request; its standard error is then in messages.txt.
int run(const Folder& folder, const std::string& request, const std::string& options = "",
        const std::string& environment = "env -u DISPLAY") {
  folder.write("request.json", request);
  const std::string command = "cd '" + folder.path.string() + "' && " + environment +
                              " '" LOBE_BIN_DIR "/lobe-picture' request.json " + options + " 2> messages.txt";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string one_panel(const std::string& panel, const std::string& more = "") {
  return R"({"pictures": [{"out": "out.png", "size": [320, 240], "panels": [)" + panel + "]" + more + "}]}";
}

using Rgb = std::array<int, 3>;

struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;

  std::size_t colors() const { return std::set<Rgb>(pixels.begin(), pixels.end()).size(); }
  int count_near(const Rgb& color) const {
    int count = 0;
    for (const Rgb& p : pixels) {
      const int off = std::abs(p[0] - color[0]) + std::abs(p[1] - color[1]) + std::abs(p[2] - color[2]);
      count += off <= 3;
    }
    return count;
  }
};

Image read_image(const fs::path& file) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* data = reader->GetOutput();
  Image image{data->GetDimensions()[0], data->GetDimensions()[1], {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto channel = [&](int k) {
        return static_cast<int>(data->GetScalarComponentAsDouble(x, y, 0, k));
      };
      image.pixels.push_back({channel(0), channel(1), channel(2)});
    }
  }
  return image;
}

// One line, naming what is wrong; no picture, whole or in part.
void check_refused(const Folder& folder, const std::string& request, const std::string& expected) {
  CAPTURE(request);
  CHECK(run(folder, request) == 2);
  const std::string message = folder.read("messages.txt");
  CAPTURE(message);
  CHECK(message.starts_with("lobe-picture: error: "));
  CHECK(message.find(expected) != std::string::npos);
  CHECK(message.find('\n') == message.size() - 1);
  CHECK_FALSE(fs::exists(folder.path / "out.png"));
  CHECK_FALSE(fs::exists(folder.path / "out.png.tmp"));
}

const Rgb tensor_mass_color = {74, 133, 191};  // of the legend's squares, which no light changes
const Rgb precomputed_color = {102, 158, 128};

}  // namespace

TEST_CASE("two tetrahedra give a shaded picture of the requested size with the legend of their regions") {
  const Folder folder;
  folder.write("tets.vtu", two_tetrahedra());
  REQUIRE(run(folder, one_panel(R"({"mesh": "tets.vtu", "color": "region", "edges": true, "title": "t = 0 s",
    "tools": [{"type": "cautery", "position": [0, 0, 1], "radius": 0.05},
              {"type": "grasp", "position": [1, 1, 1], "radius": 0.05, "points": [[1, 1, 1.2]]}]})")) == 0);
  CHECK(folder.read("messages.txt").empty());
  const Image image = read_image(folder.path / "out.png");
  CHECK(image.width == 320);
  CHECK(image.height == 240);
  CHECK(image.colors() > 300);
  CHECK(image.count_near(tensor_mass_color) > 40);
  CHECK(image.count_near(precomputed_color) == 0);
}

TEST_CASE("fibres are lines in the faces that they do not cross at right angles") {
  const Folder folder;
  std::string tets = two_tetrahedra("0 0 0", 1);
  folder.write("none.vtu", tets);
  const std::string array =
      R"(<DataArray type="Float64" Name="fibre" NumberOfComponents="3" format="ascii">1 0 0</DataArray>)";
  tets.insert(tets.find("</CellData>"), array);
  folder.write("tets.vtu", tets);
  const Rgb line_color = {250, 230, 158};
  const auto lines_seen_from = [&](const std::string& direction, const std::string& more) {
    const std::string camera = R"(, "camera": {"direction": )" + direction + "}";
    REQUIRE(run(folder, one_panel(R"({"mesh": "tets.vtu")" + more + "}", camera)) == 0);
    const Image image = read_image(folder.path / "out.png");
    fs::remove(folder.path / "out.png");
    return image.count_near(line_color);
  };
  const int along = lines_seen_from("[0, -1, 0.01]", R"(, "fibres": true)");  // the face y = 0
  CHECK(along > 60);
  CHECK(lines_seen_from("[0, -1, 0.01]", "") == 0);
  CHECK(lines_seen_from("[-1, 0, 0]", R"(, "fibres": true)") < along / 5);  // the face x = 0
  check_refused(folder, one_panel(R"({"mesh": "none.vtu", "fibres": true})"), "has no cell array \"fibre\"");
}

TEST_CASE("the displacement moves the drawn surface, at the same scale in all panels") {
  const Folder folder;
  folder.write("rest.vtu", two_tetrahedra("0 0 0"));
  folder.write("moved.vtu", two_tetrahedra("0.5 0.5 0.5"));
  const std::string panels = R"({"mesh": "rest.vtu"}, {"mesh": "moved.vtu"})";
  REQUIRE(run(folder, one_panel(panels)) == 0);
  const Image image = read_image(folder.path / "out.png");
  std::array<int, 2> organ = {0, 0};  // red pixels of the left and the right panel
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgb& p = image.pixels[i];
    organ[i % 320 >= 160] += p[0] > p[2] + 30;
  }
  CHECK(organ[0] > 500);
  CHECK(organ[1] > 1.2 * organ[0]);
}

TEST_CASE("faces that a cut has exposed look different, and a clip plane leaves cells out") {
  const Folder folder;
  folder.write("two.vtu", two_tetrahedra("0 0 0"));
  folder.write("one.vtu", two_tetrahedra("0 0 0", 1));
  const std::string camera = R"(, "camera": {"direction": [1, 1, 1]})";
  REQUIRE(run(folder, one_panel(R"({"mesh": "one.vtu"})", camera)) == 0);
  const Image whole = read_image(folder.path / "out.png");
  REQUIRE(run(folder, one_panel(R"({"mesh": "one.vtu", "first": "two.vtu"})", camera)) == 0);
  CHECK(read_image(folder.path / "out.png").pixels != whole.pixels);
  const std::string clip = R"(, "clip": {"point": [0.3, 0.3, 0.3], "normal": [1, 1, 1]})";
  REQUIRE(run(folder, one_panel(R"({"mesh": "two.vtu"})", camera + clip)) == 0);
  const Image clipped = read_image(folder.path / "out.png");
  CHECK(clipped.pixels == whole.pixels);
}

TEST_CASE("an array is drawn with its colour scale") {
  const Folder folder;
  folder.write("tets.vtu", two_tetrahedra());
  REQUIRE(run(folder, one_panel(R"({"mesh": "tets.vtu", "color": "displacement"})")) == 0);
  const Image image = read_image(folder.path / "out.png");
  CHECK(image.count_near({253, 231, 37}) > 5);  // the upper end of the scale
  CHECK(image.count_near({68, 1, 84}) > 5);     // the lower end
}

TEST_CASE("a bad request or mesh is one line and exit status 2") {
  const Folder folder;
  folder.write("tets.vtu", two_tetrahedra());
  folder.write("nan.vtu", two_tetrahedra("0 nan 0"));
  folder.write("broken.vtu", two_tetrahedra().substr(0, 400));
  folder.write("empty.obj", "");
  check_refused(folder, one_panel(R"({"mesh": "missing.vtu"})"), "missing.vtu: no such file");
  check_refused(folder, one_panel(R"({"mesh": "nan.vtu"})"), "nan.vtu");
  check_refused(folder, one_panel(R"({"mesh": "broken.vtu"})"), "broken.vtu");
  check_refused(folder, one_panel(R"({"mesh": "empty.obj"})"), "empty.obj: is empty");
  check_refused(folder, one_panel(R"({"mesh": "tets.vtu", "color": "stress"})"),
                "there are: none, region, body, displacement");
  check_refused(folder, one_panel(R"({"mesh": "tets.vtu", "color": "body"})"), "has no cell array \"body\"");
  check_refused(folder, one_panel(R"({"mesh": "tets.vtu", "colour": "none"})"),
                "/pictures/0/panels/0/colour: unknown key");
  check_refused(folder, one_panel(R"({"mesh": "tets.vtu", "bodies": [{"position": [0, 0, 0]}]})"),
                "/pictures/0/panels/0/bodies/0: needs \"box\" or \"capsule\"");
  check_refused(folder,
                one_panel(R"({"mesh": "tets.vtu", "bodies": [{"box": [1, 0, 1], "position": [0, 0, 0]}]})"),
                "/pictures/0/panels/0/bodies/0/box: must be above 0");
  check_refused(folder, one_panel(R"({"mesh": "tets.vtu"})", R"(, "size": [0, 5])"), "/pictures/0/size");
  check_refused(folder, R"({"pictures": [)", "request.json: ");
}

TEST_CASE("a wrong command line is one line and exit status 2") {
  const Folder folder;
  CHECK(run(folder, "{}", "--colour red") == 2);
  const std::string messages = folder.read("messages.txt");
  CHECK(messages.starts_with("lobe-picture: error: "));
  CHECK(messages.find("--colour") != std::string::npos);
  CHECK(messages.find('\n') == messages.size() - 1);
}

TEST_CASE("pictures that are drawn at the same time all succeed, and leave no server and no files behind") {
  const Folder folder;
  folder.write("tets.vtu", two_tetrahedra());
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  std::string together;
  for (const std::string& name : names) {
    folder.write(name + ".json", R"({"pictures": [{"out": ")" + name +
                                     R"(.png", "size": [64, 64], "panels": [{"mesh": "tets.vtu"}]}]})");
    together += "('" LOBE_BIN_DIR "/lobe-picture' " + name + ".json 2> " + name + ".txt; echo $? > " + name +
                ".status) & ";
  }
  fs::create_directory(folder.path / "temporary");
  const std::string command =
      "cd '" + folder.path.string() + "' || exit 1; export TMPDIR=$PWD/temporary; " + together + "wait";
  CHECK(std::system(command.c_str()) == 0);
  for (const std::string& name : names) {
    CHECK(folder.read(name + ".status") == "0\n");
    CHECK_MESSAGE(folder.read(name + ".txt").empty(), folder.read(name + ".txt"));
    CHECK(fs::exists(folder.path / (name + ".png")));
  }
  CHECK(fs::is_empty(folder.path / "temporary"));
}

TEST_CASE("without an X server that can be started or is there, one line says what to install") {
  const Folder folder;
  folder.write("tets.vtu", two_tetrahedra());
  CHECK(run(folder, one_panel(R"({"mesh": "tets.vtu"})"), "", "env -u DISPLAY PATH=/nowhere") == 2);
  CHECK(folder.read("messages.txt") ==
        "lobe-picture: error: there is no X server to draw on: install Xvfb (Debian's package xvfb)\n");
}
