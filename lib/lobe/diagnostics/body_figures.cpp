#include "lobe/diagnostics/body_figures.h"

#include "lobe/diagnostics/averaged_pressures.h"
#include "lobe/region/averages.h"
#include "lobe/region/energy_density.h"

namespace lobe {
namespace {

// Adds a tetrahedron. A quarter of its mass moves with each corner.
void add_tet(const Elements& elements, Index tet, const Mat34<double>& u, const Mat34<double>& v,
             double pressure, BodyFigures& to) {
  const Shape shape = elements.shape_of(tet);
  const Mat34<double> x = elements.corner_points(tet) + u;
  const double mass = elements.elastic_of(tet).density * shape.volume;
  const Mat3<double> H = displacement_gradient<double>(u, shape.gradients.rightCols<3>());
  ++to.tets;
  to.mass += mass;
  to.volume += elements.share_of(tet) * signed_volume(x);
  to.kinetic += mass / 8 * v.squaredNorm();
  to.elastic += shape.volume *
                unsmoothed_energy_density(elements, tet, H, elements.region_of[std::size_t(tet)], pressure);
  to.centre += mass / 4 * x.rowwise().sum();
  to.momentum += mass / 4 * v.rowwise().sum();
}

// A smoothing domain is of one body, as its tetrahedra share an edge.
void add_domains(const Elements& elements, const Mat3X<double>& u, std::vector<BodyFigures>& figures) {
  const Averages averages(elements);
  const std::vector<Mat3<double>> gradients = domain_gradients(averages.edges, u);
  const std::vector<double> pressures = domain_pressures(averages.edges, averages.edge_pressures, gradients);
  for (Index e = 0; e < averages.edges.count(); ++e) {
    const SmoothedEdge& edge = averages.edges[e];
    if (!(edge.volume > 0)) continue;
    const Index tet = elements.topology.around(edge.vertices.front()).front();
    figures[std::size_t(elements.bodies.body_of(tet))].elastic +=
        edge.volume * energy_density(elements, edge, gradients[e], edge.model, pressures[e]);
  }
}

}  // namespace

std::vector<BodyFigures> body_figures(const Elements& elements, const Mat3X<double>& u,
                                      const Mat3X<double>& v) {
  std::vector<BodyFigures> figures;
  for (const std::string& name : elements.bodies.names) figures.push_back({.name = name});
  if (figures.empty()) return figures;
  const std::vector<double> pressures = averaged_pressures(elements, u);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    add_tet(elements, t, u(Eigen::all, corners), v(Eigen::all, corners), pressures[std::size_t(t)],
            figures[std::size_t(elements.bodies.body_of(t))]);
  }
  if (any_smoothed(elements.materials)) add_domains(elements, u, figures);
  for (BodyFigures& body : figures)
    if (body.mass > 0) body.centre /= body.mass;
  return figures;
}

}  // namespace lobe
