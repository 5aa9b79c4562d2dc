#include "lobe/run/line_file.h"

#include <Eigen/Geometry>
#include <sstream>

#include "lobe/file/atomic_file.h"

namespace lobe {
namespace {

template <class Visit>
void for_segments(const std::vector<TermLines>& lines, Visit&& visit) {
  for (const TermLines& of_one : lines)
    for (std::size_t i = 0; i < of_one.tensions.size(); ++i)
      visit(of_one, Vec3d(of_one.ends.col(Eigen::Index(2 * i))),
            Vec3d(of_one.ends.col(Eigen::Index(2 * i + 1))), i);
}

void put_array(std::ostream& out, const char* type, const char* name, const std::string& values) {
  out << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" format=\"ascii\">" << values
      << "</DataArray>\n";
}

}  // namespace

void write_lines(const std::filesystem::path& file, const std::vector<TermLines>& lines) {
  std::ostringstream points, connectivity, offsets, numbers, tensions, damages;
  for (std::ostringstream* text : {&points, &tensions, &damages}) text->precision(17);
  bool has_damage = false;
  std::size_t count = 0;
  for_segments(lines, [&](const TermLines& line, const Vec3d& from, const Vec3d& to, std::size_t i) {
    for (const Vec3d& x : {from, to}) points << x[0] << ' ' << x[1] << ' ' << x[2] << ' ';
    connectivity << 2 * count << ' ' << 2 * count + 1 << ' ';
    offsets << 2 * ++count << ' ';
    numbers << line.number << ' ';
    tensions << line.tensions[i] << ' ';
    damages << (line.damages.empty() ? 0 : line.damages[i]) << ' ';
    has_damage = has_damage || !line.damages.empty();
  });
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n"
      << "<Piece NumberOfPoints=\"" << 2 * count << "\" NumberOfLines=\"" << count << "\">\n<Points>\n"
      << "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" << points.str()
      << "</DataArray>\n</Points>\n<Lines>\n";
  put_array(out, "Int64", "connectivity", connectivity.str());
  put_array(out, "Int64", "offsets", offsets.str());
  out << "</Lines>\n<CellData>\n";
  put_array(out, "Int32", "number", numbers.str());
  put_array(out, "Float64", "tension", tensions.str());
  if (has_damage) put_array(out, "Float64", "damage", damages.str());
  out << "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  io::write_file(file, out.str());
}

void add_lines(nlohmann::ordered_json& bodies, const std::vector<TermLines>& lines) {
  constexpr double radius = 0.0003;  // [m], that it is seen
  for_segments(lines, [&](const TermLines&, const Vec3d& from, const Vec3d& to, std::size_t) {
    const double length = (to - from).norm();
    if (length == 0) return;
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), Vec3d(to - from));
    bodies.push_back({{"capsule", {radius, length}},
                      {"position", {from[0], from[1], from[2]}},
                      {"orientation", {turn.x(), turn.y(), turn.z(), turn.w()}}});
  });
}

}  // namespace lobe
